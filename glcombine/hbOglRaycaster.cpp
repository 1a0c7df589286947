#include "glcombine/hbOglRaycaster.h"

#include <algorithm>
#include <optional>

#include "glcombine/hbGlContext.h"
#include "glcombine/hbGlTarget.h"
#include "glcombine/hbOglPlaneCompositor.h"
#include "glcombine/hbOglRays.h"
#include "glcombine/hbOglSurfaceShader.h"
#include "raycast/hbPlaneCompositor.h"

namespace {

/// Planes drawn at a time where textures are handed over again for each time.
constexpr int kStreamedPlanes = 16;

/// Targets for the planes drawn at a time, and for the one before them.
class Targets {
public:
  Targets(const hbGlFunctions& gl, const hbScene& scene, hbGlFormat format, int atATime) {
    for (int i = 0; i <= atATime; ++i)
      list_.push_back(std::make_unique<const hbGlTarget>(gl, scene.width, scene.height, format));
  }
  /// Of a plane; planes come one after the other.
  const hbGlTarget* of(int plane) const { return list_[std::size_t(plane) % list_.size()].get(); }

private:
  std::vector<std::unique_ptr<const hbGlTarget>> list_;
};

} // namespace

struct hbOglRaycaster::Parts {
  const hbGlContext& context;
  const hbGlFunctions& gl;
  hbPlaneRays rays;
  Options options;
  hbOglRays deviceRays;
  std::optional<hbOglSparseGrid> blended;
  std::optional<hbOglSurfaceShader> shader;

  Parts(const hbGlContext& c, const hbSparseGrid& grid, const hbScene& scene, const Options& choice)
      : context(c), gl(c.gl()), rays(grid, scene), options(choice), deviceRays(gl, rays) {
    blended.emplace(context, hbCombinationSparseGrid(grid), scene.component, options.blend);
    if (scene.mode == hbMode::iso) shader.emplace(gl);
  }

  int planesAtATime() const { return blended->residentBytes() < blended->textureBytes() ? kStreamedPlanes : 1; }

  /// Blends all planes and calls take(index, before, target) with each.
  template <class Take>
  void blendPlanes(hbProgress& progress, Take take) const {
    const int step = planesAtATime();
    const Targets targets(gl, rays.scene(), options.blend.target, step);
    progress.begin("blending planes", rays.planes(), "planes");
    for (int first = 0; first < rays.planes(); first += step) {
      std::vector<hbPlaneRays::Plane> planes;
      std::vector<const hbGlTarget*> drawn;
      for (int i = first; i < std::min(first + step, rays.planes()); ++i) {
        planes.push_back(rays.plane(i));
        drawn.push_back(targets.of(i));
      }
      blended->draw(planes, drawn);
      for (int i = first; i < first + int(planes.size()); ++i) take(i, *targets.of(std::max(i - 1, 0)), *targets.of(i));
      progress.advance(std::int64_t(planes.size()));
    }
  }

  hbPicture readBack(hbProgress& progress) const {
    hbPlaneCompositor compositor(rays);
    std::vector<float> values;
    blendPlanes(progress, [&](int index, const hbGlTarget&, const hbGlTarget& target) {
      target.read(values);
      for (float& value : values) value = float(blended->valueOf(double(value)));
      compositor.add(index, values);
    });
    return compositor.finish();
  }

  hbPicture composite(hbProgress& progress) const {
    const double zero = blended->valueOf(0.0), one = blended->valueOf(1.0) - zero;
    hbOglPlaneCompositor compositor(gl, deviceRays, float((double(rays.iso()) - zero) / one));
    blendPlanes(progress, [&](int index, const hbGlTarget& before, const hbGlTarget& target) {
      compositor.add(index, before, target);
    });
    return picture(compositor.found(), zero, one);
  }

  /// Of what was found, in numbers of which 0 and 1 stand for those values.
  hbPicture picture(const hbGlTarget& found, double zero, double one) const {
    std::vector<float> numbers;
    found.read(numbers);
    switch (rays.scene().mode) {
    case hbMode::xray: {
      std::vector<double> sums(numbers.begin(), numbers.end());
      for (std::size_t i = 0; i < sums.size(); ++i)
        sums[i] = zero * std::max(0, rays.rays()[i].last - rays.rays()[i].first + 1) + one * sums[i];
      return rays.xray(sums);
    }
    case hbMode::mip:
      for (float& number : numbers) number = float(zero + one * double(number));
      return rays.mip(numbers);
    case hbMode::iso:
      break;
    }
    const hbGlTarget differences(gl, rays.scene().width, rays.scene().height, hbGlFormat::r32f, 4),
        shaded(gl, rays.scene().width, rays.scene().height, hbGlFormat::r32f, 4);
    blended->differences(deviceRays, found, differences);
    shader->shade(deviceRays, differences, shaded);
    std::vector<float> values, normals;
    differences.read(values);
    shaded.read(normals);
    std::vector<hbPlaneRays::Surface> surfaces;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      if (numbers[i] >= hbOglRays::kNowhere) continue;
      const float* normal = &normals[4 * i];
      surfaces.push_back(
          {i, double(numbers[i]), {normal[0], normal[1], normal[2]}, normal[3], float(zero + double(values[4 * i]))});
    }
    return rays.iso(surfaces);
  }
};

hbOglRaycaster::hbOglRaycaster(const hbGlContext& context, const hbSparseGrid& grid, const hbScene& scene,
                               const Options& options)
    : parts_(std::make_unique<Parts>(context, grid, scene, options)) {}

hbOglRaycaster::~hbOglRaycaster() = default;

hbPicture hbOglRaycaster::render(hbProgress& progress) const {
  return parts_->options.readBack ? parts_->readBack(progress) : parts_->composite(progress);
}

const hbScene& hbOglRaycaster::scene() const { return parts_->rays.scene(); }
std::int64_t hbOglRaycaster::textureBytes() const { return parts_->blended->textureBytes(); }
std::int64_t hbOglRaycaster::residentBytes() const { return parts_->blended->residentBytes(); }
