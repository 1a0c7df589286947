#include "fitting/hbLeastSquares.h"

#include <algorithm>
#include <cmath>

double hbLeastSquares::smoothingWeight(const glm::ivec3& levels) {
  if (levels == glm::ivec3(0)) return 0.0;
  double weight = 1.0;
  for (int d = 0; d < 3; ++d)
    if (levels[d] > 0) weight *= std::ldexp(1.0, levels[d] + 1);
  return weight;
}

int hbLeastSquares::undeterminedAxis() const {
  for (int d = 0; d < 3; ++d) {
    if (set.flat()[d]) continue;
    const std::span<const double> coordinates = samples.coordinates(d);
    const double cells = std::ldexp(1.0, set.finest()[d]);
    auto sample = coordinates.begin();
    for (double node = 0.0; node <= cells; ++node, ++sample) {
      sample = std::find_if(sample, coordinates.end(), [&](double x) { return x * cells > node - 1.0; });
      if (sample == coordinates.end() || *sample * cells >= node + 1.0) return d;
    }
  }
  return -1;
}
