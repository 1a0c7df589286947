#include "raycast/hbShearWarp.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "raycast/hbPixelWarp.h"
#include "raycast/hbSliceCompositor.h"
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
  hbSliceCompositor::Memory memory;

  hbSliceCompositor compositor(std::size_t i) {
    const float iso = scene.isoValue ? float(points->valueMap().fromTrue(*scene.isoValue)) : 0.0F;
    return {factorisations[i], {*evaluators[i], scene.magnitude, map}, scene.mode, iso, memory};
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
    rays = std::make_unique<const hbPixelRays>(*scene.camera, scene.width, scene.height, grid.geometry());
    factorisations = hbShearFactorisation::of(scene, grid.geometry(), *rays, supersample);
    evaluators.clear();
    for (const hbShearFactorisation& one : factorisations) evaluators.push_back(evaluatorsOf(one));
  }
  std::int64_t steps() {
    std::int64_t sum = 0;
    for (std::size_t i = 0; i < factorisations.size(); ++i) sum += compositor(i).steps();
    return sum;
  }
};

hbShearWarp::hbShearWarp(const hbSparseGrid& grid, const hbScene& scene, const Options& options)
    : parts_(new Parts{grid, options.supersample, scene}) {
  hbScene& with = parts_->scene;
  with.camera = scene.cameraFor(grid.geometry());
  with.validate();
  if (!with.magnitude && (with.component < 0 || with.component >= grid.components()))
    throw hbError(fmt::format("component: expected 0 to {}, found {}", grid.components() - 1, with.component));
  if (with.mode == hbMode::iso && !with.isoValue) throw hbError("iso: expected an iso-value");
  if (with.mode == hbMode::dvr) throw hbError("dvr: expected an engine of the ray caster, found one of slices");
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
    bytes =
        std::max(bytes, parts_->compositor(i).bytes() + hbPixelWarp::bytes(parts_->factorisations[i], scene().mode));
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
    const std::vector<double> image = parts_->compositor(i).run(progress);
    if (scene.mode == hbMode::iso)
      warp.surface(rays, image);
    else
      warp.values(rays, image);
  }
  return picture;
}
