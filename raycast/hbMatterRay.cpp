#include "raycast/hbMatterRay.h"

#include <cmath>

namespace {

constexpr std::size_t kMostWaiting = 32;

} // namespace

hbMatterRay::hbMatterRay(const hbField& field, const hbScene& scene, const hbMatter& matter)
    : scene_(scene), matter_(matter), isLit_(hbLitPieces::areIn(scene)), pieces_(field, scene, matter) {}

void hbMatterRay::begin(const hbRay& ray, const hbRaySegment& segment) {
  ray_ = ray;
  segment_ = segment;
  light_ = {};
  ahead_ = 1.0;
  pieces_.clear();
}

bool hbMatterRay::addLit(const glm::vec4& piece, double length, double middle) {
  pieces_.add(piece, length, segment_.at(middle), ray_.direction, light_);
  // Where gradients take nothing away, the end of the ray is known without them.
  if (!scene_.gradientOpacity)
    ahead_ *= matter_.isPreintegrated() ? std::pow(1.0 - double(piece.a), length / matter_.step())
                                        : hbEmissionAbsorption::transmission(double(piece.a) * length);
  if (pieces_.waiting() >= kMostWaiting || ahead_ < hbEmissionAbsorption::kOpaque) pieces_.compose();
  return !light_.isOpaque();
}

const hbEmissionAbsorption& hbMatterRay::finish() {
  pieces_.compose();
  return light_;
}
