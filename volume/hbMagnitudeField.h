#pragma once

#include <memory>

#include "volume/hbField.h"

/// The Euclidean length of a field's components: how vector data are looked at as a scalar. Values are true data
/// values.
class hbMagnitudeField final : public hbField {
public:
  explicit hbMagnitudeField(std::shared_ptr<const hbField> vector) : vector_(std::move(vector)) {}

  const hbGeometry& geometry() const override { return vector_->geometry(); }
  int components() const override { return 1; }
  /// O(components) evaluations of the vector field.
  void values(const hbPoints& points, int component, std::span<float> out) const override;
  /// sum_i v_i grad v_i / |v|; zero where the vector is.
  void gradients(const hbPoints& points, int component, std::span<float> out,
                 const hbGradients& gradient) const override;
  hbRange range(const hbBox& box, int component) const override;

private:
  std::shared_ptr<const hbField> vector_;
};
