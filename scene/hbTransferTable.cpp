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
}

glm::vec4 hbTransferTable::at(float value) const {
  if (std::isnan(value)) return nan_;
  if (value < lo_) return below_;
  if (value > hi_) return above_;
  const double place = (double(value) - lo_) * entriesPerValue_;
  const std::size_t cell = std::min(std::size_t(place), entries_.size() - 2);
  return glm::mix(entries_[cell], entries_[cell + 1], float(place - double(cell)));
}
