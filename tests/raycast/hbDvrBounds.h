#pragma once

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <gtest/gtest.h>

#include "raycast/hbPlaneRays.h"

/// How far the channels of a planewise DVR picture move with the values along its rays. For transfer functions that
/// have no steps, and in pre-integrated scenes slabs that let half of what is behind them through at the least.
class hbDvrBounds {
public:
  explicit hbDvrBounds(const hbPlaneRays& rays)
      : rays_(rays), matter_(rays.scene(), rays.field().valueMap(), rays.step()) {
    const auto [lo, hi] = rays.scene().transfer->range();
    if (matter_.isPreintegrated()) {
      const std::vector<glm::vec4>& entries = matter_.slabs().entries();
      const std::size_t n = matter_.slabs().size();
      const double cell = (hi - lo) / double(n - 3);
      float most = 0.0F;
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j + 1 < n; ++j) {
          steepest_ = std::max({steepest_, difference(entries[i * n + j], entries[i * n + j + 1]) / cell,
                                difference(entries[j * n + i], entries[(j + 1) * n + i]) / cell});
          most = std::max(most, entries[i * n + j].a);
        }
      EXPECT_LE(most, 0.5F);
    } else {
      const std::vector<glm::vec4>& entries = matter_.table().entries();
      const double cell = (hi - lo) / double(entries.size() - 1);
      for (std::size_t i = 0; i + 1 < entries.size(); ++i) {
        colour_ = std::max(
            colour_,
            difference(glm::vec4(glm::vec3(entries[i]), 0.0F), glm::vec4(glm::vec3(entries[i + 1]), 0.0F)) / cell);
        extinction_ = std::max(extinction_, std::abs(double(entries[i + 1].a) - double(entries[i].a)) / cell);
      }
    }
  }

  const hbMatter& matter() const { return matter_; }

  /// Of a channel of this pixel, where values are off by `perValue`.
  double channel(std::size_t pixel, double perValue) const {
    const hbPlaneRays::Ray& ray = rays_.rays()[pixel];
    const double middles = std::max(0, ray.last - ray.first), step = rays_.step() / ray.cosine;
    const double length = ray.before + ray.behind + middles * step;
    // Of sum T_i a_i c_i, by a colour: the shift times sum T_i a_i <= 1; by the depth of one piece: at most what it is
    // shifted by, as it changes the piece's own light for that behind it, none of which is more than 1.
    if (!matter_.isPreintegrated()) return perValue * (colour_ + extinction_ * length);
    // A slab's opacity a <= 1/2 and its light move with both values. t times as thick, its opacity is
    // g = 1 - (1 - a)^t with g' <= 2 max(t, 1), and its light g / a <= max(t, 1) times as much, where a (g / a)' =
    // g' - g / a is between -g / a and g'. So its own light moves by 1 + 2 of that, and what is behind it by 2.
    const double thickest = std::max(1.0, step / rays_.step());
    return perValue * 2.0 * steepest_ * (middles + 2.0) * thickest * (1.0 + 2.0 + 2.0);
  }

  /// As much more where a ray may end a sample earlier or later: what is behind that.
  static double ends(double opacity) {
    return opacity > 1.0 - 2.0 * hbEmissionAbsorption::kOpaque ? hbEmissionAbsorption::kOpaque : 0.0;
  }

private:
  static double difference(const glm::vec4& a, const glm::vec4& b) {
    const glm::vec4 d = glm::abs(a - b);
    return std::max(std::max(d.r, d.g), std::max(d.b, d.a));
  }

  const hbPlaneRays& rays_;
  hbMatter matter_;
  double colour_ = 0.0, extinction_ = 0.0; ///< Greatest slopes over the value, of samples.
  double steepest_ = 0.0;                  ///< Of slabs, over either value.
};
