#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include "fitting/hbFitSamples.h"
#include "sparsegrid/hbSparseGrid.h"
#include "volume/hbVolumeField.h"

/// A volume and a sparse grid that interpolates it, as the tests of fits share them.
struct hbFitCase {
  std::vector<float> values; ///< Of the samples, x fastest.
  hbGeometry geometry;
  hbIndexSet set;
  hbLatticeMapping mapping;

  /// The regular set of that level, on axes as fine as the samples.
  hbFitCase(std::vector<float> samples, const hbSize3& size, int level, hbLatticeMapping map = hbLatticeMapping::fitted)
      : hbFitCase(std::move(samples), size, hbIndexSet::regular(level, hbIndexSet::axesOf(size)), map) {}
  hbFitCase(std::vector<float> samples, const hbSize3& size, hbIndexSet indices,
            hbLatticeMapping map = hbLatticeMapping::fitted)
      : values(std::move(samples)), set(std::move(indices)), mapping(map) {
    geometry.size = size;
    update();
  }

  /// Independent and uniform in [0,1): no grid can follow them.
  static hbFitCase noise(const hbSize3& size, int level, hbLatticeMapping map = hbLatticeMapping::fitted) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(0.0F, 1.0F);
    std::vector<float> samples(std::size_t(size.x * size.y * size.z));
    for (float& s : samples) s = unit(random);
    return {std::move(samples), size, level, map};
  }

  /// A smooth bump and a ramp, between -1 and 3.
  static std::vector<float> smoothSamples(const hbSize3& size) {
    std::vector<float> samples;
    const auto at = [](std::int64_t i, std::int64_t n) { return n > 1 ? double(i) / double(n - 1) : 0.5; };
    for (std::int64_t k = 0; k < size.z; ++k)
      for (std::int64_t j = 0; j < size.y; ++j)
        for (std::int64_t i = 0; i < size.x; ++i) {
          const double x = at(i, size.x), y = at(j, size.y), z = at(k, size.z);
          samples.push_back(float(std::sin(3.0 * x + 1.0) * std::cos(2.0 * y) * std::exp(-z) + x + y * z));
        }
    return samples;
  }
  static hbFitCase smooth(const hbSize3& size, int level, hbLatticeMapping map = hbLatticeMapping::fitted) {
    return {smoothSamples(size), size, level, map};
  }

  /// The same with one sample in ten anywhere between -1 and 3.
  static hbFitCase withOutliers(const hbSize3& size, int level) {
    std::vector<float> samples = smoothSamples(size);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(0.0F, 1.0F);
    for (float& s : samples)
      if (unit(random) < 0.1F) s = 4.0F * unit(random) - 1.0F;
    return {std::move(samples), size, level};
  }

  void setSample(std::size_t i, float value) {
    values[i] = value;
    update();
  }

  const hbVolumeField& field() const { return *field_; }
  /// The grid that interpolates the samples (of those that are finite).
  hbSparseGrid interpolated() const { return hbSparseGrid::interpolate(*field_, set, mapping); }
  hbFitSamples samples() const { return {*field_, frameGrid(), 0}; }

private:
  void update() { field_ = std::make_shared<hbVolumeField>(hbVolume::fromSamples(geometry, values)); }
  /// Of zeros.
  hbSparseGrid frameGrid() const {
    return hbSparseGrid::fromSurpluses({geometry, {}, mapping}, set,
                                       {std::vector<float>(std::size_t(set.storedValues()))});
  }

  std::shared_ptr<const hbVolumeField> field_;
};
