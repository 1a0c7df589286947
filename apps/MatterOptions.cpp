#include "apps/MatterOptions.h"

#include <algorithm>
#include <filesystem>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/Program.h"
#include "scene/hbTransferFunctionFile.h"
#include "volume/hbError.h"

void app::MatterOptions::addTo(CLI::App& subcommand) {
  const auto add = [&](const char* flag, auto& value, const std::string& text) {
    return subcommand.add_option(flag, value, text)->group("Matter (mode dvr)");
  };
  const auto flag = [&](const char* name, auto& value, const char* text) {
    subcommand.add_flag(name, value, text)->group("Matter (mode dvr)");
  };
  add("--transfer", transfer,
      fmt::format("A preset ({}; default density), or a file: ParaView's .json (FILE:NAME for one of several), or "
                  "lines of value, red, green, blue, opacity",
                  fmt::join(hbTransferFunction::presetNames(), ", ")))
      ->type_name("F");
  add("--transfer-range", transferRange, "Stretch the transfer function over these values")->type_name("LO,HI");
  add("--unit-length", unitLength,
      "The world length that opacities are stated for (default: of the function, or a "
      "hundredth of the volume's longest edge)")
      ->check(CLI::PositiveNumber);
  flag("--preintegrate", preintegrate, "Integrate over the slab between two samples beforehand");
  flag("--shade", shade, "Light what the values' gradients make a surface of");
  flag("--no-shade", unlit, "Colours as they are, whatever the scene says");
  add("--shading", shading, "Ambient, diffuse and specular light and the gloss's exponent (default 0.3,0.8,0.2,24)")
      ->type_name("A,D,S,N");
  add("--light", lights, "A light in the world, perhaps coloured; may be repeated (default: where the viewer is)")
      ->type_name("X,Y,Z[,R,G,B]")
      ->take_all();
  add("--gradient-opacity", gradientOpacity,
      "Gradients, in values per world length, up to which nothing is seen and from which on all is")
      ->type_name("LO,HI");
}

void app::MatterOptions::apply(hbScene& scene) const {
  if (preintegrate) scene.preintegrated = true;
  if (!gradientOpacity.empty()) {
    const auto ends = app::parseNumbers(gradientOpacity, 2, 2, "--gradient-opacity");
    scene.gradientOpacity = {ends[0], ends[1]};
  }
  scene.shading = shadingOf(scene.shading);
  scene.transfer = transferFunction(scene.transfer, scene.labels);
}

std::optional<hbShading> app::MatterOptions::shadingOf(std::optional<hbShading> known) const {
  if (unlit) {
    if (shade || !shading.empty() || !lights.empty())
      throw hbError("--no-shade: expected none of --shade, --shading and --light with it");
    return std::nullopt;
  }
  if (!known && (shade || !shading.empty() || !lights.empty())) known.emplace();
  if (!shading.empty()) {
    const auto n = app::parseNumbers(shading, 4, 4, "--shading");
    known->ambient = n[0];
    known->diffuse = n[1];
    known->specular = n[2];
    known->shininess = n[3];
  }
  if (!lights.empty()) known->lights.clear();
  for (const std::string& text : lights) {
    const auto n = app::parseNumbers(text, 3, 6, "--light");
    if (n.size() != 3 && n.size() != 6)
      throw hbError(fmt::format("--light: expected a place and perhaps a colour, 3 or 6 numbers, found {}", n.size()));
    hbShading::Light& light = known->lights.emplace_back();
    light.position = {n[0], n[1], n[2]};
    if (n.size() == 6) light.colour = {n[3], n[4], n[5]};
  }
  return known;
}

std::optional<hbTransferFunction> app::MatterOptions::transferFunction(std::optional<hbTransferFunction> known,
                                                                       bool ofLabels) const {
  if (!transfer.empty()) {
    const auto names = hbTransferFunction::presetNames();
    const std::size_t colon = transfer.rfind(':');
    if (std::find(names.begin(), names.end(), transfer) != names.end())
      known = hbTransferFunction::preset(transfer);
    else if (colon != std::string::npos && !std::filesystem::exists(transfer))
      known = hb::loadTransferFunctions(transfer.substr(0, colon), transfer.substr(colon + 1)).front();
    else if (std::filesystem::exists(transfer))
      known = hb::loadTransferFunctions(transfer).front();
    else
      throw hbError(
          fmt::format("--transfer: expected a file or one of {}, found '{}'", fmt::join(names, ", "), transfer));
  }
  if (ofLabels && !known) { // the values decide
    if (!transferRange.empty()) throw hbError("--transfer-range: expected --transfer, too, for --labels");
    return known;
  }
  if ((!transferRange.empty() || unitLength) && !known) known = hbTransferFunction::preset("density");
  if (!transferRange.empty()) {
    const auto ends = app::parseNumbers(transferRange, 2, 2, "--transfer-range");
    known = known->rescaled(ends[0], ends[1]);
  }
  if (unitLength) known = known->withUnitLength(*unitLength);
  return known;
}
