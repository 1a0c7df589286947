#include "apps/SceneOptions.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/trigonometric.hpp>

#include "apps/Program.h"
#include "scene/hbColormap.h"
#include "scene/hbTransferFunctionFile.h"
#include "volume/hbError.h"

void app::SceneOptions::addTo(CLI::App& subcommand) {
  const auto add = [&](const char* group, const char* flag, auto& value, const char* text) {
    return subcommand.add_option(flag, value, text)->group(group);
  };
  add("Picture", "--mode", mode,
      "xray (default): line integral; mip: greatest value; iso: surface; dvr: colour and opacity")
      ->check(CLI::IsMember({"xray", "mip", "iso", "dvr"}));
  add("Picture", "--size", size, "Pixels (default 512x512)")->type_name("WxH");
  add("Picture", "--iso", iso, "Iso-value (default: Otsu's threshold of the histogram)");
  add("Picture", "--component", component, "Which component, from 0, or magnitude")->type_name("C");
  add("Picture", "--window", window, "PNG: values shown as the colour map's ends (default: those of the picture)")
      ->type_name("LO,HI");
  add("Picture", "--colormap", colormap, "PNG: gray, inverse-gray, heat, cubehelix or coolwarm");
  add("Picture", "--transfer", transfer,
      "DVR: a preset (ct-bone, ct-skin, ct-vessels, ct-lungs, mri-head, simulation, density (default), fire), or a "
      "file: ParaView's .json (FILE:NAME for one of several), or lines of value, red, green, blue, opacity")
      ->type_name("F");
  add("Picture", "--transfer-range", transferRange, "DVR: stretch the transfer function over these values")
      ->type_name("LO,HI");
  add("Picture", "--unit-length", unitLength, "DVR: the world length that opacities are stated for")
      ->check(CLI::PositiveNumber);
  subcommand.add_flag("--preintegrate", preintegrate, "DVR: integrate over the slab between two samples beforehand")
      ->group("Picture");
  add("Picture", "--background", background, "PNG: coded sRGB, each in [0,1]")->type_name("R,G,B");
  add("Camera", "--azimuth", azimuth, "Degrees, counter-clockwise seen from above; 0 looks along +y (default 30)");
  add("Camera", "--elevation", elevation, "Degrees above the horizon (default 20)")->check(CLI::Range(-90.0, 90.0));
  add("Camera", "--zoom", zoom, "1 frames the whole volume (default)")->check(CLI::PositiveNumber);
  add("Camera", "--projection", projection, "perspective (default) or orthographic")
      ->check(CLI::IsMember({"perspective", "orthographic"}));
  add("Camera", "--camera", camera, "World coordinates: position, target[, up]: 6 or 9 numbers")
      ->type_name("X,Y,Z,...");
  add("Camera", "--scene", file, "Start from a scene file")->type_name("S.json");
  add("Rendering", "--samples", samples, "Samples over the depth of the volume (default: one a voxel)")
      ->check(CLI::Range(1, hbSampling::kMaxSamples));
  add("Rendering", "--sampling", sampling, "equidistant (default) along each ray, or planewise across the view axis")
      ->check(CLI::IsMember({"equidistant", "planewise"}));
}

hbScene app::SceneOptions::scene(const hbGeometry& geometry) const {
  hbScene result = file.empty() ? hbScene() : hb::loadScene(file);
  if (!mode.empty()) result.mode = hb::modeFromName(mode);
  if (!size.empty()) {
    const auto sizes = app::parseSizes(size, 2, "--size");
    result.width = int(std::min<std::int64_t>(sizes[0], hbScene::kMaxPictureSide + 1));
    result.height = int(std::min<std::int64_t>(sizes[1], hbScene::kMaxPictureSide + 1));
  }
  if (!sampling.empty())
    result.sampling.kind = sampling == "planewise" ? hbSampling::Kind::planewise : hbSampling::Kind::equidistant;
  if (samples > 0) result.sampling.samples = samples;
  if (iso) result.isoValue = iso;
  if (!window.empty()) {
    const auto ends = app::parseNumbers(window, 2, 2, "--window");
    result.window = {ends[0], ends[1]};
  }
  if (!colormap.empty()) result.colormap = hbColormap(colormap).name();
  if (component == "magnitude")
    result.magnitude = true;
  else if (!component.empty()) {
    const double number = app::parseNumbers(component, 1, 1, "--component").front();
    if (number != std::floor(number) || number < 0.0 || number > 65535.0)
      throw hbError(fmt::format("--component: expected a whole number from 0, or magnitude, found '{}'", component));
    result.component = int(number);
    result.magnitude = false;
  }

  if (preintegrate) result.preintegrated = true;
  if (!background.empty()) {
    const auto rgb = app::parseNumbers(background, 3, 3, "--background");
    result.background = {rgb[0], rgb[1], rgb[2]};
  }
  result.transfer = transferFunction(result.transfer);
  place(result, geometry);
  return result;
}

std::optional<hbTransferFunction> app::SceneOptions::transferFunction(std::optional<hbTransferFunction> known) const {
  if (!transfer.empty()) {
    const auto names = hbTransferFunction::presetNames();
    const std::size_t colon = transfer.rfind(':');
    if (std::find(names.begin(), names.end(), transfer) != names.end())
      known = hbTransferFunction::preset(transfer);
    else if (colon != std::string::npos && !std::filesystem::exists(transfer))
      known = hb::loadTransferFunctions(transfer.substr(0, colon), transfer.substr(colon + 1)).front();
    else if (std::filesystem::exists(transfer))
      known = hb::loadTransferFunctions(transfer).front();
    else
      throw hbError(
          fmt::format("--transfer: expected a file or one of {}, found '{}'", fmt::join(names, ", "), transfer));
  }
  if ((!transferRange.empty() || unitLength) && !known) known = hbTransferFunction::preset("density");
  if (!transferRange.empty()) {
    const auto ends = app::parseNumbers(transferRange, 2, 2, "--transfer-range");
    known = known->rescaled(ends[0], ends[1]);
  }
  if (unitLength) known = known->withUnitLength(*unitLength);
  return known;
}

void app::SceneOptions::place(hbScene& scene, const hbGeometry& geometry) const {
  using Projection = hbCamera::Projection;
  const double aspect = double(scene.width) / double(scene.height);
  Projection chosen = scene.camera ? scene.camera->projection : Projection::perspective;
  if (!projection.empty()) chosen = projection == "orthographic" ? Projection::orthographic : Projection::perspective;
  if (!camera.empty()) {
    const auto n = app::parseNumbers(camera, 6, 9, "--camera");
    if (n.size() != 6 && n.size() != 9)
      throw hbError("--camera: expected 6 or 9 numbers: position, target, and perhaps up");
    hbCamera placed;
    placed.projection = chosen;
    placed.position = {n[0], n[1], n[2]};
    placed.target = {n[3], n[4], n[5]};
    if (n.size() == 9) placed.up = {n[6], n[7], n[8]};
    placed.height = hbCamera::framing(geometry, 0, 0, Projection::orthographic, aspect).height;
    scene.camera = placed;
  } else if (!scene.camera || azimuth || elevation || !projection.empty()) {
    scene.camera = hbCamera::framing(geometry, azimuth.value_or(hbCamera::kDefaultAzimuth),
                                     elevation.value_or(hbCamera::kDefaultElevation), chosen, aspect);
  }
  if (!zoom) return;
  if (!std::isfinite(*zoom)) throw hbError(fmt::format("--zoom: expected a finite number, found {}", *zoom));
  const double half = glm::radians(0.5 * scene.camera->fieldOfView);
  scene.camera->fieldOfView = 2.0 * glm::degrees(std::atan(std::tan(half) / *zoom));
  scene.camera->height /= *zoom;
}
