#include "apps/SceneOptions.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "apps/Program.h"
#include "scene/hbColormap.h"
#include "volume/hbError.h"

namespace {

constexpr std::string_view kAxes = "xyz";

hbScene::Plane planeOf(const std::string& text, const hbGeometry& geometry) {
  if (text.size() > 2 && text[1] == ':' && kAxes.find(text[0]) != std::string_view::npos) {
    const int axis = int(kAxes.find(text[0]));
    const double place = app::parseNumbers(text.substr(2), 1, 1, "--slice").front();
    if (!(place >= 0.0 && place <= 1.0))
      throw hbError(fmt::format("--slice: expected a fraction of the edge, 0 to 1, found {}", place));
    glm::dvec3 point(0.5);
    point[axis] = place;
    const glm::dmat4 world = geometry.cubeToWorld();
    // Normal to the other two edges.
    const glm::dvec3 u(world[(axis + 1) % 3]), v(world[(axis + 2) % 3]);
    return {glm::dvec3(world * glm::dvec4(point, 1.0)), glm::cross(glm::normalize(u), glm::normalize(v))};
  }
  const auto n = app::parseNumbers(text, 6, 6, "--slice");
  return {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
}

/// Looks against the normal, with all of the volume in view and before the camera's plane, and with the world's z axis
/// up, or y where that is the normal.
hbCamera facing(const hbScene::Plane& plane, const hbGeometry& geometry, double aspect) {
  hbCamera camera = hbCamera::framing(geometry, 0.0, 0.0, hbCamera::Projection::orthographic, aspect);
  const double away = glm::length(camera.position - camera.target);
  const glm::dvec3 size = glm::abs(plane.normal);
  // Squares of what is scaled do not go under or over.
  const glm::dvec3 normal = glm::normalize(plane.normal / std::max({size.x, size.y, size.z}));
  camera.target -= glm::dot(camera.target - plane.point, normal) * normal;
  camera.position = camera.target + 2.0 * away * normal;
  if (std::abs(normal.z) > 0.99) camera.up = {0.0, 1.0, 0.0};
  const glm::dvec3 right = glm::normalize(glm::cross(camera.up, normal)), up = glm::cross(normal, right);
  const glm::dmat4 world = geometry.cubeToWorld();
  double half = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 place(world * glm::dvec4(corner & 1, corner >> 1 & 1, corner >> 2, 1.0));
    half = std::max({half, std::abs(glm::dot(place - camera.target, up)),
                     std::abs(glm::dot(place - camera.target, right)) / aspect});
  }
  camera.height = 2.0 * hbCamera::kFramingMargin * half;
  return camera;
}

} // namespace

void app::SceneOptions::addTo(CLI::App& subcommand) {
  const auto add = [&](const char* group, const char* flag, auto& value, const char* text) {
    return subcommand.add_option(flag, value, text)->group(group);
  };
  add("Picture", "--mode", mode,
      "xray (default): line integral; mip: greatest value; iso: surface; dvr: colour and opacity; slice: see "
      "--slice")
      ->check(CLI::IsMember({"xray", "mip", "iso", "dvr", "slice"}));
  add("Picture", "--size", size, "Pixels (default 512x512)")->type_name("WxH");
  add("Picture", "--iso", iso, "Iso-value (default: Otsu's threshold of the histogram)");
  add("Picture", "--component", component, "Which component, from 0, or magnitude")->type_name("C");
  add("Picture", "--window", window, "PNG: values shown as the colour map's ends (default: those of the picture)")
      ->type_name("LO,HI");
  add("Picture", "--colormap", colormap, "PNG: gray, inverse-gray, heat, cubehelix or coolwarm");
  add("Picture", "--background", background, "PNG: coded sRGB, each in [0,1]")->type_name("R,G,B");
  subcommand.add_flag("--labels", labels, "Values are labels: show the nearest sample's, each in a colour of its own")
      ->group("Picture");
  add("Picture", "--clip", clip, "Show this part of the volume: fractions of its edges along its own axes, 0 to 1")
      ->type_name("X0,X1,Y0,Y1,Z0,Z1");
  add("Picture", "--slice", slice,
      "The values on a plane: across an axis of the volume at a fraction of its edge, or through a point of the world "
      "with a normal; seen from the front unless a camera is given")
      ->type_name("x|y|z:T or X,Y,Z,NX,NY,NZ");
  matter.addTo(subcommand);
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

  if (!background.empty()) {
    const auto rgb = app::parseNumbers(background, 3, 3, "--background");
    result.background = {rgb[0], rgb[1], rgb[2]};
  }
  if (labels) result.labels = true;
  if (!clip.empty()) {
    const auto n = app::parseNumbers(clip, 6, 6, "--clip");
    result.clip = {{n[0], n[2], n[4]}, {n[1], n[3], n[5]}};
  }
  cut(result, geometry);
  matter.apply(result);
  place(result, geometry);
  return result;
}

void app::SceneOptions::cut(hbScene& scene, const hbGeometry& geometry) const {
  if (!slice.empty()) {
    if (!mode.empty() && mode != "slice")
      throw hbError(fmt::format("--slice: expected --mode slice or none, found {}", mode));
    scene.mode = hbMode::slice;
    scene.slice = planeOf(slice, geometry);
  }
  if (scene.mode == hbMode::slice && !scene.slice) throw hbError("--mode slice: expected --slice with it");
  scene.validate(); // before a camera is placed by it
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
  } else if (!scene.camera && scene.mode == hbMode::slice && !azimuth && !elevation && projection.empty()) {
    scene.camera = facing(*scene.slice, geometry, aspect);
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
