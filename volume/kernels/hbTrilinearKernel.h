#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "volume/hbField.h"
#include "volume/hbSampleType.h"

/// Samples between which hb::evaluateTrilinear() interpolates: of a type hb::hasTrilinearKernel(), in the machine's
/// byte order, neighbours along x side by side, at any address.
struct hbTrilinearSamples {
  const std::byte* first = nullptr;
  hbSampleType type = hbSampleType::float32;
  hbSize3 size{1};                       ///< At least two along x.
  std::int64_t strideY = 0, strideZ = 0; ///< Bytes.
  double a = 1.0, b = 0.0;               ///< A value is a * sample + b, rounded once to 32 bits.
};

namespace hb {

/// 32-bit floats, and integers of 8 and 16 bits.
bool hasTrilinearKernel(hbSampleType type);

/// The trilinear interpolant, at coordinates as hbField has them: with every instruction set the bits that
/// hbVolumeField computes point by point. No byte is read but those of the samples around a point.
void evaluateTrilinear(const hbTrilinearSamples& samples, const hbPoints& points, std::span<float> out);

} // namespace hb
