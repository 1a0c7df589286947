#include "scene/hbShading.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "volume/hbError.h"

namespace {

glm::dvec3 unit(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0.0 ? v / length : v;
}

/// Of a base from 0 on. Whole exponents take a few products, others many times as long.
double power(double base, double exponent) {
  if (exponent != std::floor(exponent)) return std::pow(base, exponent);
  double result = 1.0;
  for (auto left = unsigned(exponent); left > 0; left /= 2, base *= base)
    if (left % 2 == 1) result *= base;
  return result;
}

} // namespace

hbShading::Reflection hbShading::reflection(const glm::dvec3& place, const glm::dvec3& ray,
                                            const glm::dvec3& gradient) const {
  const double greatest = std::max({std::abs(gradient.x), std::abs(gradient.y), std::abs(gradient.z)});
  // Squares of what is scaled do not go under or over.
  glm::dvec3 normal = greatest > 0.0 ? unit(gradient / greatest) : glm::dvec3(0.0);
  if (glm::dot(normal, ray) > 0.0) normal = -normal;
  Reflection sum{glm::dvec3(ambient), glm::dvec3(0.0)};
  const auto shine = [&](const glm::dvec3& towards, const glm::dvec3& colour) {
    if (!(greatest > 0.0)) {
      sum.matter += diffuse * colour;
      return;
    }
    const double cosine = glm::dot(normal, towards);
    if (!(cosine > 0.0)) return;
    sum.matter += diffuse * cosine * colour;
    sum.gloss += specular * power(std::max(0.0, glm::dot(normal, unit(towards - ray))), shininess) * colour;
  };
  if (lights.empty()) shine(-ray, glm::dvec3(1.0));
  for (const Light& light : lights) shine(unit(light.position - place), light.colour);
  return sum;
}

void hbShading::validate(const std::string& what) const {
  const auto within = [&](const char* name, double value, double most) {
    if (!(value >= 0.0 && value <= most))
      throw hbError(fmt::format("{}: {}: expected 0 to {}, found {}", what, name, most, value));
  };
  within("ambient", ambient, kMostLight);
  within("diffuse", diffuse, kMostLight);
  within("specular", specular, kMostLight);
  within("shininess", shininess, kMostShininess);
  if (lights.size() > kMostLights)
    throw hbError(fmt::format("{}: lights: expected at most {}, found {}", what, kMostLights, lights.size()));
  for (const Light& light : lights)
    for (int d = 0; d < 3; ++d) {
      within("lights: color", light.colour[d], kMostLight);
      if (!std::isfinite(light.position[d]))
        throw hbError(fmt::format("{}: lights: position: expected finite numbers, found {}", what, light.position[d]));
    }
}
