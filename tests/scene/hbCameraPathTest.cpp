#include "scene/hbCameraPath.h"

#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "volume/hbError.h"

namespace {

std::string errorOf(const std::string& text) {
  try {
    hb::pathFromJson(text, "p.json");
  } catch (const hbError& e) {
    return e.what();
  }
  return "";
}

} // namespace

TEST(hbCameraPath, AnOrbitOfAFramingGoesThroughItsAzimuths) {
  hbGeometry g;
  g.size = {5, 9, 7};
  g.origin = {3.0, -1.0, 2.0};
  const std::vector<hbCamera> cameras = hb::orbit(hbCamera::framing(g, 40.0, 20.0), 8);
  ASSERT_EQ(cameras.size(), 8U);
  for (int i = 0; i < 8; ++i) {
    const hbCamera& camera = cameras[std::size_t(i)];
    // Framings stand at other distances, in the same direction.
    const hbCamera framed = hbCamera::framing(g, 40.0 + 45.0 * i, 20.0);
    EXPECT_LT(glm::length(camera.viewAxis() - framed.viewAxis()), 1e-14) << i;
    EXPECT_LT(glm::length(camera.up - framed.up), 1e-14) << i;
    EXPECT_NEAR(glm::length(camera.position - camera.target), glm::length(cameras[0].position - camera.target), 1e-13);
  }
  hbCamera level;
  level.position = {0.0, 0.0, 3.0};
  level.up = {0.0, 2.0, 0.0};
  for (const hbCamera& camera : hb::orbit(level, 3)) EXPECT_LT(glm::length(camera.up - level.up), 1e-15);
  EXPECT_EQ(hb::orbit(cameras[0], 1), std::vector{cameras[0]});
  EXPECT_THROW(hb::orbit(cameras[0], 0), hbError);
}

TEST(hbCameraPath, JsonRoundTripsExactly) {
  std::vector<hbCamera> cameras = hb::orbit({}, 3);
  cameras[1].projection = hbCamera::Projection::orthographic;
  cameras[1].height = 1.0 / 3.0;
  const std::string text = hb::toJson(cameras);
  EXPECT_EQ(hb::pathFromJson(text, "p.json"), cameras);
  const auto path = std::filesystem::path(testing::TempDir()) / "hbCameraPathTest.json";
  hb::savePath(cameras, path);
  EXPECT_EQ(hb::loadPath(path), cameras);
  cameras[2].up = glm::dvec3(0.0);
  EXPECT_THROW(hb::toJson(cameras), hbError);
}

TEST(hbCameraPath, ErrorsNameTheCamera) {
  EXPECT_EQ(errorOf(R"({"cameras": []})"), "p.json: version: expected, but missing");
  EXPECT_EQ(errorOf(R"({"version": 1})"), "p.json: cameras: expected, but missing");
  EXPECT_EQ(errorOf(R"({"version": 1, "cameras": []})"),
            "p.json: cameras: expected an array of 1 to 100000 objects, found an array");
  EXPECT_EQ(errorOf(R"({"version": 1, "cameras": [{"position": [0, 1, 2]}]})"),
            "p.json: cameras: 0: target: expected, but missing");
  EXPECT_EQ(errorOf(R"({"version": 1, "cameras": [{"position": [1, 0, 0], "target": [0, 0, 0]},
                                                  {"position": [1, 0, 0], "target": [1, 0, 0]}]})"),
            "p.json: cameras: 1: target: expected a point a finite distance from the position, found 0");
}
