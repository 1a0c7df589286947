#include "report/hbHardCaseMeasurement.h"

#include <algorithm>
#include <cmath>

#include "report/hbHardCasePicture.h"
#include "report/hbHardCaseValues.h"

hbHardCaseMeasurement::hbHardCaseMeasurement(const hbHardCase::Problem& problem, const hbSparseGrid* evaluated)
    : problem_(problem), evaluated_(evaluated ? *evaluated : problem.grid) {}

std::unique_ptr<hbHardCaseMeasurement> hbHardCaseMeasurement::of(const hbHardCase::Problem& problem,
                                                                 const hbSparseGrid* evaluated) {
  if (problem.scene) return std::make_unique<hbHardCasePicture>(problem, evaluated);
  return std::make_unique<hbHardCaseValues>(problem, evaluated);
}

double hbHardCaseMeasurement::rangeOf(double least, double greatest) {
  const double magnitude = std::max(std::abs(least), std::abs(greatest));
  return greatest - least > 0x1p-40 * magnitude ? greatest - least : magnitude;
}
