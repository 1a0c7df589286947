#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "raycast/hbRaySegment.h"
#include "raycast/hbShearWarp.h"
#include "sparsegrid/hbSparseGrid.h"
#include "volume/hbVolumeField.h"

/// Volumes and cameras that the tests of shear-warp share.
namespace hbTestScenes {

using Projection = hbCamera::Projection;

/// The grid through the values of a function at the nodes of a box, given with its geometry.
inline hbSparseGrid gridOf(const hbGeometry& geometry, const hbIndexSet& set,
                           const std::vector<std::function<double(const glm::dvec3&)>>& components) {
  std::vector<double> samples;
  const std::vector<double> xs = geometry.cubeCoordinates(0), ys = geometry.cubeCoordinates(1),
                            zs = geometry.cubeCoordinates(2);
  for (const double z : zs)
    for (const double y : ys)
      for (const double x : xs)
        for (const auto& f : components) samples.push_back(f({x, y, z}));
  const hbVolumeField field(hbVolume::fromSamples(geometry, std::move(samples), int(components.size())));
  return hbSparseGrid::interpolate(field, set, hbLatticeMapping::fitted);
}
/// The same with the regular set of a level.
inline hbSparseGrid gridOf(const hbGeometry& geometry, int level,
                           const std::vector<std::function<double(const glm::dvec3&)>>& components) {
  return gridOf(geometry, hbIndexSet::regular(level, hbIndexSet::axesOf(geometry.size)), components);
}

inline double waves(const glm::dvec3& p) {
  return std::sin(5.0 * p.x + 1.0) * std::cos(4.0 * p.y) + p.z * p.z - 0.4 * p.x;
}

inline hbGeometry box(const hbSize3& size, const glm::dvec3& edges) {
  hbGeometry g;
  g.size = size;
  for (int d = 0; d < 3; ++d) g.spacing[d] = size[d] > 1 ? edges[d] / double(size[d] - 1) : edges[d];
  return g;
}

/// Unequal edges; turned, mirrored and sheared.
inline hbGeometry awkward() {
  hbGeometry g = box({9, 17, 9}, {2.0, 3.0, 1.5});
  g.origin = {3.0, -1.0, 2.0};
  const double c = std::cos(0.5), s = std::sin(0.5);
  g.direction = glm::dmat3(glm::dvec3(c, s, 0), glm::dvec3(s, -c, 0), glm::normalize(glm::dvec3(0.2, 0.1, 1)));
  return g;
}

inline hbScene sceneOf(hbMode mode, const hbCamera& camera, int width = 14, int height = 11, int samples = 9) {
  hbScene scene;
  scene.mode = mode;
  scene.width = width;
  scene.height = height;
  scene.sampling.samples = samples;
  scene.camera = camera;
  if (mode == hbMode::iso) scene.isoValue = 0.3;
  return scene;
}

/// Cameras around, in and behind a volume.
inline std::vector<hbCamera> cameras(const hbGeometry& g) {
  std::vector<hbCamera> list;
  for (const Projection projection : {Projection::orthographic, Projection::perspective}) {
    for (const auto& [azimuth, elevation] : {std::pair(0.0, 0.0),
                                             {90.0, 0.0},
                                             {180.0, 0.0},
                                             {270.0, 0.0},
                                             {0.0, 90.0},
                                             {0.0, -90.0},
                                             {35.0, 20.0},
                                             {-125.0, -40.0},
                                             {44.0, 60.0}})
      list.push_back(hbCamera::framing(g, azimuth, elevation, projection));
    const glm::dmat4 world = g.cubeToWorld();
    const auto at = [&](double x, double y, double z) { return glm::dvec3(world * glm::dvec4(x, y, z, 1.0)); };
    hbCamera inside; // looking obliquely from within
    inside.projection = projection;
    inside.position = at(0.4, 0.3, 0.45);
    inside.target = at(0.9, 0.8, 0.6);
    inside.height = 2.0;
    inside.fieldOfView = 60.0;
    list.push_back(inside);
    inside.fieldOfView = 150.0; // up to four main directions
    list.push_back(inside);
    inside.position = at(0.999, 0.5, 0.5); // beyond the last slice along x
    inside.target = at(2.0, 0.5, 0.6);
    list.push_back(inside);
  }
  return list;
}

inline std::vector<float> channel(const hbPicture& picture, const std::string& name) { return *picture.find(name); }

inline hbPicture draw(const hbSparseGrid& grid, const hbScene& scene, int supersample = 1) {
  return hbShearWarp(grid, scene, {supersample}).render();
}

/// All of a volume, an inner part of it, one thinner than most distances between slices, and one at a corner.
inline std::vector<hbScene::ClipBox> clipBoxes() {
  return {{},
          {{0.1, 0.25, 0.3}, {0.8, 0.7, 0.9}},
          {{0.0, 0.51, 0.0}, {1.0, 0.52, 1.0}},
          {{0.7, 0.0, 0.6}, {1.0, 0.45, 1.0}}};
}

/// World length and middle of the part of a pixel's ray in the cube, or in what of it is seen.
struct InCube {
  double length = 0.0;
  glm::dvec3 enter{0.0}, leave{0.0};
};
inline std::optional<InCube> inCube(const hbGeometry& g, const hbScene& scene, int x, int y) {
  const hbScene::ClipBox box = scene.clip.value_or(hbScene::ClipBox{});
  const auto segment = hb::clipToCube(scene.camera->ray(x + 0.5, y + 0.5, scene.width, scene.height),
                                      glm::inverse(g.cubeToWorld()), box.lo, box.hi);
  if (!segment) return std::nullopt;
  return InCube{segment->length(), segment->at(segment->enter), segment->at(segment->leave)};
}

} // namespace hbTestScenes
