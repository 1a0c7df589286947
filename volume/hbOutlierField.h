#pragma once

#include <memory>
#include <vector>

#include "volume/hbField.h"

/// A field some of whose samples are spoiled: to see what a fit or a compressor makes of bad data.
///
/// A given share of the samples, spread irregularly, have a value that is uniformly distributed over the field's
/// range() (of its component: of plain volumes the exact one, of others a bound) instead of their own. Points belong to
/// the nearest sample. Always the same ones.
class hbOutlierField final : public hbField {
public:
  /// 0 <= share <= 1. Asks `source` for its range once.
  hbOutlierField(std::shared_ptr<const hbField> source, double share);

  const hbGeometry& geometry() const override { return source_->geometry(); }
  int components() const override { return source_->components(); }
  hbValueMap valueMap() const override { return source_->valueMap(); }
  void values(const hbPoints& points, int component, std::span<float> out) const override;
  /// 0 where a value is spoiled.
  void gradients(const hbPoints& points, int component, std::span<float> out,
                 const hbGradients& gradient) const override;
  void lattice(std::span<const double> xs, std::span<const double> ys, std::span<const double> zs, int component,
               float* out, std::size_t strideY, std::size_t strideZ) const override;
  hbRange range(const hbBox&, int component) const override { return ranges_[std::size_t(component)]; }

private:
  std::int64_t nearest(double x, int axis) const;
  /// Replaces the value where that sample is spoiled, and says whether it is.
  bool spoil(std::int64_t x, std::int64_t y, std::int64_t z, int component, float& value) const;

  std::shared_ptr<const hbField> source_;
  double share_;
  std::vector<hbRange> ranges_;
};
