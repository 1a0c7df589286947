#include <cmath>
#include <sstream>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "tests/apps/hbAppTest.h"
#include "volume/fields/hbAnalyticField.h"

namespace {

/// The rows of numbers under the CSV heading.
std::vector<std::vector<double>> rows(const hbProgramRun& run) {
  std::istringstream lines(run.out);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "x,y,z,value,dx,dy,dz");
  std::vector<std::vector<double>> list;
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    std::vector<double>& row = list.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
    EXPECT_EQ(row.size(), 7U) << line;
  }
  return list;
}

} // namespace

class probe : public hbAppTest {};

TEST_F(probe, GivesValuesAndGradientsOfTheFormula) {
  // Coordinates that floats hold exactly, so that only the outcome is rounded.
  write("points.txt",
        "# x y z\n0.125 0.5 0.75\n\n0,0,0\n1, 1, 1 # a corner\n\t0.25\t0.375 0.625\r\n-0.5 0 0\n0 0 1.001\n");
  const hbProgramRun found = run({"probe", "field:multilinear", "--points", "points.txt", "--stats", "s.json"});
  EXPECT_RUNS(found);
  const auto list = rows(found);
  ASSERT_EQ(list.size(), 6U);
  EXPECT_EQ(json("s.json")["points"], 6);
  for (std::size_t i = 0; i < 4; ++i) {
    const double x = list[i][0], y = list[i][1], z = list[i][2];
    // Each rounded to a float: half an ulp of numbers below 32.
    constexpr double kBound = 16 * 0x1p-23;
    EXPECT_NEAR(list[i][3], 1 + 2 * x + 3 * y - 4 * z + 5 * x * y - 6 * y * z + 7 * x * z + 8 * x * y * z, kBound);
    EXPECT_NEAR(list[i][4], 2 + 5 * y + 7 * z + 8 * y * z, kBound);
    EXPECT_NEAR(list[i][5], 3 + 5 * x - 6 * z + 8 * x * z, kBound);
    EXPECT_NEAR(list[i][6], -4 - 6 * y + 7 * x + 8 * x * y, kBound);
  }
  EXPECT_EQ(list[3][2], 0.625);
  for (std::size_t i = 4; i < 6; ++i)
    for (std::size_t j = 3; j < 7; ++j) EXPECT_TRUE(std::isnan(list[i][j])) << i;
}

TEST_F(probe, WorksInTheWorldOfASpacedAndObliqueVolume) {
  // Spacing 2 along axes turned by 3-4-5 about z; sample (i,j,k) lies at origin + 2 (i a + j b + k c).
  write("v.nhdr",
        "NRRD0005\ntype: float\ndimension: 3\nsizes: 3 3 3\nspace dimension: 3\nspace origin: (10,-20,5)\n"
        "space directions: (1.2,1.6,0) (-1.6,1.2,0) (0,0,2)\nencoding: raw\nendian: little\ndata file: v.raw\n");
  const glm::dvec3 origin(10, -20, 5), a(0.6, 0.8, 0), b(-0.8, 0.6, 0), c(0, 0, 1);
  std::string samples;
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) {
        const float value = float(1 + 3 * i - 5 * j + 7 * k);
        samples.append(reinterpret_cast<const char*>(&value), sizeof(value));
      }
  write("v.raw", samples);
  // In the world the linear function has the slope 3/2 along a, -5/2 along b, 7/2 along c.
  const glm::dvec3 slope = 1.5 * a - 2.5 * b + 3.5 * c;
  std::string points;
  const std::vector<glm::dvec3> steps{{0.5, 0.25, 1.25}, {0, 0, 0}, {2, 2, 2}, {1.75, 0.125, 1}};
  for (const glm::dvec3& s : steps) {
    const glm::dvec3 p = origin + 2.0 * (s.x * a + s.y * b + s.z * c);
    points += fmt::format("{} {} {}\n", p.x, p.y, p.z);
  }
  points += "10 -21 5\n"; // beside the box
  write("points.txt", points);
  EXPECT_RUNS(run({"compress", "v.nhdr", "v.hbv"}));
  for (const char* input : {"v.nhdr", "v.hbv"}) {
    const hbProgramRun found = run({"probe", input, "--points", "points.txt"});
    EXPECT_RUNS(found);
    const auto list = rows(found);
    ASSERT_EQ(list.size(), 5U);
    for (std::size_t i = 0; i < steps.size(); ++i) {
      // Cube coordinates as floats, times slopes of up to 14; about ten further roundings of numbers below 32.
      constexpr double kBound = 14 * 3 * 0x1p-24 + 10 * 32 * 0x1p-24;
      EXPECT_NEAR(list[i][3], 1 + 3 * steps[i].x - 5 * steps[i].y + 7 * steps[i].z, kBound) << input;
      for (int d = 0; d < 3; ++d) EXPECT_NEAR(list[i][std::size_t(4 + d)], slope[d], kBound) << input;
    }
    EXPECT_TRUE(std::isnan(list[4][3]));
  }
  // In the cube's own coordinates the slopes are per edge.
  write("cube.txt", "0.5 0.5 0.5\n");
  const auto list = rows(run({"probe", "v.nhdr", "--points", "cube.txt", "--space", "cube"}));
  ASSERT_EQ(list.size(), 1U);
  EXPECT_EQ(list[0], (std::vector<double>{0.5, 0.5, 0.5, 6, 6, -10, 14}));
}

TEST_F(probe, EnginesAgree) {
  write("points.txt", "0.3 0.2 0.9\n0.71 0.5 0.123\n");
  EXPECT_RUNS(run({"compress", "field:smooth", "s.hbv", "--level", "6"}));
  const auto direct = rows(run({"probe", "s.hbv", "--points", "points.txt", "--engine", "direct"}));
  const auto combination = rows(run({"probe", "s.hbv", "--points", "points.txt", "--engine", "combination"}));
  const auto seminodal = rows(run({"probe", "s.hbv", "--points", "points.txt"}));
  const auto truth = rows(run({"probe", "field:smooth", "--points", "points.txt"}));
  ASSERT_EQ(direct.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    // 46 grids with coefficients of at most 2, a dozen roundings each of values below 3.
    EXPECT_NEAR(direct[i][3], combination[i][3], 46 * 2 * 12 * 3 * 0x1p-24);
    EXPECT_NEAR(direct[i][3], seminodal[i][3], 46 * 2 * 12 * 3 * 0x1p-24); // fewer terms
    // Interpolation: n^2 h^2 with h = 1/64 bounds this smooth function's error amply.
    EXPECT_NEAR(direct[i][3], truth[i][3], 36.0 / 4096.0);
  }
}

TEST_F(probe, RefusesBadPointsEnginesAndComponents) {
  write("good.txt", "0 0 0\n");
  for (const char* text : {"0 0\n", "0 0 0 0\n", "0 zero 0\n", "0 0 1e999\n", "nan 0 0\n", "0 0 0x\n", "inf 0 0\n"}) {
    write("bad.txt", std::string("0.5 0.5 0.5\n") + text);
    expectFailureLeavesAll({"probe", "field:ball", "--points", "bad.txt"}, 1, "bad.txt: line 2");
  }
  const std::string zeros("\0\0\0", 3);
  write("zeros.txt", zeros);
  expectFailureLeavesAll({"probe", "field:ball", "--points", "zeros.txt"}, 1, "zeros.txt: line 1");
  std::filesystem::create_directory(folder_ / "folder");
  expectFailureLeavesAll({"probe", "field:ball", "--points", "folder"}, 1, "folder");
  expectFailureLeavesAll({"probe", "field:ball", "--points", "none.txt"}, 1, "none.txt");
  expectFailureLeavesAll({"probe", "field:ball", "--points", "good.txt", "--component", "1"}, 1, "--component");
  expectFailureLeavesAll({"probe", "field:ball", "--points", "good.txt", "--component", "-1"}, 2, "--component");
  expectFailureLeavesAll({"probe", "field:ball", "--points", "good.txt", "--engine", "direct"}, 1, "direct");
  expectFailureLeavesAll({"probe", "field:ball", "--points", "good.txt", "--engine", "fast"}, 1, "fast");
  expectFailureLeavesAll({"probe", "field:ball", "--points", "good.txt", "--space", "outer"}, 2, "--space");
  write("none.txt", "# nothing\n");
  EXPECT_EQ(rows(run({"probe", "field:ball", "--points", "none.txt"})).size(), 0U);
}
