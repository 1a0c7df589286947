#pragma once

#include <cstdint>

namespace hb {

/// 64 bits that look random, always the same ones for the same number; neighbours' are independent. Source: the
/// finaliser of SplitMix64 (Steele, Lea, Flood, Fast splittable pseudorandom number generators, 2014).
constexpr std::uint64_t mixedBits(std::uint64_t number) {
  std::uint64_t bits = number + 0x9E3779B97F4A7C15U;
  bits = (bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9U;
  bits = (bits ^ (bits >> 27)) * 0x94D049BB133111EBU;
  return bits ^ (bits >> 31);
}

} // namespace hb
