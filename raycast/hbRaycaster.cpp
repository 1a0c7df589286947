#include "raycast/hbRaycaster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "raycast/hbMatter.h"
#include "raycast/hbMatterRay.h"
#include "raycast/hbPointBatch.h"
#include "raycast/hbRaySegment.h"
#include "raycast/hbSceneCheck.h"
#include "raycast/hbSurfaceShader.h"
#include "scene/hbColorSpace.h"
#include "volume/hbParallel.h"

namespace {

constexpr int kTile = 16;            // pixels a side
constexpr std::int32_t kBatch = 256; // samples handed to the field at once
/// Of one ray: 16 times the planes of a scene, for rays at an angle of up to 86 degrees to the view axis.
constexpr double kMostSamples = 16.0 * hbSampling::kMaxSamples;

/// The samples of one ray: sample i lies at the world distance first + i * step, i < count, and stands for `weight`.
struct RaySamples {
  double first = 0.0, step = 0.0, weight = 0.0;
  std::int32_t count = 0;
  double firstWeight = 0.0, lastWeight = 0.0; ///< What the ends stand for: with them, weights add up to the ray.

  /// The length that sample i stands for where nothing may be left out.
  double share(std::int32_t i) const { return i == 0 ? firstWeight : i + 1 == count ? lastWeight : weight; }
};

/// A crossing of the iso-value: above and below at the ends of [a, b].
struct Crossing {
  std::size_t pixel = 0;
  hbRaySegment segment;
  glm::dvec3 ray{0.0};
  double a = 0.0, b = 0.0;
  float valueA = 0.0F, valueB = 0.0F;
};

// Several sums, and several maxima, side by side: each of them alone would wait for one addition after the other.
constexpr std::size_t kSideBySide = 8;

double sumOf(std::span<const float> values) {
  std::array<double, kSideBySide> sums{};
  std::size_t i = 0;
  for (; i + kSideBySide <= values.size(); i += kSideBySide)
    for (std::size_t k = 0; k < kSideBySide; ++k) sums[k] += double(values[i + k]);
  for (std::size_t k = 0; i + k < values.size(); ++k) sums[k] += double(values[i + k]);
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

/// NaN are left out; minus infinity where there is nothing else.
float greatestOf(std::span<const float> values) {
  std::array<float, kSideBySide> greatest;
  greatest.fill(-std::numeric_limits<float>::infinity());
  std::size_t i = 0;
  for (; i + kSideBySide <= values.size(); i += kSideBySide)
    for (std::size_t k = 0; k < kSideBySide; ++k) greatest[k] = std::max(greatest[k], values[i + k]);
  for (std::size_t k = 0; i + k < values.size(); ++k) greatest[k] = std::max(greatest[k], values[i + k]);
  return *std::max_element(greatest.begin(), greatest.end());
}

/// What all tiles of one frame share.
struct Frame {
  const hbField& field;
  const hbScene& scene;
  const hbCamera camera;
  const hbCamera::Rays rays;
  const hbValueMap map;
  glm::dmat4 worldToCube;
  hbSampling::Extent extent;
  double step;
  float iso;

  std::vector<float>*y, *a, *z = nullptr, *nx = nullptr, *ny = nullptr, *nz = nullptr, *value = nullptr;
  std::array<std::vector<float>*, 3> rgb{};
  const hbMatter* matter;        ///< DVR alone.
  const hbVisibleBlocks* blocks; ///< None: all may be seen.

  Frame(const hbField& f, const hbScene& s, const hbMatter* m, const hbVisibleBlocks* b, hbPicture& picture)
      : field(f), scene(s), camera(*s.camera), rays(camera), map(f.valueMap()),
        worldToCube(glm::inverse(f.geometry().cubeToWorld())), extent(hbSampling::extent(f.geometry(), camera)),
        step(s.sampling.stepLength(f.geometry(), camera)), iso(s.isoValue ? float(map.fromTrue(*s.isoValue)) : 0.0F),
        matter(m), blocks(b) {
    y = &picture.add("Y");
    a = &picture.add("A");
    if (s.mode == hbMode::dvr) {
      for (std::size_t c = 0; c < 3; ++c) rgb[c] = &picture.add(std::string(1, "RGB"[c]));
    }
    if (s.mode != hbMode::iso) return;
    z = &picture.add("Z", std::numeric_limits<float>::infinity());
    nx = &picture.add("N.X");
    ny = &picture.add("N.Y");
    nz = &picture.add("N.Z");
    value = &picture.add("value");
  }

  std::optional<hbRaySegment> clip(const hbRay& ray) const {
    const hbScene::ClipBox box = scene.clip.value_or(hbScene::ClipBox{});
    return hb::clipToCube(ray, worldToCube, box.lo, box.hi);
  }

  RaySamples samples(const hbRay& ray, const hbRaySegment& segment) const {
    if (scene.sampling.kind == hbSampling::Kind::planewise) return onPlanes(ray, segment);
    const double count = std::min(std::max(1.0, std::ceil(segment.length() / step)), kMostSamples);
    const double length = segment.length() / count;
    // Iso looks at both ends of every step, integrals and maxima at the midpoints.
    if (scene.mode == hbMode::iso || (matter && matter->isPreintegrated()))
      return {segment.enter, length, length, std::int32_t(count) + 1};
    return {segment.enter + 0.5 * length, length, length, std::int32_t(count), length, length};
  }

  RaySamples onPlanes(const hbRay& ray, const hbRaySegment& segment) const {
    const glm::dvec3 axis = camera.viewAxis();
    const double cosine = glm::dot(ray.direction, axis);
    if (!(cosine > 0.0)) return {};
    // Plane i lies at near + (i + 1/2) step along the axis, measured from the camera's position.
    const double start = glm::dot(ray.origin - camera.position, axis);
    const auto plane = [&](double distance) { return (start + distance * cosine - extent.near) / step - 0.5; };
    const double planes = scene.sampling.planes(field.geometry(), camera);
    const double first = std::max(0.0, std::ceil(plane(segment.enter))),
                 last = std::min(planes - 1.0, std::floor(plane(segment.leave)));
    // Light is not lost between two planes.
    if (last < first && scene.mode == hbMode::dvr) {
      const double length = segment.length();
      return {segment.enter + 0.5 * length, length, length, 1, length, length};
    }
    if (last < first) return {};
    RaySamples samples{(extent.near + (first + 0.5) * step - start) / cosine, step / cosine, step / cosine,
                       std::int32_t(last - first) + 1};
    // The ends stand for what is left of the ray in the volume, up to the middle between two planes.
    const double half = 0.5 * samples.step, end = samples.first + double(samples.count - 1) * samples.step;
    samples.firstWeight = samples.count == 1 ? segment.length() : samples.first + half - segment.enter;
    samples.lastWeight = samples.count == 1 ? segment.length() : segment.leave - (end - half);
    return samples;
  }
};

/// Works through the pixels of one tile.
class Tile {
public:
  explicit Tile(const Frame& frame) : frame_(frame) {
    if (frame.matter) light_.emplace(frame.field, frame.scene, *frame.matter);
  }

  void pixel(int px, int py) {
    const hbRay ray = frame_.rays.at(px + 0.5, py + 0.5, frame_.scene.width, frame_.scene.height);
    const auto segment = frame_.clip(ray);
    if (!segment) return;
    const std::size_t at = std::size_t(px) + std::size_t(frame_.scene.width) * std::size_t(py);
    if (frame_.scene.mode == hbMode::slice) return meetPlane(ray, *segment, at);
    const RaySamples samples = frame_.samples(ray, *segment);
    switch (frame_.scene.mode) {
    case hbMode::xray:
      return integrate(*segment, samples, at);
    case hbMode::mip:
      return maximum(*segment, samples, at);
    case hbMode::iso:
      return findCrossing(ray, *segment, samples, at);
    case hbMode::dvr:
      light_->begin(ray, *segment);
      frame_.matter->isPreintegrated() ? compositeSlabs(*segment, samples) : composite(*segment, samples);
      return show(light_->finish(), at);
    case hbMode::slice:
      break;
    }
  }

  /// Evaluates what was put off to be done for all pixels at a time.
  void finish() {
    if (!met_.empty()) showPlane();
    if (crossings_.empty()) return;
    if (frame_.scene.sampling.kind == hbSampling::Kind::equidistant) refine();
    shade();
  }

private:
  /// Hands the ray's values to visit(index of the first, values) in batches; stops when visit returns false.
  template <class Visit>
  void marchBatches(const hbRaySegment& segment, const RaySamples& samples, Visit visit) {
    marchPart(segment, samples, 0, samples.count, visit);
  }
  template <class Visit>
  bool marchPart(const hbRaySegment& segment, const RaySamples& samples, std::int32_t begin, std::int32_t end,
                 Visit visit) {
    for (; begin < end; begin += kBatch) {
      batch_.line(segment, samples.first, samples.step, begin, std::min(end - begin, kBatch));
      batch_.evaluate(frame_.field, frame_.scene.component);
      if (!visit(begin, std::span<const float>(batch_.value))) return false;
    }
    return true;
  }

  /// The same, one by one: to visit(index, value).
  template <class Visit>
  void march(const hbRaySegment& segment, const RaySamples& samples, Visit visit) {
    marchBatches(segment, samples, oneByOne(visit));
  }
  template <class Visit>
  static auto oneByOne(Visit& visit) {
    return [&](std::int32_t begin, std::span<const float> values) {
      for (const float value : values)
        if (!visit(begin++, value)) return false;
      return true;
    };
  }

  /// The same, but for samples in blocks that cannot be seen; where some of them follow each other, the first and the
  /// last may be visited.
  template <class Visit>
  void marchVisible(const hbRaySegment& segment, const RaySamples& samples, Visit visit) {
    if (!frame_.blocks) return march(segment, samples, visit);
    hbVisibleBlocks::Walk walk(*frame_.blocks, segment);
    const auto before = [&](double distance) {
      return std::int32_t(
          std::clamp(std::floor((distance - samples.first) / samples.step), -1.0, double(samples.count)));
    };
    for (std::int32_t done = 0; walk.next();) {
      const std::int32_t begin = std::max(done, before(walk.enter())),
                         end = std::min(samples.count, before(walk.leave()) + 2);
      if (!marchPart(segment, samples, begin, end, oneByOne(visit))) return;
      done = std::max(done, end);
    }
  }

  void integrate(const hbRaySegment& segment, const RaySamples& samples, std::size_t at) {
    if (samples.count == 0) return; // between two planes
    double sum = 0.0;
    marchBatches(segment, samples, [&](std::int32_t, std::span<const float> values) {
      sum += sumOf(values);
      return true;
    });
    const double length = double(samples.count) * samples.weight;
    (*frame_.y)[at] = float(frame_.map.scale * sum * samples.weight + frame_.map.offset * length);
    (*frame_.a)[at] = 1.0F;
  }

  void maximum(const hbRaySegment& segment, const RaySamples& samples, std::size_t at) {
    float greatest = -std::numeric_limits<float>::infinity();
    marchBatches(segment, samples, [&](std::int32_t, std::span<const float> values) {
      greatest = std::max(greatest, greatestOf(values));
      return true;
    });
    if (samples.count == 0) return; // between two planes
    (*frame_.y)[at] = float(frame_.map.toTrue(greatest));
    (*frame_.a)[at] = 1.0F;
  }

  void composite(const hbRaySegment& segment, const RaySamples& samples) {
    marchVisible(segment, samples, [&](std::int32_t i, float value) {
      return light_->add(frame_.matter->at(value), samples.share(i), samples.first + double(i) * samples.step);
    });
  }

  /// A slab between each two samples; on planes, what lies before the first and behind the last has their values.
  void compositeSlabs(const hbRaySegment& segment, const RaySamples& samples) {
    float before = 0.0F;
    double end = segment.enter;
    bool isSeen = true;
    const auto add = [&](float front, float back, double until) {
      isSeen = light_->add(frame_.matter->slab(front, back), std::max(0.0, until - end), 0.5 * (end + until));
      end = until;
      return isSeen;
    };
    std::int32_t next = 0;
    marchVisible(segment, samples, [&](std::int32_t i, float value) {
      const double here = samples.first + double(i) * samples.step;
      const bool isBehindGap = i > next;
      const float front = i > 0 ? before : value;
      before = value;
      next = i + 1;
      if (!isBehindGap) return add(front, value, here);
      end = here; // what was left out cannot be seen
      return true;
    });
    if (next > 0 && isSeen) add(before, before, segment.leave);
  }

  void show(const hbEmissionAbsorption& light, std::size_t at) {
    for (std::size_t c = 0; c < 3; ++c) (*frame_.rgb[c])[at] = float(light.colour()[int(c)]);
    (*frame_.y)[at] = float(hb::linearToXyz(light.colour()).y);
    (*frame_.a)[at] = float(light.opacity());
  }

  void meetPlane(const hbRay& ray, const hbRaySegment& segment, std::size_t at) {
    const hbScene::Plane& plane = *frame_.scene.slice;
    const double distance =
        glm::dot(plane.point - ray.origin, plane.normal) / glm::dot(ray.direction, plane.normal); // NaN along it
    // A plane that is a face of the volume is in it, however the two distances are rounded.
    const double slack = 1e-12 * (std::abs(distance) + segment.leave);
    if (!(distance >= segment.enter - slack && distance <= segment.leave + slack)) return;
    met_.push_back(at);
    places_.push_back(segment.at(distance));
  }

  void showPlane() {
    batch_.clear();
    for (const glm::dvec3& place : places_) batch_.add(place);
    batch_.evaluate(frame_.field, frame_.scene.component);
    for (std::size_t i = 0; i < met_.size(); ++i) {
      (*frame_.y)[met_[i]] = float(frame_.map.toTrue(batch_.value[i]));
      (*frame_.a)[met_[i]] = 1.0F;
    }
  }

  void findCrossing(const hbRay& ray, const hbRaySegment& segment, const RaySamples& samples, std::size_t at) {
    float before = 0.0F;
    march(segment, samples, [&](std::int32_t i, float value) {
      const bool crossed = i > 0 && (before >= frame_.iso) != (value >= frame_.iso);
      if (crossed) {
        const double b = samples.first + double(i) * samples.step;
        crossings_.push_back({at, segment, ray.direction, b - samples.step, b, before, value});
      }
      before = value;
      return !crossed;
    });
  }

  void refine() {
    // Every bracket is one step long at first, so all of them are done after the same number of rounds.
    for (int round = 0; round < hbRaycaster::kIsoRounds; ++round) {
      batch_.clear();
      for (const Crossing& c : crossings_) batch_.add(c.segment.at(0.5 * (c.a + c.b)));
      batch_.evaluate(frame_.field, frame_.scene.component);
      for (std::size_t i = 0; i < crossings_.size(); ++i) {
        Crossing& c = crossings_[i];
        const double middle = 0.5 * (c.a + c.b);
        const float value = batch_.value[i];
        const bool inFirstHalf = (c.valueA >= frame_.iso) != (value >= frame_.iso);
        (inFirstHalf ? c.b : c.a) = middle;
        (inFirstHalf ? c.valueB : c.valueA) = value;
      }
    }
  }

  void shade() {
    // Where the line through both ends meets the iso-value; they lie on different sides, so it is between them.
    std::vector<double> distance;
    std::vector<glm::dvec3> places, rays;
    for (const Crossing& c : crossings_) {
      const double t = (double(frame_.iso) - double(c.valueA)) / (double(c.valueB) - double(c.valueA));
      distance.push_back(c.a + std::clamp(t, 0.0, 1.0) * (c.b - c.a));
      places.push_back(c.segment.at(distance.back()));
      rays.push_back(c.ray);
    }
    hbSurfaceShader shader(frame_.field, frame_.scene.component);
    shader.shade(places, rays);
    for (std::size_t i = 0; i < crossings_.size(); ++i) {
      const Crossing& c = crossings_[i];
      const glm::dvec3& normal = shader.normals()[i];
      (*frame_.y)[c.pixel] = float(-glm::dot(normal, c.ray)); // Lambert, lit from the viewer
      (*frame_.a)[c.pixel] = 1.0F;
      (*frame_.z)[c.pixel] = float(depth(c, distance[i]));
      (*frame_.nx)[c.pixel] = float(normal.x);
      (*frame_.ny)[c.pixel] = float(normal.y);
      (*frame_.nz)[c.pixel] = float(normal.z);
      (*frame_.value)[c.pixel] = float(frame_.map.toTrue(shader.values()[i]));
    }
  }

  // Rays of both projections start on the plane through the camera's position.
  double depth(const Crossing& c, double distance) const {
    return distance * glm::dot(c.ray, frame_.camera.viewAxis());
  }

  const Frame& frame_;
  hbPointBatch batch_;
  std::vector<Crossing> crossings_;
  std::optional<hbMatterRay> light_;
  std::vector<std::size_t> met_;   ///< Pixels that see the scene's plane,
  std::vector<glm::dvec3> places_; ///< and where.
};

} // namespace

hbRaycaster::hbRaycaster(const hbField& field, const hbScene& scene) : field_(field), scene_(scene) {
  scene_.camera = scene.cameraFor(field.geometry());
  hb::checkScene(scene_, field);
  prepare();
}

void hbRaycaster::look(const hbCamera& camera) {
  camera.validate();
  scene_.camera = camera;
  prepare();
}

void hbRaycaster::prepare() {
  if (scene_.mode != hbMode::dvr) return;
  const double step = scene_.sampling.stepLength(field_.geometry(), *scene_.camera);
  if (!matter_ || (matter_->isPreintegrated() && matter_->step() != step))
    matter_.emplace(scene_, field_.valueMap(), step);
  // Blocks are made of all samples, a picture of as many as its rays have: they pay where those are not fewer.
  const hbSize3 size = field_.geometry().size;
  const double taken = double(scene_.width) * scene_.height * scene_.sampling.planes(field_.geometry(), *scene_.camera);
  if (!blocks_ && field_.hasLocalRanges() && double(size.x) * double(size.y) * double(size.z) <= taken)
    blocks_.emplace(field_, scene_.component, hbVisibility(*scene_.transfer, *matter_));
}

hbPicture hbRaycaster::render(hbProgress& progress) const {
  hbPicture picture;
  picture.width = scene_.width;
  picture.height = scene_.height;
  picture.metadata[hbPicture::kSceneKey] = hb::toJson(scene_);
  const Frame frame(field_, scene_, matter_ ? &*matter_ : nullptr, blocks_ ? &*blocks_ : nullptr, picture);
  progress.begin("ray casting", std::int64_t(scene_.width) * scene_.height, "pixels");
  const int rows = (scene_.height + kTile - 1) / kTile, columns = (scene_.width + kTile - 1) / kTile;
  hb::parallelFor(std::int64_t(rows) * columns, [&](std::int64_t index) {
    const int row = int(index / columns), column = int(index % columns);
    Tile tile(frame);
    const int x1 = std::min(scene_.width, (column + 1) * kTile), y1 = std::min(scene_.height, (row + 1) * kTile);
    for (int y = row * kTile; y < y1; ++y) {
      for (int x = column * kTile; x < x1; ++x) tile.pixel(x, y);
      progress.advance(x1 - column * kTile);
    }
    tile.finish();
  });
  return picture;
}
