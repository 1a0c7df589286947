#include "volume/hbErrorRecord.h"

#include <fmt/format.h>

#include "volume/hbByteReader.h"
#include "volume/hbByteWriter.h"
#include "volume/hbError.h"

void hbErrorRecord::validate(const std::string& what) const {
  for (std::size_t c = 0; c < components.size(); ++c) {
    const Component& component = components[c];
    if (component.reference > Reference::analyticField)
      throw hbError(
          fmt::format("{}: component {}: expected reference 0, 1 or 2, found {}", what, c, int(component.reference)));
    if (component.kind > Kind::guaranteed)
      throw hbError(fmt::format("{}: component {}: expected kind 0 or 1, found {}", what, c, int(component.kind)));
    if (component.max < 0.0 || component.rmse < 0.0)
      throw hbError(
          fmt::format("{}: component {}: expected errors of at least 0, found a maximum of {} and an RMSE of {}", what,
                      c, component.max, component.rmse));
  }
}

std::vector<std::byte> hbErrorRecord::encode() const {
  validate("error record");
  hbByteWriter out;
  out.u32(std::uint32_t(components.size()));
  out.zeros(4);
  for (const Component& component : components) {
    out.u8(std::uint8_t(component.reference));
    out.u8(std::uint8_t(component.kind));
    out.zeros(6);
    out.u64(component.points);
    out.f64(component.max);
    out.f64(component.rmse);
    out.f64(component.psnr);
  }
  return out.take();
}

hbErrorRecord hbErrorRecord::decode(std::span<const std::byte> bytes, const std::string& what) {
  hbByteReader in(bytes, what);
  hbErrorRecord record;
  const std::uint32_t count = in.u32();
  in.zeros(4);
  for (std::uint32_t c = 0; c < count; ++c) {
    Component component;
    component.reference = Reference(in.u8());
    component.kind = Kind(in.u8());
    in.zeros(6);
    component.points = in.u64();
    component.max = in.f64();
    component.rmse = in.f64();
    component.psnr = in.f64();
    record.components.push_back(component);
  }
  in.finish();
  record.validate(what);
  return record;
}
