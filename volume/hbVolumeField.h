#pragma once

#include <optional>

#include "volume/hbField.h"
#include "volume/hbVolume.h"

/// The trilinear interpolant of a volume's samples, evaluated from the samples as they are stored (no converted copy),
/// so it also works on a mapped file larger than the memory. This is the `full` engine: the reference of every picture.
class hbVolumeField final : public hbField {
public:
  /// Values are those of `volume` seen through `map` (usually volume.chooseValueMap()). NaN and infinite samples count
  /// as `nonFinite` (a data value) where one is given; otherwise they spread to the cells around them.
  hbVolumeField(hbVolume volume, const hbValueMap& map, std::optional<double> nonFinite = std::nullopt);
  explicit hbVolumeField(const hbVolume& volume) : hbVolumeField(volume, volume.chooseValueMap()) {}

  /// The same with the nearest sample in place of the interpolant, the upper one half-way: for labels, between which
  /// nothing lies. Its gradients are 0.
  hbVolumeField nearest() const {
    hbVolumeField field = *this;
    field.isNearest_ = true;
    return field;
  }

  const hbVolume& volume() const { return volume_; }
  const hbGeometry& geometry() const override { return volume_.geometry(); }
  int components() const override { return volume_.components(); }
  hbValueMap valueMap() const override { return map_; }
  /// By vector instructions, with the same bits, for samples of 32-bit floats and of 8- and 16-bit integers that lie
  /// side by side along x in the machine's byte order, where `nonFinite` is not given.
  void values(const hbPoints& points, int component, std::span<float> out) const override;
  void gradients(const hbPoints& points, int component, std::span<float> out,
                 const hbGradients& gradient) const override;

  /// Coordinates within 2^-30 of a cell from a sample count as that sample, which comes back unrounded.
  void lattice(std::span<const double> xs, std::span<const double> ys, std::span<const double> zs, int component,
               float* out, std::size_t strideY, std::size_t strideZ) const override;

  /// Exact: the least and greatest sample of the cells the box meets. O(samples in the box); NaN samples are left out.
  hbRange range(const hbBox& box, int component) const override;
  bool hasLocalRanges() const override { return true; }

private:
  hbVolume volume_;
  hbValueMap map_;
  double a_ = 1.0, b_ = 0.0; ///< value = a * sample + b
  std::optional<float> nonFinite_;
  bool isNearest_ = false;
};
