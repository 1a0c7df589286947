#include "volume/hbOutlierField.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "volume/hbMixedBits.h"

hbOutlierField::hbOutlierField(std::shared_ptr<const hbField> source, double share)
    : source_(std::move(source)), share_(share) {
  assert(share >= 0.0 && share <= 1.0);
  for (int c = 0; c < source_->components(); ++c) ranges_.push_back(source_->range({}, c));
}

std::int64_t hbOutlierField::nearest(double x, int axis) const {
  const double last = double(geometry().size[axis] - 1);
  return x > 0.0 ? std::int64_t(std::min(x, 1.0) * last + 0.5) : 0;
}

bool hbOutlierField::spoil(std::int64_t x, std::int64_t y, std::int64_t z, int component, float& value) const {
  const hbSize3& size = geometry().size;
  // Two independent numbers in [0,1) a sample and component.
  const auto number = std::uint64_t(((component * size.z + z) * size.y + y) * size.x + x);
  const auto unit = [&](std::uint64_t which) { return double(hb::mixedBits(~(2 * number + which)) >> 11) * 0x1p-53; };
  if (unit(0) >= share_) return false;
  const hbRange& range = ranges_[std::size_t(component)];
  value = float(double(range.lo) + unit(1) * (double(range.hi) - double(range.lo)));
  return true;
}

void hbOutlierField::values(const hbPoints& points, int component, std::span<float> out) const {
  source_->values(points, component, out);
  for (std::size_t i = 0; i < out.size(); ++i)
    spoil(nearest(double(points.x[i]), 0), nearest(double(points.y[i]), 1), nearest(double(points.z[i]), 2), component,
          out[i]);
}

void hbOutlierField::gradients(const hbPoints& points, int component, std::span<float> out,
                               const hbGradients& gradient) const {
  source_->gradients(points, component, out, gradient);
  for (std::size_t i = 0; i < out.size(); ++i)
    if (spoil(nearest(double(points.x[i]), 0), nearest(double(points.y[i]), 1), nearest(double(points.z[i]), 2),
              component, out[i]))
      gradient.dx[i] = gradient.dy[i] = gradient.dz[i] = 0.0F;
}

void hbOutlierField::lattice(std::span<const double> xs, std::span<const double> ys, std::span<const double> zs,
                             int component, float* out, std::size_t strideY, std::size_t strideZ) const {
  source_->lattice(xs, ys, zs, component, out, strideY, strideZ);
  for (std::size_t k = 0; k < zs.size(); ++k)
    for (std::size_t j = 0; j < ys.size(); ++j)
      for (std::size_t i = 0; i < xs.size(); ++i)
        spoil(nearest(xs[i], 0), nearest(ys[j], 1), nearest(zs[k], 2), component, out[i + j * strideY + k * strideZ]);
}
