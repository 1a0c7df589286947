#pragma once

#include <memory>
#include <string>
#include <vector>

#include "report/hbHardCase.h"
#include "report/hbHardCaseWay.h"
#include "volume/hbProgress.h"

class hbGlContext;
struct hbHardCaseError;

/// What one way made of a hard case. Errors are in true values; of iso-surfaces, of the values along rays.
struct hbHardCaseResult {
  enum class Status : std::uint8_t {
    done,
    refused, ///< The engine cannot take the grid, and says so in `note`.
    failed   ///< Something else went wrong: see `note`.
  };
  hbHardCaseWay way;
  Status status = Status::done;
  double error = 0.0, bound = 0.0; ///< The greatest of each; infinite where one is NaN.
  /// The greatest error of a point or pixel in parts of its own bound; infinite where an error is NaN or a bound no
  /// finite number.
  double share = 0.0;
  bool stable = false;      ///< See kStable.
  bool saysNothing = false; ///< The bound is the values' range or more: no error of a usable value could exceed it.
  std::string note;

  /// A way is stable where it loses no more than 4 of a float's 24 bits of the values' range.
  static constexpr double kStable = 0x1p-20;
  /// Beyond its bound, whatever that says.
  bool exceedsBound() const { return status == Status::done && !(share <= 1.0); }
  /// Within a bound that says something.
  bool isWithinBound() const { return status == Status::done && !saysNothing && share <= 1.0; }

  /// Of errors at all points or pixels, of values with that range.
  static hbHardCaseResult of(const hbHardCaseWay& way, const std::vector<hbHardCaseError>& errors, double range);
};

/// A hard case and what all ways made of it.
struct hbHardCaseResults {
  std::string name, why;
  double coefficients = 0.0; ///< Sum of the combination's coefficients' magnitudes.
  double range = 0.0;        ///< How far exact values lie apart.
  /// What is added up at a point at the most, in parts of the range: of the hierarchical basis and of the combination.
  double hierarchicalTerms = 0.0, combinationTerms = 0.0;
  std::vector<hbHardCaseResult> results; ///< In the order of hbHardCaseWay::all().

  /// The way that evaluates with the least error; none: all were refused.
  const hbHardCaseResult* mostStable() const;
  /// Why, in one line.
  std::string reason() const;
};

namespace hb {

/// One case, by one way. `context`: current, for OpenGL alone; none: that is refused. Throws hbCancelled.
hbHardCaseResult measureHardCase(const hbHardCase::Problem& problem, const hbHardCaseWay& way,
                                 const hbGlContext* context);

} // namespace hb

/// Cases by all ways. OpenGL is OSMesa or EGL, whichever there is, or refused; its context is current in this thread as
/// long as this lives.
class hbHardCaseRun {
public:
  hbHardCaseRun();
  ~hbHardCaseRun();
  hbHardCaseRun(const hbHardCaseRun&) = delete;
  hbHardCaseRun& operator=(const hbHardCaseRun&) = delete;

  /// One case, in a second or so. A way that throws is a result; where the case cannot be made, all of them failed.
  /// Advances `progress` by one a way. Throws hbCancelled.
  hbHardCaseResults of(const hbHardCase& one, hbProgress& progress = hbProgress::none()) const;

private:
  class Device;
  void measure(const hbHardCase& one, hbHardCaseResults& results, hbProgress& progress) const;

  std::unique_ptr<Device> device_;
};
