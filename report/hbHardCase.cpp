#include "report/hbHardCase.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "raycast/hbPlaneRays.h"
#include "sparsegrid/hbHierarchise.h"
#include "sparsegrid/hbNodeSampler.h"
#include "volume/fields/hbAnalyticField.h"
#include "volume/hbVolumeField.h"

namespace {

using Patch = hbHardCase::Patch;
using Problem = hbHardCase::Problem;
using Projection = hbCamera::Projection;
using Formula = std::function<double(const glm::dvec3& p)>;

constexpr double kPlaces = 0x1p24; // coordinates in a unit
const glm::dvec3 kSheet(1.0, 1.0, 0.001);

/// From the values at the nodes, in 64 bits.
Problem problemOf(const hbSparseGrid::Frame& frame, const hbIndexSet& set, std::vector<double> values) {
  hb::hierarchise(set, values);
  std::vector<float> stored(values.begin(), values.end()), lost;
  double largest = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] -= double(stored[i]);
    largest = std::max(largest, std::abs(values[i]));
  }
  // What is lost of subnormal numbers would not fit a float.
  const double scale = largest > 0.0 ? std::exp2(std::ilogb(largest)) : 1.0;
  for (const double value : values) lost.push_back(float(value / scale));
  hbSparseGrid::Frame lostFrame = frame;
  lostFrame.valueMap = {0.0, scale * frame.valueMap.scale};
  return {hbSparseGrid::fromSurpluses(frame, set, {std::move(stored)}),
          hbSparseGrid::fromSurpluses(lostFrame, set, {std::move(lost)}),
          {},
          std::nullopt};
}

Problem problemOf(const hbField& field, const hbIndexSet& set, hbLatticeMapping mapping = hbLatticeMapping::fitted) {
  return problemOf({field.geometry(), field.valueMap(), mapping}, set,
                   hbNodeSampler(field, set, mapping).sample(hbProgress::none()).front());
}

/// The values of a function of a node's subspace, its place there, and where it lies.
template <class Function>
std::vector<double> nodalValues(const hbIndexSet& set, Function f) {
  std::vector<double> values;
  for (const hbSubspace& subspace : set.subspaces())
    for (std::int64_t k = 0; k < subspace.nodes.z; ++k)
      for (std::int64_t j = 0; j < subspace.nodes.y; ++j)
        for (std::int64_t i = 0; i < subspace.nodes.x; ++i) {
          const hbSize3 index(i, j, k);
          glm::dvec3 p;
          for (int d = 0; d < 3; ++d) {
            const int level = subspace.levels[d];
            p[d] = set.flat()[d] ? 0.5 : level == 0 ? double(index[d]) : std::ldexp(double(2 * index[d] + 1), -level);
          }
          values.push_back(f(subspace, index, p));
        }
  return values;
}

hbSparseGrid::Frame frameOf(const hbSize3& size, const glm::dvec3& edges = glm::dvec3(1.0)) {
  hbSparseGrid::Frame frame;
  frame.geometry.size = size;
  for (int d = 0; d < 3; ++d) frame.geometry.spacing[d] = size[d] > 1 ? edges[d] / double(size[d] - 1) : edges[d];
  return frame;
}

Problem ofFormula(int level, const Formula& f, const glm::dvec3& edges = glm::dvec3(1.0)) {
  const hbIndexSet set = hbIndexSet::regular(level, {});
  return problemOf(frameOf(hbSize3((std::int64_t{1} << level) + 1), edges), set,
                   nodalValues(set, [&](const hbSubspace&, const hbSize3&, const glm::dvec3& p) { return f(p); }));
}

/// Regular, at equal distances all over the cube, between the nodes: no coordinate has few bits.
Patch everywhere(const Problem& problem, const glm::ivec3& count) {
  Patch patch;
  for (int d = 0; d < 3; ++d) {
    if (problem.grid.indexSet().flat()[d]) continue;
    patch.count[d] = count[d];
    patch.step[d] = (2.0 * std::floor(0.5 * kPlaces / count[d]) - 1.0) / kPlaces;
    patch.first[d] = (2.0 * std::floor(0.2 * kPlaces / count[d]) + 1.0) / kPlaces;
  }
  return patch;
}

/// Nodes of the first levels, the faces among them.
Patch nodes(const Problem& problem, const glm::ivec3& count) {
  Patch patch;
  for (int d = 0; d < 3; ++d) {
    if (problem.grid.indexSet().flat()[d]) continue;
    patch.count[d] = count[d];
    patch.first[d] = 0.0;
    patch.step[d] = 1.0 / (count[d] - 1);
  }
  return patch;
}

/// Around a place, `half` to either side but within the cube.
Patch around(const glm::dvec3& middle, const glm::dvec3& half, const glm::ivec3& count) {
  Patch patch;
  patch.count = count;
  for (int d = 0; d < 3; ++d) {
    const double step = 2.0 * std::floor(kPlaces * half[d] / (count[d] - 1)) - 1.0; // odd
    const double first = std::round(kPlaces * middle[d] - 0.5 * step * (count[d] - 1));
    patch.step[d] = step / kPlaces;
    patch.first[d] = std::clamp(first, 0.0, kPlaces - step * (count[d] - 1)) / kPlaces;
  }
  return patch;
}

Problem withPatches(Problem problem) {
  problem.patches = {everywhere(problem, {9, 9, 3}), nodes(problem, {9, 9, 3})};
  return problem;
}

/// An analytic field on the regular grid of a level.
Problem ofField(const std::string& specification, int level) {
  const auto field = hbAnalyticField::create(specification)->withSize(hbSize3((std::int64_t{1} << level) + 1));
  return problemOf(*field, hbIndexSet::regular(level, {}));
}

/// Of a size that is no 2^n + 1, or has thin axes.
Problem ofSize(const hbSize3& size, hbLatticeMapping mapping) {
  const auto field = hbAnalyticField::create("vortex")->withSize(size);
  return withPatches(problemOf(*field, hbIndexSet::regular(5, hbIndexSet::axesOf(size)), mapping));
}

double smooth(const glm::dvec3& p) {
  return std::sin(2.0 * p.x + 0.3) * std::cos(1.5 * p.y - 0.2) * std::exp(0.7 * p.z);
}
double waves(const glm::dvec3& p) { return std::sin(5.0 * p.x + 1.0) * std::cos(4.0 * p.y) + p.z * p.z - 0.4 * p.x; }

/// A volume of 32-bit floats with a large common offset, centred as files are, or not.
Problem offset(bool isCentred) {
  hbGeometry geometry = frameOf(hbSize3(33)).geometry;
  std::vector<float> samples;
  const std::vector<double> places = geometry.cubeCoordinates(0);
  for (const double z : places)
    for (const double y : places)
      for (const double x : places) samples.push_back(float(1e6 + smooth({x, y, z})));
  const hbVolume volume = hbVolume::fromSamples(geometry, std::move(samples));
  const hbValueMap map = isCentred ? volume.chooseValueMap() : hbValueMap{};
  return withPatches(problemOf(hbVolumeField(volume, map), hbIndexSet::regular(5, {})));
}

/// Terms as large as they come beside the values' range: about 1 times each coefficient. Nodes that took a component
/// grid's sign instead would make the sum itself as large, and the range with it.
Problem checkerboard() {
  constexpr int kLevel = 11;
  constexpr double kStep = 1.0 / 8.0; // the combination makes about 8 of it
  const hbIndexSet set = hbIndexSet::regular(kLevel, {});
  const auto square = [](const hbSubspace& subspace, const hbSize3& index, const glm::dvec3&) {
    const glm::ivec3 l = glm::max(subspace.levels, 1);
    if (l.x + l.y + l.z - 2 < kLevel) return 1.0;
    return (index.x + index.y + index.z) % 2 == 0 ? 1.0 + kStep : 1.0 - kStep;
  };
  Problem problem = problemOf(frameOf(hbSize3((std::int64_t{1} << kLevel) + 1)), set, nodalValues(set, square));
  problem.patches = {everywhere(problem, {5, 5, 2}), around({0.5, 0.5, 0.5}, glm::dvec3(0x1p-8), {5, 5, 2})};
  return problem;
}

/// The subspace of a level that is as fine along all axes as it can be.
glm::ivec3 evenLevels(int level) { return {1 + (level + 1) / 3, 1 + level / 3, 1 + (level - 1) / 3}; }

Problem spikes() {
  constexpr int kLevel = 8;
  const hbIndexSet set = hbIndexSet::regular(kLevel, {});
  const auto spike = [](const hbSubspace& subspace, const hbSize3& index, const glm::dvec3&) {
    const glm::ivec3 l = subspace.levels;
    const int level = l.x + l.y + l.z - 2;
    if (std::min({l.x, l.y, l.z}) < 1 || l != evenLevels(level)) return 0.0;
    return index == hbSize3(subspace.nodes.x / 3, subspace.nodes.y / 2, subspace.nodes.z - 1) ? 1.0 : 0.0;
  };
  Problem problem = problemOf(frameOf(hbSize3((std::int64_t{1} << kLevel) + 1)), set, nodalValues(set, spike));
  problem.patches = {everywhere(problem, {9, 9, 3})};
  for (int level = 1; level <= kLevel; ++level) {
    const hbSubspace& subspace = set.subspace(evenLevels(level));
    const hbSize3 index(subspace.nodes.x / 3, subspace.nodes.y / 2, subspace.nodes.z - 1);
    glm::dvec3 place, half;
    for (int d = 0; d < 3; ++d) {
      half[d] = std::exp2(-subspace.levels[d]);
      place[d] = double(2 * index[d] + 1) * half[d];
    }
    problem.patches.push_back(around(place, half, {5, 5, 3}));
  }
  return problem;
}

Problem squareRoot() {
  Problem problem = ofFormula(8, [](const glm::dvec3& p) { return std::sqrt(p.x) * (1.0 + p.y) * (1.0 + p.z); });
  problem.patches = {everywhere(problem, {9, 9, 3}), around({0.0, 0.4, 0.6}, {0x1p-7, 0.1, 0.1}, {9, 3, 3})};
  return problem;
}

Problem levelTwelve() {
  Problem problem = ofField("vortex", 12);
  problem.patches = {everywhere(problem, {4, 4, 2})};
  return problem;
}

hbScene pictureOf(hbMode mode, const hbCamera& camera, int samples = 16) {
  hbScene scene;
  scene.mode = mode;
  scene.width = scene.height = 16;
  scene.camera = camera;
  scene.sampling = {hbSampling::Kind::planewise, samples};
  return scene;
}

/// An X-ray of waves in a box of those edges.
template <class Camera>
Problem view(Camera cameraOf, const glm::dvec3& edges = glm::dvec3(1.0), int samples = 16) {
  Problem problem = ofFormula(4, waves, edges);
  problem.scene = pictureOf(hbMode::xray, cameraOf(problem.grid.geometry()), samples);
  return problem;
}

/// An iso-surface seen along y; `isoOf` is given the samples along a ray near the middle.
template <class IsoOf>
Problem surface(const Formula& f, int samples, IsoOf isoOf) {
  Problem problem = ofFormula(5, f);
  hbScene scene =
      pictureOf(hbMode::iso, hbCamera::framing(problem.grid.geometry(), 0.0, 0.0, Projection::orthographic), samples);
  scene.isoValue = 0.0;
  const hbPlaneRays rays(problem.grid, scene);
  constexpr std::size_t kColumn = 9, kRow = 6; // of 16
  const std::size_t pixel = kColumn + kRow * std::size_t(scene.width);
  std::vector<double> values;
  for (int i = rays.rays()[pixel].first; i <= rays.rays()[pixel].last; ++i)
    values.push_back(problem.grid.calcValue(rays.at(pixel, i), 0));
  scene.isoValue = double(float(isoOf(values)));
  problem.scene = scene;
  return problem;
}

std::vector<hbHardCase> valueCases() {
  const auto field = [](const std::string& specification, int level) {
    return [=] { return withPatches(ofField(specification, level)); };
  };
  return {
      {"large-offset", "1e6 and a small signal in 32-bit floats, as such a file is read", [] { return offset(true); }},
      {"large-offset-kept", "the same where nobody takes the offset away: it takes 20 of the 24 bits",
       [] { return offset(false); }},
      {"checkerboard",
       "7/8 and 9/8 in turn on the finest nodes of level 11, 1 on all others: terms of 221 cancel to a range of 1",
       checkerboard},
      {"spikes", "1 on one node of every level, 0 on all others: neighbours differ by all there is", spikes},
      {"ball", "an edge: surpluses that do not fall, of either sign", field("ball", 6)},
      {"kink", "a diagonal kink: no mixed derivatives, surpluses that do not fall", field("kink", 6)},
      {"marschner-lobb-below", "two samples a wave would take level 6, this is 5: aliases", field("marschner-lobb", 5)},
      {"marschner-lobb-at", "level 6 has just two samples a wave along the axes", field("marschner-lobb", 6)},
      {"marschner-lobb-above", "level 7 has four samples a wave along the axes", field("marschner-lobb", 7)},
      {"sqrt", "an infinite slope at a face: surpluses fall by half a bit a level only", squareRoot},
      {"huge-range", "from 1e-38 to 1e+30 along x: small values beside large ones",
       [] {
         return withPatches(ofFormula(
             5, [](const glm::dvec3& p) { return std::pow(10.0, -38.0 + 68.0 * p.x) * (1.0 + p.y * p.z) / 2.0; }));
       }},
      {"subnormal", "values about 1e-40, below the least normal float: as few as 17 bits are left",
       [] { return withPatches(ofFormula(4, [](const glm::dvec3& p) { return 1e-40 * smooth(p); })); }},
      {"constant", "0.1 everywhere: the coefficients sum to 1, their magnitudes to 61",
       [] { return withPatches(ofFormula(6, [](const glm::dvec3&) { return 0.1; })); }},
      {"multilinear", "all but the corners' surpluses are 0: interpolation is exact", field("multilinear", 5)},
      {"two-samples", "2 x 33 x 33: an axis with level 0 only",
       [] {
         return ofSize({2, 33, 33}, hbLatticeMapping::fitted);
       }},
      {"slice-x", "1 x 33 x 33: a single slice across the fast axis",
       [] {
         return ofSize({1, 33, 33}, hbLatticeMapping::fitted);
       }},
      {"slice-z", "33 x 33 x 1: a single slice",
       [] {
         return ofSize({33, 33, 1}, hbLatticeMapping::fitted);
       }},
      {"odd-sizes-fitted", "21 x 14 x 9, no 2^n + 1: nodes between the samples",
       [] {
         return ofSize({21, 14, 9}, hbLatticeMapping::fitted);
       }},
      {"odd-sizes-aligned", "21 x 14 x 9, no 2^n + 1: coordinates are scaled, and rounded once more",
       [] {
         return ofSize({21, 14, 9}, hbLatticeMapping::aligned);
       }},
      {"level-1", "the coarsest grid, 27 nodes", field("vortex", 1)},
      {"level-12", "the finest grid of the paper's tables: 199 component grids", levelTwelve},
  };
}

std::vector<hbHardCase> pictureCases() {
  const auto framed = [](double azimuth, double elevation, Projection projection) {
    return [=](const hbGeometry& g) { return hbCamera::framing(g, azimuth, elevation, projection); };
  };
  return {
      {"view-along-axis", "X-ray along an axis: samples on nodes' planes",
       [=] { return view(framed(0.0, 0.0, Projection::orthographic)); }},
      {"view-along-diagonal", "X-ray along the cube's diagonal: rays through edges and corners",
       [=] { return view(framed(45.0, 35.264389682754654, Projection::orthographic)); }},
      {"view-grazing", "X-ray a thousandth off a face: rays that are in the volume for a moment",
       [] {
         return view([](const hbGeometry&) {
           hbCamera camera;
           camera.projection = Projection::orthographic;
           camera.position = {-1.0, -0.0015, 0.5};
           camera.target = {0.5, 0.0, 0.5};
           camera.height = 0.02;
           return camera;
         });
       }},
      {"view-from-inside", "X-ray of what lies before a camera in the volume",
       [] {
         return view([](const hbGeometry&) {
           hbCamera camera;
           camera.position = {0.4, 0.3, 0.45};
           camera.target = {0.9, 0.8, 0.6};
           camera.fieldOfView = 80.0;
           return camera;
         });
       }},
      {"iso-tangent", "an iso-surface that a ray touches at one sample: there, or not",
       [] {
         return surface(
             [](const glm::dvec3& p) {
               const glm::dvec3 q = p - 0.5;
               return q.x * q.x + q.y * q.y + q.z * q.z;
             },
             17, [](const std::vector<double>& values) { return *std::min_element(values.begin(), values.end()); });
       }},
      {"iso-at-node", "the iso-value is that of nodes on which all rays have a sample",
       [] {
         return surface([](const glm::dvec3& p) { return std::exp(0.7 * p.y); }, 16,
                        [](const std::vector<double>& values) { return values[10]; });
       }},
      {"aspect-across", "edges of 1, 1 and 0.001: X-ray across a sheet",
       [=] { return view(framed(30.0, 90.0, Projection::perspective), kSheet); }},
      {"aspect-along", "edges of 1, 1 and 0.001: X-ray along a sheet",
       [] {
         return view(
             [](const hbGeometry&) {
               hbCamera camera;
               camera.projection = Projection::orthographic;
               camera.position = {0.4, -1.0, 0.0005};
               camera.target = {0.41, 0.5, 0.0005};
               camera.height = 0.002;
               return camera;
             },
             kSheet);
       }},
      {"large-step", "one sample for the whole volume: rays that meet no plane",
       [=] { return view(framed(30.0, 20.0, Projection::perspective), glm::dvec3(1.0), 1); }},
  };
}

} // namespace

std::vector<double> hbHardCase::Patch::along(int axis) const {
  std::vector<double> places(static_cast<std::size_t>(count[axis]));
  for (std::size_t i = 0; i < places.size(); ++i) places[i] = first[axis] + double(i) * step[axis];
  return places;
}

const std::vector<hbHardCase>& hb::hardCases() {
  static const std::vector<hbHardCase> all = [] {
    std::vector<hbHardCase> list = valueCases();
    for (hbHardCase& one : pictureCases()) list.push_back(std::move(one));
    return list;
  }();
  return all;
}
