#include "scene/hbDisplay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "scene/hbColorSpace.h"
#include "scene/hbColormap.h"
#include "volume/hbError.h"

namespace {

const glm::dvec3 kBackground(0.12);          // coded sRGB
const glm::dvec3 kSurface(0.78, 0.70, 0.60); // reflectance in linear light

using Window = std::pair<double, double>;

std::uint8_t toByte(double coded) { return std::uint8_t(std::lround(255.0 * std::clamp(coded, 0.0, 1.0))); }

void put(hbImage8& image, std::size_t pixel, const glm::dvec3& coded) {
  for (int c = 0; c < 3; ++c) image.rgb[3 * pixel + std::size_t(c)] = toByte(coded[c]);
}

hbImage8 background(int width, int height, const glm::dvec3& colour = kBackground) {
  hbImage8 image{width, height, std::vector<std::uint8_t>(3 * std::size_t(width) * std::size_t(height))};
  for (std::size_t i = 0; i < image.rgb.size() / 3; ++i) put(image, i, colour);
  return image;
}

/// Red, green, blue and opacity, each nullptr where the picture has none.
std::array<const std::vector<float>*, 4> lightOf(const hbPicture& picture) {
  return {picture.find("R"), picture.find("G"), picture.find("B"), picture.find("A")};
}

/// Premultiplied linear light over the background.
hbImage8 compositedImage(const hbPicture& picture, const glm::dvec3& backdrop) {
  const auto [r, g, b, a] = lightOf(picture);
  const glm::dvec3 behind = hb::srgbToLinear(backdrop);
  hbImage8 image = background(picture.width, picture.height);
  for (std::size_t i = 0; i < a->size(); ++i)
    put(image, i, hb::linearToSrgb(glm::dvec3((*r)[i], (*g)[i], (*b)[i]) + (1.0 - double((*a)[i])) * behind));
  return image;
}

const std::vector<float>& checkedY(const hbPicture& picture) {
  picture.validate("picture");
  const auto* values = picture.find("Y");
  if (values == nullptr) throw hbError("picture: expected a channel Y, found none");
  return *values;
}

/// Opacity of a pixel in [0,1]; 0 where it has no value.
double coverage(const std::vector<float>& values, const std::vector<float>* alpha, std::size_t pixel) {
  if (std::isnan(values[pixel])) return 0.0;
  if (alpha == nullptr) return 1.0;
  const double a = (*alpha)[pixel];
  return a > 0.0 ? std::min(a, 1.0) : 0.0; // NaN is 0
}

/// The place of a value in the window. Halved first, so that a window as wide as the range of doubles does not
/// overflow.
double placeIn(const Window& window, double value) {
  const double width = 0.5 * window.second - 0.5 * window.first;
  if (width > 0.0) return std::clamp((0.5 * value - 0.5 * window.first) / width, 0.0, 1.0);
  return value > window.second ? 1.0 : 0.0;
}

hbColormap mapOf(const hbScene& scene) {
  if (!scene.colormap.empty()) return hbColormap(scene.colormap);
  return hbColormap(scene.mode == hbMode::mip ? "heat" : "gray");
}

hbImage8 differenceImage(const hbPicture& a, const hbPicture& b, std::optional<double> limit, bool isSigned) {
  const auto &valuesA = checkedY(a), &valuesB = checkedY(b);
  if (a.width != b.width || a.height != b.height)
    throw hbError(fmt::format("difference picture: expected pictures of equal size, found {} x {} and {} x {}", a.width,
                              a.height, b.width, b.height));
  double greatest = 0.0;
  for (std::size_t i = 0; i < valuesA.size(); ++i) {
    const double difference = std::abs(double(valuesA[i]) - double(valuesB[i]));
    if (std::isfinite(difference)) greatest = std::max(greatest, difference);
  }
  const double top = limit.value_or(greatest);
  const hbColormap map(isSigned ? "coolwarm" : "heat");
  const Window window = isSigned ? Window(-top, top) : Window(0.0, top);
  hbImage8 image = background(a.width, a.height);
  for (std::size_t i = 0; i < valuesA.size(); ++i) {
    const double x = valuesA[i], y = valuesB[i];
    if (std::isnan(x) && std::isnan(y)) continue;
    const double difference = x == y ? 0.0 : isSigned ? x - y : std::abs(x - y);
    if (std::isnan(difference))
      put(image, i, map.rgb(1.0));
    else if (top > 0.0)
      put(image, i, map.rgb(placeIn(window, difference)));
    else
      put(image, i, map.rgb(isSigned ? 0.5 : 0.0));
  }
  return image;
}

} // namespace

std::pair<double, double> hb::displayWindow(const hbPicture& picture, const hbScene& scene) {
  const auto& values = checkedY(picture);
  if (scene.window) return *scene.window;
  const auto* alpha = picture.find("A");
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i]) || coverage(values, alpha, i) == 0.0) continue;
    lo = std::min(lo, double(values[i]));
    hi = std::max(hi, double(values[i]));
  }
  if (!(lo <= hi)) return {0.0, 1.0};
  return {scene.mode == hbMode::xray ? std::min(lo, 0.0) : lo, hi};
}

hbImage8 hb::displayImage(const hbPicture& picture, const hbScene& scene) {
  return displayImage(picture, scene, displayWindow(picture, scene));
}

hbImage8 hb::displayImage(const hbPicture& picture, const hbScene& scene, const std::pair<double, double>& window) {
  const auto& values = checkedY(picture);
  const glm::dvec3 backdrop = backgroundColour(scene);
  const auto light = lightOf(picture);
  if (scene.mode == hbMode::dvr && std::find(light.begin(), light.end(), nullptr) == light.end())
    return compositedImage(picture, backdrop);
  const auto* alpha = picture.find("A");
  const hbColormap map = mapOf(scene);
  const glm::dvec3 behind = srgbToLinear(backdrop);
  const bool showsLabels = scene.mode == hbMode::slice && scene.labels && scene.transfer;
  hbImage8 image = background(picture.width, picture.height, backdrop);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double a = coverage(values, alpha, i);
    if (a == 0.0) continue;
    if (scene.mode == hbMode::iso) {
      const double shade = std::clamp(double(values[i]), 0.0, 1.0);
      put(image, i, linearToSrgb(behind + a * (shade * kSurface - behind)));
      continue;
    }
    if (showsLabels) {
      if (scene.transfer->opacity(values[i]) > 0.0) put(image, i, linearToSrgb(scene.transfer->colour(values[i])));
      continue;
    }
    const glm::dvec3 colour = map.rgb(placeIn(window, values[i]));
    put(image, i, a == 1.0 ? colour : linearToSrgb(behind + a * (srgbToLinear(colour) - behind)));
  }
  return image;
}

hbImage8 hb::absoluteDifferenceImage(const hbPicture& a, const hbPicture& b, std::optional<double> limit) {
  return differenceImage(a, b, limit, false);
}

hbImage8 hb::signedDifferenceImage(const hbPicture& a, const hbPicture& b, std::optional<double> limit) {
  return differenceImage(a, b, limit, true);
}

glm::dvec3 hb::backgroundColour(const hbScene& scene) { return scene.background.value_or(kBackground); }

hbImage8 hb::sideBySide(std::span<const hbImage8> images, int gap) {
  if (images.empty() || gap < 0)
    throw hbError(fmt::format("side by side: expected at least one image and a gap of 0 or more, found {} and {}",
                              images.size(), gap));
  std::int64_t width = std::int64_t(gap) * std::int64_t(images.size() - 1);
  int height = 0;
  for (const hbImage8& image : images) {
    width += image.width;
    height = std::max(height, image.height);
  }
  if (width > hbScene::kMaxPictureSide)
    throw hbError(
        fmt::format("side by side: expected a width of at most {} pixels, found {}", hbScene::kMaxPictureSide, width));
  hbImage8 result = background(int(width), height);
  std::size_t left = 0;
  for (const hbImage8& image : images) {
    const std::size_t rowBytes = 3 * std::size_t(image.width);
    for (int y = 0; y < image.height; ++y)
      std::copy_n(image.rgb.begin() + std::ptrdiff_t(rowBytes * std::size_t(y)), rowBytes,
                  result.rgb.begin() + std::ptrdiff_t(3 * (left + std::size_t(width) * std::size_t(y))));
    left += std::size_t(image.width) + std::size_t(gap);
  }
  return result;
}
