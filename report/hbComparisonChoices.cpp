#include "report/hbComparisonChoices.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "report/hbCoarseGrid.h"
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

hbSparseGridFile sparseFile(const hbInput& input, const hbComparison& what, int level, hbProgress& progress) {
  if (!input.analytic) {
    hbSparseCompression compression;
    compression.set.levels = glm::ivec3(level);
    compression.measure = hbSparseCompression::Measure::none;
    compression.nonFinite = what.nonFinite;
    compression.memoryLimit = what.memoryLimit;
    return compression.compress(input, progress).file;
  }
  // The geometry stays the field's, so that light falls on the same central differences at every level.
  const hbIndexSet set = hbIndexSet::regular(level, hbIndexSet::uncappedAxesOf(input.geometry().size));
  // Nodal values in 64 bits, surpluses, as much again for the form that errors are measured with.
  const double need = 24.0 * double(set.storedValues());
  if (need > double(what.memoryLimit))
    throw hbError(fmt::format("level {} needs about {:.3g} MB, more than the memory limit of {:.3g} MB", level,
                              need / 0x1p20, double(what.memoryLimit) / 0x1p20));
  return {hbSparseGrid::interpolate(*input.analytic, set, hbLatticeMapping::fitted, progress), {}, {}, {}, {}};
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

void hbComparisonChoices::makeSparse(int level, Json& record, hbProgress& progress) const {
  const std::filesystem::path file = folder_.choice(fmt::format("sparse-{}.hbv", level));
  const Stopwatch watch;
  hbSparseGridFile made = sparseFile(source_.input(), what_, level, progress);
  made.provenance.json = Json{{"program", "hbvol " + what_.version}, {"source", source_.input().name}}.dump(
      -1, ' ', true, Json::error_handler_t::replace);
  made.write(file);
  record["seconds_build"] = watch.seconds();
  record["file"] = "choices/" + file.filename().string();
  record["size"] = nullptr;
  record["stored_values"] = made.grid.indexSet().storedValues();
  std::unique_ptr<const hbField> fast;
  if (hbSemiNodalGrid::fits(made.grid.indexSet())) fast = std::make_unique<const hbSemiNodalGrid>(made.grid);
  describe(record, made.grid, fast ? *fast : made.grid, std::filesystem::file_size(file), progress);
}

hbComparisonChoice hbComparisonChoices::sparse(int level, hbProgress& progress) {
  const std::string key = fmt::format("sparse-{}", level);
  const auto make = [&](Json& record) {
    hbInnerProgress inner(progress);
    makeSparse(level, record, inner);
  };
  hbReadOptions read;
  read.memoryLimit = what_.memoryLimit;
  return {key, record(key, head("sparse", fmt::format("sparse grid, level {}", level), level), make),
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
