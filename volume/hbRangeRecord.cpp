#include "volume/hbRangeRecord.h"

#include <cmath>

#include <fmt/format.h>

#include "volume/hbByteReader.h"
#include "volume/hbByteWriter.h"
#include "volume/hbError.h"

void hbRangeRecord::validate(const std::string& what) const {
  for (std::size_t c = 0; c < components.size(); ++c) {
    const auto& [lo, hi] = components[c];
    if (!(lo <= hi) && !(std::isnan(lo) && std::isnan(hi)))
      throw hbError(fmt::format("{}: component {}: expected a least value not above the greatest, found {} and {}",
                                what, c, lo, hi));
  }
}

std::vector<std::byte> hbRangeRecord::encode() const {
  validate("range record");
  hbByteWriter out;
  out.u32(std::uint32_t(components.size()));
  out.zeros(4);
  for (const auto& [lo, hi] : components) {
    out.f64(lo);
    out.f64(hi);
  }
  return out.take();
}

hbRangeRecord hbRangeRecord::decode(std::span<const std::byte> bytes, const std::string& what) {
  hbByteReader in(bytes, what);
  hbRangeRecord record;
  const std::uint32_t count = in.u32();
  in.zeros(4);
  for (std::uint32_t c = 0; c < count; ++c) {
    const double lo = in.f64();
    record.components.push_back({lo, in.f64()});
  }
  in.finish();
  record.validate(what);
  return record;
}
