// The engine opengl of `render`. What its pictures are is in tests/glcombine; here, that the options arrive.

#include <algorithm>

#include <fmt/format.h>

#include "scene/hbPictureFile.h"
#include "tests/apps/hbAppTest.h"

class renderOpenGl : public hbAppTest {
protected:
  void SetUp() override { EXPECT_RUNS(run({"compress", "field:smooth,size=33", "s.hbv", "--level", "5"})); }

  /// Runs `render` at 40 x 30 pixels and 16 planes with more options, and gives its statistics.
  nlohmann::json drawn(const std::string& picture, const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"render",      "s.hbv", picture,      "--size",    "40x30",   "--samples", "16",
                                       "--elevation", "35",    "--sampling", "planewise", "--stats", "s.json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_RUNS(run(arguments));
    return json("s.json");
  }
  double difference(const std::string& a, const std::string& b) const {
    return run({"diff", a, b, "--json"}).json()["max"].get<double>();
  }
};

TEST_F(renderOpenGl, EveryFormDrawsThePlanewisePicture) {
  // 31 grids of weight 2 at the most, 31 additions and 20 roundings each of values below 2, rays shorter than 2;
  // coordinates: 8 roundings times slopes up to 2 * 2^5 of as much.
  const double tolerance = 31.0 * 2 * (31 + 20 + 8 * 2 * 32) * 0x1p-24 * 2 * 2;
  for (const char* mode : {"xray", "mip"}) {
    drawn("cpu.exr", {"--mode", mode});
    for (const std::vector<std::string>& form : std::vector<std::vector<std::string>>{
             {},
             {"--gl-form", "seminodal", "--gl", "egl"},
             {"--gl-form", "fused", "--gl", "osmesa"},
             {"--gl-form", "blend"},
             {"--gl-form", "blend", "--gl-read-back"},
             {"--gl-form", "blend", "--gl-layout", "padded", "--gl-order", "positive-first", "--gl-filter", "exact"}}) {
      std::vector<std::string> options{"--engine", "opengl", "--mode", mode};
      options.insert(options.end(), form.begin(), form.end());
      const auto stats = drawn("gl.exr", options);
      EXPECT_LE(difference("cpu.exr", "gl.exr"), tolerance) << fmt::format("{}", fmt::join(options, " "));
      EXPECT_EQ(*hb::readExr(folder_ / "gl.exr").find("A"), *hb::readExr(folder_ / "cpu.exr").find("A"));
      EXPECT_EQ(stats["gl_form"], form.empty() ? "seminodal" : form[1]);
    }
  }
}

TEST_F(renderOpenGl, EveryFormShowsColourAndOpacity) {
  // A value as above. It moves a ray's optical depth, of at most 2 / 0.1 unit lengths, by the slope of -ln(1 - opacity)
  // of density, which is at most 0.53 / 0.5, and colours by less than 8; slabs of 1/16 of the depth between two values
  // move by either, and have those depths.
  const double tolerance = 31.0 * 2 * (31 + 20 + 8 * 2 * 32) * 0x1p-24 * 2 * (2 / 0.1 * 1.06 + 8);
  EXPECT_LT(tolerance, 0.15);
  for (const bool isPreintegrated : {false, true}) {
    std::vector<std::string> options{"--mode",           "dvr", "--transfer",    "density",
                                     "--transfer-range", "0,1", "--unit-length", "0.1"};
    if (isPreintegrated) options.emplace_back("--preintegrate");
    drawn("cpu.exr", options);
    options.insert(options.end(), {"--engine", "opengl", "--gl-form", ""});
    for (const char* form : {"seminodal", "fused", "blend"}) {
      options.back() = form;
      EXPECT_EQ(drawn("gl.exr", options)["mode"], "dvr");
      EXPECT_LE(difference("cpu.exr", "gl.exr"), tolerance) << form;
      for (const char* name : {"R", "G", "B", "A", "Y"})
        EXPECT_NE(hb::readExr(folder_ / "gl.exr").find(name), nullptr) << name;
    }
    options.emplace_back("--gl-read-back");
    drawn("back.exr", options);
    EXPECT_LE(difference("cpu.exr", "back.exr"), tolerance);
  }
}

TEST_F(renderOpenGl, StatisticsNameTheDeviceAndTheTextures) {
  auto stats = drawn("gl.exr", {"--engine", "opengl", "--mode", "iso", "--iso", "0.5"});
  EXPECT_EQ(stats["engine"], "opengl");
  EXPECT_EQ(stats["sampling"], "planewise");
  EXPECT_EQ(stats["texture_bytes"], 4 * 1505); // level 5's stored values
  EXPECT_EQ(stats["gl_context"], "osmesa");
  for (const char* key : {"gl_vendor", "gl_renderer", "gl_version"}) EXPECT_FALSE(stats[key].empty()) << key;
  EXPECT_EQ(hb::readExr(folder_ / "gl.exr").metadata.at("hbvol.engine"), "opengl");

  const std::vector<std::string> blend{"--engine", "opengl", "--gl-form", "blend"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), blend.begin(), blend.end());
    return more;
  };
  stats = drawn("r16.exr", with({"--gl-textures", "r16", "--gl-target", "r16", "--gl-layout", "padded"}));
  EXPECT_EQ(stats["texture_bytes"], 2 * 22016);
  EXPECT_EQ(stats["texture_bytes_resident"], 2 * 22016);
  drawn("r32f.exr", blend);
  EXPECT_GT(difference("r32f.exr", "r16.exr"), 0.0);
  // With the limits of the paper's machines named, or handed over again and again.
  stats = drawn("streamed.exr", with({"--texture-memory", "10kB", "--stream"}));
  EXPECT_EQ(stats["texture_bytes"], 4 * 5687);
  EXPECT_LE(stats["texture_bytes_resident"], 10 * 1024);
  EXPECT_EQ(difference("r32f.exr", "streamed.exr"), 0.0);
}

TEST_F(renderOpenGl, RefusesWhatItCannotDo) {
  const auto refused = [&](const std::vector<std::string>& more, int code, std::string_view words) {
    std::vector<std::string> arguments{"render", "s.hbv", "x.exr", "--size", "4x4"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    expectFailureLeavesAll(arguments, code, words);
  };
  expectFailureLeavesAll({"render", "field:ball", "x.exr", "--engine", "opengl"}, 1,
                         "the engine opengl cannot evaluate an analytic field");
  refused({"--gl", "osmesa"}, 1, "--gl: expected --engine opengl with it");
  refused({"--stream"}, 1, "--stream: expected --engine opengl with it");
  refused({"--engine", "opengl", "--stream"}, 1, "--stream: expected --gl-form blend with it, found seminodal");
  refused({"--engine", "opengl", "--gl-form", "fused", "--gl-target", "r8"}, 1, "--gl-target");
  refused({"--engine", "opengl", "--gl-form", "fast"}, 2, "--gl-form");
  refused({"--engine", "opengl", "--sampling", "equidistant"}, 1,
          "--sampling: expected planewise with --engine opengl");
  refused({"--engine", "opengl", "--gl", "glx"}, 2, "--gl");
  refused({"--engine", "opengl", "--gl-form", "blend", "--gl-target", "r12"}, 2, "--gl-target");
  refused({"--engine", "opengl", "--gl-form", "blend", "--gl-target", "r8", "--gl-order", "interleaved"}, 1,
          "order of blending: expected positive terms first for the target r8");
  refused({"--engine", "opengl", "--texture-memory", "0"}, 2, "--texture-memory");
  refused({"--engine", "opengl", "--texture-memory", "6019"}, 1,
          "expected memory for 6020 bytes, found a limit of 6019");
  refused({"--engine", "opengl", "--gl-form", "blend", "--texture-memory", "22747"}, 1,
          "expected memory for 22748 bytes, found a limit of 22747 (streaming needs 1188)");
  refused({"--engine", "opengl", "--component", "magnitude"}, 1, "magnitude");
  expectFailureLeavesAll({"render", "s.hbv", "x.exr", "--engine", "opengl", "--size", "4000x4000", "--memory", "1GB"},
                         1, "x.exr: needs about");
}
