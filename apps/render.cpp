#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <oneapi/tbb/info.h>

#include "apps/EngineOptions.h"
#include "apps/PictureSeries.h"
#include "apps/Program.h"
#include "apps/SceneOptions.h"
#include "raycast/hbSceneDefaults.h"
#include "report/hbMedian.h"
#include "volume/hbError.h"
#include "volume/hbMagnitudeField.h"
#include "volume/hbMemoryMonitor.h"

namespace {

struct Options {
  app::InputOptions input;
  app::SceneOptions scene;
  std::string out, saveScene;
  app::EngineOptions engine;
  app::PictureSeries series;
  int repeat = 1;
};

void run(const Options& options, const app::CommonOptions& common) {
  app::PictureTimes times;
  const hbInput input = options.input.open(common, app::progress());
  times.load = times.sinceBegin();
  hbMemoryMonitor memory;

  double before = times.sinceBegin();
  const hbEngine engine = input.engine(options.engine.engine());
  std::shared_ptr<const hbField> field = options.input.field(input, options.engine.name, common);
  times.build = times.sinceBegin() - before;

  hbScene scene = options.scene.scene(input.geometry());
  if (scene.magnitude) {
    field = std::make_shared<const hbMagnitudeField>(field);
    scene.component = 0;
  }
  if (scene.component >= field->components())
    throw hbError(
        fmt::format("--component: expected 0 to {} or magnitude, found {}", input.components() - 1, scene.component));
  if (scene.labels) field = hb::labelField(*field, scene, options.scene.matter.unitLength);
  const hbHistogram histogram = hb::completeScene(scene, *field, app::progress());
  before = times.sinceBegin();
  const auto renderer = hbRenderer::create(engine, input, *field, scene, options.engine.renderer(common),
                                           [&](double bytes) { common.checkMemory(bytes, options.out); });
  times.build += times.sinceBegin() - before;
  options.series.draw(*renderer,
                      {options.out,
                       options.saveScene,
                       options.repeat,
                       {{"hbvol.engine", std::string(hb::engineName(engine))}, {"hbvol.input", input.name}}},
                      histogram, times);
  const std::vector<double>& frames = times.pictures;
  const double median = hb::median(frames);
  const auto [least, greatest] = std::minmax_element(frames.begin(), frames.end());

  const hbCamera& camera = *renderer->scene().camera;
  nlohmann::ordered_json stats{
      {"engine", hb::engineName(engine)},
      {"mode", hb::modeName(scene.mode)},
      {"width", scene.width},
      {"height", scene.height},
      {"samples", scene.sampling.planes(input.geometry(), camera)},
      {"step", scene.sampling.stepLength(input.geometry(), camera)},
      {"sampling", nullptr},
      {"iso", scene.isoValue ? nlohmann::ordered_json(*scene.isoValue) : nlohmann::ordered_json()},
      {"seconds_load", times.load},
      {"seconds_build", times.build},
      {"seconds_first_picture", times.first},
      {"seconds_frame_median", median},
      {"seconds_frame_min", *least},
      {"seconds_frame_max", *greatest},
      {"pictures", frames.size() / std::size_t(options.repeat)},
      {"repeat", options.repeat},
      {"memory_growth_bytes", memory.growth()},
      {"compressed_bytes", input.sparse ? nlohmann::ordered_json(input.fileBytes) : nlohmann::ordered_json()},
      {"texture_bytes", 0},
      {"threads", common.threads > 0 ? common.threads : oneapi::tbb::info::default_concurrency()},
      {"gl_renderer", nullptr}};
  options.engine.describe(renderer->facts(), stats);
  fmt::print("{}: {} by {} in {:.3f} s a frame ({} samples over the depth), load {:.3f} s\n", options.out,
             hb::modeName(scene.mode), hb::engineName(engine), median, stats["samples"].get<int>(), times.load);
  common.writeStats(stats);
}

app::Work prepare(const Options& options, const app::CommonOptions& common) {
  if (app::extension(options.out) != ".exr" && app::extension(options.out) != ".png")
    throw hbError(fmt::format("{}: expected a name that ends with .exr or .png", options.out));
  common.checkOutputs({options.out, options.saveScene, options.series.savePath});
  options.series.checkOthers(options.out, {options.saveScene, options.series.savePath, common.stats});
  options.input.rawLayout();
  const hbEngine engine = options.engine.engine();
  if (engine == hbEngine::opengl && options.scene.sampling == "equidistant")
    throw hbError("--sampling: expected planewise with --engine opengl, found equidistant");
  return [&] { run(options, common); };
}

} // namespace

void addRender(CLI::App& program, const app::CommonOptions& common, app::Work& work) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      program.add_subcommand("render", "Ray-casts a picture; with no options, the whole volume from a pleasant angle");
  options->input.addTo(*command);
  command
      ->add_option("OUT", options->out, "The picture: .exr (raw floats, all layers, the scene) or .png (as displayed)")
      ->required()
      ->type_name("");
  options->scene.addTo(*command);
  options->series.addTo(*command);
  command->add_option("--save-scene", options->saveScene, "Save the scene as rendered")
      ->group("Camera")
      ->type_name("S.json");
  options->engine.addTo(*command);
  command->add_option("--repeat", options->repeat, "Frames to time; the median is reported")
      ->check(CLI::Range(1, 10000))
      ->group("Rendering")
      ->capture_default_str();
  command->callback([options, &common, &work] { work = prepare(*options, common); });
}
