#include "volume/hbField.h"

#include <algorithm>
#include <vector>

void hbField::lattice(std::span<const float> xs, std::span<const float> ys, std::span<const float> zs, int component,
                      float* out, std::size_t strideY, std::size_t strideZ) const {
  std::vector<float> y(xs.size()), z(xs.size());
  for (std::size_t k = 0; k < zs.size(); ++k) {
    std::fill(z.begin(), z.end(), zs[k]);
    for (std::size_t j = 0; j < ys.size(); ++j) {
      std::fill(y.begin(), y.end(), ys[j]);
      values({xs, y, z}, component, {out + j * strideY + k * strideZ, xs.size()});
    }
  }
}
