#include "glcombine/hbOglRaycaster.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "glcombine/hbGlContext.h"
#include "glcombine/hbGlTarget.h"
#include "glcombine/hbOglFused.h"
#include "glcombine/hbOglLight.h"
#include "glcombine/hbOglMatter.h"
#include "glcombine/hbOglPlaneCompositor.h"
#include "glcombine/hbOglRays.h"
#include "glcombine/hbOglSurfaceShader.h"
#include "glcombine/hbOglTiles.h"
#include "raycast/hbLitPieces.h"
#include "raycast/hbMatter.h"
#include "raycast/hbPlaneCompositor.h"
#include "sparsegrid/hbSemiNodalGrid.h"
#include "volume/hbError.h"

namespace {

/// Copies the pixels of one tile out of a target's.
void copyTile(const std::vector<float>& target, const hbOglTiles& tiles, int tile, std::vector<float>& out) {
  out.resize(std::size_t(tiles.width()) * std::size_t(tiles.height()));
  for (int y = 0; y < tiles.height(); ++y)
    std::copy_n(target.begin() + tiles.x(tile) + std::ptrdiff_t(tiles.y(tile) + y) * tiles.targetWidth(), tiles.width(),
                out.begin() + std::ptrdiff_t(y) * tiles.width());
}

} // namespace

struct hbOglRaycaster::Parts {
  const hbGlContext& context;
  const hbGlFunctions& gl;
  const hbSparseGrid& grid;
  hbScene scene;
  Options options;
  std::optional<hbOglSparseGrid> blended; ///< blend, and where pictures are composited on the device, how.
  std::optional<hbOglPlaneCompositor> compositor;
  std::optional<hbOglFused> fused; ///< The other forms, and what they draw into.
  std::optional<hbGlTarget> marched;
  std::optional<hbOglSurfaceShader> shader;
  std::optional<hbMatter> matter; ///< DVR, but where planes are read back.
  std::optional<hbOglMatter> deviceMatter;
  hbOglLight light;

  Parts(const hbGlContext& c, const hbSparseGrid& g, const hbScene& asked, const Options& choice)
      : context(c), gl(c.gl()), grid(g), scene(hbPlaneRays(g, asked).scene()), options(choice), light(g, scene) {
    options.blend.memory = options.memory;
    if (isLit() && options.form == Form::blend && !options.readBack)
      throw hbError("shading: expected planes that are read back or another form, found the form blend");
    const int most = mostTexels();
    if (std::max(scene.width, scene.height) > most)
      throw hbError(fmt::format("picture: expected sides of at most {} pixels on this device, found {} x {}", most,
                                scene.width, scene.height));
    if (options.form == Form::blend) {
      blended.emplace(context, hbCombinationSparseGrid(grid), scene.component, options.blend);
      classify();
      if (!options.readBack) compositor.emplace(gl, scene, deviceMatter ? &*deviceMatter : nullptr);
    } else {
      if (options.form == Form::fused)
        fuse(hbCombinationSparseGrid(grid));
      else
        fuse(hbSemiNodalGrid(grid));
      classify();
      marched.emplace(gl, scene.width, scene.height, hbGlFormat::r32f, deviceMatter ? 4 : 1);
    }
    if (scene.mode == hbMode::iso) shader.emplace(gl);
  }

  bool isLit() const { return scene.mode == hbMode::dvr && hbLitPieces::areIn(scene); }

  /// DVR: for the scene's camera; what is known of the same step is kept.
  void classify() {
    const double step = scene.sampling.stepLength(grid.geometry(), *scene.camera);
    const bool isInSoftware = blended && options.readBack;
    if (scene.mode != hbMode::dvr || isInSoftware || (matter && matter->step() == step)) return;
    matter.emplace(scene, grid.valueMap(), step);
    const double zero = blended ? blended->valueOf(0.0) : 0.0, one = blended ? blended->valueOf(1.0) : 1.0;
    const hbValueMap& map = matter->map();
    deviceMatter.emplace(gl, *matter, hbValueMap{map.toTrue(zero), map.scale * (one - zero)}, isLit());
  }

  template <class Grid>
  void fuse(const Grid& stored) {
    const auto bytes = std::int64_t(stored.values(scene.component).size_bytes());
    if (bytes > options.memory)
      throw hbError(fmt::format("textures: expected memory for {} bytes, found a limit of {}", bytes, options.memory));
    fused.emplace(context, stored, scene.component);
  }

  /// Blends all planes, as many at a time as there are tiles, and calls take(first, count, before, target) with each
  /// lot; `before` is the target of the lot before.
  template <class Take>
  void blendPlanes(const hbPlaneRays& rays, const hbOglTiles& tiles, hbProgress& progress, Take take) const {
    const auto target = [&] { return hbGlTarget(gl, tiles.targetWidth(), tiles.targetHeight(), options.blend.target); };
    const hbGlTarget targets[] = {target(), target()};
    progress.begin("blending planes", rays.planes(), "planes");
    for (int first = 0, lot = 0; first < rays.planes(); first += tiles.count(), ++lot) {
      std::vector<hbPlaneRays::Plane> planes;
      for (int i = first; i < std::min(first + tiles.count(), rays.planes()); ++i) planes.push_back(rays.plane(i));
      blended->draw(planes, tiles, targets[lot % 2]);
      take(first, int(planes.size()), targets[(lot + 1) % 2], targets[lot % 2]);
      progress.advance(std::int64_t(planes.size()));
    }
  }

  hbOglTiles tilesFor(const hbPlaneRays& rays) const {
    return {scene.width, scene.height, rays.planes(), mostTexels()};
  }

  GLint mostTexels() const {
    GLint most = 0;
    gl.GetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
    return most;
  }

  hbPicture readBack(const hbPlaneRays& rays, hbProgress& progress) const {
    hbPlaneCompositor software(rays);
    const hbOglTiles tiles = tilesFor(rays);
    std::vector<float> read, values;
    blendPlanes(rays, tiles, progress, [&](int first, int count, const hbGlTarget&, const hbGlTarget& target) {
      target.read(read);
      for (float& value : read) value = float(blended->valueOf(double(value)));
      for (int i = 0; i < count; ++i) {
        copyTile(read, tiles, i, values);
        software.add(first + i, values);
      }
    });
    return software.finish();
  }

  hbPicture blend(const hbPlaneRays& rays, hbProgress& progress) {
    const hbOglRays deviceRays(gl, rays);
    const double zero = blended->valueOf(0.0), one = blended->valueOf(1.0) - zero;
    compositor->begin(float((double(rays.iso()) - zero) / one));
    const hbOglTiles tiles = tilesFor(rays);
    blendPlanes(rays, tiles, progress, [&](int first, int count, const hbGlTarget& before, const hbGlTarget& target) {
      compositor->add(deviceRays, first, count, tiles, before, target);
    });
    return picture(deviceRays, compositor->found(), zero, one);
  }

  hbPicture march(const hbPlaneRays& rays, hbProgress& progress) {
    const hbOglRays deviceRays(gl, rays);
    progress.begin("casting rays", 1, "pictures");
    if (deviceMatter)
      fused->composite(deviceRays, *deviceMatter, light, *marched);
    else
      fused->march(deviceRays, *marched);
    hbPicture made = picture(deviceRays, *marched, 0.0, 1.0);
    progress.advance(1);
    return made;
  }

  /// Of what was found, in numbers of which 0 and 1 stand for those values.
  hbPicture picture(const hbOglRays& deviceRays, const hbGlTarget& found, double zero, double one) const {
    const hbPlaneRays& rays = deviceRays.planes();
    std::vector<float> numbers;
    found.read(numbers);
    switch (scene.mode) {
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
      return rays.iso(surfaces(deviceRays, found, numbers, zero));
    case hbMode::dvr:
    case hbMode::slice:
      break;
    }
    std::vector<glm::vec4> lights(rays.rays().size());
    for (std::size_t i = 0; i < numbers.size(); ++i) lights[i / 4][int(i % 4)] = numbers[i];
    return rays.dvr(lights, *matter);
  }

  std::vector<hbPlaneRays::Surface> surfaces(const hbOglRays& deviceRays, const hbGlTarget& found,
                                             const std::vector<float>& places, double zero) const {
    const hbGlTarget differences(gl, scene.width, scene.height, hbGlFormat::r32f, 4),
        shaded(gl, scene.width, scene.height, hbGlFormat::r32f, 4);
    if (blended)
      blended->differences(deviceRays, found, differences);
    else
      fused->differences(deviceRays, found, differences);
    shader->shade(deviceRays, differences, shaded);
    std::vector<float> values, normals;
    differences.read(values);
    shaded.read(normals);
    std::vector<hbPlaneRays::Surface> list;
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (places[i] >= hbOglRays::kNowhere) continue;
      const float* normal = &normals[4 * i];
      list.push_back(
          {i, double(places[i]), {normal[0], normal[1], normal[2]}, normal[3], float(zero + double(values[4 * i]))});
    }
    return list;
  }
};

hbOglRaycaster::hbOglRaycaster(const hbGlContext& context, const hbSparseGrid& grid, const hbScene& scene,
                               const Options& options)
    : parts_(std::make_unique<Parts>(context, grid, scene, options)) {}

hbOglRaycaster::~hbOglRaycaster() = default;

double hbOglRaycaster::bytes(const hbSparseGrid& grid, const hbScene& scene, const Options& options) {
  const hbIndexSet& set = grid.indexSet();
  // Rays and what was found; surfaces take places, normals and values more, and several lists of them; DVR four numbers
  // where X-ray has one.
  double perPixel = scene.mode == hbMode::iso ? 336.0 : scene.mode == hbMode::dvr ? 288.0 : 144.0;
  // Pieces of a plane that wait for their gradients, with six values each, in lists that may be half empty.
  if (scene.mode == hbMode::dvr && hbLitPieces::areIn(scene) && options.form == Form::blend) perPixel += 416.0;
  // Passes draw into two targets by turns.
  if (options.form != Form::blend) perPixel += scene.mode == hbMode::dvr ? 16.0 : 4.0;
  const double matter = scene.mode == hbMode::dvr ? hbOglMatter::bytes(scene.preintegrated) : 0.0;
  const double pixels = perPixel * scene.width * scene.height + matter;
  if (options.form == Form::seminodal)
    return pixels + hbSemiNodalGrid::bytes(set, grid.components()) + hbSemiNodalGrid::bytes(set, 1);
  const double components = hbCombinationSparseGrid::bytes(set, grid.components());
  if (options.form == Form::fused) return pixels + components + double(sizeof(float)) * double(set.combinationValues());
  double texels = 0.0;
  constexpr std::int64_t kMostTexels = 2048; // any device's; what pieces share is little
  for (const auto& one : set.componentGrids())
    texels += double(hbTextureLayout(one.levels, set.flat(), options.blend.form, kMostTexels).texels());
  return pixels + components + texels * double(sizeof(float) + std::size_t(hb::glFormatBytes(options.blend.textures)));
}

void hbOglRaycaster::look(const hbCamera& camera) {
  camera.validate();
  parts_->scene.camera = camera;
  parts_->classify();
}

hbPicture hbOglRaycaster::render(hbProgress& progress) {
  const hbPlaneRays rays(parts_->grid, parts_->scene);
  if (parts_->fused) return parts_->march(rays, progress);
  return parts_->options.readBack ? parts_->readBack(rays, progress) : parts_->blend(rays, progress);
}

const hbScene& hbOglRaycaster::scene() const { return parts_->scene; }
std::int64_t hbOglRaycaster::textureBytes() const {
  return parts_->blended ? parts_->blended->textureBytes() : parts_->fused->textureBytes();
}
std::int64_t hbOglRaycaster::residentBytes() const {
  return parts_->blended ? parts_->blended->residentBytes() : parts_->fused->textureBytes();
}
