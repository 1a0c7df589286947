#include "raycast/hbShearWarp.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "raycast/hbMatter.h"
#include "raycast/hbPixelWarp.h"
#include "raycast/hbSceneCheck.h"
#include "raycast/hbSliceCompositor.h"
#include "raycast/hbSliceLight.h"
#include "sparsegrid/hbSemiNodalGrid.h"
#include "volume/hbError.h"
#include "volume/hbMagnitudeField.h"

struct hbShearWarp::Parts {
  const hbSparseGrid& grid;
  int supersample;
  hbScene scene; ///< With its camera.
  std::vector<hbShearFactorisation> factorisations;
  std::unique_ptr<const hbPixelRays> rays;
  using Evaluators = std::vector<hbLatticeEvaluator>;        ///< One a component.
  std::vector<std::shared_ptr<const Evaluators>> evaluators; ///< One list a factorisation; equal orders share it.
  std::vector<std::pair<hbAxisOrder, std::shared_ptr<const Evaluators>>> known; ///< Of this and earlier cameras.
  std::shared_ptr<const hbField> points;                                        ///< The same function at any point.
  int component = 0;                                                            ///< Of `points`.
  hbValueMap map;                                                               ///< Of the grid.
  std::optional<hbMatter> matter;                                               ///< The mode dvr's, for its step.
  std::optional<hbVisibility> visibility;
  hbSliceCompositor::Memory memory;
  hbSliceLight::Memory memoryOfLight;

  Parts(const hbSparseGrid& ofGrid, int raysAPixel, const hbScene& ofScene)
      : grid(ofGrid), supersample(raysAPixel), scene(ofScene) {}

  hbSliceSampler::Source source(std::size_t i) const { return {*evaluators[i], scene.magnitude, map}; }
  hbSliceCompositor compositor(std::size_t i) {
    const float iso = scene.isoValue ? float(points->valueMap().fromTrue(*scene.isoValue)) : 0.0F;
    return {factorisations[i], source(i), scene.mode, iso, memory};
  }
  hbSliceLight light(std::size_t i) {
    return {factorisations[i], source(i), *matter, *visibility, points->geometry(), scene, memoryOfLight};
  }
  std::shared_ptr<const Evaluators> evaluatorsOf(const hbShearFactorisation& one) {
    if (one.isEmpty()) return std::make_shared<const Evaluators>();
    const auto same =
        std::find_if(known.begin(), known.end(), [&](const auto& other) { return other.first == one.order(); });
    if (same != known.end()) return same->second;
    auto list = std::make_shared<Evaluators>();
    for (int c = 0; c < grid.components(); ++c)
      if (scene.magnitude || c == scene.component) list->emplace_back(grid, c, one.order());
    return known.emplace_back(one.order(), std::move(list)).second;
  }
  /// For the scene's camera.
  void place() {
    rays = std::make_unique<const hbPixelRays>(*scene.camera, scene.width, scene.height, grid.geometry(),
                                               scene.clip.value_or(hbScene::ClipBox{}));
    factorisations = hbShearFactorisation::of(scene, grid.geometry(), *rays, supersample);
    evaluators.clear();
    for (const hbShearFactorisation& one : factorisations) evaluators.push_back(evaluatorsOf(one));
    if (scene.mode != hbMode::dvr) return;
    const double step = scene.sampling.stepLength(grid.geometry(), *scene.camera);
    if (matter && (!matter->isPreintegrated() || matter->step() == step)) return;
    matter.emplace(scene, points->valueMap(), step);
    visibility.emplace(*scene.transfer, *matter);
  }
  std::int64_t steps() {
    std::int64_t sum = 0;
    for (std::size_t i = 0; i < factorisations.size(); ++i) sum += matter ? light(i).steps() : compositor(i).steps();
    return sum;
  }
  /// What slices of one factorisation take, in bytes.
  double bytes(std::size_t i) { return matter ? light(i).bytes() + matter->bytes() : compositor(i).bytes(); }
};

hbShearWarp::hbShearWarp(const hbSparseGrid& grid, const hbScene& scene, const Options& options)
    : parts_(std::make_unique<Parts>(grid, options.supersample, scene)) {
  hbScene& with = parts_->scene;
  with.camera = scene.cameraFor(grid.geometry());
  hbScene ofComponent = with;
  if (with.magnitude) ofComponent.component = 0;
  hb::checkScene(ofComponent, grid);
  if (with.mode == hbMode::slice) throw hbError("slice: expected an engine of the ray caster, found one of slices");
  if (options.supersample < 1 || options.supersample > kMostSupersample)
    throw hbError(fmt::format("supersample: expected 1 to {}, found {}", kMostSupersample, options.supersample));

  parts_->map = grid.valueMap();
  parts_->points = std::shared_ptr<const hbField>(std::shared_ptr<const hbField>(), &grid);
  if (with.mode == hbMode::iso && hbSemiNodalGrid::fits(grid.indexSet()))
    parts_->points = std::make_shared<const hbSemiNodalGrid>(grid);
  if (with.magnitude) parts_->points = std::make_shared<const hbMagnitudeField>(parts_->points);
  parts_->component = with.magnitude ? 0 : with.component;
  parts_->place();
}

void hbShearWarp::look(const hbCamera& camera) {
  camera.validate();
  parts_->scene.camera = camera;
  parts_->place();
}

hbShearWarp::~hbShearWarp() = default;

const hbScene& hbShearWarp::scene() const { return parts_->scene; }

std::vector<int> hbShearWarp::slices() const {
  std::vector<int> list;
  for (const hbShearFactorisation& one : parts_->factorisations)
    if (!one.isEmpty()) list.push_back(one.slices());
  return list;
}

double hbShearWarp::bytes() const {
  double bytes = 0.0;
  for (std::size_t i = 0; i < parts_->factorisations.size(); ++i)
    bytes = std::max(bytes, parts_->bytes(i) + hbPixelWarp::bytes(parts_->factorisations[i], scene().mode));
  return bytes;
}

hbPicture hbShearWarp::render(hbProgress& progress) const {
  const hbScene& scene = parts_->scene;
  hbPicture picture;
  picture.width = scene.width;
  picture.height = scene.height;
  picture.metadata[hbPicture::kSceneKey] = hb::toJson(scene);
  progress.begin("compositing slices", parts_->steps(), "slices");
  hbPixelWarp warp(*parts_->rays, scene, *parts_->points, parts_->component, picture);
  for (std::size_t i = 0; i < parts_->factorisations.size(); ++i) {
    const hbShearFactorisation& rays = parts_->factorisations[i];
    if (scene.mode == hbMode::dvr)
      warp.light(rays, parts_->light(i).run(progress), *parts_->matter);
    else if (scene.mode == hbMode::iso)
      warp.surface(rays, parts_->compositor(i).run(progress));
    else
      warp.values(rays, parts_->compositor(i).run(progress));
  }
  return picture;
}
