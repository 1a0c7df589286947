#include "raycast/hbMatterRay.h"

#include <cmath>

#include <glm/geometric.hpp>

namespace {

constexpr std::size_t kMostWaiting = 32;

} // namespace

hbMatterRay::hbMatterRay(const hbField& field, const hbScene& scene, const hbMatter& matter)
    : scene_(scene), matter_(matter), differences_(field, scene.component),
      isLit_(scene.shading || scene.gradientOpacity), cubeToWorld_(field.geometry().cubeToWorld()) {}

void hbMatterRay::begin(const hbRay& ray, const hbRaySegment& segment) {
  ray_ = ray;
  segment_ = segment;
  light_ = {};
  ahead_ = 1.0;
  waiting_.clear();
  places_.clear();
}

bool hbMatterRay::addLit(const glm::vec4& piece, double length, double middle) {
  waiting_.push_back({piece, length});
  places_.push_back(segment_.at(middle));
  // Where gradients take nothing away, the end of the ray is known without them.
  if (!scene_.gradientOpacity)
    ahead_ *= matter_.isPreintegrated() ? std::pow(1.0 - double(piece.a), length / matter_.step())
                                        : std::exp(-double(piece.a) * length);
  if (waiting_.size() >= kMostWaiting || ahead_ < hbEmissionAbsorption::kOpaque) composeLit();
  return !light_.isOpaque();
}

const hbEmissionAbsorption& hbMatterRay::finish() {
  composeLit();
  return light_;
}

void hbMatterRay::composeLit() {
  if (waiting_.empty()) return;
  const std::vector<glm::dvec3>& gradients = differences_.at(places_);
  for (std::size_t i = 0; i < waiting_.size() && !light_.isOpaque(); ++i) {
    const glm::dvec3& gradient = gradients[i];
    Piece piece = waiting_[i];
    if (scene_.gradientOpacity) piece.length *= matter_.shownBy(glm::length(gradient));
    const glm::dvec3 place(cubeToWorld_ * glm::dvec4(places_[i], 1.0));
    compose(piece,
            scene_.shading ? scene_.shading->reflection(place, ray_.direction, gradient) : hbShading::Reflection{});
  }
  waiting_.clear();
  places_.clear();
}
