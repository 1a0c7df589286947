#include "apps/OpenGlOptions.h"

#include <algorithm>
#include <array>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "volume/hbError.h"

namespace {

constexpr std::array kFormats{hbGlFormat::r8, hbGlFormat::r16, hbGlFormat::r16f, hbGlFormat::r32f};

hbGlFormat formatOf(const std::string& name) {
  return *std::find_if(kFormats.begin(), kFormats.end(), [&](hbGlFormat f) { return hb::glFormatName(f) == name; });
}

} // namespace

void app::OpenGlOptions::addTo(CLI::App& subcommand) {
  const auto take = [&](CLI::Option* option, bool isOfBlending) {
    option->group("OpenGL");
    all_.push_back(option);
    if (isOfBlending) blending_.push_back(option);
  };
  const auto choose = [&](const char* flag, std::string& value, const std::vector<std::string>& names, const char* text,
                          bool isOfBlending = true) {
    CLI::Option* option = subcommand.add_option(flag, value, text)->check(CLI::IsMember(names));
    if (!value.empty()) option->capture_default_str();
    take(option, isOfBlending);
  };
  const std::vector<std::string> formats{"r8", "r16", "r16f", "r32f"};
  choose("--gl", context, {"auto", "osmesa", "egl"}, "osmesa: software; egl: a graphics processor where there is one",
         false);
  choose("--gl-form", form, {"blend", "fused", "seminodal"},
         "blend: textures over each other, plane by plane; fused: one shader for all component grids; seminodal: the "
         "same for lines along x",
         false);
  choose("--gl-textures", textures, formats, "Blend: how textures keep values");
  choose("--gl-target", target, formats, "Blend: how sums are kept");
  choose("--gl-layout", layout, {"exact", "padded"}, "Blend: textures of 2^l+1 texels, or padded to powers of two");
  choose("--gl-order", order, {"positive-first", "interleaved"},
         "Blend: the order of terms (default: interleaved in float targets)");
  choose("--gl-filter", filter, {"hardware", "exact"}, "Blend: who interpolates, the device or the shader in 32 bits");
  take(subcommand.add_flag("--gl-read-back", readBack, "Blend: read every plane back and composite it in software"),
       true);
  take(subcommand.add_option("--texture-memory", textureMemory, "Limit of texture memory, as in 16MB (powers of 1024)")
           ->transform(CLI::AsSizeValue(false))
           ->check(CLI::PositiveNumber),
       false);
  take(subcommand.add_flag("--stream", stream, "Blend: hand textures over again where they do not fit"), true);
}

std::string app::OpenGlOptions::firstGiven(const std::vector<CLI::Option*>& options) const {
  const auto given = std::find_if(options.begin(), options.end(), [](const CLI::Option* o) { return o->count() > 0; });
  return given == options.end() ? std::string() : (*given)->get_name();
}

hbOglRaycaster::Options app::OpenGlOptions::raycaster(bool isOpenGl) const {
  if (const std::string option = firstGiven(all_); !isOpenGl && !option.empty())
    throw hbError(fmt::format("{}: expected --engine opengl with it", option));
  if (const std::string option = firstGiven(blending_); form != "blend" && !option.empty())
    throw hbError(fmt::format("{}: expected --gl-form blend with it, found {}", option, form));
  hbOglRaycaster::Options options;
  options.form = form == "blend"   ? hbOglRaycaster::Form::blend
                 : form == "fused" ? hbOglRaycaster::Form::fused
                                   : hbOglRaycaster::Form::seminodal;
  options.readBack = readBack;
  if (textureMemory > 0) options.memory = std::int64_t(std::min<std::uint64_t>(textureMemory, INT64_MAX));
  options.blend.textures = formatOf(textures);
  options.blend.target = formatOf(target);
  options.blend.form = layout == "padded" ? hbTextureLayout::Form::padded : hbTextureLayout::Form::exact;
  using Order = hbOglSparseGrid::Order;
  if (!order.empty()) options.blend.order = order == "interleaved" ? Order::interleaved : Order::positiveFirst;
  if (filter == "exact") options.blend.filter = hbOglSparseGrid::Filter::exact;
  options.blend.stream = stream;
  return options;
}

hbGlContext::Kind app::OpenGlOptions::kind() const {
  return context == "osmesa" ? hbGlContext::Kind::osmesa
         : context == "egl"  ? hbGlContext::Kind::egl
                             : hbGlContext::Kind::automatic;
}
