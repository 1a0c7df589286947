#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "scene/hbScene.h"
#include "sparsegrid/hbSparseGrid.h"

/// A sparse grid that is hard to evaluate in 32 bits, and where it is looked at: single values or one picture.
struct hbHardCase {
  /// Points of the cube where values are compared: first + i * step along each axis, multiples of 2^-24, which 32-bit
  /// floats hold.
  struct Patch {
    glm::ivec3 count{1};
    glm::dvec3 first{0.5}, step{0.0};

    std::size_t points() const { return std::size_t(count.x) * std::size_t(count.y) * std::size_t(count.z); }
    /// The coordinates along an axis.
    std::vector<double> along(int axis) const;
  };

  struct Problem {
    hbSparseGrid grid;
    /// What storing took from the surpluses: their values in 64 bits less the stored ones.
    hbSparseGrid lost;
    std::vector<Patch> patches;   ///< Empty where there is a picture.
    std::optional<hbScene> scene; ///< X-ray or iso-surface, planewise, with its camera.
  };

  std::string name; ///< A word or some with hyphens.
  std::string why;  ///< One line.
  std::function<Problem()> make;
};

namespace hb {

/// All of them, each made within a second.
const std::vector<hbHardCase>& hardCases();

} // namespace hb
