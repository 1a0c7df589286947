#include "volume/hbField.h"

#include <algorithm>
#include <vector>

void hbField::lattice(std::span<const double> xs, std::span<const double> ys, std::span<const double> zs, int component,
                      float* out, std::size_t strideY, std::size_t strideZ) const {
  const std::vector<float> x(xs.begin(), xs.end());
  std::vector<float> y(xs.size()), z(xs.size());
  for (std::size_t k = 0; k < zs.size(); ++k) {
    std::fill(z.begin(), z.end(), float(zs[k]));
    for (std::size_t j = 0; j < ys.size(); ++j) {
      std::fill(y.begin(), y.end(), float(ys[j]));
      values({x, y, z}, component, {out + j * strideY + k * strideZ, xs.size()});
    }
  }
}
