#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "volume/hbVolume.h"

/// Pseudo-random samples from 0 to 168, the same for the same seed.
inline hbVolume volumeOf(const hbSize3& size, unsigned seed, int components = 1) {
  hbGeometry g;
  g.size = size;
  std::vector<float> samples(std::size_t(g.samples() * components));
  std::uint32_t state = seed;
  for (float& sample : samples) sample = float((state = state * 1664525U + 1013904223U) >> 8U) / 1e5F;
  return hbVolume::fromSamples(g, std::move(samples), components);
}
