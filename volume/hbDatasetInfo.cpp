#include "volume/hbDatasetInfo.h"

#include <cmath>

#include <fmt/format.h>

#include "volume/hbByteReader.h"
#include "volume/hbByteWriter.h"
#include "volume/hbError.h"

void hbDatasetInfo::validate(const std::string& what) const {
  geometry.validate(what);
  if (geometry.centring > hbGeometry::Centring::cell)
    throw hbError(fmt::format("{}: expected centring 0 or 1, found {}", what, int(geometry.centring)));
  if (sampleType < hbSampleType::int8 || sampleType > hbSampleType::float64)
    throw hbError(fmt::format("{}: expected a sample type from 1 to 8, found {}", what, int(sampleType)));
  if (mapping > hbLatticeMapping::aligned)
    throw hbError(fmt::format("{}: expected lattice mapping 0 or 1, found {}", what, int(mapping)));
  if (!std::isfinite(slope) || slope == 0.0 || !std::isfinite(intercept))
    throw hbError(fmt::format("{}: expected a finite slope other than 0 and a finite intercept, found {} and {}", what,
                              slope, intercept));
  if (!std::isfinite(valueMap.offset) || !std::isfinite(valueMap.scale) || !(valueMap.scale > 0.0))
    throw hbError(fmt::format("{}: expected a finite offset and a positive, finite scale, found {} and {}", what,
                              valueMap.offset, valueMap.scale));
  if (componentNames.empty() || componentNames.size() > kMaxComponents)
    throw hbError(
        fmt::format("{}: expected 1 to {} components, found {}", what, kMaxComponents, componentNames.size()));
  if (geometry.space.size() > kMaxNameBytes)
    throw hbError(fmt::format("{}: expected a name of the space of at most {} bytes, found {}", what, kMaxNameBytes,
                              geometry.space.size()));
  for (const std::string& name : componentNames)
    if (name.size() > kMaxNameBytes)
      throw hbError(
          fmt::format("{}: expected component names of at most {} bytes, found {}", what, kMaxNameBytes, name.size()));
}

std::vector<std::byte> hbDatasetInfo::encode() const {
  validate("dataset");
  hbByteWriter out;
  for (int d = 0; d < 3; ++d) out.i64(geometry.size[d]);
  for (int d = 0; d < 3; ++d) out.f64(geometry.origin[d]);
  for (int d = 0; d < 3; ++d) out.f64(geometry.spacing[d]);
  for (int axis = 0; axis < 3; ++axis)
    for (int d = 0; d < 3; ++d) out.f64(geometry.direction[axis][d]);
  out.f64(slope);
  out.f64(intercept);
  out.f64(valueMap.offset);
  out.f64(valueMap.scale);
  out.u8(std::uint8_t(geometry.centring));
  out.u8(std::uint8_t(sampleType));
  out.u8(std::uint8_t(mapping));
  out.zeros(1);
  out.u32(std::uint32_t(componentNames.size()));
  out.string(geometry.space);
  for (const std::string& name : componentNames) out.string(name);
  return out.take();
}

hbDatasetInfo hbDatasetInfo::decode(std::span<const std::byte> bytes, const std::string& what) {
  hbByteReader in(bytes, what);
  hbDatasetInfo info;
  for (int d = 0; d < 3; ++d) info.geometry.size[d] = in.i64();
  for (int d = 0; d < 3; ++d) info.geometry.origin[d] = in.f64();
  for (int d = 0; d < 3; ++d) info.geometry.spacing[d] = in.f64();
  for (int axis = 0; axis < 3; ++axis)
    for (int d = 0; d < 3; ++d) info.geometry.direction[axis][d] = in.f64();
  info.slope = in.f64();
  info.intercept = in.f64();
  info.valueMap.offset = in.f64();
  info.valueMap.scale = in.f64();
  info.geometry.centring = hbGeometry::Centring(in.u8());
  info.sampleType = hbSampleType(in.u8());
  info.mapping = hbLatticeMapping(in.u8());
  in.zeros(1);
  const std::uint32_t components = in.u32();
  info.geometry.space = in.string(kMaxNameBytes);
  info.componentNames.clear();
  // A name takes at least four bytes, so a wrong count ends at the end of the bytes, not of the memory.
  for (std::uint32_t c = 0; c < components; ++c) info.componentNames.push_back(in.string(kMaxNameBytes));
  in.finish();
  info.validate(what);
  return info;
}
