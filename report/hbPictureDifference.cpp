#include "report/hbPictureDifference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "report/hbErrorStatistics.h"
#include "scene/hbColorSpace.h"
#include "scene/hbDisplay.h"
#include "scene/hbPictureFile.h"
#include "scene/hbScene.h"
#include "volume/hbError.h"

namespace {

// ---- SSIM ----

constexpr int kWindow = 11;
constexpr int kMoments = 5; // of luma x and y: x, y, x^2, y^2, xy
using Moments = std::array<double, kMoments>;

/// One factor of the separable Gaussian window, adding up to 1.
std::array<double, kWindow> gaussian() {
  constexpr double kSigma = 1.5;
  constexpr int kCentre = kWindow / 2;
  std::array<double, kWindow> weights{};
  double sum = 0.0;
  for (int i = 0; i < kWindow; ++i) {
    const double distance = i - kCentre;
    sum += weights[std::size_t(i)] = std::exp(-distance * distance / (2.0 * kSigma * kSigma));
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

double luma(const hbImage8& image, std::size_t pixel) {
  const std::uint8_t* rgb = image.rgb.data() + 3 * pixel;
  return 0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2];
}

/// The moments of row y under the window's horizontal factor: width - 10 of them.
void filterRow(const hbImage8& a, const hbImage8& b, int y, const std::array<double, kWindow>& weights,
               std::vector<Moments>& out) {
  const std::size_t width = std::size_t(a.width);
  std::vector<Moments> row(width);
  for (std::size_t x = 0; x < width; ++x) {
    const double p = luma(a, x + width * std::size_t(y)), q = luma(b, x + width * std::size_t(y));
    row[x] = {p, q, p * p, q * q, p * q};
  }
  out.assign(width - (kWindow - 1), Moments{});
  for (std::size_t x = 0; x < out.size(); ++x)
    for (std::size_t i = 0; i < kWindow; ++i)
      for (std::size_t m = 0; m < kMoments; ++m) out[x][m] += weights[i] * row[x + i][m];
}

/// Equation 13 of the paper.
double similarity(const Moments& m) {
  constexpr double kC1 = (0.01 * 255) * (0.01 * 255), kC2 = (0.03 * 255) * (0.03 * 255);
  const auto& [meanX, meanY, squareX, squareY, product] = m;
  const double varianceX = squareX - meanX * meanX, varianceY = squareY - meanY * meanY;
  const double covariance = product - meanX * meanY;
  return (2.0 * meanX * meanY + kC1) * (2.0 * covariance + kC2) /
         ((meanX * meanX + meanY * meanY + kC1) * (varianceX + varianceY + kC2));
}

// ---- L*u*v* ----

class LuvOfBytes {
public:
  LuvOfBytes() {
    for (std::size_t i = 0; i < linear_.size(); ++i) linear_[i] = hb::srgbToLinear(double(i) / 255.0);
  }
  glm::dvec3 operator()(const std::uint8_t* rgb) const {
    return hb::xyzToLuv(hb::linearToXyz({linear_[rgb[0]], linear_[rgb[1]], linear_[rgb[2]]}));
  }

private:
  std::array<double, 256> linear_{};
};

void addPerceived(const hbImage8& a, const hbImage8& b, hbPictureDifference& difference) {
  const LuvOfBytes luv;
  double sum = 0.0;
  for (std::size_t i = 0; i < a.rgb.size(); i += 3) {
    if (std::equal(&a.rgb[i], &a.rgb[i] + 3, &b.rgb[i])) continue;
    const double distance = glm::distance(luv(&a.rgb[i]), luv(&b.rgb[i]));
    sum += distance;
    difference.luvMax = std::max(difference.luvMax, distance);
  }
  difference.luvMean = sum / (double(a.rgb.size()) / 3.0);
  difference.ssim = hb::ssim(a, b);
}

// ---- both kinds ----

template <class Picture>
void checkSizes(const Picture& a, const Picture& b, const std::string& nameA, const std::string& nameB) {
  if (a.width != b.width || a.height != b.height)
    throw hbError(fmt::format("{} and {}: expected pictures of equal size, found {} x {} and {} x {}", nameA, nameB,
                              a.width, a.height, b.width, b.height));
}

std::string channelNames(const hbPicture& picture) {
  std::string names;
  for (const auto& [name, values] : picture.channels) names += (names.empty() ? "" : ", ") + name;
  return names;
}

/// The channel to compare; see the header.
std::string commonChannel(const hbPicture& a, const hbPicture& b, const std::string& nameA, const std::string& nameB) {
  const bool inA = a.find("Y") != nullptr, inB = b.find("Y") != nullptr;
  if (inA && inB) return "Y";
  if (!inA && !inB)
    for (const auto& [name, values] : a.channels)
      if (b.find(name) != nullptr) return name;
  throw hbError(fmt::format("{} and {}: expected channel Y or another one in both, found {} and {}", nameA, nameB,
                            channelNames(a), channelNames(b)));
}

hbScene sceneOf(const hbPicture& picture, const std::string& name) {
  const auto at = picture.metadata.find(hbPicture::kSceneKey);
  return at == picture.metadata.end() ? hbScene{}
                                      : hb::sceneFromJson(at->second, fmt::format("{}: {}", name, at->first));
}

/// What is displayed of the picture when `channel` takes the place of its "Y"; with its light where that is "Y".
hbPicture asY(const hbPicture& picture, const std::string& channel) {
  hbPicture result{picture.width, picture.height, {{"Y", *picture.find(channel)}}, {}};
  for (const char* name : channel == "Y" ? std::vector{"R", "G", "B", "A"} : std::vector{"A"})
    if (const auto* values = picture.find(name)) result.channels[name] = *values;
  return result;
}

} // namespace

std::optional<double> hb::ssim(const hbImage8& a, const hbImage8& b) {
  if (a.width < kWindow || a.height < kWindow) return std::nullopt;
  const auto weights = gaussian();
  std::array<std::vector<Moments>, kWindow> rows; // row y is kept in slot y mod 11
  double sum = 0.0;
  for (int y = 0; y < a.height; ++y) {
    filterRow(a, b, y, weights, rows[std::size_t(y % kWindow)]);
    const int top = y - (kWindow - 1);
    if (top < 0) continue;
    double rowSum = 0.0;
    for (std::size_t x = 0; x < rows[0].size(); ++x) {
      Moments window{};
      for (int i = 0; i < kWindow; ++i)
        for (std::size_t m = 0; m < kMoments; ++m)
          window[m] += weights[std::size_t(i)] * rows[std::size_t((top + i) % kWindow)][x][m];
      rowSum += similarity(window);
    }
    sum += rowSum;
  }
  return sum / (double(a.width - (kWindow - 1)) * double(a.height - (kWindow - 1)));
}

hbPictureDifference hb::pictureDifference(const hbImage8& a, const hbImage8& b, const std::string& nameA,
                                          const std::string& nameB) {
  checkSizes(a, b, nameA, nameB);
  hbErrorStatistics statistics;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) statistics.add(a.rgb[i], b.rgb[i]);
  hbPictureDifference difference{statistics.max, statistics.rmse(), statistics.psnr(255.0), {}, 0.0, 0.0};
  addPerceived(a, b, difference);
  return difference;
}

hbPictureDifference hb::pictureDifference(const hbPicture& a, const hbPicture& b, const std::string& nameA,
                                          const std::string& nameB) {
  a.validate(nameA);
  b.validate(nameB);
  checkSizes(a, b, nameA, nameB);
  const std::string channel = commonChannel(a, b, nameA, nameB);
  const std::vector<float>&valuesA = *a.find(channel), &valuesB = *b.find(channel);
  hbErrorStatistics statistics;
  for (std::size_t i = 0; i < valuesA.size(); ++i) statistics.add(valuesA[i], valuesB[i]);
  hbPictureDifference difference{statistics.max, statistics.rmse(), statistics.psnr(), {}, 0.0, 0.0};

  const hbScene scene = sceneOf(a, nameA);
  const hbPicture shownA = asY(a, channel);
  const auto window = displayWindow(shownA, scene);
  addPerceived(displayImage(shownA, scene, window), displayImage(asY(b, channel), scene, window), difference);
  return difference;
}

hbPictureDifference hb::pictureFileDifference(const std::filesystem::path& a, const std::filesystem::path& b) {
  const auto pictureA = readPicture(a), pictureB = readPicture(b);
  if (pictureA.index() != pictureB.index())
    throw hbError(
        fmt::format("{} and {}: expected two .exr or two .png pictures, found one of each", a.string(), b.string()));
  if (const auto* exr = std::get_if<hbPicture>(&pictureA))
    return pictureDifference(*exr, std::get<hbPicture>(pictureB), a.string(), b.string());
  return pictureDifference(std::get<hbImage8>(pictureA), std::get<hbImage8>(pictureB), a.string(), b.string());
}
