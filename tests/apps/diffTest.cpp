#include <cmath>

#include <fmt/format.h>

#include "scene/hbPictureFile.h"
#include "tests/apps/hbAppTest.h"

class diff : public hbAppTest {
protected:
  void writePicture(const std::string& name, int width, int height, float value) const {
    hbPicture picture;
    picture.width = width;
    picture.height = height;
    std::vector<float>& y = picture.add("Y");
    for (std::size_t i = 0; i < y.size(); ++i) y[i] = float(i);
    y[5] += value;
    hb::writeExr(picture, folder_ / name);
  }
};

TEST_F(diff, ComparesPictures) {
  writePicture("a.exr", 16, 12, 0.0F);
  writePicture("b.exr", 16, 12, 3.0F);
  writePicture("small.exr", 12, 16, 0.0F);
  const hbProgramRun found = run({"diff", "a.exr", "b.exr", "--json", "--out", "side.png"});
  EXPECT_RUNS(found);
  const auto json = found.json();
  EXPECT_EQ(json["max"], 3.0);
  EXPECT_DOUBLE_EQ(json["rmse"].get<double>(), std::sqrt(9.0 / 192.0));
  EXPECT_DOUBLE_EQ(json["psnr"].get<double>(), 20.0 * std::log10(191.0 / std::sqrt(9.0 / 192.0)));
  EXPECT_LT(json["ssim"].get<double>(), 1.0);
  EXPECT_GT(json["luv_max"].get<double>(), json["luv_mean"].get<double>());
  EXPECT_EQ(hb::readPng(folder_ / "side.png").height, 12);

  const hbProgramRun equal = run({"diff", "a.exr", "a.exr", "--json"});
  EXPECT_RUNS(equal);
  EXPECT_EQ(equal.json()["max"], 0.0);
  EXPECT_TRUE(equal.json()["psnr"].is_null());
  EXPECT_EQ(equal.json()["ssim"], 1.0);
  EXPECT_EQ(equal.json()["luv_max"], 0.0);

  expectFailureLeavesAll({"diff", "a.exr", "small.exr"}, 1, "16 x 12");
  expectFailureLeavesAll({"diff", "a.exr", "side.png"}, 1, "side.png");
  expectFailureLeavesAll({"diff", "a.exr", "b.exr", "--out", "x.png/"}, 1, "x.png");
  write("bad.exr", "no picture");
  write("bad.png", "no picture");
  expectFailureLeavesAll({"diff", "a.exr", "bad.exr"}, 1, "bad.exr");
  expectFailureLeavesAll({"diff", "bad.png", "bad.png"}, 1, "bad.png");
}

TEST_F(diff, ComparesVolumesInAnyForm) {
  writeVolume<float>("a.nrrd", {9, 9, 9}, 1, [](auto x, auto y, auto z, int) { return double(x + y + z); });
  writeVolume<double>("b.nrrd", {9, 9, 9}, 1,
                      [](auto x, auto y, auto z, int) { return double(x + y + z) + (x == 8 ? 0.5 : 0.0); });
  writeVolume<float>("c.nrrd", {9, 9, 5}, 1, [](auto x, auto y, auto z, int) { return double(x + y + 2 * z); });
  auto json = run({"diff", "a.nrrd", "b.nrrd", "--json"}).json();
  EXPECT_EQ(json["max"], 0.5);
  EXPECT_DOUBLE_EQ(json["rmse"].get<double>(), 0.5 / 3.0);
  EXPECT_TRUE(json["ssim"].is_null());
  EXPECT_TRUE(json["luv_mean"].is_null());
  EXPECT_EQ(json["count"], 729);
  // A linear function is a sparse grid of any level: only rounding is left, of a few values below 32.
  EXPECT_RUNS(run({"compress", "a.nrrd", "a.hbv", "--level", "2"}));
  for (const auto& [a, b] : {std::pair("a.nrrd", "a.hbv"), std::pair("a.hbv", "a.nrrd"), std::pair("a.hbv", "a.hbv")}) {
    json = run({"diff", a, b, "--json"}).json();
    EXPECT_LT(json["max"].get<double>(), 32 * 32 * 0x1p-24) << a << " " << b;
  }
  // Volumes of unlike sizes have no common samples; a field and one of them are compared at points of the cube.
  expectFailureLeavesAll({"diff", "a.nrrd", "c.nrrd"}, 1, "9 x 9 x 9");
  json = run({"diff", "c.nrrd", "a.hbv", "--json", "--points", "1000"}).json();
  EXPECT_EQ(json["count"], 1000);
  EXPECT_LT(json["max"].get<double>(), 32 * 32 * 0x1p-24);
  expectFailureLeavesAll({"diff", "a.nrrd", "b.nrrd", "--component", "1"}, 1, "--component");
}

TEST_F(diff, FailsAboveALimit) {
  writeVolume<float>("a.nrrd", {3, 3, 3}, 1, [](auto x, auto, auto, int) { return double(x); });
  writeVolume<float>("b.nrrd", {3, 3, 3}, 1, [](auto x, auto, auto, int) { return double(x) + 0.25; });
  EXPECT_RUNS(run({"diff", "a.nrrd", "b.nrrd", "--fail-above", "max=0.25", "--fail-above", "rmse=1"}));
  const hbProgramRun above = run({"diff", "a.nrrd", "b.nrrd", "--fail-above", "max=0.2", "--json"});
  EXPECT_FAILS(above, 1, "max is 0.25, above 0.2");
  EXPECT_EQ(above.json()["max"], 0.25);
  for (const char* item : {"max", "max=", "=1", "best=1", "kind=1", "max=one", "max=inf"})
    EXPECT_FAILS(run({"diff", "a.nrrd", "b.nrrd", "--fail-above", item}), 1, "--fail-above");
}
