#include "report/hbPictureDifference.h"

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "scene/hbColorSpace.h"
#include "scene/hbDisplay.h"
#include "scene/hbPictureFile.h"
#include "scene/hbScene.h"
#include "volume/hbError.h"

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

hbImage8 noise(int width, int height, unsigned seed) {
  hbImage8 image{width, height, std::vector<std::uint8_t>(std::size_t(3 * width * height))};
  std::uint32_t state = seed;
  for (auto& byte : image.rgb) byte = std::uint8_t((state = state * 1664525U + 1013904223U) >> 24U);
  return image;
}

hbImage8 flat(int width, int height, std::uint8_t gray) {
  return {width, height, std::vector<std::uint8_t>(std::size_t(3 * width * height), gray)};
}

hbPicture pictureOf(int width, std::vector<float> y) {
  hbPicture picture;
  picture.width = width;
  picture.height = int(y.size()) / width;
  picture.channels["Y"] = std::move(y);
  return picture;
}

/// SSIM by its definition: one window after the other, two-dimensional weights, central moments.
double naiveSsim(const hbImage8& a, const hbImage8& b) {
  const auto luma = [](const hbImage8& image, int x, int y) {
    const std::uint8_t* p = &image.rgb[std::size_t(3 * (x + image.width * y))];
    return 0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2];
  };
  double total = 0.0;
  int windows = 0;
  for (int cy = 5; cy < a.height - 5; ++cy)
    for (int cx = 5; cx < a.width - 5; ++cx, ++windows) {
      double weights = 0.0, meanX = 0.0, meanY = 0.0;
      const auto each = [&](auto f) {
        for (int j = -5; j <= 5; ++j)
          for (int i = -5; i <= 5; ++i)
            f(std::exp(-(i * i + j * j) / (2 * 1.5 * 1.5)), luma(a, cx + i, cy + j), luma(b, cx + i, cy + j));
      };
      each([&](double w, double x, double y) { weights += w, meanX += w * x, meanY += w * y; });
      meanX /= weights, meanY /= weights;
      double varX = 0.0, varY = 0.0, covariance = 0.0;
      each([&](double w, double x, double y) {
        varX += w / weights * (x - meanX) * (x - meanX);
        varY += w / weights * (y - meanY) * (y - meanY);
        covariance += w / weights * (x - meanX) * (y - meanY);
      });
      total += (2 * meanX * meanY + 6.5025) * (2 * covariance + 58.5225) /
               ((meanX * meanX + meanY * meanY + 6.5025) * (varX + varY + 58.5225));
    }
  return total / windows;
}

} // namespace

TEST(hbPictureDifference, EqualImagesDoNotDiffer) {
  const hbImage8 image = noise(20, 15, 1);
  const hbPictureDifference d = hb::pictureDifference(image, image);
  EXPECT_EQ(d.max, 0.0);
  EXPECT_EQ(d.rmse, 0.0);
  EXPECT_FALSE(d.psnr);
  EXPECT_EQ(d.ssim, 1.0);
  EXPECT_EQ(d.luvMean, 0.0);
  EXPECT_EQ(d.luvMax, 0.0);
}

TEST(hbPictureDifference, ImagesByHand) {
  const hbPictureDifference d = hb::pictureDifference(flat(12, 13, 100), flat(12, 13, 101));
  EXPECT_EQ(d.max, 1.0);
  EXPECT_EQ(d.rmse, 1.0);
  EXPECT_DOUBLE_EQ(*d.psnr, 20 * std::log10(255.0));
  // Without variance SSIM is (2 m n + C1) / (m^2 + n^2 + C1); what is left of the variances is the rounding of squares
  // of about 1e4, some eps * 1e4 * 11, against C2 = 58.5.
  EXPECT_NEAR(*d.ssim, (2 * 100.0 * 101.0 + 6.5025) / (100.0 * 100.0 + 101.0 * 101.0 + 6.5025), 1e-10);
  const auto lightness = [](double byte) {
    return hb::xyzToLuv(hb::linearToXyz(glm::dvec3(hb::srgbToLinear(byte / 255)))).x;
  };
  EXPECT_NEAR(d.luvMax, lightness(101) - lightness(100), 1e-10); // grays: the distance is that in L*
  EXPECT_NEAR(d.luvMean, d.luvMax, 1e-10);
}

TEST(hbPictureDifference, ColoursAreComparedInLuv) {
  // Red against black in one pixel of two: the mean is half of |(53.24, 175.01, 37.75)|, to the digits of that.
  const hbImage8 a{2, 1, {255, 0, 0, 9, 9, 9}}, b{2, 1, {0, 0, 0, 9, 9, 9}};
  const hbPictureDifference d = hb::pictureDifference(a, b);
  EXPECT_NEAR(d.luvMax, std::hypot(53.24, 175.01, 37.75), 0.2);
  EXPECT_DOUBLE_EQ(d.luvMean, d.luvMax / 2);
  EXPECT_FALSE(d.ssim); // too small
}

TEST(hbPictureDifference, SsimAgreesWithItsDefinition) {
  const hbImage8 a = noise(17, 24, 5);
  hbImage8 b = noise(17, 24, 6);
  for (std::size_t i = 0; i < b.rgb.size(); ++i) b.rgb[i] = std::uint8_t((3 * a.rgb[i] + b.rgb[i]) / 4);
  // Moments of up to 65025 lose a few eps * 65025 * 11 against denominators above 58.5.
  EXPECT_NEAR(*hb::ssim(a, b), naiveSsim(a, b), 1e-10);
  EXPECT_LT(*hb::ssim(a, b), 0.99);
  EXPECT_FALSE(hb::ssim(noise(10, 30, 1), noise(10, 30, 2)));
  EXPECT_FALSE(hb::ssim(noise(30, 10, 1), noise(30, 10, 2)));
  EXPECT_TRUE(hb::ssim(noise(11, 11, 1), noise(11, 11, 2)));
}

TEST(hbPictureDifference, FloatPicturesByHand) {
  const hbPictureDifference d = hb::pictureDifference(pictureOf(2, {0, 10, 20, 40}), pictureOf(2, {3, 6, 20, 40}));
  EXPECT_EQ(d.max, 4.0);
  EXPECT_EQ(d.rmse, 2.5);
  EXPECT_DOUBLE_EQ(*d.psnr, 20 * std::log10(40 / 2.5));
  EXPECT_GT(d.luvMax, 0.0);
}

TEST(hbPictureDifference, BothAreSeenThroughTheFirstOnesWindow) {
  // Equal but for one outlier, which would change b's own window and so every pixel of it.
  std::vector<float> values(100);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = float(i);
  const hbPicture a = pictureOf(10, values);
  values[0] = 1000.0F;
  const hbPictureDifference d = hb::pictureDifference(a, pictureOf(10, values));
  EXPECT_NEAR(d.luvMax, 100.0, 0.1); // black against white
  EXPECT_DOUBLE_EQ(d.luvMean, d.luvMax / 100);
}

TEST(hbPictureDifference, TheScenesColoursAreThoseOfTheMetadata) {
  hbPicture a = pictureOf(2, {0, 1}), b = pictureOf(2, {1, 1});
  hbScene scene;
  scene.window = {0.0, 10.0};
  a.metadata[hbPicture::kSceneKey] = hb::toJson(scene);
  const double dim = hb::pictureDifference(a, b).luvMax;
  EXPECT_LT(dim, 10.0); // a tenth of the way to white: L* is 9.3; with a window of their own it would be 100
  EXPECT_EQ(dim, hb::pictureDifference(hb::displayImage(a, scene), hb::displayImage(b, scene)).luvMax);
  a.metadata[hbPicture::kSceneKey] = "{";
  EXPECT_THROW(hb::pictureDifference(a, b), hbError);
}

TEST(hbPictureDifference, NaNInBothIsEqualInOneInfinite) {
  const auto both = hb::pictureDifference(pictureOf(2, {kNaN, 1}), pictureOf(2, {kNaN, 1}));
  EXPECT_EQ(both.max, 0.0);
  EXPECT_EQ(both.luvMax, 0.0);
  EXPECT_EQ(hb::pictureDifference(pictureOf(2, {kNaN, 1}), pictureOf(2, {0, 1})).max,
            std::numeric_limits<double>::infinity());
}

TEST(hbPictureDifference, NoRangeNoPsnr) {
  const auto d = hb::pictureDifference(pictureOf(2, {5, 5}), pictureOf(2, {5, 6}));
  EXPECT_EQ(d.max, 1.0);
  EXPECT_FALSE(d.psnr);
}

TEST(hbPictureDifference, WithoutYTheFirstCommonChannelCounts) {
  hbPicture a = pictureOf(1, {1}), b = pictureOf(1, {1});
  a.channels = {{"B", {1.0F}}, {"V", {2.0F}}};
  b.channels = {{"V", {5.0F}}, {"Z", {1.0F}}};
  EXPECT_EQ(hb::pictureDifference(a, b).max, 3.0);
}

TEST(hbPictureDifference, ErrorsNameBoth) {
  const auto errorOf = [](const auto& a, const auto& b) -> std::string {
    try {
      hb::pictureDifference(a, b, "a.x", "b.x");
    } catch (const hbError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(errorOf(flat(2, 3, 0), flat(3, 2, 0)),
            "a.x and b.x: expected pictures of equal size, found 2 x 3 and 3 x 2");
  EXPECT_EQ(errorOf(pictureOf(1, {1, 2}), pictureOf(2, {1, 2})),
            "a.x and b.x: expected pictures of equal size, found 1 x 2 and 2 x 1");
  hbPicture other = pictureOf(1, {1});
  other.channels = {{"A", {1.0F}}, {"Z", {1.0F}}};
  EXPECT_EQ(errorOf(pictureOf(1, {1}), other),
            "a.x and b.x: expected channel Y or another one in both, found Y and A, Z");
}

TEST(hbPictureDifference, ComparesFiles) {
  const std::filesystem::path folder(testing::TempDir());
  const auto exr = folder / "hbPictureDifferenceTest.exr", png = folder / "hbPictureDifferenceTest.png";
  hb::writeExr(pictureOf(2, {1, 2}), exr);
  hb::writePng(flat(2, 1, 7), png);
  EXPECT_EQ(hb::pictureFileDifference(exr, exr).max, 0.0);
  EXPECT_EQ(hb::pictureFileDifference(png, png).max, 0.0);
  EXPECT_THROW(hb::pictureFileDifference(exr, png), hbError);
  EXPECT_THROW(hb::pictureFileDifference(exr, folder / "hbPictureDifferenceTest-missing.exr"), hbError);
}
