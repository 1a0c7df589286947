#include "report/hbHardCaseWay.h"

#include <array>
#include <string_view>

namespace {
constexpr std::array<std::string_view, 8> kNames{"stored",  "direct",       "seminodal",    "combination",
                                                 "lattice", "opengl-blend", "opengl-fused", "opengl"};
}

std::string hbHardCaseWay::name() const { return std::string(kNames[std::size_t(engine)]); }

std::string hbHardCaseWay::formatName() const {
  return engine == Engine::blend ? std::string(hb::glFormatName(format)) : std::string();
}

std::string hbHardCaseWay::label() const { return engine == Engine::blend ? name() + "-" + formatName() : name(); }

std::vector<hbHardCaseWay> hbHardCaseWay::all() {
  using enum Engine;
  std::vector<hbHardCaseWay> list;
  for (const Engine engine : {stored, direct, seminodal, combination, lattice}) list.push_back({engine});
  for (const hbGlFormat format : {hbGlFormat::r32f, hbGlFormat::r16f, hbGlFormat::r16, hbGlFormat::r8})
    list.push_back({blend, format});
  for (const Engine engine : {fused, oglSeminodal}) list.push_back({engine});
  return list;
}
