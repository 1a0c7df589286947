#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/Program.h"
#include "volume/fields/hbCavitySpecification.h"

namespace app {

/// `count` names for the steps of a series: stem.ext becomes stem_0000.ext and so on, in as many digits as the last
/// needs, at least four. In `stem_<sizes>_float32.raw` the number stands before the sizes. Throws hbError where `out`
/// has no extension.
std::vector<std::string> seriesNames(const std::string& out, std::int64_t nodes, std::int64_t count);

/// Simulates a cavity on `nodes`^3 nodes and writes it as float32 samples, says so, and writes the statistics: one
/// volume, or, where `steps` is above 0, that many: at equal times from the start (which is left out) to the end time
/// (20 where none is asked for), each written when it is reached. Throws hbError.
void runCavity(const hbCavitySpecification& specification, std::int64_t nodes, std::int64_t steps,
               const std::string& out, const CommonOptions& common);

} // namespace app
