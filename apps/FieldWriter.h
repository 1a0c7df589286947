#pragma once

#include <filesystem>

#include "volume/hbField.h"
#include "volume/hbProgress.h"

namespace app {

/// Writes a field's true values at the samples of `geometry` (any sizes, on the field's cube) as a volume file of
/// float32, or float64 where the field's value map needs it. Slab by slab: bounded memory. Throws hbError.
void writeField(const hbField& field, const hbGeometry& geometry, const std::filesystem::path& path,
                hbProgress& progress);

} // namespace app
