#pragma once

#include <cstdint>

/// One pixel of a render target with fixed-point numbers, as OpenGL blends it: what a combination in such a target
/// comes to, without OpenGL.
///
/// Numbers lie in [0,1] in steps of 1 / (2^bits - 1). What is drawn is clamped to them and rounded to the nearest step,
/// blended, and the result clamped (below 0, too). Source: OpenGL 3.3, 2.1.5 and 4.1.7; the
/// sparse-grid paper, section 6 and Fig. 9.
class hbFixedPointTarget {
public:
  /// 1 to 24 bits. Begins with 0.
  explicit hbFixedPointTarget(int bits) : most_((std::int64_t{1} << bits) - 1) {}

  /// GL_FUNC_ADD with factors ONE: adds `source`.
  void add(double source);
  /// GL_FUNC_REVERSE_SUBTRACT: subtracts `source`.
  void reverseSubtract(double source);

  double value() const { return double(steps_) / double(most_); }
  /// Half a step: how far rounding moves a number in [0,1].
  double halfStep() const { return 0.5 / double(most_); }

private:
  std::int64_t quantised(double value) const;

  std::int64_t most_;
  std::int64_t steps_ = 0;
};

namespace hb {

/// The value that stands for 0 in textures of fixed-point numbers, whose least value is `least`, so that a combination
/// whose coefficients sum to `whole` and whose values are not below `least` is not below 0 in a target, where 0 stands
/// for `whole` times it. `least` where they sum to 1, less otherwise; where the sum is not positive there is none, and
/// it is `least`.
double fixedPointLow(double least, double whole);

} // namespace hb
