#include "volume/hbGeometry.h"

#include <cmath>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "volume/hbError.h"

glm::dvec3 hbGeometry::extent() const {
  glm::dvec3 edges;
  for (int d = 0; d < 3; ++d) edges[d] = isFlat(d) ? spacing[d] : spacing[d] * double(size[d] - 1);
  return edges;
}

glm::dmat4 hbGeometry::cubeToWorld() const {
  const glm::dvec3 edges = extent();
  glm::dvec3 corner = origin;
  for (int d = 0; d < 3; ++d)
    if (isFlat(d)) corner -= 0.5 * spacing[d] * direction[d];
  return {glm::dvec4(direction[0] * edges[0], 0.0), glm::dvec4(direction[1] * edges[1], 0.0),
          glm::dvec4(direction[2] * edges[2], 0.0), glm::dvec4(corner, 1.0)};
}

glm::dvec3 hbGeometry::cubeSpacing() const {
  glm::dvec3 step;
  for (int d = 0; d < 3; ++d) step[d] = isFlat(d) ? 1.0 : 1.0 / double(size[d] - 1);
  return step;
}

std::vector<double> hbGeometry::cubeCoordinates(int axis) const {
  if (isFlat(axis)) return {0.5};
  std::vector<double> coordinates;
  for (std::int64_t i = 0; i < size[axis]; ++i) coordinates.push_back(double(i) / double(size[axis] - 1));
  return coordinates;
}

void hbGeometry::validate(const std::string& what) const {
  // Far beyond any unit's use, and small enough that cubeToWorld() can be inverted: no product of three edges and the
  // origin leaves the range of 64-bit floats.
  constexpr double kMaxLength = 1e80;
  constexpr std::int64_t kMaxSamples = std::int64_t{1} << 60;
  std::int64_t product = 1;
  for (int d = 0; d < 3; ++d) {
    if (size[d] < 1)
      throw hbError(fmt::format("{}: expected at least one node along {}, found {}", what, "xyz"[d], size[d]));
    if (size[d] >= kMaxSamples / product)
      throw hbError(
          fmt::format("{}: expected fewer than 2^60 samples, found {} x {} x {}", what, size.x, size.y, size.z));
    product *= size[d];
    if (!(spacing[d] >= 1.0 / kMaxLength && spacing[d] <= kMaxLength))
      throw hbError(fmt::format("{}: expected a positive spacing along {}, from {:g} to {:g}, found {}", what, "xyz"[d],
                                1.0 / kMaxLength, kMaxLength, spacing[d]));
    if (!(std::abs(origin[d]) <= kMaxLength))
      throw hbError(fmt::format("{}: expected a finite origin, within {:g}, found {}", what, kMaxLength, origin[d]));
    if (!(std::abs(glm::length(direction[d]) - 1.0) < 1e-3))
      throw hbError(fmt::format("{}: expected a unit direction of axis {}, found length {}", what, "xyz"[d],
                                glm::length(direction[d])));
  }
  if (!(std::abs(glm::determinant(direction)) > 1e-6))
    throw hbError(fmt::format("{}: expected three independent directions, found determinant {}", what,
                              glm::determinant(direction)));
}
