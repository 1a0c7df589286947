#pragma once

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
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

  /// Of one that was composited in 32 bits, with seen += (1 - seen.a) o (c, 1) for each opacity o of a piece's depth.
  double inFloats(std::size_t pixel) const {
    const hbPlaneRays::Ray& ray = rays_.rays()[pixel];
    // An error of seen.a is passed on by 1 - o, so that what it does to the light of all pieces behind is not more than
    // it is: of each sum and each 1 - seen.a, which are rounded by 2^-25 at most, in all four channels. The sum of what
    // pieces add is not more than 1; of their depths times what comes through, neither: so relative errors of depths
    // and opacities do as much in the picture. They are: of the product and the opacity 2 and 8, of the colour 3, of
    // the extinction 5 (entries, interpolation, product with the length).
    const double samples = std::max(1, ray.last - ray.first + 1);
    if (!matter_.isPreintegrated()) return (2.0 * samples + 18.0) * 0x1p-24 + inLength();
    // A slab more than there are samples; interpolated twice (6 roundings), which counts twice in the depth of
    // opacities up to 1/2; the depth (8) and its product with the length; the quotient of light and opacity (5).
    return (2.0 * (samples + 1.0) + 10.0 + 6.0 + 12.0 + 9.0 + 5.0) * 0x1p-24 + inLength();
  }

  /// As much more where rays that became this opaque, up to `tolerance`, may have ended a sample earlier or later.
  static double ends(double opacity, double other, double tolerance) {
    const double end = 1.0 - hbEmissionAbsorption::kOpaque;
    return std::min(std::abs(opacity - end), std::abs(other - end)) <= tolerance ? hbEmissionAbsorption::kOpaque : 0.0;
  }

private:
  /// Relatively, of lengths between planes: of a vector, affine over the picture, whose three terms together are at
  /// most five times as long as the longest and rounded 6 times, and which is not shorter than 1; squared and rooted.
  double inLength() const {
    const hbScene& scene = rays_.scene();
    double longest = 1.0;
    for (const double x : {0.0, double(scene.width)})
      for (const double y : {0.0, double(scene.height)}) {
        const glm::dvec3 way = scene.camera->ray(x, y, scene.width, scene.height).direction;
        longest = std::max(longest, 1.0 / glm::dot(way, scene.camera->viewAxis()));
      }
    return (30.0 * longest + 4.0) * 0x1p-24;
  }

  static double difference(const glm::vec4& a, const glm::vec4& b) {
    const glm::vec4 d = glm::abs(a - b);
    return std::max(std::max(d.r, d.g), std::max(d.b, d.a));
  }

  const hbPlaneRays& rays_;
  hbMatter matter_;
  double colour_ = 0.0, extinction_ = 0.0; ///< Greatest slopes over the value, of samples.
  double steepest_ = 0.0;                  ///< Of slabs, over either value.
};
