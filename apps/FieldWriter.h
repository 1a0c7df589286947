#pragma once

#include <filesystem>

#include "apps/Program.h"
#include "volume/hbField.h"

namespace app {

/// Writes a field's true values at the samples of `geometry` (any sizes, on the field's cube) as a volume file of
/// float32, or float64 where the field's value map needs it. Slab by slab: memory for one of them, checked
/// before work starts. Throws hbError.
void writeField(const hbField& field, const hbGeometry& geometry, const std::filesystem::path& path,
                const CommonOptions& common);

} // namespace app
