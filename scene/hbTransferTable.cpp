#include "scene/hbTransferTable.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "volume/hbError.h"

hbTransferTable::hbTransferTable(const hbTransferFunction& function, std::size_t entries) {
  if (entries < 2 || entries > kMaxEntries)
    throw hbError(fmt::format("transfer table: expected 2 to {} entries, found {}", kMaxEntries, entries));
  const auto entry = [&](double value) {
    return glm::vec4(glm::dvec4(function.colour(value), function.extinction(value)));
  };
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  below_ = entry(-kInfinity);
  above_ = entry(kInfinity);
  nan_ = entry(std::numeric_limits<double>::quiet_NaN());
  std::tie(lo_, hi_) = function.range();
  const double last = double(entries - 1);
  entriesPerValue_ = last / (hi_ - lo_);
  entries_.reserve(entries);
  for (std::size_t i = 0; i < entries; ++i) {
    const double t = double(i) / last;
    entries_.push_back(entry((1.0 - t) * lo_ + t * hi_));
  }
  // The last entries before what is seen; a cell is left out for the rounding of places.
  const auto seen = [](const glm::vec4& e) { return e.a != 0.0F; };
  const auto first = std::find_if(entries_.begin(), entries_.end(), seen) - entries_.begin();
  const auto end = entries_.rend() - std::find_if(entries_.rbegin(), entries_.rend(), seen);
  clearBelow_ = seen(below_) ? -kInfinity : lo_ + double(first - 2) / entriesPerValue_;
  clearAbove_ = seen(above_) ? kInfinity : lo_ + double(end + 1) / entriesPerValue_;
}
