#pragma once

#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "volume/hbGeometry.h"

/// A transfer function: colour and opacity over the value of a volume. Immutable: a change makes another one.
///
/// This is the reference, in 64 bits; hbTransferTable is the fast form of it, hbOpacityRange its greatest opacities.
/// Colours and opacities mean what they mean in VTK and ParaView (vtkColorTransferFunction, vtkPiecewiseFunction),
/// whose colour maps are read and written by hbTransferFunctionFile.
class hbTransferFunction {
public:
  /// Where colours are interpolated between points. `rgb` is coded sRGB, `hsv` of the same, `lab` CIE L*a*b* (D65),
  /// `diverging` Moreland's (hb::mixMsh); `step` has the colour of the piece's upper end.
  enum class ColorSpace { rgb, hsv, lab, diverging, step };

  struct ColorPoint {
    double value = 0.0;
    glm::dvec3 rgb{0.0}; ///< Coded sRGB, each channel in [0,1].
    bool operator==(const ColorPoint&) const = default;
  };

  /// An opacity and the shape of the piece from here to the next point.
  struct OpacityPoint {
    double value = 0.0;
    double opacity = 0.0; ///< Of one unit length, in [0,1].
    /// Where in the piece, as a fraction in [0,1], half of the way between both opacities is done.
    double midpoint = 0.5;
    /// In [0,1]: 0 is linear on both sides of the midpoint, 1 nearly a step there.
    double sharpness = 0.0;
    bool operator==(const OpacityPoint&) const = default;
  };

  /// What opacity is beyond the first and last of its points: theirs, or 0.
  enum class Outside { clamp, zero };

  /// What it is made of. Values of points never fall; equal ones make a step.
  struct Definition {
    std::string name = {};
    ColorSpace colorSpace = ColorSpace::rgb;
    bool hsvWrap = false;                      ///< In `hsv`, hue goes the short way round, across red where that is it.
    std::vector<ColorPoint> colors = {};       ///< At least one.
    std::vector<OpacityPoint> opacities = {};  ///< None: a ramp from 0 to 1 over the colours, as in ParaView.
    std::optional<glm::dvec3> belowColor = {}; ///< Coded sRGB below the first colour's value; none: that colour.
    std::optional<glm::dvec3> aboveColor = {}; ///< Coded sRGB above the last colour's value; none: that colour.
    glm::dvec3 nanColor{0.5, 0.0, 0.0};        ///< Coded sRGB; VTK's default.
    double nanOpacity = 0.0;                   ///< Holes in the data are not seen.
    Outside outside = Outside::clamp;
    std::optional<double> unitLength = {}; ///< The world length that opacities are stated for, 1e-80 to 1e80.
    bool relative = false;                 ///< Its values are places in the data's range; to be rescaled() to that.
    bool operator==(const Definition&) const = default;
  };

  static constexpr std::size_t kMaxPoints = 4096;    ///< Of either kind. A file of so many has less than 1 MB.
  static constexpr std::size_t kMaxNameLength = 256; ///< Bytes.
  /// Of one unit length: -ln(1 - a) for the greatest number a < 1 in 64 bits, so that no opacity but 1 is changed by
  /// it.
  static constexpr double kMaxOpticalDepth = 53.0 * std::numbers::ln2;

  /// Throws hbError beginning with `what` and the name of the member (as in ParaView's files) that is outside its
  /// range: points not increasing, not within the range of 32-bit floats, all at one value, too many, and so on.
  explicit hbTransferFunction(Definition definition, const std::string& what = "transfer function");

  /// With `opacities` filled in.
  const Definition& definition() const { return definition_; }
  const std::string& name() const { return definition_.name; }

  /// The least and greatest value of a point, first < second.
  std::pair<double, double> range() const;

  /// The colour in linear light, channels in [0,1]. O(log points). At a step it is the colour below. What leaves sRGB
  /// on the way between two points is divided by its greatest channel and cut off at 0, as in VTK.
  glm::dvec3 colour(double value) const;

  /// The opacity of one unit length in [0,1]. O(log points). At a step it is the opacity above.
  double opacity(double value) const;

  /// The opacity of one unit length as an optical depth: -ln(1 - opacity), at most kMaxOpticalDepth. A length d lets
  /// through exp(-opticalDepth d / unitLength), which is (1 - opacity)^(d / unitLength).
  double opticalDepth(double value) const;

  /// The extinction coefficient in 1 / world length: opticalDepth(value) / unitLength. Throws hbError where no unit
  /// length is stated.
  double extinction(double value) const;

  /// The opacity at a value between those of two neighbouring points, first.value <= value <= second.value. It never
  /// turns back on the way.
  static double opacityBetween(const OpacityPoint& first, const OpacityPoint& second, double value);

  /// The same function over another range: points keep their places relative to each other. Not `relative` any more.
  /// Throws hbError unless lo < hi, both finite and in the range of 32-bit floats.
  hbTransferFunction rescaled(double lo, double hi) const;

  /// The same function with opacities stated for another length.
  hbTransferFunction withUnitLength(double length) const;

  /// What opacities are stated for in this volume where nobody says so: a hundredth of the longest edge of its box. It
  /// does not depend on the number of samples, so a picture does not change with resolution.
  static double defaultUnitLength(const hbGeometry& geometry);

  /// A colour of its own for each label, a whole number from `least` to `greatest`, and for what is less than a half
  /// away from it; 0 is not seen. Throws hbError for more than kMaxPoints / 2 labels, or none.
  static hbTransferFunction ofLabels(std::int64_t least, std::int64_t greatest);

  /// One of presetNames(); throws hbError listing them for another one. doc/transfer-functions.md describes them.
  static hbTransferFunction preset(std::string_view name);
  static std::span<const std::string_view> presetNames();

  bool operator==(const hbTransferFunction& other) const { return definition_ == other.definition_; }

private:
  Definition definition_;
  std::vector<glm::dvec3> inSpace_; ///< The colours in the space in which they are interpolated.
};
