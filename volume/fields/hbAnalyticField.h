#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "volume/fields/hbDual.h"
#include "volume/fields/hbFieldParameters.h"
#include "volume/fields/hbInterval.h"
#include "volume/hbField.h"

/// A scalar field given by a formula, evaluated in 64 bits wherever it is asked, with its exact gradient.
///
/// The names and their formulas, on [0,1]^3, are listed in doc/fields.md. Its geometry is the unit cube in world space
/// with a nominal size (129 nodes an axis unless the specification has `size=N`), which only says how fine it should be
/// looked at.
class hbAnalyticField final : public hbField {
public:
  /// From "NAME[,parameter=value...]" (what follows "field:" on the command line). Throws hbError for an unknown name
  /// or parameter, or a value out of range, naming those there are.
  static std::shared_ptr<const hbAnalyticField> create(std::string_view specification);

  struct Description {
    std::string name;
    std::string formula;
    hbFieldParameters parameters; ///< With their defaults.
  };
  static std::vector<Description> all();

  /// The name and every parameter's value: create(specification()) gives the same field.
  const std::string& specification() const { return specification_; }

  /// The same field with other nominal sizes.
  std::shared_ptr<const hbAnalyticField> withSize(const hbSize3& size) const;

  double value(const glm::dvec3& p) const { return formula_.value(p); }
  hbDual valueAndGradient(const glm::dvec3& p) const { return formula_.gradient(p); }

  const hbGeometry& geometry() const override { return geometry_; }
  int components() const override { return 1; }
  void values(const hbPoints& points, int component, std::span<float> out) const override;
  /// The formula's own gradient.
  void gradients(const hbPoints& points, int component, std::span<float> out,
                 const hbGradients& gradient) const override;
  void lattice(std::span<const double> xs, std::span<const double> ys, std::span<const double> zs, int component,
               float* out, std::size_t strideY, std::size_t strideZ) const override;
  /// By interval arithmetic: encloses every value, tighter the smaller the box.
  hbRange range(const hbBox& box, int component) const override;

  /// One formula in three arithmetics.
  struct Formula {
    std::function<double(const glm::dvec3&)> value;
    std::function<hbDual(const glm::dvec3&)> gradient;
    std::function<hbInterval(const hbInterval& x, const hbInterval& y, const hbInterval& z)> interval;
  };

private:
  using Parameters = hbFieldParameters;
  hbAnalyticField(std::string name, Parameters parameters);

  double coordinate(int axis, double x) const; ///< Clamped (NaN to 0); the middle of a flat axis.
  glm::dvec3 point(const hbPoints& points, std::size_t i) const;

  std::string name_;
  Parameters parameters_; ///< Every one, `size` included.
  std::string specification_;
  Formula formula_;
  hbGeometry geometry_;
};
