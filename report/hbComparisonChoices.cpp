#include "report/hbComparisonChoices.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "report/hbCoarseGrid.h"
#include "report/hbFitJson.h"
#include "report/hbInnerProgress.h"
#include "report/hbSparseCompression.h"
#include "sparsegrid/hbSemiNodalGrid.h"
#include "volume/hbError.h"
#include "volume/hbVolumeField.h"

namespace {

using Json = hb::ReportJson;

class Stopwatch {
public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count(); }

private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

Json sizeJson(const hbSize3& size) { return {size.x, size.y, size.z}; }

Json head(const std::string& kind, const std::string& label, std::optional<int> level) {
  return {{"kind", kind},
          {"label", label},
          {"level", level ? Json(*level) : Json()},
          {"status", "done"},
          {"error", nullptr}};
}

hbSparseCompression::Result sparseFile(const hbInput& input, const hbComparison& what, int level,
                                       const std::optional<hbFit>& fit, hbProgress& progress) {
  if (!input.analytic) {
    hbSparseCompression compression;
    compression.set.levels = glm::ivec3(level);
    compression.measure = hbSparseCompression::Measure::none;
    compression.fit = fit;
    compression.nonFinite = what.nonFinite;
    compression.memoryLimit = what.memoryLimit;
    return compression.compress(input, progress);
  }
  // The geometry stays the field's, so that light falls on the same central differences at every level.
  const hbIndexSet set = hbIndexSet::regular(level, hbIndexSet::uncappedAxesOf(input.geometry().size));
  // Nodal values in 64 bits, surpluses, as much again for the form that errors are measured with.
  double need = 24.0 * double(set.storedValues());
  if (fit) need += fit->bytes(set, input.geometry().size);
  if (need > double(what.memoryLimit))
    throw hbError(fmt::format("level {} needs about {:.3g} MB, more than the memory limit of {:.3g} MB", level,
                              need / 0x1p20, double(what.memoryLimit) / 0x1p20));
  hbSparseGrid grid = hbSparseGrid::interpolate(*input.analytic, set, hbLatticeMapping::fitted, progress);
  if (!fit) return {{std::move(grid), {}, {}, {}, {}}, {}};
  hbFit::Result fitted = fit->run(*input.analytic, grid, progress);
  return {{std::move(fitted.grid), {}, {}, {}, {}}, std::move(fitted.reports)};
}

} // namespace

Json hbComparisonChoices::record(const std::string& key, Json head, const std::function<void(Json&)>& make) {
  if (std::optional<Json> known = folder_.find(key); known && known->value("status", "") == "done")
    return std::move(*known);
  Json record{{"key", key}};
  record.update(head);
  try {
    make(record);
  } catch (const hbCancelled&) {
    throw;
  } catch (const std::exception& error) {
    record["status"] = "failed";
    record["error"] = error.what();
  }
  return folder_.keep(key, std::move(record));
}

void hbComparisonChoices::describe(Json& record, const hbField& field, const hbField& atPoints, std::uint64_t bytes,
                                   hbProgress& progress) const {
  record["bytes"] = bytes;
  record["bits_per_sample"] =
      8.0 * double(bytes) / (double(source_.volume().geometry().samples()) * source_.volume().components());
  const auto [lo, hi] = source_.range();
  record["measured_at"] = source_.measuresAll() ? "all samples" : "random points";
  record["values"] = hb::reportJson(source_.errors(field, progress), hi - lo);
  record["true_values"] = source_.analytic() ? hb::reportJson(source_.trueErrors(atPoints, progress), hi - lo) : Json();
}

hbComparisonChoice hbComparisonChoices::original(hbProgress& progress) {
  const auto make = [&](Json& record) {
    hbInnerProgress inner(progress);
    record["size"] = sizeJson(source_.volume().geometry().size);
    record["seconds_build"] = 0.0;
    describe(record, source_.field(), source_.field(), source_.bytes(), inner);
  };
  return {"original", record("original", head("original", "the volume itself", std::nullopt), make),
          [this] { return source_.load(); }};
}

void hbComparisonChoices::makeSparse(const std::string& key, int level, const std::optional<hbFit>& fit, Json& record,
                                     hbProgress& progress) const {
  const std::filesystem::path file = folder_.choice(key + ".hbv");
  const Stopwatch watch;
  auto [made, fits] = sparseFile(source_.input(), what_, level, fit, progress);
  Json provenance{{"program", "hbvol " + what_.version}, {"source", source_.input().name}};
  for (const hbFitReport& one : fits) provenance["fit"].push_back(hb::provenanceOf(one));
  made.provenance.json = provenance.dump(-1, ' ', true, Json::error_handler_t::replace);
  made.write(file);
  record["seconds_build"] = watch.seconds();
  record["file"] = "choices/" + file.filename().string();
  record["size"] = nullptr;
  record["stored_values"] = made.grid.indexSet().storedValues();
  if (fit) {
    const hbFitReport& report = fits[std::size_t(what_.scene.component)];
    record["fit"] = hb::toJson(report);
    if (!report.improved) record["label"] = record["label"].get<std::string>() + " (interpolation kept)";
  }
  std::unique_ptr<const hbField> fast;
  if (hbSemiNodalGrid::fits(made.grid.indexSet())) fast = std::make_unique<const hbSemiNodalGrid>(made.grid);
  describe(record, made.grid, fast ? *fast : made.grid, std::filesystem::file_size(file), progress);
}

hbComparisonChoice hbComparisonChoices::sparse(int level, hbProgress& progress) {
  return sparseGrid(fmt::format("sparse-{}", level), head("sparse", fmt::format("sparse grid, level {}", level), level),
                    level, {}, progress);
}

hbComparisonChoice hbComparisonChoices::fitted(const hbComparison::Fit& fit, int level, hbProgress& progress) {
  hbFit how;
  how.method = fit.method;
  how.loss = what_.loss;
  how.memoryLimit = what_.memoryLimit;
  return sparseGrid(fmt::format("{}-{}", fit.name, level),
                    head(fit.name, fmt::format("{}, level {}", fit.inWords(), level), level), level, how, progress);
}

hbComparisonChoice hbComparisonChoices::sparseGrid(const std::string& key, Json head, int level,
                                                   const std::optional<hbFit>& fit, hbProgress& progress) {
  const auto make = [&](Json& record) {
    hbInnerProgress inner(progress);
    makeSparse(key, level, fit, record, inner);
  };
  hbReadOptions read;
  read.memoryLimit = what_.memoryLimit;
  return {key, record(key, std::move(head), make),
          [file = folder_.choice(key + ".hbv").string(), read] { return hbInput::open(file, read); }};
}

hbComparisonChoice hbComparisonChoices::coarse(int level, std::uint64_t bytes, hbProgress& progress) {
  const std::string key = fmt::format("coarse-{}", level);
  const hbField& field = source_.analytic() ? static_cast<const hbField&>(*source_.analytic()) : source_.field();
  auto kept = std::make_shared<std::optional<hbCoarseGrid>>();
  const auto make = [&](Json& record) {
    hbInnerProgress inner(progress);
    *kept = hbCoarseGrid::within(field, bytes, inner);
    const hbSize3 size = (*kept)->volume.geometry().size;
    record["label"] = fmt::format("full grid of {} x {} x {}", size.x, size.y, size.z);
    record["size"] = sizeJson(size);
    record["stored_values"] = size.x * size.y * size.z;
    const Stopwatch watch;
    hbCoarseGrid::take(field, std::max({size.x, size.y, size.z}), inner);
    record["seconds_build"] = watch.seconds();
    const hbVolumeField grid((*kept)->volume);
    describe(record, grid, grid, (*kept)->packed.size(), inner);
  };
  Json made = record(key, head("coarse", "full grid", level), make);
  const auto load = [kept, &field, size = made.value("size", Json())] {
    if (!*kept) *kept = hbCoarseGrid::take(field, *std::max_element(size.begin(), size.end()));
    hbInput input;
    input.name = "coarse grid";
    input.volume = std::make_shared<const hbVolume>(hbCoarseGrid::unpack((*kept)->volume, (*kept)->packed));
    return input;
  };
  return {key, std::move(made), load};
}

hbComparisonChoice hbComparisonChoices::zfp(hbComparisonPeers& peers, int level, std::uint64_t bytes,
                                            hbProgress& progress) {
  const std::string key = fmt::format("zfp-{}", level);
  const std::filesystem::path file = folder_.choice(key + ".nrrd");
  const auto make = [&](Json& record) {
    hbInnerProgress inner(progress);
    const hbZfpRun run = peers.peers().compress(peers.floats(), bytes, file, inner);
    record["label"] = fmt::format("zfp, {:.4g} kB", double(run.bytes) / 1024.0);
    record["seconds_build"] = run.secondsCompress;
    record["seconds_unpack"] = run.secondsDecompress;
    record["file"] = "choices/" + file.filename().string();
    record["mode"] = run.mode;
    record["parameter"] = run.parameter;
    const hbVolumeField field(*hbInput::open(file.string(), {}).volume);
    describe(record, field, field, run.bytes, inner);
  };
  return {key, record(key, head("zfp", fmt::format("zfp, as sparse grid of level {}", level), level), make),
          [name = file.string()] { return hbInput::open(name, {}); }};
}
