#include "report/hbComparisonRun.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <malloc.h>

#include "raycast/hbNominalSamples.h"
#include "raycast/hbSceneDefaults.h"
#include "report/hbInnerProgress.h"
#include "report/hbMedian.h"
#include "report/hbPictureDifference.h"
#include "scene/hbDisplay.h"
#include "scene/hbPictureFile.h"
#include "volume/hbError.h"
#include "volume/hbMemoryMonitor.h"
#include "volume/hbParallel.h"

namespace {

using Json = hb::ReportJson;
using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

/// What lies in main memory when frames are drawn, but for what they take themselves: samples or surpluses, and what
/// the engine makes of them.
double residentBytes(const hbInput& input, hbEngine engine) {
  if (input.volume)
    return double(input.geometry().samples()) * input.components() * double(hb::sampleBytes(input.volume->type()));
  return double(sizeof(float)) * double(input.sparse->grid.indexSet().storedValues()) * input.components() +
         input.fieldBytes(engine);
}

Json inputJson(const hbComparisonSource& source, const hbComparison& what) {
  const hbGeometry& geometry = source.volume().geometry();
  return {{"name", hb::storedJson(source.input().name)},
          {"representation", source.input().representation()},
          {"size", {geometry.size.x, geometry.size.y, geometry.size.z}},
          {"samples", geometry.samples()},
          {"component", what.scene.component},
          {"bytes_uncompressed", source.bytes()},
          {"range", {hb::finiteOrNull(source.range().first), hb::finiteOrNull(source.range().second)}}};
}

/// Differences are shown on a scale from minus to plus this share of the reference picture's window.
constexpr double kShownDifference = 0.1;

} // namespace

struct hbComparisonRun::Case {
  std::string key;
  hbComparison::Engine engine;
  hbMode mode;
};

hbComparisonRun::hbComparisonRun(const hbComparisonSource& source, const hbComparison& what, hbComparisonFolder& folder)
    : source_(source), what_(what), folder_(folder), peers_(source, what, folder) {
  for (const hbMode mode : what.modes) {
    hbScene scene = what.scene;
    scene.mode = mode;
    scene.camera = scene.cameraFor(source.volume().geometry());
    if (mode != hbMode::iso) scene.isoValue.reset();
    if (mode != hbMode::dvr) scene.transfer.reset();
    try {
      hb::completeScene(scene, source.field());
      scenes_[mode] = std::move(scene);
    } catch (const hbError& error) {
      sceneErrors_[mode] = error.what();
    }
  }
}

const hbScene& hbComparisonRun::sceneOf(hbMode mode) const {
  if (const auto error = sceneErrors_.find(mode); error != sceneErrors_.end()) throw hbError(error->second);
  return scenes_.at(mode);
}

std::vector<hbComparisonRun::Case> hbComparisonRun::casesOf(const hbComparisonChoice& choice) const {
  const std::string kind = choice.record["kind"];
  std::vector<hbComparison::Engine> engines{hbComparison::engineFromName("full")};
  if (kind == "sparse") {
    engines = what_.engines;
  } else if (hbComparison::isSparseGrid(kind)) {
    engines = {what_.engines.front()}; // other values in the same grids: engines differ as they do there
  }
  std::vector<Case> cases;
  for (const auto& engine : engines)
    for (const hbMode mode : what_.modes)
      cases.push_back({fmt::format("{}-{}-{}", choice.key, engine.name, hb::modeName(mode)), engine, mode});
  return cases;
}

hbPicture hbComparisonRun::draw(const hbField& field, hbMode mode, hbProgress& progress) const {
  hbInnerProgress inner(progress);
  return hbRenderer::create(hbEngine::full, source_.input(), field, sceneOf(mode), {})->render(inner);
}

const hbPicture& hbComparisonRun::reference(hbMode mode, bool isTrue, hbProgress& progress) {
  const auto known = references_.find({mode, isTrue});
  if (known != references_.end()) return known->second;
  const std::filesystem::path file =
      folder_.path() / "pictures" / fmt::format("{}-{}.exr", isTrue ? "true" : "reference", hb::modeName(mode));
  if (!std::filesystem::exists(file))
    hb::writeExr(draw(isTrue ? static_cast<const hbField&>(*source_.analytic()) : source_.field(), mode, progress),
                 file);
  return references_.emplace(std::pair(mode, isTrue), hb::readExr(file)).first->second;
}

void hbComparisonRun::compare(const hbPicture& picture, const Case& one, Json& record) {
  const hbPicture& reference = references_.at({one.mode, false});
  record["picture"] = hb::reportJson(hb::pictureDifference(reference, picture));
  const auto truth = references_.find({one.mode, true});
  record["true_picture"] =
      truth == references_.end() ? Json() : hb::reportJson(hb::pictureDifference(truth->second, picture));

  const hbScene& scene = sceneOf(one.mode);
  const auto window = hb::displayWindow(reference, scene);
  record["image"] = hbComparisonFolder::picture(one.key);
  hb::writePng(hb::displayImage(picture, scene, window), folder_.path() / record["image"].get<std::string>());
  record["difference"] = hbComparisonFolder::picture(one.key + "-difference");
  const double width = window.second - window.first;
  hb::writePng(hb::signedDifferenceImage(picture, reference, width > 0.0 ? kShownDifference * width : 1.0),
               folder_.path() / record["difference"].get<std::string>());
}

Json hbComparisonRun::measured(const hbComparisonChoice& choice, const Case& one, hbProgress& progress) {
  reference(one.mode, false, progress);
  if (source_.analytic()) reference(one.mode, true, progress);
  choice.load(); // whatever is only made once, and the system's memory of files

  ::malloc_trim(0); // or what earlier cases left would be taken again without growth
  hbMemoryMonitor memory;
  hbInnerProgress inner(progress);
  const auto begin = Clock::now();
  const hbInput input = choice.load();
  const auto checkMemory = [&](double bytes) {
    if (bytes > double(what_.memoryLimit))
      throw hbError(fmt::format("needs about {:.3g} MB, more than the memory limit of {:.3g} MB", bytes / 0x1p20,
                                double(what_.memoryLimit) / 0x1p20));
  };
  checkMemory(residentBytes(input, one.engine.engine));
  const auto field = input.field(one.engine.engine, what_.nonFinite, inner);
  hbRenderer::Options options;
  options.openGl.form = one.engine.form;
  options.threads = what_.threads;
  const auto renderer = hbRenderer::create(one.engine.engine, input, *field, sceneOf(one.mode), options, checkMemory);
  // Of zfp, the plain volume is read here; unpacking it was measured by itself.
  const double unpack = choice.record.value("seconds_unpack", 0.0);
  const double build = unpack + secondsSince(begin);
  hbPicture picture = renderer->render(inner);
  const double first = unpack + secondsSince(begin);

  std::vector<double> frames;
  for (double sum = 0.0; int(frames.size()) < what_.repeats && sum < hbComparison::kMostSeconds; sum += frames.back()) {
    const auto before = Clock::now();
    picture = renderer->render(inner);
    frames.push_back(secondsSince(before));
  }
  const double median = hb::median(frames);
  const auto [least, greatest] = std::minmax_element(frames.begin(), frames.end());
  const double samples = hb::nominalSamples(source_.volume().geometry(), sceneOf(one.mode));
  const hbRenderer::Facts facts = renderer->facts();
  Json record{{"seconds_build", build},
              {"seconds_first_picture", first},
              {"seconds_warmup", first - build},
              {"seconds_frame", {{"median", median}, {"min", *least}, {"max", *greatest}, {"repeats", frames.size()}}},
              {"samples", samples},
              {"samples_per_second", samples / median},
              {"sampling", facts.sampling},
              {"compressed_bytes", choice.record["bytes"]},
              {"resident_bytes", residentBytes(input, one.engine.engine)},
              {"memory_growth_bytes", memory.growth()},
              {"texture_bytes", facts.textureBytes},
              {"gl_renderer", facts.glRenderer.empty() ? Json() : Json(facts.glRenderer)}};
  compare(picture, one, record);
  return record;
}

Json hbComparisonRun::record(const Case& one, const std::string& choice, const std::function<Json()>& make) {
  if (auto known = folder_.find(one.key); known && known->value("status", "") != "failed") return std::move(*known);
  Json record{{"key", one.key},   {"choice", choice}, {"engine", one.engine.name}, {"mode", hb::modeName(one.mode)},
              {"status", "done"}, {"error", nullptr}};
  try {
    record.update(make());
  } catch (const hbCancelled&) {
    throw;
  } catch (const hbPeerRefusal& refusal) {
    record["status"] = "refused";
    record["error"] = refusal.what();
  } catch (const std::exception& error) {
    record["status"] = "failed";
    record["error"] = error.what();
  }
  return folder_.keep(one.key, std::move(record));
}

void hbComparisonRun::measure(const hbComparisonChoice& choice, const Case& one, hbProgress& progress) {
  cases_.push_back(record(one, choice.key, [&] {
    if (!choice.isDone()) throw hbError(choice.record["error"].get<std::string>());
    return measured(choice, one, progress);
  }));
}

void hbComparisonRun::take(const hbComparisonChoice& choice, hbProgress& progress) {
  choices_.push_back(choice.record);
  for (const Case& one : casesOf(choice)) {
    measure(choice, one, progress);
    progress.advance(1);
  }
}

void hbComparisonRun::takeVtk(hbProgress& progress) {
  using Mapper = hbPeers::VtkMapper;
  for (const auto& [name, mapper] : {std::pair("vtk-cpu", Mapper::cpu), std::pair("vtk-gpu", Mapper::gpu)})
    for (const hbMode mode : what_.modes) {
      const Case one{fmt::format("original-{}-{}", name, hb::modeName(mode)), {name, hbEngine::full, {}}, mode};
      Json made = record(one, "original", [&, mapper = mapper] {
        const hbPicture& expected = reference(mode, false, progress);
        return peers_.vtk(mapper, sceneOf(mode), expected, one.key, kShownDifference, progress);
      });
      // What VTK does not draw is no case of it.
      if (made["status"] != "refused") cases_.push_back(std::move(made));
      progress.advance(1);
    }
}

void hbComparisonRun::takeFits(int level, hbComparisonChoices& choices, hbProgress& progress) {
  for (const hbComparison::Fit& fit : what_.fits) take(choices.fitted(fit, level, progress), progress);
}

void hbComparisonRun::takeZfp(const hbComparisonChoice& sparse, hbComparisonChoices& choices, hbProgress& progress) {
  take(choices.zfp(peers_, sparse.record["level"], sparse.record["bytes"], progress), progress);
}

Json hbComparisonRun::run(hbProgress& progress) {
  const std::int64_t levels = what_.lastLevel - what_.firstLevel + 1;
  const auto modes = std::int64_t(what_.modes.size()), engines = std::int64_t(what_.engines.size());
  const auto fits = std::int64_t(what_.fits.size());
  const int vtk = peers_.hasVtk() ? 2 : 0, zfp = peers_.hasZfp() ? 1 : 0;
  progress.begin("comparing", modes * (1 + vtk + levels * (1 + zfp + engines + fits)), "cases");
  hbComparisonChoices choices(source_, what_, folder_);
  take(choices.original(progress), progress);
  if (peers_.hasVtk()) takeVtk(progress);
  for (int level = what_.firstLevel; level <= what_.lastLevel; ++level) {
    const hbComparisonChoice sparse = choices.sparse(level, progress);
    take(sparse, progress);
    takeFits(level, choices, progress);
    if (!sparse.isDone()) continue; // there is no number of bytes to compare with
    take(choices.coarse(level, sparse.record["bytes"], progress), progress);
    if (peers_.hasZfp()) takeZfp(sparse, choices, progress);
  }
  return assemble(progress);
}

Json hbComparisonRun::identity(const hbComparisonSource& source, const hbComparison& what) {
  Json identity = what.settings();
  identity["input"] = inputJson(source, what);
  identity["version"] = what.version;
  // A file that was written since is another input.
  std::error_code isNoFile;
  const auto written = std::filesystem::last_write_time(source.input().name, isNoFile);
  identity["written"] = isNoFile ? Json() : Json(written.time_since_epoch().count());
  return identity;
}

Json hbComparisonRun::assemble(hbProgress& progress) const {
  Json machine = hb::reportJson(hbMachine::current());
  machine["threads"] = what_.threads > 0 ? what_.threads : hb::parallelThreads();
  machine["gl_renderer"] = nullptr;
  for (const Json& one : cases_)
    if (one["choice"] != "original" && one.contains("gl_renderer") && !one["gl_renderer"].is_null())
      machine["gl_renderer"] = one["gl_renderer"];
  Json report{{"version", what_.version},
              {"command", hb::storedJson(what_.command)},
              {"machine", machine},
              {"input", inputJson(source_, what_)},
              {"settings", what_.settings()},
              {"runs", folder_.runs()},
              {"difference_scale", kShownDifference},
              {"choices", choices_},
              {"cases", cases_},
              {"peers", peers_.versions(progress)}};
  return report;
}
