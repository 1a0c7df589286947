#pragma once

#include <cstdint>
#include <vector>

#include "volume/hbField.h"

/// A rectilinear lattice cut into parts for hbField::lattice(): each some whole planes across z, or where a plane is
/// large, or planes are few, some rows of one plane. Part after part, x fastest, they make up the lattice. How it is
/// cut depends on its sizes alone.
class hbLatticeParts {
public:
  /// The most samples of a part, unless a row has more: a plane of 1025^2 is one part.
  static constexpr std::int64_t kMostSamples = 3 * (std::int64_t{1} << 19);

  /// Planes z to z + planes, of each the rows y to y + rows.
  struct Part {
    std::int64_t y = 0, rows = 1, z = 0, planes = 1;
  };

  /// Coordinates of the cube, increasing, at least one an axis. At most `mostSamples` a part, or one row.
  hbLatticeParts(std::vector<double> xs, std::vector<double> ys, std::vector<double> zs,
                 std::int64_t mostSamples = kMostSamples);

  hbSize3 size() const { return {std::int64_t(xs_.size()), std::int64_t(ys_.size()), std::int64_t(zs_.size())}; }
  std::int64_t count() const;
  Part part(std::int64_t index) const;
  std::int64_t samples(const Part& part) const { return size().x * part.rows * part.planes; }
  /// How many samples the parts before it have.
  std::int64_t samplesBefore(const Part& part) const { return size().x * (part.z * size().y + part.y); }

  /// out = the part's values, samples(part) of them, x fastest. Thread-safe where the field is.
  void evaluate(const hbField& field, int component, const Part& part, float* out) const;

private:
  std::vector<double> xs_, ys_, zs_;
  std::int64_t rows_ = 1, planes_ = 1; ///< Of a part.
};
