#include "raycast/hbEngine.h"

#include <array>

#include <fmt/format.h>

#include "volume/hbError.h"

namespace {
constexpr std::array<std::string_view, 7> kNames{"auto",        "full",    "direct", "seminodal",
                                                 "combination", "lattice", "opengl"};
}

std::string_view hb::engineName(hbEngine engine) { return kNames[std::size_t(engine)]; }

hbEngine hb::engineFromName(std::string_view name) {
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (kNames[i] == name) return hbEngine(i);
  throw hbError(
      fmt::format("engine: expected auto, full, direct, seminodal, combination, lattice or opengl, found '{}'", name));
}
