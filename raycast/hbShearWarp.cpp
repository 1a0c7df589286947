#include "raycast/hbShearWarp.h"

#include <algorithm>

#include <fmt/format.h>

#include "raycast/hbPixelWarp.h"
#include "raycast/hbSliceCompositor.h"
#include "sparsegrid/hbSemiNodalGrid.h"
#include "volume/hbError.h"
#include "volume/hbMagnitudeField.h"

struct hbShearWarp::Parts {
  hbScene scene; ///< With its camera.
  std::vector<hbShearFactorisation> factorisations;
  std::unique_ptr<const hbPixelRays> rays;
  using Evaluators = std::vector<hbLatticeEvaluator>;        ///< One a component.
  std::vector<std::shared_ptr<const Evaluators>> evaluators; ///< One list a factorisation; equal orders share it.
  std::shared_ptr<const hbField> points;                     ///< The same function at any point.
  int component = 0;                                         ///< Of `points`.
  hbValueMap map;                                            ///< Of the grid.
  hbSliceCompositor::Memory memory;

  hbSliceCompositor compositor(std::size_t i) {
    const float iso = scene.isoValue ? float(points->valueMap().fromTrue(*scene.isoValue)) : 0.0F;
    return {factorisations[i], {*evaluators[i], scene.magnitude, map}, scene.mode, iso, memory};
  }
  std::int64_t steps() {
    std::int64_t sum = 0;
    for (std::size_t i = 0; i < factorisations.size(); ++i) sum += compositor(i).steps();
    return sum;
  }
};

hbShearWarp::hbShearWarp(const hbSparseGrid& grid, const hbScene& scene, const Options& options)
    : parts_(std::make_unique<Parts>()) {
  hbScene& with = parts_->scene;
  with = scene;
  with.camera = scene.cameraFor(grid.geometry());
  with.validate();
  if (!with.magnitude && (with.component < 0 || with.component >= grid.components()))
    throw hbError(fmt::format("component: expected 0 to {}, found {}", grid.components() - 1, with.component));
  if (with.mode == hbMode::iso && !with.isoValue) throw hbError("iso: expected an iso-value");
  if (with.mode == hbMode::dvr) throw hbError("dvr: expected an engine of the ray caster, found one of slices");
  if (with.mode == hbMode::slice) throw hbError("slice: expected an engine of the ray caster, found one of slices");
  if (options.supersample < 1 || options.supersample > kMostSupersample)
    throw hbError(fmt::format("supersample: expected 1 to {}, found {}", kMostSupersample, options.supersample));

  parts_->rays = std::make_unique<const hbPixelRays>(*with.camera, with.width, with.height, grid.geometry());
  parts_->factorisations = hbShearFactorisation::of(with, grid.geometry(), *parts_->rays, options.supersample);
  for (const hbShearFactorisation& one : parts_->factorisations) {
    const auto same = std::find_if(parts_->factorisations.begin(), parts_->factorisations.end(),
                                   [&](const hbShearFactorisation& other) {
                                     return &other == &one || (other.order() == one.order() && !other.isEmpty());
                                   });
    if (&*same != &one) {
      parts_->evaluators.push_back(parts_->evaluators[std::size_t(same - parts_->factorisations.begin())]);
      continue;
    }
    auto list = std::make_shared<Parts::Evaluators>();
    for (int c = 0; c < grid.components() && !one.isEmpty(); ++c)
      if (with.magnitude || c == with.component) list->emplace_back(grid, c, one.order());
    parts_->evaluators.push_back(std::move(list));
  }
  parts_->map = grid.valueMap();
  parts_->points = std::shared_ptr<const hbField>(std::shared_ptr<const hbField>(), &grid);
  if (with.mode == hbMode::iso && hbSemiNodalGrid::fits(grid.indexSet()))
    parts_->points = std::make_shared<const hbSemiNodalGrid>(grid);
  if (with.magnitude) parts_->points = std::make_shared<const hbMagnitudeField>(parts_->points);
  parts_->component = with.magnitude ? 0 : with.component;
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
