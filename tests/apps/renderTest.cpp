#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "raycast/hbInput.h"
#include "scene/hbPictureFile.h"
#include "scene/hbScene.h"
#include "scene/hbTransferFunctionFile.h"
#include "sparsegrid/hbRoundingBounds.h"
#include "tests/apps/hbAppTest.h"
#include "volume/hbInstructionSet.h"

class render : public hbAppTest {
protected:
  hbPicture picture(const std::string& name) const { return hb::readExr(folder_ / name); }

  static std::ptrdiff_t covered(const hbPicture& picture) {
    const std::vector<float>& a = *picture.find("A");
    return std::count(a.begin(), a.end(), 1.0F);
  }
};

TEST_F(render, MakesAPictureWhenAskedForNothing) {
  EXPECT_RUNS(run({"render", "field:smooth", "r.exr", "--stats", "s.json"}));
  const hbPicture made = picture("r.exr");
  EXPECT_EQ(made.width, 512);
  EXPECT_EQ(made.height, 512);
  EXPECT_GT(covered(made), 512 * 512 / 4);
  const auto stats = json("s.json");
  EXPECT_EQ(stats["engine"], "full");
  EXPECT_EQ(stats["mode"], "xray");
  EXPECT_EQ(stats["width"], 512);
  EXPECT_EQ(stats["height"], 512);
  EXPECT_GT(stats["samples"], 128);
  for (const char* key :
       {"seconds_load", "seconds_build", "seconds_frame_median", "memory_growth_bytes", "texture_bytes", "threads"})
    EXPECT_TRUE(stats[key].is_number()) << key;
  EXPECT_TRUE(stats["compressed_bytes"].is_null());
  EXPECT_TRUE(stats.contains("gl_renderer"));
}

TEST_F(render, WritesPngAndScenes) {
  EXPECT_RUNS(run({"compress", "field:marschner-lobb", "m.hbv", "--level", "5"}));
  EXPECT_RUNS(run({"render", "m.hbv", "m.png", "--mode", "mip", "--size", "40x30", "--azimuth", "70", "--zoom", "1.5",
                   "--save-scene", "scene.json", "--window", "0,1", "--colormap", "cubehelix", "--projection",
                   "orthographic"}));
  const hbImage8 image = hb::readPng(folder_ / "m.png");
  EXPECT_EQ(image.width, 40);
  EXPECT_EQ(image.height, 30);
  const hbScene scene = hb::loadScene(folder_ / "scene.json");
  EXPECT_EQ(scene.mode, hbMode::mip);
  EXPECT_EQ(scene.camera->projection, hbCamera::Projection::orthographic);
  // The scene alone gives the same picture again.
  EXPECT_RUNS(run({"render", "m.hbv", "again.png", "--scene", "scene.json", "--stats", "s.json", "--repeat", "3"}));
  EXPECT_EQ(bytes("again.png"), bytes("m.png"));
  const auto stats = json("s.json");
  EXPECT_EQ(stats["engine"], "seminodal");
  EXPECT_EQ(stats["instruction_set"], hb::instructionSet());
  EXPECT_EQ(stats["repeat"], 3);
  EXPECT_EQ(stats["compressed_bytes"], std::filesystem::file_size(folder_ / "m.hbv"));
  EXPECT_LE(stats["seconds_frame_min"], stats["seconds_frame_median"]);
  EXPECT_LE(stats["seconds_frame_median"], stats["seconds_frame_max"]);
}

TEST_F(render, EnginesAgree) {
  EXPECT_RUNS(run({"compress", "field:smooth", "s.hbv", "--level", "5"}));
  for (const char* mode : {"xray", "mip"}) {
    for (const char* engine : {"direct", "combination", "seminodal"})
      EXPECT_RUNS(run({"render", "s.hbv", fmt::format("{}.exr", engine), "--engine", engine, "--mode", mode, "--size",
                       "40x30", "--samples", "16"}));
    // 31 grids with coefficients of at most 2, a dozen roundings each of values below 2; rays shorter than 2. The
    // semi-nodal sum has fewer terms, and all of them positive weights.
    for (const char* other : {"combination.exr", "seminodal.exr"})
      EXPECT_LT(run({"diff", "direct.exr", other, "--json"}).json()["max"].get<double>(), 31 * 2 * 12 * 2 * 2 * 0x1p-24)
          << mode << " " << other;
  }
}

TEST_F(render, ColourAndOpacityAgreeAmongEngines) {
  EXPECT_RUNS(run({"compress", "field:smooth", "s.hbv", "--level", "5"}));
  for (const char* engine : {"direct", "combination", "seminodal"})
    EXPECT_RUNS(run({"render", "s.hbv", fmt::format("{}.exr", engine), "--engine", engine, "--mode", "dvr", "--size",
                     "40x30", "--samples", "16", "--transfer", "density", "--transfer-range", "0,1", "--unit-length",
                     "0.1", "--save-scene", "scene.json"}));
  // A ray shorter than 2 has an optical depth of at most 20 times that of density's 0.5, and a value's error (as in
  // EnginesAgree, without the length) changes the depth by the slope of -ln(1 - opacity), at most 0.53 / 0.5, and
  // colours by less than 8 in linear light.
  const double value = 31 * 2 * 12 * 2 * 0x1p-24;
  for (const char* other : {"combination.exr", "seminodal.exr"})
    EXPECT_LT(run({"diff", "direct.exr", other, "--json"}).json()["max"].get<double>(), value * (20 * 1.06 + 8))
        << other;
  const hbPicture made = picture("direct.exr");
  for (const char* name : {"R", "G", "B", "A", "Y"}) EXPECT_NE(made.find(name), nullptr) << name;
  const hbScene scene = hb::loadScene(folder_ / "scene.json");
  EXPECT_EQ(scene.transfer->name(), "density");
  EXPECT_EQ(scene.transfer->range(), std::pair(0.0, 1.0));
  EXPECT_EQ(scene.transfer->definition().unitLength, 0.1);
  // The scene alone gives the same picture again, and the file that holds its function, too.
  EXPECT_RUNS(run({"render", "s.hbv", "again.exr", "--engine", "seminodal", "--scene", "scene.json"}));
  EXPECT_EQ(picture("again.exr").channels, picture("seminodal.exr").channels);
  hb::saveTransferFunctions(std::array{hbTransferFunction::preset("fire"), *scene.transfer}, folder_ / "maps.json");
  EXPECT_RUNS(run({"render", "s.hbv", "again.exr", "--mode", "dvr", "--size", "40x30", "--samples", "16", "--transfer",
                   "maps.json:density"}));
  EXPECT_EQ(picture("again.exr").channels, picture("seminodal.exr").channels);
}

// Along an axis slices are the planes of planewise ray casting, and pixels the rays of the lattice.
TEST_F(render, TheLatticeEngineDrawsColourAndOpacity) {
  EXPECT_RUNS(run({"compress", "field:smooth,size=33", "s.hbv", "--level", "5"}));
  const hbInput input = hbInput::open(path("s.hbv"), {});
  const hbSparseGrid& grid = input.sparse->grid;
  const double value = hb::latticeBound(grid) + hb::semiNodalBound(grid);
  for (const bool isPreintegrated : {false, true}) {
    for (const char* engine : {"lattice", "seminodal"}) {
      std::vector<std::string> arguments{"render",
                                         "s.hbv",
                                         fmt::format("{}.exr", engine),
                                         "--engine",
                                         engine,
                                         "--mode",
                                         "dvr",
                                         "--size",
                                         "41x31",
                                         "--samples",
                                         "16",
                                         "--sampling",
                                         "planewise",
                                         "--azimuth",
                                         "90",
                                         "--elevation",
                                         "0",
                                         "--projection",
                                         "orthographic",
                                         "--transfer",
                                         "density",
                                         "--transfer-range",
                                         "0,1",
                                         "--unit-length",
                                         "0.1"};
      if (isPreintegrated) arguments.push_back("--preintegrate");
      EXPECT_RUNS(run(arguments));
    }
    // As in ColourAndOpacityAgreeAmongEngines, a slab having two values; and the caster's rays end where they are
    // opaque.
    EXPECT_LT(run({"diff", "lattice.exr", "seminodal.exr", "--json"}).json()["max"].get<double>(),
              2 * value * (20 * 1.06 + 8) + 0x1p-10 + 0x1p-20);
    const hbPicture made = picture("lattice.exr");
    EXPECT_GT(*std::ranges::max_element(*made.find("A")), 0.5F);
  }
  // From an angle, with a scene of its own.
  EXPECT_RUNS(run({"render", "s.hbv", "o.png", "--engine", "lattice", "--mode", "dvr", "--size", "41x31",
                   "--supersample", "2", "--stats", "s.json"}));
  EXPECT_EQ(json("s.json")["engine"], "lattice");
  EXPECT_EQ(json("s.json")["mode"], "dvr");
}

TEST_F(render, ColourAndOpacityNeedNoOptions) {
  EXPECT_RUNS(
      run({"render", "field:hydrogen,size=33", "r.png", "--mode", "dvr", "--size", "30x30", "--background", "1,1,1"}));
  const hbImage8 image = hb::readPng(folder_ / "r.png");
  EXPECT_EQ(image.rgb[0], 255); // beside the volume
  EXPECT_LT(*std::min_element(image.rgb.begin(), image.rgb.end()), 200);
  write("table.txt", "# value r g b opacity\n0 1 0 0 0.5\n1 1 0 0 0.5\n");
  EXPECT_RUNS(run(
      {"render", "field:hydrogen,size=33", "r.exr", "--mode", "dvr", "--size", "30x30", "--transfer", "table.txt"}));
  const hbPicture made = picture("r.exr");
  const auto greatest = [&](const char* name) {
    return *std::max_element(made.find(name)->begin(), made.find(name)->end());
  };
  EXPECT_EQ(greatest("G"), 0.0F);
  EXPECT_GT(greatest("R"), 0.5F);
}

TEST_F(render, LightsMatter) {
  const auto drawn = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"render", "field:hydrogen,size=33", "r.exr", "--mode", "dvr", "--size", "20x20"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_RUNS(run(arguments));
    return picture("r.exr").channels;
  };
  const auto plain = drawn({}), lit = drawn({"--shade", "--save-scene", "scene.json"});
  EXPECT_NE(lit.at("R"), plain.at("R"));
  EXPECT_EQ(lit.at("A"), plain.at("A"));
  EXPECT_EQ(hb::loadScene(folder_ / "scene.json").shading, hbShading{});
  EXPECT_EQ(drawn({"--scene", "scene.json"}), lit);
  EXPECT_EQ(drawn({"--scene", "scene.json", "--no-shade"}), plain);
  // By ambient light alone, colours are what they are.
  EXPECT_EQ(drawn({"--shading", "1,0,0,1"}), plain);
  drawn({"--light", "1,2,3", "--light", "0,0,9,1,0.5,0", "--save-scene", "scene.json"});
  EXPECT_EQ(hb::loadScene(folder_ / "scene.json").shading->lights,
            (std::vector<hbShading::Light>{{{1, 2, 3}}, {{0, 0, 9}, {1.0, 0.5, 0.0}}}));
  const auto borders = drawn({"--gradient-opacity", "0,1e6"});
  EXPECT_LT(*std::ranges::max_element(borders.at("A")), *std::ranges::max_element(plain.at("A")));
}

TEST_F(render, CutsVolumes) {
  EXPECT_RUNS(run({"render", "field:ball,size=33", "r.exr", "--size", "20x20"}));
  const std::ptrdiff_t whole = covered(picture("r.exr"));
  EXPECT_RUNS(run({"render", "field:ball,size=33", "r.exr", "--size", "20x20", "--clip", "0,1,0.25,0.75,0,0.5"}));
  EXPECT_GT(covered(picture("r.exr")), 20);
  EXPECT_LT(covered(picture("r.exr")), whole);
}

// Each fills the picture but for a margin of 1 % on either side, seen from the front: to the right and upwards values
// grow as they should.
TEST_F(render, SlicesVolumes) {
  writeVolume<float>("v.nrrd", {5, 9, 7}, 1,
                     [](std::int64_t x, std::int64_t y, std::int64_t z, int) { return float(x + 10 * y + 100 * z); });
  const struct {
    const char *plane, *size;
    double middle, right, up; // the value in the middle, and what it grows by over the slice
  } cases[] = {{"x:0.25", "80x60", 341.0, 80.0, 600.0},
               {"y:1", "40x60", 382.0, -4.0, 600.0},
               {"z:0.5", "40x80", 342.0, 4.0, 80.0},
               {"2,8,3,0,-1,0", "40x60", 382.0, 4.0, 600.0}};
  for (const auto& c : cases) {
    EXPECT_RUNS(run({"render", "v.nrrd", "r.exr", "--slice", c.plane, "--size", c.size}));
    const hbPicture made = picture("r.exr");
    const std::vector<float>& y = *made.find("Y");
    const auto at = [&](int px, int py) { return double(y[std::size_t(px + made.width * py)]); };
    // The picture is 1.02 times as large as the slice, and even, so the middle lies between pixels.
    const double stepRight = c.right * 1.02 / made.width, stepUp = c.up * 1.02 / made.height;
    const int px = made.width / 2, py = made.height / 2;
    EXPECT_NEAR(at(px, py), c.middle + 0.5 * stepRight - 0.5 * stepUp, 1e-3) << c.plane;
    EXPECT_NEAR(at(px + 1, py) - at(px, py), stepRight, 1e-3) << c.plane;
    EXPECT_NEAR(at(px, py) - at(px, py + 1), stepUp, 1e-3) << c.plane;
    const auto inside = [](int pixels) { return 2 * int(0.5 * pixels / 1.02 + 0.5); };
    EXPECT_EQ(covered(made), inside(made.width) * inside(made.height)) << c.plane;
  }
  EXPECT_RUNS(run({"render", "v.nrrd", "r.exr", "--slice", "2,4,3,0,1e-200,0", "--size", "40x60"}));
  EXPECT_GT(covered(picture("r.exr")), 1000);
  expectFailureLeavesAll({"render", "v.nrrd", "x.exr", "--slice", "x:1.5"}, 1, "--slice: expected a fraction");
  expectFailureLeavesAll({"render", "v.nrrd", "x.exr", "--slice", "0,0,0,0,0,0"}, 1, "slice: expected a finite point");
  expectFailureLeavesAll({"render", "v.nrrd", "x.exr", "--slice", "w:0"}, 1, "--slice");
  expectFailureLeavesAll({"render", "v.nrrd", "x.exr", "--mode", "slice"}, 1, "--mode slice: expected --slice");
  expectFailureLeavesAll({"render", "v.nrrd", "x.exr", "--mode", "iso", "--slice", "x:0"}, 1,
                         "--slice: expected --mode slice or none, found iso");
  EXPECT_RUNS(run({"compress", "field:ball", "b.hbv", "--level", "2"}));
  for (const char* engine : {"lattice", "opengl"})
    expectFailureLeavesAll({"render", "b.hbv", "x.exr", "--engine", engine, "--slice", "x:0"}, 1,
                           "slice: expected an engine of the ray caster");
}

// Labels 0, 3 and 7 in thirds along x; nothing in between is seen.
TEST_F(render, ShowsLabels) {
  writeVolume<std::uint8_t>("l.nrrd", {6, 4, 4}, 1, [](std::int64_t x, std::int64_t, std::int64_t, int) {
    return x < 2 ? 0 : x < 4 ? 7 : 3;
  });
  EXPECT_RUNS(run({"render", "l.nrrd", "s.exr", "--slice", "z:0.4", "--labels", "--size", "60x40"}));
  const hbPicture slice = picture("s.exr");
  std::set<float> seen;
  for (std::size_t i = 0; i < slice.find("Y")->size(); ++i)
    if ((*slice.find("A"))[i] > 0.0F) seen.insert((*slice.find("Y"))[i]);
  EXPECT_EQ(seen, (std::set<float>{0.0F, 3.0F, 7.0F}));
  EXPECT_RUNS(run({"render", "l.nrrd", "s.png", "--slice", "z:0.4", "--labels", "--size", "60x40"}));
  const hbImage8 image = hb::readPng(folder_ / "s.png");
  std::set<std::array<int, 3>> colours;
  for (std::size_t i = 0; i < image.rgb.size(); i += 3)
    colours.insert({image.rgb[i], image.rgb[i + 1], image.rgb[i + 2]});
  EXPECT_EQ(colours.size(), 3U); // two labels, and the background, which 0 shows, too
  EXPECT_RUNS(run({"render", "l.nrrd", "d.exr", "--mode", "dvr", "--labels", "--size", "30x20", "--azimuth", "0",
                   "--elevation", "0", "--unit-length", "0.5", "--save-scene", "scene.json"}));
  const hbScene scene = hb::loadScene(folder_ / "scene.json");
  EXPECT_TRUE(scene.labels);
  EXPECT_EQ(scene.transfer->name(), "labels");
  EXPECT_EQ(scene.transfer->range(), std::pair(-0.5, 7.5));
  EXPECT_EQ(scene.transfer->definition().unitLength, 0.5);
  const hbPicture lit = picture("d.exr");
  EXPECT_EQ(lit.find("A")->at(30 * 10 + 6), 0.0F);
  EXPECT_GT(lit.find("A")->at(30 * 10 + 15), 0.9F);
  EXPECT_RUNS(run({"render", "l.nrrd", "again.exr", "--scene", "scene.json"}));
  EXPECT_EQ(picture("again.exr").channels, lit.channels);
  EXPECT_RUNS(run({"compress", "l.nrrd", "l.hbv", "--level", "2"}));
  expectFailureLeavesAll({"render", "l.hbv", "x.exr", "--labels"}, 1, "--labels: expected a plain volume");
  expectFailureLeavesAll({"render", "l.nrrd", "x.exr", "--labels", "--mode", "dvr", "--preintegrate"}, 1,
                         "preintegrated: expected false for labels");
  expectFailureLeavesAll({"render", "l.nrrd", "x.exr", "--labels", "--mode", "dvr", "--transfer-range", "0,9"}, 1,
                         "--transfer-range: expected --transfer");
  writeVolume<float>("far.nrrd", {2, 2, 2}, 1,
                     [](std::int64_t x, std::int64_t, std::int64_t, int) { return x == 0 ? -1e20F : 5.0F; });
  expectFailureLeavesAll({"render", "far.nrrd", "x.exr", "--labels", "--mode", "dvr"}, 1, "--labels: expected numbers");
}

TEST_F(render, GoesAroundAndAlongPaths) {
  EXPECT_RUNS(run({"compress", "field:hydrogen", "h.hbv", "--level", "3"}));
  EXPECT_RUNS(run({"render", "h.hbv", "around.exr", "--size", "16x12", "--orbit", "3", "--azimuth", "10", "--repeat",
                   "2", "--save-path", "path.json", "--save-scene", "scene.json", "--stats", "s.json"}));
  EXPECT_EQ(json("s.json")["pictures"], 3);
  EXPECT_EQ(json("path.json")["cameras"].size(), 3U);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "around.exr"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "around-0003.exr"));
  EXPECT_NE(picture("around-0000.exr").channels, picture("around-0001.exr").channels);
  // The first one is what the scene shows; by every engine its own, and a path gives the same pictures again.
  EXPECT_RUNS(run({"render", "h.hbv", "one.exr", "--scene", "scene.json"}));
  EXPECT_EQ(picture("one.exr").channels, picture("around-0000.exr").channels);
  for (const char* engine : {"seminodal", "lattice", "opengl"}) {
    EXPECT_RUNS(run({"render", "h.hbv", "again.exr", "--size", "16x12", "--path", "path.json", "--engine", engine}));
    EXPECT_RUNS(run({"render", "h.hbv", "one.exr", "--scene", "scene.json", "--engine", engine}));
    EXPECT_EQ(picture("again-0000.exr").channels, picture("one.exr").channels) << engine;
    EXPECT_NE(picture("again-0002.exr").channels, picture("one.exr").channels) << engine;
  }
  EXPECT_RUNS(run({"render", "h.hbv", "again.exr", "--size", "16x12", "--path", "path.json"}));
  for (const char* number : {"0000", "0001", "0002"})
    EXPECT_EQ(picture(fmt::format("again-{}.exr", number)).channels,
              picture(fmt::format("around-{}.exr", number)).channels);
  // PNGs of a series have one window.
  EXPECT_RUNS(run({"render", "h.hbv", "p.png", "--size", "16x12", "--path", "path.json", "--mode", "mip"}));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "p-0002.png"));
  expectFailureLeavesAll({"render", "h.hbv", "x.png", "--orbit", "2", "--path", "path.json"}, 2, "--orbit");
  expectFailureLeavesAll({"render", "h.hbv", "x.png", "--orbit", "0"}, 2, "--orbit");
  expectFailureLeavesAll({"render", "h.hbv", "x.json.png", "--orbit", "2", "--save-path", "x.json-0001.png"}, 1,
                         "no picture of the series");
  expectFailureLeavesAll({"render", "h.hbv", "x.png", "--path", "none.json"}, 1, "none.json");
  expectFailureLeavesAll({"render", "h.hbv", "x.png", "--path", "scene.json"}, 1,
                         "unknown key; known are version, cameras");
}

TEST_F(render, RefusesWrongColoursAndOpacities) {
  EXPECT_RUNS(run({"compress", "field:ball", "b.hbv", "--level", "2"}));
  const auto refused = [&](const std::vector<std::string>& more, int code, std::string_view words) {
    std::vector<std::string> arguments{"render", "b.hbv", "x.exr", "--mode", "dvr", "--size", "4x4"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    expectFailureLeavesAll(arguments, code, words);
  };
  refused({"--light", "1,2"}, 1, "--light: expected");
  refused({"--light", "1,2,3,4"}, 1, "--light: expected a place and perhaps a colour");
  refused({"--light", "1,2,3,-1,0,0"}, 1, "shading: lights: color");
  refused({"--shading", "1,1,1"}, 1, "--shading: expected");
  refused({"--shading", "1,1,1,-1"}, 1, "shininess");
  refused({"--no-shade", "--shade"}, 1, "--no-shade");
  refused({"--gradient-opacity", "2,1"}, 1, "gradientOpacity");
  refused({"--clip", "0,1,0,1,1,0"}, 1, "clip: expected a box");
  refused({"--clip", "0,1"}, 1, "--clip");
  refused({"--transfer", "none.json"}, 1, "--transfer: expected a file or one of ct-bone");
  refused({"--transfer", "none.json:bone"}, 1, "none.json");
  write("bad.json", "[{}]");
  refused({"--transfer", "bad.json"}, 1, "bad.json");
  refused({"--transfer-range", "1,0"}, 1, "found 1 to 0");
  refused({"--transfer-range", "1"}, 1, "--transfer-range");
  refused({"--unit-length", "0"}, 2, "--unit-length");
  refused({"--background", "1,1"}, 1, "--background");
  refused({"--background", "2,0,0"}, 1, "background: expected channels in [0,1]");
}

TEST_F(render, TheLatticeEngineDrawsTheSame) {
  EXPECT_RUNS(run({"compress", "field:smooth,size=33", "s.hbv", "--level", "5"}));
  for (const char* mode : {"xray", "mip", "iso"}) {
    // Along an axis slices are the planes of planewise ray casting, and pixels the rays of the lattice.
    for (const char* engine : {"lattice", "seminodal"})
      EXPECT_RUNS(run({"render",       "s.hbv",     fmt::format("{}.exr", engine),
                       "--engine",     engine,      "--mode",
                       mode,           "--size",    "41x31",
                       "--samples",    "16",        "--sampling",
                       "planewise",    "--azimuth", "90",
                       "--elevation",  "0",         "--projection",
                       "orthographic", "--stats",   fmt::format("{}.json", engine)}));
    // Both engines are so far off at the most, times the length of a ray; pictures are floats. (What an iso-surface
    // shows depends on its slopes: hbShearWarpTest.)
    const hbInput input = hbInput::open(path("s.hbv"), {});
    const double values = hb::latticeBound(input.sparse->grid) + hb::semiNodalBound(input.sparse->grid);
    const double largest = hb::amplitude(input.sparse->grid), length = input.geometry().extent().x;
    const double tolerance = (values + 2 * 0x1p-24 * largest) * std::max(1.0, length);
    if (std::string(mode) != "iso") {
      EXPECT_LE(run({"diff", "lattice.exr", "seminodal.exr", "--json"}).json()["max"].get<double>(), tolerance) << mode;
    }
    EXPECT_EQ(covered(picture("lattice.exr")), covered(picture("seminodal.exr")));
    EXPECT_EQ(picture("lattice.exr").metadata.at("hbvol.engine"), "lattice");
  }
  auto stats = json("lattice.json");
  EXPECT_EQ(stats["engine"], "lattice");
  EXPECT_EQ(stats["sampling"], "object-aligned");
  EXPECT_EQ(stats["slices"], nlohmann::json{16});
  EXPECT_EQ(stats["samples"], 16);
  EXPECT_EQ(stats["supersample"], 1);
  stats = json("seminodal.json");
  EXPECT_EQ(stats["sampling"], "planewise");
  EXPECT_FALSE(stats.contains("slices"));
  for (const char* file : {"lattice.json", "seminodal.json"}) {
    stats = json(file);
    EXPECT_GE(stats["seconds_first_picture"].get<double>(),
              stats["seconds_load"].get<double>() + stats["seconds_build"].get<double>() +
                  stats["seconds_frame_median"].get<double>()); // the only frame
  }
  EXPECT_RUNS(run({"render", "s.hbv", "fine.exr", "--engine", "lattice", "--size", "40x30", "--supersample", "3",
                   "--stats", "s.json"}));
  EXPECT_EQ(json("s.json")["supersample"], 3);
}

TEST_F(render, ExtractsFirstWhereAsked) {
  EXPECT_RUNS(run({"compress", "field:smooth,size=17", "s.hbv", "--level", "4"}));
  // A ray casting of the full grid, which the file written first gives, too.
  EXPECT_RUNS(run({"render", "s.hbv", "full.exr", "--engine", "full", "--size", "20x20", "--stats", "s.json"}));
  EXPECT_EQ(json("s.json")["engine"], "full");
  EXPECT_RUNS(run({"extract", "s.hbv", "s.nrrd"}));
  EXPECT_RUNS(run({"render", "s.nrrd", "file.exr", "--size", "20x20"}));
  EXPECT_EQ(picture("full.exr").channels, picture("file.exr").channels);
}

TEST_F(render, AnIsoValueOutsideTheRangeIsAnEmptyPictureAndAWarning) {
  const hbProgramRun made =
      run({"render", "field:smooth", "r.exr", "--mode", "iso", "--iso", "100", "--size", "20x20"});
  EXPECT_EQ(made.exitCode, 0);
  EXPECT_TRUE(made.err.starts_with("hbvol: warning: ")) << made.err;
  EXPECT_EQ(std::count(made.err.begin(), made.err.end(), '\n'), 1) << made.err;
  const hbPicture empty = picture("r.exr");
  const std::vector<float>& a = *empty.find("A");
  EXPECT_TRUE(std::all_of(a.begin(), a.end(), [](float v) { return v == 0.0F; }));
  EXPECT_RUNS(run({"render", "field:smooth", "r.exr", "--mode", "iso", "--iso", "1", "--size", "20x20"}));
  EXPECT_GT(covered(picture("r.exr")), 0);
}

TEST_F(render, ShowsComponentsAndTheirMagnitude) {
  // (3, 4) everywhere: X-ray is the value times the length of the ray.
  writeVolume<float>("v.nrrd", {5, 5, 5}, 2, [](auto, auto, auto, int c) { return 3.0 + c; });
  EXPECT_RUNS(run({"compress", "v.nrrd", "v.hbv"}));
  auto info = run({"info", "v.hbv", "--json"}).json();
  EXPECT_EQ(info["components"], 2);
  EXPECT_EQ(info["errors"].size(), 2U);
  for (const char* input : {"v.nrrd", "v.hbv"})
    for (const auto& [component, value] : {std::pair("0", 3.0), std::pair("1", 4.0), std::pair("magnitude", 5.0)}) {
      // Along -z through the middle: 4 samples' distances, 4 in the world.
      EXPECT_RUNS(run({"render", input, "r.exr", "--component", component, "--size", "1x1", "--camera",
                       "2,2,10,2,2,0,0,1,0", "--projection", "orthographic"}));
      // The sum is in 64 bits; surpluses and values are floats.
      EXPECT_NEAR(picture("r.exr").find("Y")->at(0), 4.0 * value, 32 * 16 * 0x1p-24) << input << " " << component;
    }
  for (const char* component : {"2", "-1", "0.5", "99999999999", "all", "nan"})
    expectFailureLeavesAll({"render", "v.hbv", "x.exr", "--component", component}, 1, "--component");
}

TEST_F(render, FlatVolumesGoThroughTheWholeChain) {
  writeVolume<std::uint8_t>("v.nrrd", {9, 6, 1}, 1, [](auto x, auto y, auto, int) { return double(10 * x + y); });
  EXPECT_RUNS(run({"compress", "v.nrrd", "v.hbv", "--mapping", "aligned", "--index-set", "full"}));
  EXPECT_EQ(run({"info", "v.hbv", "--json"}).json()["dims"], (nlohmann::json{9, 6, 1}));
  EXPECT_RUNS(run({"extract", "v.hbv", "e.nrrd"}));
  const auto difference = run({"diff", "v.nrrd", "e.nrrd", "--json"}).json();
  EXPECT_LT(difference["max"].get<double>(), 0.5);
  for (const char* input : {"v.nrrd", "v.hbv"})
    for (const char* mode : {"xray", "mip", "iso"}) {
      EXPECT_RUNS(run({"render", input, "r.exr", "--mode", mode, "--size", "30x20"}));
      const hbPicture made = picture("r.exr");
      EXPECT_GT(covered(made), 0) << input << " " << mode;
      for (const auto& [name, values] : made.channels)
        EXPECT_TRUE(std::none_of(values.begin(), values.end(), [](float v) { return std::isnan(v); })) << name;
    }
  // Along a line and at a point, too.
  writeVolume<float>("line.nrrd", {7, 1, 1}, 1, [](auto x, auto, auto, int) { return double(x); });
  writeVolume<float>("point.nrrd", {1, 1, 1}, 1, [](auto, auto, auto, int) { return 2.0; });
  for (const char* input : {"line", "point"}) {
    const std::string name(input);
    EXPECT_RUNS(run({"compress", name + ".nrrd", name + ".hbv"}));
    EXPECT_RUNS(run({"render", name + ".hbv", "r.exr", "--size", "9x9"}));
    EXPECT_GT(covered(picture("r.exr")), 0) << input;
    EXPECT_RUNS(run({"extract", name + ".hbv", name + "-e.nrrd"}));
    // A handful of values below 8, rounded a few times.
    EXPECT_LT(run({"diff", name + ".nrrd", name + "-e.nrrd", "--json"}).json()["max"].get<double>(), 64 * 0x1p-24);
  }
}

TEST_F(render, TheCameraMayBeInside) {
  writeVolume<float>("v.nrrd", {5, 5, 5}, 1, [](auto, auto, auto, int) { return 1.0; });
  for (const char* mode : {"xray", "mip"}) {
    // From the middle along x: 2 units to the face.
    EXPECT_RUNS(run({"render", "v.nrrd", "r.exr", "--mode", mode, "--camera", "2,2,2,4,2,2", "--size", "9x9"}));
    const hbPicture made = picture("r.exr");
    EXPECT_EQ(covered(made), 81) << mode;
    // The middle pixel's ray lies on the axis but for rounding.
    EXPECT_NEAR(made.find("Y")->at(40), std::string(mode) == "xray" ? 2.0 : 1.0, 1e-6) << mode;
  }
  // Looking away from a volume behind the camera: nothing to see, and no error.
  EXPECT_RUNS(run({"render", "v.nrrd", "r.exr", "--camera", "10,2,2,20,2,2", "--size", "9x9"}));
  EXPECT_EQ(covered(picture("r.exr")), 0);
  EXPECT_RUNS(run({"render", "v.nrrd", "r.png", "--camera", "10,2,2,20,2,2", "--size", "9x9"}));
}

TEST_F(render, RefusesWhatItCannotDo) {
  EXPECT_RUNS(run({"compress", "field:ball", "b.hbv", "--level", "2"}));
  expectFailureLeavesAll({"render", "field:ball", "x.exr", "--engine", "direct"}, 1, "engine direct");
  expectFailureLeavesAll({"render", "field:ball", "x.exr", "--engine", "combination"}, 1, "engine combination");
  expectFailureLeavesAll({"render", "field:ball", "x.exr", "--engine", "lattice"}, 1,
                         "the engine lattice cannot evaluate an analytic field");
  expectFailureLeavesAll({"render", "b.hbv", "x.exr", "--supersample", "2"}, 1,
                         "--supersample: expected --engine lattice with it, found auto");
  for (const char* supersample : {"0", "9", "1.5"})
    expectFailureLeavesAll({"render", "b.hbv", "x.exr", "--engine", "lattice", "--supersample", supersample}, 2,
                           "--supersample");
  // The grid has few values, but the full one many, and so has a picture's lattice.
  expectFailureLeavesAll({"render", "b.hbv", "x.exr", "--engine", "full", "--memory", "300kB"}, 1, "--memory");
  expectFailureLeavesAll({"render", "b.hbv", "x.exr", "--engine", "lattice", "--size", "400x400", "--supersample", "8",
                          "--memory", "10MB"},
                         1, "x.exr: needs about");
  expectFailureLeavesAll({"render", "b.hbv", "x.exr", "--engine", "fastest"}, 1, "fastest");
  expectFailureLeavesAll({"render", "b.hbv", "x.exr", "--component", "1"}, 1, "--component");
  for (const char* size :
       {"0x5", "5x0", "-5x5", "5", "axb", "5x5x5", "99999x99999", "16385x1", "99999999999999999999x1"})
    expectFailureLeavesAll({"render", "b.hbv", "x.exr", "--size", size}, 1, "");
  expectFailureLeavesAll({"render", "b.hbv", "x.exr", "--size", "16384x16384", "--memory", "1GB"}, 1, "--memory");
  for (const char* camera :
       {"1,2,3", "1,2,3,4,5,6,7", "1,1,1,1,1,1", "0,0,0,0,0,1,0,0,1", "nan,0,0,1,1,1", "a,b,c,d,e,f"})
    expectFailureLeavesAll({"render", "b.hbv", "x.exr", "--camera", camera}, 1, "");
  for (const char* window : {"1", "2,1", "1,1", "1,inf"})
    expectFailureLeavesAll({"render", "b.hbv", "x.png", "--window", window, "--size", "4x4"}, 1, "window");
  expectFailureLeavesAll({"render", "b.hbv", "x.png", "--colormap", "rainbow"}, 1, "rainbow");
  expectFailureLeavesAll({"render", "b.hbv", "x.exr", "--zoom", "0"}, 2, "--zoom");
  expectFailureLeavesAll({"render", "b.hbv", "x.exr", "--zoom", "nan"}, 1, "zoom");
  expectFailureLeavesAll({"render", "b.hbv", "x.exr", "--iso", "nan", "--mode", "iso", "--size", "4x4"}, 1, "iso");
  expectFailureLeavesAll({"render", "b.hbv", "x.exr", "--azimuth", "inf", "--size", "4x4"}, 1, "azimuth");
  expectFailureLeavesAll({"render", "b.hbv", "x.exr", "--elevation", "91"}, 2, "--elevation");
  expectFailureLeavesAll({"render", "b.hbv", "x.exr", "--samples", "0"}, 2, "--samples");
  expectFailureLeavesAll({"render", "b.hbv", "x.exr", "--repeat", "0"}, 2, "--repeat");
}

TEST_F(render, RefusesWrongScenes) {
  const std::vector<std::string> scenes{"",
                                        "[]",
                                        "{",
                                        R"({"version": 2})",
                                        R"({"version": 1, "mode": "best"})",
                                        R"({"version": 1, "camera": {"position": [0, 0, 0]}})",
                                        R"({"version": 1, "width": 0})",
                                        R"({"version": 1, "colour": 1})",
                                        R"({"version": 1, "width": 1e999})",
                                        "\xFF\xFE",
                                        std::string(400000, '[')};
  for (const std::string& scene : scenes) {
    write("scene.json", scene);
    expectFailureLeavesAll({"render", "field:ball", "x.exr", "--scene", "scene.json"}, 1, "scene.json");
  }
  expectFailureLeavesAll({"render", "field:ball", "x.exr", "--scene", "none.json"}, 1, "none.json");
  // Where the scene cannot be saved there is no picture either.
  expectFailureLeavesAll({"render", "field:ball", "x.exr", "--size", "4x4", "--save-scene", "none/s.json"}, 1,
                         "none/s.json");
}
