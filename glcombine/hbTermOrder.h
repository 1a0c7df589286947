#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace hb {

/// An order to add the terms of a combination in, as indices into `coefficients`: at each step the coefficient that
/// leaves their partial sum nearest to what lies between 0 and the whole sum, terms of equal coefficients as they come.
/// With all positive terms first the sum grows to that of their coefficients, and 32 bits lose as much of the result.
///
/// Partial sums stay within the greatest magnitude of a coefficient of that; where the whole sum is 1 and coefficients
/// are integers, as those of a combination that interpolates, within that magnitude. O(terms x distinct coefficients).
std::vector<std::size_t> interleaved(std::span<const double> coefficients);

} // namespace hb
