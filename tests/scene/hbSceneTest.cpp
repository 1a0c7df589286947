#include "scene/hbScene.h"

#include <cmath>
#include <fstream>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "volume/hbError.h"

namespace {

hbScene everythingSet() {
  hbScene scene;
  scene.mode = hbMode::iso;
  scene.camera.emplace();
  scene.camera->projection = hbCamera::Projection::orthographic;
  scene.camera->position = {0.1, -1.0 / 3.0, 1e-7};
  scene.camera->height = 12.5;
  scene.sampling = {hbSampling::Kind::planewise, 300};
  scene.isoValue = -1024.1;
  scene.window = {-0.1, 1e30};
  scene.colormap = "cubehelix";
  scene.transfer = hbTransferFunction::preset("ct-bone").withUnitLength(1.0 / 3.0);
  scene.preintegrated = true;
  scene.shading.emplace();
  scene.shading->specular = 1.0 / 7.0;
  scene.shading->lights = {{{1.0, -2.0, 1.0 / 3.0}, {1.0, 0.5, 0.25}}, {{0.0, 0.0, 9.0}}};
  scene.gradientOpacity = {0.1, 1e9};
  scene.clip = {{0.1, 0.0, 0.0}, {1.0, 1.0 / 3.0, 1.0}};
  scene.slice = {{0.1, 0.2, 0.3}, {0.0, -1.0, 1e-5}};
  scene.background = {0.1, 1.0, 1.0 / 3.0};
  scene.labels = true;
  scene.preintegrated = false;
  scene.component = 2;
  scene.magnitude = true;
  scene.width = 640;
  scene.height = 480;
  return scene;
}

std::string errorOf(const std::string& text) {
  try {
    hb::sceneFromJson(text, "s.json");
  } catch (const hbError& e) {
    return e.what();
  }
  return "";
}

std::filesystem::path temporary(const char* name) { return std::filesystem::path(testing::TempDir()) / name; }

} // namespace

TEST(hbScene, JsonRoundTripsExactly) {
  hbScene slabs = everythingSet(); // which labels cannot have
  slabs.labels = false;
  slabs.preintegrated = true;
  for (const hbScene& scene : {hbScene{}, everythingSet(), slabs}) {
    const std::string text = hb::toJson(scene);
    EXPECT_EQ(hb::sceneFromJson(text, "s.json"), scene);
    EXPECT_EQ(hb::toJson(hb::sceneFromJson(text, "s.json")), text);
  }
}

TEST(hbScene, MissingKeysKeepTheirDefaults) {
  EXPECT_EQ(hb::sceneFromJson(R"({"version": 1})", "s.json"), hbScene{});
  const hbScene scene =
      hb::sceneFromJson(R"({"version": 1, "camera": {"position": [1, 2, 3], "target": [0, 0, 0]}})", "s.json");
  EXPECT_EQ(scene.camera->position, glm::dvec3(1, 2, 3));
  EXPECT_EQ(scene.camera->projection, hbCamera::Projection::perspective);
}

TEST(hbScene, SavesAndLoads) {
  const auto path = temporary("hbSceneTest.json");
  hb::saveScene(everythingSet(), path);
  EXPECT_EQ(hb::loadScene(path), everythingSet());
  EXPECT_THROW(hb::loadScene(temporary("hbSceneTest-missing.json")), hbError);
  EXPECT_THROW(hb::saveScene(hbScene{}, temporary("no-such-folder") / "s.json"), hbError);
}

TEST(hbScene, RefusesLargeFilesUnread) {
  const auto path = temporary("hbSceneTest-large.json");
  std::ofstream(path) << std::string((1 << 20) + 1, ' ');
  EXPECT_THROW(hb::loadScene(path), hbError);
}

TEST(hbScene, ErrorsNameTheFileAndTheKey) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"[]", "s.json: expected an object, found an array"},
      {"{}", "s.json: version: expected, but missing"},
      {R"({"version": 2})", "s.json: version: expected 1, found 2"},
      {R"({"version": 1, "colour": 3})",
       "s.json: colour: unknown key; known are version, mode, camera, sampling, "
       "isoValue, window, colormap, transfer, preintegrated, shading, gradientOpacity, clip, slice, background, "
       "labels, component, magnitude, width, height"},
      {R"({"version": 1, "mode": "best"})", "s.json: mode: expected xray, mip, iso, dvr or slice, found \"best\""},
      {R"({"version": 1, "mode": 3})", "s.json: mode: expected a string, found 3"},
      {R"({"version": 1, "width": 0})", "s.json: width: expected 1 to 16384, found 0"},
      {R"({"version": 1, "height": 16385})", "s.json: height: expected 1 to 16384, found 16385"},
      {R"({"version": 1, "width": 512.0})", "s.json: width: expected an integer of 32 bits, found 512.0"},
      {R"({"version": 1, "width": 18446744073709551615})",
       "s.json: width: expected an integer of 32 bits, found 18446744073709551615"},
      {R"({"version": 1, "component": -1})", "s.json: component: expected 0 to 2147483647, found -1"},
      {R"({"version": 1, "magnitude": 1})", "s.json: magnitude: expected true or false, found 1"},
      {R"({"version": 1, "isoValue": null})", "s.json: isoValue: expected a number, found null"},
      {R"({"version": 1, "window": [1, 1]})",
       "s.json: window: expected two finite numbers, the first less than the second, found 1, 1"},
      {R"({"version": 1, "window": [1]})", "s.json: window: expected an array of 2 numbers, found an array"},
      {R"({"version": 1, "window": [1, "2"]})", "s.json: window: expected a number, found \"2\""},
      {"{\"version\": 1, \"colormap\": \"a\\nb\"}",
       "s.json: colormap: expected one of gray, inverse-gray, heat, cubehelix, coolwarm, found 'a?b'"},
      {R"({"version": 1, "sampling": {"kind": "random"}})",
       "s.json: sampling: kind: expected equidistant or planewise, found \"random\""},
      {R"({"version": 1, "sampling": {"samples": -1}})", "s.json: sampling: samples: expected 0 to 1048576, found -1"},
      {R"({"version": 1, "shading": {"light": []}})",
       "s.json: shading: light: unknown key; known are ambient, diffuse, specular, shininess, lights"},
      {R"({"version": 1, "shading": {"ambient": -1}})", "s.json: shading: ambient: expected 0 to 1000, found -1"},
      {R"({"version": 1, "shading": {"lights": {}}})",
       "s.json: shading: lights: expected an array of at most 8 objects, found an object"},
      {R"({"version": 1, "shading": {"lights": [{"color": [1, 1, 1]}]}})",
       "s.json: shading: lights: position: expected, but missing"},
      {R"({"version": 1, "labels": true, "preintegrated": true})",
       "s.json: preintegrated: expected false for labels, between which there is nothing to integrate"},
      {R"({"version": 1, "gradientOpacity": [2, 1]})",
       "s.json: gradientOpacity: expected two numbers from 0 on, the first less than the second, found 2, 1"},
      {R"({"version": 1, "clip": {"lo": [0, 0.5, 0], "hi": [1, 0.5, 1]}})",
       "s.json: clip: expected a box of some size within 0 to 1, found 0.5 to 0.5 along axis y"},
      {R"({"version": 1, "slice": {"point": [0, 0, 0]}})", "s.json: slice: normal: expected, but missing"},
      {R"({"version": 1, "slice": {"point": [0, 0, 0], "normal": [0, 0, 0]}})",
       "s.json: slice: expected a finite point and a finite normal other than 0"},
      {R"({"version": 1, "sampling": 5})", "s.json: sampling: expected an object, found 5"},
      {R"({"version": 1, "camera": {"target": [0, 0, 0]}})", "s.json: camera: position: expected, but missing"},
      {R"({"version": 1, "camera": {"position": [0, 0], "target": [0, 0, 0]}})",
       "s.json: camera: position: expected an array of 3 numbers, found an array"},
      {R"({"version": 1, "camera": {"position": [0, 0, 1], "target": [0, 1, 0], "projection": "orthographic"}})",
       "s.json: camera: height: expected, but missing"},
      {R"({"version": 1, "camera": {"position": [1, 0, 0], "target": [0, 0, 0], "fieldOfView": 180}})",
       "s.json: camera: fieldOfView: expected degrees inside (0, 180), found 180"},
      {"{\n  \"version\": 1,\n  \"isoValue\": 1e999}",
       "s.json: line 3, column 15: expected a number in the range of 64-bit floats, found 1e999"},
  };
  for (const auto& [text, message] : cases) EXPECT_EQ(errorOf(text), message);
}

TEST(hbScene, SyntaxErrorsNameLineAndColumn) {
  EXPECT_EQ(errorOf("{\n  \"version\": 1,\n  oops\n}").substr(0, 25), "s.json: line 3, column 3:");
  EXPECT_EQ(errorOf("").substr(0, 25), "s.json: line 1, column 1:");
  EXPECT_EQ(errorOf("{\"version\": NaN}").substr(0, 25), "s.json: line 1, column 13");
}

TEST(hbScene, RefusesToWriteWhatItWouldNotRead) {
  const auto with = [](auto change) {
    hbScene scene = everythingSet();
    change(scene);
    return scene;
  };
  constexpr double kInf = std::numeric_limits<double>::infinity();
  EXPECT_THROW(hb::toJson(with([&](auto& s) { s.isoValue = kInf; })), hbError);
  EXPECT_THROW(hb::toJson(with([&](auto& s) { s.isoValue = std::nan(""); })), hbError);
  EXPECT_THROW(hb::toJson(with([&](auto& s) { s.window = {0.0, kInf}; })), hbError);
  EXPECT_THROW(hb::toJson(with([&](auto& s) { s.width = 0; })), hbError);
  EXPECT_THROW(hb::toJson(with([&](auto& s) { s.gradientOpacity = {0.0, kInf}; })), hbError);
  EXPECT_THROW(hb::toJson(with([&](auto& s) { s.clip->lo.z = -0.1; })), hbError);
  EXPECT_THROW(hb::toJson(with([&](auto& s) { s.slice->point.z = kInf; })), hbError);
  EXPECT_THROW(hb::toJson(with([&](auto& s) { s.colormap = "jet"; })), hbError);
  EXPECT_THROW(hb::toJson(with([&](auto& s) { s.sampling.samples = hbSampling::kMaxSamples + 1; })), hbError);
  EXPECT_THROW(hb::toJson(with([&](auto& s) { s.camera->height = -1; })), hbError);
}

RC_GTEST_PROP(hbScene, AnyDamageGivesASceneOrAOneLineError, ()) {
  std::string text = hb::toJson(everythingSet());
  const int changes = *rc::gen::inRange(1, 5);
  for (int i = 0; i < changes; ++i) {
    const auto at = *rc::gen::inRange<std::size_t>(0, text.size() + 1);
    const auto bytes = *rc::gen::oneOf(rc::gen::element<std::string>("{", "}", "[", "]", "\"", ",", ":", "null", "-",
                                                                     "1e400", "\n", "\\u0000", "9", "true"),
                                       rc::gen::container<std::string>(1, rc::gen::arbitrary<char>()));
    text.replace(at, std::min<std::size_t>(*rc::gen::inRange<std::size_t>(0, 4), text.size() - at), bytes);
  }
  try {
    const hbScene scene = hb::sceneFromJson(text, "s.json");
    RC_ASSERT(hb::sceneFromJson(hb::toJson(scene), "again") == scene);
  } catch (const hbError& e) {
    const std::string message = e.what();
    RC_ASSERT(message.starts_with("s.json: "));
    RC_ASSERT(message.find('\n') == std::string::npos);
    RC_ASSERT(message.size() < 600U);
  }
}

TEST(hbScene, DeepNestingIsRefusedWithoutRecursion) {
  EXPECT_THROW(hb::sceneFromJson(std::string(500000, '['), "s.json"), hbError);
  EXPECT_THROW(hb::sceneFromJson(std::string(100000, '[') + std::string(100000, ']'), "s.json"), hbError);
}

TEST(hbScene, TheDefaultCameraFramesTheVolumeForThePicturesShape) {
  hbGeometry g;
  g.size = {9, 9, 9};
  hbScene scene;
  scene.width = 200;
  scene.height = 100;
  EXPECT_EQ(scene.cameraFor(g), hbCamera::framing(g, 30.0, 20.0, hbCamera::Projection::perspective, 2.0));
  EXPECT_EQ(everythingSet().cameraFor(g), *everythingSet().camera);
}

TEST(hbScene, TransferFunctionsAndBackgroundsAreChecked) {
  EXPECT_EQ(errorOf(R"({"version": 1, "background": [0, 2, 0]})"),
            "s.json: background: expected channels in [0,1], found 2");
  EXPECT_TRUE(errorOf(R"({"version": 1, "background": 1})").starts_with("s.json: background: expected an array"));
  EXPECT_TRUE(errorOf(R"({"version": 1, "transfer": []})").starts_with("s.json: transfer: expected an object"));
  const std::string nothing = errorOf(R"({"version": 1, "transfer": {"ColorSpace": "RGB"}})");
  EXPECT_TRUE(nothing.starts_with("s.json: transfer")) << nothing;
}
