#pragma once

#include <cstdint>
#include <filesystem>

#include "apps/Program.h"
#include "volume/hbField.h"
#include "volume/hbSubLattice.h"

namespace app {

/// Writes a field's true values at the places of `lattice` (of the field's geometry) as a volume file of float32, or
/// float64 where the field's value map needs it. Slab by slab: memory for one of 24 MB, or for a row where that is
/// more, and half as much again for several components or a value map, checked before work starts. Returns the bytes of
/// all samples. Throws hbError.
std::uint64_t writeField(const hbField& field, const hbSubLattice& lattice, const std::filesystem::path& path,
                         const CommonOptions& common);

} // namespace app
