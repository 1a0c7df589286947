#pragma once

#include <memory>
#include <vector>

#include "report/hbHardCase.h"
#include "report/hbHardCaseWay.h"

class hbGlContext;

/// How far a value is from the exact one, and how far rounding may have taken it: true values.
struct hbHardCaseError {
  double error = 0.0, bound = 0.0;
};

/// Compares a grid's values or its picture, by any way, with a plain evaluation in 64 bits.
///
/// The exact value is that of the stored 32-bit surpluses: what an engine loses, and no more. What storing them lost is
/// a way of its own.
class hbHardCaseMeasurement {
public:
  /// Keeps a reference to `problem`. `evaluated`: what the engines are given in place of the problem's grid; for those
  /// who want to see a wrong one found out.
  explicit hbHardCaseMeasurement(const hbHardCase::Problem& problem, const hbSparseGrid* evaluated = nullptr);
  virtual ~hbHardCaseMeasurement() = default;
  hbHardCaseMeasurement(const hbHardCaseMeasurement&) = delete;
  hbHardCaseMeasurement& operator=(const hbHardCaseMeasurement&) = delete;

  /// Of patches or of the picture.
  static std::unique_ptr<hbHardCaseMeasurement> of(const hbHardCase::Problem& problem,
                                                   const hbSparseGrid* evaluated = nullptr);

  /// One a point, or a pixel that shows the volume; of X-rays by planes, a pixel: those that meet no plane are to be
  /// empty, and an error there is infinite. `context`: current, for OpenGL alone. Throws hbError as the engines
  /// do.
  virtual std::vector<hbHardCaseError> errors(const hbHardCaseWay& way, const hbGlContext* context) const = 0;

  /// How far the exact values lie apart, of equal ones their magnitude; of an X-ray, the greatest
  /// sum of their magnitudes along a ray.
  virtual double range() const = 0;

  /// What is added up at a point at the most, over the range of the values: of the hierarchical basis and of the
  /// combination technique.
  struct Amplification {
    double hierarchical = 0.0, combination = 0.0;
  };
  virtual Amplification amplification() const = 0;

protected:
  /// Values that differ by rounding in 64 bits only are equal: their magnitude.
  static double rangeOf(double least, double greatest);

  const hbHardCase::Problem& problem_;
  const hbSparseGrid& evaluated_;
};
