#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace hb {

/// An order to add the terms of a combination in, as indices into `coefficients`: at each step the coefficient that
/// leaves their partial sum nearest to [0,1], terms of equal coefficients as they come. With all positive terms first
/// the sum grows to that of their coefficients, and 32 bits lose as much of the result.
///
/// Where the whole sum is in [0,1], as a combination's is, partial sums stay within the greatest magnitude of a
/// coefficient. O(terms x distinct coefficients).
std::vector<std::size_t> interleaved(std::span<const int> coefficients);

} // namespace hb
