#pragma once

#include <nlohmann/json.hpp>

#include "sparsegrid/hbIndexSet.h"
#include "sparsegrid/hbSparseGridFile.h"
#include "volume/hbGeometry.h"
#include "volume/hbHistogram.h"

/// The parts of what `info` finds.
namespace app {

nlohmann::ordered_json geometryJson(const hbGeometry& geometry);

nlohmann::ordered_json histogramJson(const hbHistogram& histogram);

/// The sizes of a sparse grid, whether there is one or not.
void addIndexSet(nlohmann::ordered_json& info, const hbIndexSet& set, const hbGeometry& geometry, int components);

/// Everything a sparse grid's file says; of its provenance, what is nested too deep to be shown is left out.
void addSparseGrid(nlohmann::ordered_json& info, const hbSparseGridFile& file);

} // namespace app
