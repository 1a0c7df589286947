#include "apps/InfoJson.h"

#include "apps/Program.h"
#include "report/hbReportJson.h"

using Json = nlohmann::ordered_json;

Json app::geometryJson(const hbGeometry& g) {
  const auto list = [](const auto& v) { return Json{v.x, v.y, v.z}; };
  return {{"origin", list(g.origin)},
          {"spacing", list(g.spacing)},
          {"direction", {list(g.direction[0]), list(g.direction[1]), list(g.direction[2])}},
          {"extent", list(g.extent())},
          {"centring", g.centring == hbGeometry::Centring::cell ? "cell" : "node"},
          {"space", g.space}};
}

void app::addIndexSet(Json& info, const hbIndexSet& set, const hbGeometry& geometry, int components) {
  info["level"] = set.number();
  info["finest_levels"] = {set.finest().x, set.finest().y, set.finest().z};
  info["subspaces"] = set.subspaces().size();
  info["stored_values"] = set.storedValues();
  info["component_grids"] = set.componentGrids().size();
  info["combination_values"] = set.combinationValues();
  info["padded_texels"] = set.paddedTexels();
  info["value_bytes"] = set.storedValues() * components * std::int64_t(sizeof(float));
  info["samples_per_stored_value"] = double(geometry.samples()) / double(set.storedValues());
}

Json app::histogramJson(const hbHistogram& h) {
  return {{"count", h.count},
          {"nans", h.nans},
          {"infinities", h.infinities},
          {"min", hb::finiteOrNull(h.min)},
          {"max", hb::finiteOrNull(h.max)},
          {"mean", hb::finiteOrNull(h.mean)},
          {"deviation", hb::finiteOrNull(h.deviation)},
          {"otsu_threshold", hb::finiteOrNull(h.otsuThreshold())},
          {"percentiles",
           {{"1", hb::finiteOrNull(h.percentile(0.01))},
            {"50", hb::finiteOrNull(h.percentile(0.5))},
            {"99", hb::finiteOrNull(h.percentile(0.99))}}},
          {"bins", h.bins}};
}

void app::addSparseGrid(Json& info, const hbSparseGridFile& file) {
  addIndexSet(info, file.grid.indexSet(), file.grid.geometry(), file.grid.components());
  info["mapping"] = file.info.mapping == hbLatticeMapping::aligned ? "aligned" : "fitted";
  info["type"] = hb::sampleTypeName(file.info.sampleType);
  info["component_names"] = file.info.componentNames;
  if (file.range)
    for (const auto& c : file.range->components)
      info["source_range"].push_back({hb::finiteOrNull(c.lo), hb::finiteOrNull(c.hi)});
  constexpr const char* kReferences[] = {"all samples", "random samples", "random points of the analytic field"};
  if (file.error)
    for (const auto& c : file.error->components)
      info["errors"].push_back({{"against", kReferences[std::size_t(c.reference)]},
                                {"kind", c.kind == hbErrorRecord::Kind::measured ? "measured" : "guaranteed"},
                                {"points", c.points},
                                {"max", hb::finiteOrNull(c.max)},
                                {"rmse", hb::finiteOrNull(c.rmse)},
                                {"psnr", hb::finiteOrNull(c.psnr)}});
  // Any file may be asked about, and whoever prints the document recurses.
  constexpr int kMaxDepth = 32;
  info["provenance"] =
      Json::parse(file.provenance.json, [](int depth, Json::parse_event_t, const Json&) { return depth < kMaxDepth; });
}
