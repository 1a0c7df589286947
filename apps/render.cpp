#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <oneapi/tbb/info.h>

#include "apps/MemoryMonitor.h"
#include "apps/Program.h"
#include "raycast/hbRaycaster.h"
#include "raycast/hbSceneDefaults.h"
#include "scene/hbColormap.h"
#include "scene/hbDisplay.h"
#include "scene/hbPictureFile.h"
#include "volume/hbError.h"
#include "volume/hbMagnitudeField.h"

namespace {

using Clock = std::chrono::steady_clock;

struct Options {
  app::InputOptions input;
  std::string out, mode, engine = "auto", size, scene, saveScene, camera, projection, window, colormap, component,
                         sampling;
  std::optional<double> azimuth, elevation, zoom, iso;
  int samples = 0, repeat = 1;
};

/// The scene file, if any, with the options on top; what is still open afterwards is the renderer's default.
hbScene sceneFor(const Options& options, const hbGeometry& geometry) {
  hbScene scene = options.scene.empty() ? hbScene() : hb::loadScene(options.scene);
  if (!options.mode.empty()) scene.mode = hb::modeFromName(options.mode);
  if (!options.size.empty()) {
    const auto sizes = app::parseSizes(options.size, 2, "--size");
    scene.width = int(std::min<std::int64_t>(sizes[0], hbScene::kMaxPictureSide + 1));
    scene.height = int(std::min<std::int64_t>(sizes[1], hbScene::kMaxPictureSide + 1));
  }
  if (!options.sampling.empty())
    scene.sampling.kind = options.sampling == "planewise" ? hbSampling::Kind::planewise : hbSampling::Kind::equidistant;
  if (options.samples > 0) scene.sampling.samples = options.samples;
  if (options.iso) scene.isoValue = options.iso;
  if (!options.window.empty()) {
    const auto ends = app::parseNumbers(options.window, 2, 2, "--window");
    scene.window = {ends[0], ends[1]};
  }
  if (!options.colormap.empty()) scene.colormap = hbColormap(options.colormap).name();
  if (options.component == "magnitude")
    scene.magnitude = true;
  else if (!options.component.empty()) {
    scene.component = int(app::parseNumbers(options.component, 1, 1, "--component").front());
    scene.magnitude = false;
  }

  const auto projection =
      options.projection == "orthographic" ? hbCamera::Projection::orthographic : hbCamera::Projection::perspective;
  if (!options.camera.empty()) {
    const auto n = app::parseNumbers(options.camera, 6, 9, "--camera");
    if (n.size() != 6 && n.size() != 9)
      throw hbError("--camera: expected 6 or 9 numbers: position, target, and perhaps up");
    hbCamera camera;
    camera.projection = projection;
    camera.position = {n[0], n[1], n[2]};
    camera.target = {n[3], n[4], n[5]};
    if (n.size() == 9) camera.up = {n[6], n[7], n[8]};
    camera.height =
        hbCamera::framing(geometry, 0, 0, hbCamera::Projection::orthographic, double(scene.width) / scene.height)
            .height;
    scene.camera = camera;
  } else if (!scene.camera || options.azimuth || options.elevation || options.zoom || !options.projection.empty()) {
    scene.camera = hbCamera::framing(geometry, options.azimuth.value_or(hbCamera::kDefaultAzimuth),
                                     options.elevation.value_or(hbCamera::kDefaultElevation), projection,
                                     double(scene.width) / double(scene.height), options.zoom.value_or(1.0));
  }
  return scene;
}

void writePicture(const hbPicture& picture, const hbScene& scene, const std::string& path) {
  if (path.ends_with(".exr"))
    hb::writeExr(picture, path);
  else
    hb::writePng(hb::displayImage(picture, scene), path);
}

void warnOfEmptyPicture(const hbScene& scene, const hbHistogram& histogram) {
  fmt::print(stderr,
             "hbvol: warning: nothing of the iso-surface {} is in view; the values looked at lie in [{:.6g}, {:.6g}]\n",
             *scene.isoValue, histogram.min, histogram.max);
}

void run(const Options& options, const app::CommonOptions& common) {
  if (!options.out.ends_with(".exr") && !options.out.ends_with(".png"))
    throw hbError(fmt::format("{}: expected a name that ends with .exr or .png", options.out));
  const auto seconds = [](Clock::time_point from) {
    return std::chrono::duration<double>(Clock::now() - from).count();
  };

  auto start = Clock::now();
  const hbInput input = options.input.open(common, app::progress());
  const double secondsLoad = seconds(start);
  app::MemoryMonitor memory;

  start = Clock::now();
  const hbEngine engine = input.engine(hb::engineFromName(options.engine));
  if (engine == hbEngine::combination && input.sparse)
    common.checkMemory(std::uint64_t(input.sparse->grid.indexSet().combinationValues()) * 4, input.name);
  std::shared_ptr<const hbField> field = input.field(engine, options.input.nanValue);
  const double secondsBuild = seconds(start);

  hbScene scene = sceneFor(options, input.geometry());
  if (scene.magnitude) field = std::make_shared<const hbMagnitudeField>(field);
  if (scene.component >= field->components())
    throw hbError(
        fmt::format("--component: expected 0 to {} or magnitude, found {}", input.components() - 1, scene.component));
  hbHistogram histogram;
  if (scene.mode == hbMode::iso) {
    histogram = hb::fieldHistogram(*field, scene.component, app::progress());
    if (!scene.isoValue) scene.isoValue = histogram.otsuThreshold();
  }
  const hbRaycaster raycaster(*field, scene);
  common.checkMemory(std::uint64_t(scene.width) * std::uint64_t(scene.height) * 32, options.out);

  hbPicture picture;
  std::vector<double> frames;
  for (int i = 0; i < options.repeat; ++i) {
    start = Clock::now();
    picture = raycaster.render(app::progress());
    frames.push_back(seconds(start));
  }
  std::sort(frames.begin(), frames.end());
  const std::vector<float>& covered = *picture.find("A");
  if (scene.mode == hbMode::iso && std::all_of(covered.begin(), covered.end(), [](float a) { return a == 0.0F; }))
    warnOfEmptyPicture(scene, histogram);
  picture.metadata["hbvol.engine"] = hb::engineName(engine);
  picture.metadata["hbvol.input"] = input.name;
  writePicture(picture, raycaster.scene(), options.out);
  if (!options.saveScene.empty()) hb::saveScene(raycaster.scene(), options.saveScene);

  const hbCamera& camera = *raycaster.scene().camera;
  nlohmann::ordered_json stats{
      {"engine", hb::engineName(engine)},
      {"mode", hb::modeName(scene.mode)},
      {"width", scene.width},
      {"height", scene.height},
      {"samples", scene.sampling.planes(input.geometry(), camera)},
      {"step", scene.sampling.stepLength(input.geometry(), camera)},
      {"sampling", scene.sampling.kind == hbSampling::Kind::planewise ? "planewise" : "equidistant"},
      {"iso", scene.isoValue ? nlohmann::ordered_json(*scene.isoValue) : nlohmann::ordered_json()},
      {"seconds_load", secondsLoad},
      {"seconds_build", secondsBuild},
      {"seconds_frame_median", frames[frames.size() / 2]},
      {"seconds_frame_min", frames.front()},
      {"seconds_frame_max", frames.back()},
      {"repeat", options.repeat},
      {"memory_growth_bytes", memory.growth()},
      {"compressed_bytes", input.sparse ? nlohmann::ordered_json(input.fileBytes) : nlohmann::ordered_json()},
      {"texture_bytes", 0},
      {"threads", common.threads > 0 ? common.threads : oneapi::tbb::info::default_concurrency()},
      {"gl_renderer", nullptr}};
  fmt::print("{}: {} by {} in {:.3f} s a frame ({} samples over the depth), load {:.3f} s\n", options.out,
             hb::modeName(scene.mode), hb::engineName(engine), frames[frames.size() / 2], stats["samples"].get<int>(),
             secondsLoad);
  common.writeStats(stats);
}

} // namespace

void addRender(CLI::App& program, app::CommonOptions& common) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      program.add_subcommand("render", "Ray-casts a picture; with no options, the whole volume from a pleasant angle");
  options->input.addTo(*command);
  command
      ->add_option("OUT", options->out, "The picture: .exr (raw floats, all layers, the scene) or .png (as displayed)")
      ->required()
      ->type_name("");
  const auto add = [&](const char* group, const char* flag, auto& value, const char* text) {
    return command->add_option(flag, value, text)->group(group);
  };
  add("Picture", "--mode", options->mode, "xray (default): line integral; mip: greatest value; iso: surface")
      ->check(CLI::IsMember({"xray", "mip", "iso"}));
  add("Picture", "--size", options->size, "Pixels (default 512x512)")->type_name("WxH");
  add("Picture", "--iso", options->iso, "Iso-value (default: Otsu's threshold of the histogram)");
  add("Picture", "--component", options->component, "Which component, from 0, or magnitude")->type_name("C");
  add("Picture", "--window", options->window,
      "PNG: values shown as the colour map's ends (default: those of the picture)")
      ->type_name("LO,HI");
  add("Picture", "--colormap", options->colormap, "PNG: gray, inverse-gray, heat, cubehelix or coolwarm");
  add("Camera", "--azimuth", options->azimuth,
      "Degrees, counter-clockwise seen from above; 0 looks along +y (default 30)");
  add("Camera", "--elevation", options->elevation, "Degrees above the horizon (default 20)")
      ->check(CLI::Range(-90.0, 90.0));
  add("Camera", "--zoom", options->zoom, "1 frames the whole volume (default)")->check(CLI::PositiveNumber);
  add("Camera", "--projection", options->projection, "perspective (default) or orthographic")
      ->check(CLI::IsMember({"perspective", "orthographic"}));
  add("Camera", "--camera", options->camera, "World coordinates: position, target[, up]: 6 or 9 numbers")
      ->type_name("X,Y,Z,...");
  add("Camera", "--scene", options->scene, "Start from a scene file")->type_name("S.json");
  add("Camera", "--save-scene", options->saveScene, "Save the scene as rendered")->type_name("S.json");
  add("Rendering", "--engine", options->engine,
      "auto, full (plain volumes and fields), direct or combination (sparse grids)")
      ->capture_default_str();
  add("Rendering", "--samples", options->samples, "Samples over the depth of the volume (default: one a voxel)")
      ->check(CLI::Range(1, hbSampling::kMaxSamples));
  add("Rendering", "--sampling", options->sampling,
      "equidistant (default) along each ray, or planewise across the view axis")
      ->check(CLI::IsMember({"equidistant", "planewise"}));
  add("Rendering", "--repeat", options->repeat, "Frames to time; the median is reported")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command->callback([options, &common] { run(*options, common); });
}
