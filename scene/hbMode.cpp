#include "scene/hbMode.h"

#include <array>
#include <utility>

#include <fmt/format.h>

#include "volume/hbError.h"

namespace {
constexpr std::array<std::pair<std::string_view, hbMode>, 5> kModes{{{"xray", hbMode::xray},
                                                                     {"mip", hbMode::mip},
                                                                     {"iso", hbMode::iso},
                                                                     {"dvr", hbMode::dvr},
                                                                     {"slice", hbMode::slice}}};
}

std::string_view hb::modeName(hbMode mode) { return kModes[std::size_t(mode)].first; }

hbMode hb::modeFromName(std::string_view name) {
  for (const auto& [known, mode] : kModes)
    if (known == name) return mode;
  throw hbError(fmt::format("mode: expected xray, mip, iso, dvr or slice, found '{}'", name));
}
