#include "scene/hbDisplay.h"

#include <array>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "volume/hbError.h"

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();
using Rgb = std::array<int, 3>;
constexpr Rgb kBackground{31, 31, 31}; // 0.12 * 255

hbPicture pictureOf(std::vector<float> y, std::vector<float> a = {}) {
  hbPicture picture;
  picture.width = int(y.size());
  picture.height = 1;
  picture.channels["Y"] = std::move(y);
  if (!a.empty()) picture.channels["A"] = std::move(a);
  return picture;
}

Rgb pixel(const hbImage8& image, int x, int y = 0) {
  const std::uint8_t* p = &image.rgb[std::size_t(3 * (x + image.width * y))];
  return {p[0], p[1], p[2]};
}

hbScene sceneOf(hbMode mode) {
  hbScene scene;
  scene.mode = mode;
  return scene;
}

using Window = std::pair<double, double>;

} // namespace

TEST(hbDisplay, TheWindowIsThatOfTheCoveredFinitePixels) {
  const hbPicture picture = pictureOf({3, 7, -100, kNaN, kInf}, {1, 0.5F, 0, 1, 1});
  EXPECT_EQ(hb::displayWindow(picture, sceneOf(hbMode::mip)), Window(3, 7));
  EXPECT_EQ(hb::displayWindow(picture, sceneOf(hbMode::xray)), Window(0, 7));
  EXPECT_EQ(hb::displayWindow(pictureOf({-2, 5}), sceneOf(hbMode::xray)), Window(-2, 5));
  EXPECT_EQ(hb::displayWindow(pictureOf({kNaN}), sceneOf(hbMode::xray)), Window(0, 1));
  hbScene scene;
  scene.window = Window(1, 2);
  EXPECT_EQ(hb::displayWindow(picture, scene), Window(1, 2));
}

TEST(hbDisplay, ValuesGoThroughWindowAndMap) {
  hbScene scene;
  scene.window = Window(0, 255);
  const hbImage8 image = hb::displayImage(pictureOf({0, 100, 255, 1e9F, -5, kInf}), scene);
  const std::array expected{0, 100, 255, 255, 0, 255};
  for (int x = 0; x < 6; ++x) EXPECT_EQ(pixel(image, x), (Rgb{expected[x], expected[x], expected[x]})) << x;
  scene.mode = hbMode::mip; // heat: 0.5 is (1, 1/2, 0), and 255 / 2 is rounded away from 0
  EXPECT_EQ(pixel(hb::displayImage(pictureOf({127.5F}), scene), 0), (Rgb{255, 128, 0}));
  scene.colormap = "inverse-gray";
  EXPECT_EQ(pixel(hb::displayImage(pictureOf({255}), scene), 0), (Rgb{0, 0, 0}));
}

TEST(hbDisplay, UncoveredPixelsShowTheBackground) {
  for (const hbMode mode : {hbMode::xray, hbMode::mip, hbMode::iso}) {
    const hbImage8 image = hb::displayImage(pictureOf({kNaN, 1, 1, 0.5F}, {1, 0, kNaN, 1}), sceneOf(mode));
    for (int x = 0; x < 3; ++x) EXPECT_EQ(pixel(image, x), kBackground) << x;
    EXPECT_NE(pixel(image, 3), kBackground);
  }
}

TEST(hbDisplay, CoverageMixesInLinearLight) {
  // White over the background, half each: sRGB of (1 + 0.0137) / 2 is 0.7405 (189); mixing the bytes would give 143.
  hbScene scene;
  scene.window = Window(0, 1);
  EXPECT_EQ(pixel(hb::displayImage(pictureOf({1}, {0.5F}), scene), 0), (Rgb{189, 189, 189}));
}

TEST(hbDisplay, IsoIsTheSurfaceColourTimesTheShade) {
  // sRGB of (0.78, 0.70, 0.60) is (0.8962, 0.8540, 0.7977); of half of it (0.6579, 0.6262, 0.5834).
  const hbImage8 image = hb::displayImage(pictureOf({1, 0.5F, 0, 3}), sceneOf(hbMode::iso));
  EXPECT_EQ(pixel(image, 0), (Rgb{229, 218, 203}));
  EXPECT_EQ(pixel(image, 1), (Rgb{168, 160, 149}));
  EXPECT_EQ(pixel(image, 2), (Rgb{0, 0, 0}));
  EXPECT_EQ(pixel(image, 3), pixel(image, 0));
}

TEST(hbDisplay, OneValueAndExtremeWindowsAreShown) {
  EXPECT_EQ(pixel(hb::displayImage(pictureOf({4, 4}), sceneOf(hbMode::mip)), 0), (Rgb{0, 0, 0}));
  EXPECT_EQ(pixel(hb::displayImage(pictureOf({0, 0}), sceneOf(hbMode::xray)), 0), (Rgb{0, 0, 0}));
  hbScene scene;
  scene.window = Window(-1.7e308, 1.7e308);
  EXPECT_EQ(pixel(hb::displayImage(pictureOf({0}), scene), 0), (Rgb{128, 128, 128}));
}

TEST(hbDisplay, DifferencesAreShownOverOneScale) {
  const hbPicture a = pictureOf({1, 5, 3, kNaN, kNaN, kInf}), b = pictureOf({1, 3, 5, kNaN, 2, kInf});
  const hbImage8 absolute = hb::absoluteDifferenceImage(a, b, 4.0);
  EXPECT_EQ(pixel(absolute, 0), (Rgb{0, 0, 0}));
  EXPECT_EQ(pixel(absolute, 1), (Rgb{255, 128, 0})); // half of the scale
  EXPECT_EQ(pixel(absolute, 2), pixel(absolute, 1));
  EXPECT_EQ(pixel(absolute, 3), kBackground);
  EXPECT_EQ(pixel(absolute, 4), (Rgb{255, 255, 255}));
  EXPECT_EQ(pixel(absolute, 5), (Rgb{0, 0, 0}));
  EXPECT_EQ(pixel(hb::absoluteDifferenceImage(a, b), 1), (Rgb{255, 255, 255})); // the greatest one
  const hbImage8 with = hb::signedDifferenceImage(a, b, 2.0);
  EXPECT_GT(pixel(with, 1)[0], pixel(with, 1)[2]); // a greater: warm
  EXPECT_LT(pixel(with, 2)[0], pixel(with, 2)[2]);
  EXPECT_EQ(pixel(with, 0)[0], pixel(with, 0)[2]);
  EXPECT_EQ(pixel(hb::absoluteDifferenceImage(a, a), 0), (Rgb{0, 0, 0}));
  EXPECT_EQ(pixel(hb::signedDifferenceImage(a, a), 0), pixel(with, 0));
}

TEST(hbDisplay, SideBySideKeepsThePixels) {
  const hbImage8 one{1, 2, {1, 2, 3, 4, 5, 6}}, two{2, 1, {7, 8, 9, 10, 11, 12}};
  const hbImage8 row = hb::sideBySide(std::array{one, two}, 3);
  EXPECT_EQ(row.width, 6);
  EXPECT_EQ(row.height, 2);
  EXPECT_EQ(pixel(row, 0, 0), (Rgb{1, 2, 3}));
  EXPECT_EQ(pixel(row, 0, 1), (Rgb{4, 5, 6}));
  EXPECT_EQ(pixel(row, 1, 0), kBackground);
  EXPECT_EQ(pixel(row, 4, 0), (Rgb{7, 8, 9}));
  EXPECT_EQ(pixel(row, 5, 0), (Rgb{10, 11, 12}));
  EXPECT_EQ(pixel(row, 5, 1), kBackground);
}

TEST(hbDisplay, RefusesWhatCannotBeShown) {
  hbPicture withoutY = pictureOf({1});
  withoutY.channels = {{"value", {1.0F}}};
  EXPECT_THROW(hb::displayImage(withoutY, hbScene{}), hbError);
  EXPECT_THROW(hb::displayImage(hbPicture{}, hbScene{}), hbError);
  EXPECT_THROW(hb::absoluteDifferenceImage(pictureOf({1}), pictureOf({1, 2})), hbError);
  EXPECT_THROW(hb::sideBySide({}), hbError);
  const hbImage8 one{1, 1, {0, 0, 0}};
  EXPECT_THROW(hb::sideBySide(std::array{one}, -1), hbError);
  EXPECT_THROW(hb::sideBySide(std::array{one, one}, 16384), hbError);
}

TEST(hbDisplay, BackgroundIsTheScenesOrADarkGray) {
  hbScene scene;
  EXPECT_EQ(hb::backgroundColour(scene), glm::dvec3(0.12));
  scene.background = {1.0, 0.5, 0.25};
  EXPECT_EQ(hb::backgroundColour(scene), glm::dvec3(1.0, 0.5, 0.25));
}

TEST(hbDisplay, LightIsShownOverTheBackground) {
  hbPicture picture = pictureOf({0, 0, 0}, {0, 1, 0.5F});
  picture.channels["R"] = {0, 1, 0.25F};
  picture.channels["G"] = {0, 0, 0.25F};
  picture.channels["B"] = {0, 0, 0};
  hbScene scene = sceneOf(hbMode::dvr);
  hbImage8 image = hb::displayImage(picture, scene);
  EXPECT_EQ(pixel(image, 0), kBackground);
  EXPECT_EQ(pixel(image, 1), (Rgb{255, 0, 0}));
  scene.background = {1.0, 1.0, 1.0};
  image = hb::displayImage(picture, scene);
  EXPECT_EQ(pixel(image, 0), (Rgb{255, 255, 255}));
  // In linear light: 0.25 + 0.5 and 0.5; coded 0.8808 and 0.7354.
  EXPECT_EQ(pixel(image, 2), (Rgb{225, 225, 188}));
  picture.channels.erase("B"); // then its "Y" is shown
  EXPECT_EQ(pixel(hb::displayImage(picture, scene), 1), (Rgb{0, 0, 0}));
}

TEST(hbDisplay, EveryModeTakesTheScenesBackground) {
  hbScene scene = sceneOf(hbMode::mip);
  scene.background = {1.0, 0.0, 0.0};
  EXPECT_EQ(pixel(hb::displayImage(pictureOf({1, 2}, {0, 1}), scene), 0), (Rgb{255, 0, 0}));
}
