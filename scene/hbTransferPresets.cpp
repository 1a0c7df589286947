// The presets of hbTransferFunction. Those for CT are over Hounsfield units and state opacities for 1 mm, world lengths
// being millimetres there; the others are relative.

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scene/hbColorSpace.h"
#include "scene/hbColormap.h"
#include "scene/hbTransferFunction.h"
#include "volume/hbError.h"

namespace {

using Definition = hbTransferFunction::Definition;
using ColorSpace = hbTransferFunction::ColorSpace;

// From spongy bone (150 HU) on: marrow dark, cortex ivory, metal white.
Definition ctBone() {
  return {.colorSpace = ColorSpace::lab,
          .colors = {{150, {0.48, 0.22, 0.13}},
                     {350, {0.80, 0.58, 0.38}},
                     {700, {0.95, 0.87, 0.72}},
                     {1500, {0.99, 0.97, 0.91}},
                     {3000, {1.0, 1.0, 1.0}}},
          .opacities = {{150, 0.0}, {300, 0.04}, {500, 0.25}, {900, 0.60}, {1500, 0.90}, {3000, 1.0}},
          .unitLength = 1.0};
}

// The border of air and skin, at which rays end within a few millimetres; bone shows where skin is cut away.
Definition ctSkin() {
  return {.colorSpace = ColorSpace::lab,
          .colors = {{-600, {0.62, 0.40, 0.31}},
                     {-200, {0.86, 0.66, 0.54}},
                     {0, {0.93, 0.76, 0.64}},
                     {80, {0.72, 0.30, 0.24}},
                     {300, {0.93, 0.85, 0.70}},
                     {1500, {1.0, 0.98, 0.92}}},
          .opacities = {{-600, 0.0}, {-400, 0.10}, {-200, 0.45}, {0, 0.70}, {300, 0.85}, {1500, 1.0}},
          .unitLength = 1.0};
}

// Blood with contrast medium (200 to 450 HU) solid, bone behind it thinner.
Definition ctVessels() {
  return {.colorSpace = ColorSpace::lab,
          .colors = {{130, {0.40, 0.02, 0.03}},
                     {250, {0.80, 0.10, 0.08}},
                     {400, {0.98, 0.45, 0.25}},
                     {600, {0.94, 0.86, 0.72}},
                     {1500, {1.0, 0.99, 0.95}}},
          .opacities = {{130, 0.0}, {180, 0.05}, {280, 0.45}, {420, 0.60}, {600, 0.15}, {1000, 0.30}, {1500, 0.60}},
          .unitLength = 1.0};
}

// Tissue full of air as a haze, vessels and walls in it bright; the body around, from -150 HU on, is not seen.
Definition ctLungs() {
  return {.colorSpace = ColorSpace::lab,
          .colors = {{-980, {0.16, 0.22, 0.38}},
                     {-800, {0.38, 0.52, 0.68}},
                     {-600, {0.78, 0.72, 0.72}},
                     {-350, {0.96, 0.62, 0.50}},
                     {-150, {0.99, 0.86, 0.74}}},
          .opacities = {{-980, 0.0}, {-900, 0.004}, {-750, 0.012}, {-550, 0.06}, {-350, 0.25}, {-150, 0.0}},
          .unitLength = 1.0};
}

// Noise below a tenth hidden, then ever denser, from fat's and muscle's browns to white matter's ivory.
Definition mriHead() {
  return {.colorSpace = ColorSpace::lab,
          .colors = {{0.0, {0.10, 0.07, 0.08}},
                     {0.25, {0.45, 0.28, 0.24}},
                     {0.5, {0.78, 0.60, 0.52}},
                     {0.75, {0.92, 0.84, 0.74}},
                     {1.0, {1.0, 0.99, 0.95}}},
          .opacities = {{0.0, 0.0}, {0.10, 0.0}, {0.22, 0.10}, {0.45, 0.20}, {0.75, 0.45}, {1.0, 0.70}},
          .relative = true};
}

// Both extremes, blue and red; what lies in the middle of the range is not seen.
Definition simulation() {
  const hbColormap map("coolwarm");
  return {.colorSpace = ColorSpace::diverging,
          .colors = {{0.0, map.rgb(0.0)}, {1.0, map.rgb(1.0)}},
          .opacities = {{0.0, 0.45}, {0.25, 0.08}, {0.45, 0.0}, {0.55, 0.0}, {0.75, 0.08}, {1.0, 0.45}},
          .relative = true};
}

// Brighter is more, from deep water to ivory; the hue turns steadily with it.
Definition density() {
  return {.colorSpace = ColorSpace::lab,
          .colors = {{0.0, {0.09, 0.12, 0.32}},
                     {0.25, {0.12, 0.36, 0.55}},
                     {0.5, {0.20, 0.62, 0.65}},
                     {0.75, {0.70, 0.84, 0.68}},
                     {1.0, {1.0, 0.97, 0.86}}},
          .opacities = {{0.0, 0.0}, {0.05, 0.0}, {1.0, 0.5}},
          .relative = true};
}

// Smoke, embers, flames.
Definition fire() {
  return {.colorSpace = ColorSpace::lab,
          .colors = {{0.0, {0.10, 0.08, 0.09}},
                     {0.25, {0.36, 0.06, 0.04}},
                     {0.5, {0.86, 0.24, 0.04}},
                     {0.75, {1.0, 0.66, 0.14}},
                     {1.0, {1.0, 0.97, 0.84}}},
          .opacities = {{0.0, 0.0}, {0.10, 0.0}, {0.30, 0.04}, {0.60, 0.15}, {1.0, 0.60}},
          .relative = true};
}

// Parallel to each other.
constexpr std::array<std::string_view, 8> kNames{"ct-bone",  "ct-skin",    "ct-vessels", "ct-lungs",
                                                 "mri-head", "simulation", "density",    "fire"};
constexpr std::array kPresets{ctBone, ctSkin, ctVessels, ctLungs, mriHead, simulation, density, fire};
static_assert(kNames.size() == kPresets.size());

} // namespace

hbTransferFunction hbTransferFunction::preset(std::string_view name) {
  const auto at = std::find(kNames.begin(), kNames.end(), name);
  if (at == kNames.end())
    throw hbError(fmt::format("transfer function: expected one of {}, found '{}'", fmt::join(kNames, ", "), name));
  Definition d = kPresets[std::size_t(at - kNames.begin())]();
  d.name = name;
  return hbTransferFunction(std::move(d));
}

std::span<const std::string_view> hbTransferFunction::presetNames() { return kNames; }

// Hues a golden angle apart, so that neighbours differ, in three turns of saturation and brightness.
hbTransferFunction hbTransferFunction::ofLabels(std::int64_t least, std::int64_t greatest) {
  if (least > greatest || greatest - least >= std::int64_t(kMaxPoints / 2))
    throw hbError(fmt::format("labels: expected 1 to {} from the least to the greatest, found {} to {}", kMaxPoints / 2,
                              least, greatest));
  constexpr double kGolden = 0.61803398874989485;
  constexpr std::array kSaturations{0.55, 0.85, 0.35}, kBrightnesses{0.95, 0.80, 1.0};
  constexpr double kOpacity = 0.6;
  Definition d{.name = "labels", .colorSpace = ColorSpace::step};
  for (std::int64_t label = least; label <= greatest; ++label) {
    const double hue = double(label) * kGolden - std::floor(double(label) * kGolden);
    const auto turn = std::size_t((label % 3 + 3) % 3);
    const glm::dvec3 rgb = hb::hsvToRgb({hue, kSaturations[turn], kBrightnesses[turn]});
    if (label == least) d.colors.push_back({double(label) - 0.5, rgb});
    d.colors.push_back({double(label) + 0.5, rgb});
    const double opacity = label == 0 ? 0.0 : kOpacity;
    d.opacities.push_back({double(label) - 0.5, opacity});
    d.opacities.push_back({double(label) + 0.5, opacity});
  }
  return hbTransferFunction(std::move(d));
}
