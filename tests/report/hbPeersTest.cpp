#include "report/hbPeers.h"

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "report/hbValueDifference.h"
#include "scene/hbPictureFile.h"
#include "scene/hbScene.h"
#include "tests/report/hbTestVolumes.h"
#include "tests/volume/hbTestFiles.h"
#include "volume/hbVolumeReader.h"
#include "volume/hbVolumeWriter.h"

namespace {

/// An environment variable for the running test: a value, or none.
class Variable {
public:
  Variable(const char* name, const std::optional<std::string>& value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    set(value);
  }
  ~Variable() { set(before_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

private:
  void set(const std::optional<std::string>& value) {
    if (value)
      ::setenv(name_, value->c_str(), 1);
    else
      ::unsetenv(name_);
  }

  const char* name_;
  std::optional<std::string> before_;
};

void writeScript(const std::filesystem::path& path, const std::string& script) {
  std::ofstream(path) << "#!/bin/sh\n" << script << '\n';
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
}

/// Peers that are shell scripts in a folder of the test; nothing asks for an X server.
class hbFakePeers : public ::testing::Test {
protected:
  hbPeers zfp(const std::string& script) {
    writeScript(folder_ / "hbvol_peer_zfp", script);
    return hbPeers({folder_.path()});
  }
  hbPeers vtk(const std::string& script) {
    writeScript(folder_ / "hbvol_peer_vtk", script);
    return hbPeers({folder_.path()});
  }
  static hbZfpRun compress(const hbPeers& peers) { return peers.compress("in.nrrd", 1000, "out.nrrd"); }
  static hbVtkRun render(const hbPeers& peers, hbProgress& progress = hbProgress::none()) {
    return peers.render("in.nrrd", "scene.json", hbPeers::VtkMapper::gpu, 2, 3, "out.png", progress);
  }

  hbTestFolder folder_;
  Variable display_{"DISPLAY", ":0"};
};

constexpr const char* kZfpAnswer =
    R"(echo '{"name":"zfp","version":"9.8.7","bytes":999,"mode":"rate","parameter":1.5,"rmse":0.25,"threads":1,)"
    R"("seconds_compress":0.5,"seconds_decompress":0.125}')";
constexpr const char* kVtkAnswer =
    R"(echo '{"name":"vtk","version":"9.1.0","mapper":"gpu","renderer":"one","threads":3,"step":0.5,)"
    R"("seconds_first":2,"seconds_frames":[0.5,0.25]}')";

TEST_F(hbFakePeers, runsAreRead) {
  const hbZfpRun packed = compress(zfp(std::string("test \"$*\" = 'in.nrrd 1000 out.nrrd' &&") + kZfpAnswer));
  EXPECT_EQ(packed.version, "9.8.7");
  EXPECT_EQ(packed.bytes, 999U);
  EXPECT_EQ(packed.mode, "rate");
  EXPECT_EQ(packed.parameter, 1.5);
  EXPECT_EQ(packed.rmse, 0.25);
  EXPECT_EQ(packed.threads, 1);
  EXPECT_EQ(packed.secondsCompress, 0.5);
  EXPECT_EQ(packed.secondsDecompress, 0.125);

  const hbVtkRun drawn = render(vtk(std::string("test \"$*\" = 'in.nrrd scene.json gpu 2 3 out.png' &&") + kVtkAnswer));
  EXPECT_EQ(drawn.version, "9.1.0");
  EXPECT_EQ(drawn.renderer, "one");
  EXPECT_EQ(drawn.threads, 3);
  EXPECT_EQ(drawn.step, 0.5);
  EXPECT_EQ(drawn.secondsFirst, 2.0);
  EXPECT_EQ(drawn.secondsFrames, (std::vector{0.5, 0.25}));
}

TEST_F(hbFakePeers, versionsAreAsked) {
  EXPECT_EQ(zfp("test \"$1\" = --version && echo zfp 1.0.0").zfpVersion(), "1.0.0");
  EXPECT_EQ(vtk("echo vtk 9.1.0").vtkVersion(), "9.1.0");
  for (const char* script : {"echo vtk 9.1.0", "echo 'zfp '", "true", "printf 'zfp 1\\n2\\n'"})
    EXPECT_HB_ERROR(zfp(script).zfpVersion(), "hbvol_peer_zfp: expected zfp and a version, found '");
}

TEST_F(hbFakePeers, refusalIsThePeersOwnLine) {
  const hbPeers peers = zfp("echo 'zfp: expected at least 12 bytes, found 3' >&2; exit 3");
  EXPECT_THROW(compress(peers), hbPeerRefusal);
  EXPECT_EQ(hb::test::errorOf([&] { compress(peers); }), "zfp: expected at least 12 bytes, found 3");
  EXPECT_THROW(render(vtk("echo 'vtk: does not draw this' >&2; exit 3")), hbPeerRefusal);
}

TEST_F(hbFakePeers, failureIsNoRefusal) {
  const auto isRefusal = [](const hbPeers& peers) {
    try {
      render(peers);
    } catch (const hbPeerRefusal&) {
      return true;
    } catch (const hbError&) {
    }
    return false;
  };
  // Another program's status 3.
  EXPECT_FALSE(isRefusal(vtk("echo 'xvfb-run: error: xauth command not found' >&2; exit 3")));
  EXPECT_HB_ERROR(render(vtk("echo first >&2; echo 'vtk: no such file' >&2; exit 1")),
                  "hbvol_peer_vtk: expected exit status 0, found 1 and the message: vtk: no such file");
  EXPECT_HB_ERROR(render(vtk("kill -ABRT $$")), "expected exit status 0, found 134 and the message: nothing");
}

TEST_F(hbFakePeers, whatIsNoAnswerIsAnError) {
  EXPECT_HB_ERROR(compress(zfp("printf 'gar\\nbage'")), "expected a JSON object of its run, found 'gar bage'");
  EXPECT_HB_ERROR(compress(zfp("true")), "expected a JSON object of its run, found ''");
  EXPECT_HB_ERROR(compress(zfp("echo '{}'")), "expected a JSON object of its run, found '{}");
  EXPECT_HB_ERROR(compress(zfp("echo '[1]'")), "expected a JSON object of its run");
  EXPECT_HB_ERROR(render(vtk("echo '{\"version\":7}'")), "expected a JSON object of its run");
  const hbPeers peers = zfp(kZfpAnswer);
  EXPECT_HB_ERROR(peers.compress("a", 998, "b"), "expected 1 to 998 bytes, found");
  EXPECT_HB_ERROR(vtk(kVtkAnswer).render("a", "b", hbPeers::VtkMapper::cpu, 3, 3, "c"), "expected 3 frames, found");
  EXPECT_HB_ERROR(vtk(kVtkAnswer).render("a", "b", hbPeers::VtkMapper::cpu, 2, 2, "c"),
                  "expected 1 to 2 threads, found");
  EXPECT_HB_ERROR(
      render(vtk(
          R"(echo '{"version":"1","renderer":"","threads":1,"step":1,"seconds_first":-1,"seconds_frames":[1,1]}')")),
      "expected times, found");
}

TEST_F(hbFakePeers, missingPeersAreNamed) {
  const Variable path("PATH", folder_.path().string());
  const hbPeers peers({folder_.path()});
  EXPECT_FALSE(peers.hasZfp());
  EXPECT_FALSE(peers.hasVtk());
  EXPECT_HB_ERROR(peers.zfpVersion(),
                  "hbvol_peer_zfp: expected beside the running program, in $HBVOL_PEERS or on PATH");
  EXPECT_HB_ERROR(compress(peers), "hbvol_peer_zfp: expected");
  EXPECT_HB_ERROR(render(peers), "hbvol_peer_vtk: expected");
}

TEST_F(hbFakePeers, foldersAreTheProgramsOwnAndHbvolPeers) {
  const auto own = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  {
    const Variable peers("HBVOL_PEERS", folder_.path().string());
    EXPECT_EQ(hbPeers::folders(), (std::vector{own, folder_.path()}));
  }
  const Variable peers("HBVOL_PEERS", std::nullopt);
  EXPECT_EQ(hbPeers::folders(), std::vector{own});
}

TEST_F(hbFakePeers, xServerIsStartedWhereThereIsNone) {
  const Variable path("PATH", folder_.path().string() + ":" + std::getenv("PATH"));
  const Variable display("DISPLAY", std::nullopt);
  // Leaves its own options out and runs the rest.
  writeScript(folder_ / "xvfb-run",
              "test \"$1 $2 $3\" = '-a -s -noreset -screen 0 1024x1024x24' || exit 1; shift 3; DISPLAY=:9 exec \"$@\"");
  const hbPeers peers = vtk(std::string("test \"$DISPLAY\" = :9 &&") + kVtkAnswer);
  EXPECT_EQ(render(peers).renderer, "one");
  // A version needs none.
  EXPECT_EQ(vtk("test -z \"$DISPLAY\" && echo vtk 1").vtkVersion(), "1");
}

TEST_F(hbFakePeers, cancellingEndsARun) {
  const hbPeers peers = vtk("touch \"${0%/*}/started\"; exec sleep 1000");
  hbProgress progress;
  std::thread cancel([&] {
    while (!std::filesystem::exists(folder_ / "started")) std::this_thread::yield();
    progress.cancel();
  });
  EXPECT_THROW(render(peers, progress), hbCancelled);
  cancel.join();
}

/// The programs themselves, where they were built.
class hbRealPeers : public ::testing::Test {
protected:
  /// A ramp from 0 to 1 along z in the cube, on unlike spacings and away from the origin.
  hbVolume writeRamp() {
    hbGeometry geometry;
    geometry.size = {9, 9, 17};
    geometry.spacing = {2.0, 1.0, 1.0};
    geometry.origin = {-8.0, 3.0, 5.0};
    std::vector<float> samples;
    for (int z = 0; z < 17; ++z) samples.insert(samples.end(), 81, float(z) / 16.0F);
    hbVolume volume = hbVolume::fromSamples(geometry, std::move(samples));
    hb::writeVolume(volume, in_);
    return volume;
  }

  hbTestFolder folder_;
  std::filesystem::path in_ = folder_ / "in.nrrd";
  hbPeers peers_;
};

TEST_F(hbRealPeers, zfpKeepsWithinTheBytes) {
  if (!peers_.hasZfp()) GTEST_SKIP() << "hbvol_peer_zfp was not built";
  EXPECT_EQ(peers_.zfpVersion().find_first_not_of("0123456789."), std::string::npos);
  const hbVolume volume = volumeOf({17, 9, 13}, 5);
  hb::writeVolume(volume, in_);
  double before = INFINITY;
  for (const std::uint64_t bytes : {1000, 2000, 4000, 20000}) {
    const hbZfpRun run = peers_.compress(in_, bytes, folder_ / "out.nrrd");
    EXPECT_LE(run.bytes, bytes);
    EXPECT_LT(run.rmse, before);
    before = run.rmse;
    const hbVolume out = hb::readVolume(folder_ / "out.nrrd");
    EXPECT_EQ(out.geometry(), volume.geometry());
    // A sum of 1989 squares is wrong by at most 1988 times half a unit in the last place, whatever its order; two of
    // them differ by twice as much, and their roots by half of that.
    EXPECT_NEAR(hb::volumeDifference(volume, out).rmse(), run.rmse, 1989 * 0x1p-53 * run.rmse);
  }
  EXPECT_EQ(before, 0.0); // more bytes than the samples have: without loss
}

TEST_F(hbRealPeers, zfpRefuses) {
  if (!peers_.hasZfp()) GTEST_SKIP() << "hbvol_peer_zfp was not built";
  writeRamp();
  EXPECT_THROW(peers_.compress(in_, 1, folder_ / "out.nrrd"), hbPeerRefusal);
  EXPECT_HB_ERROR(peers_.compress(in_, 1, folder_ / "out.nrrd"), "zfp: expected at least ");
  hbGeometry two;
  two.size = {2, 1, 1};
  hb::writeVolume(hbVolume::fromSamples(two, std::vector<float>{NAN, 1.0F}), in_);
  EXPECT_HB_ERROR(peers_.compress(in_, 999, folder_ / "out.nrrd"), "expected finite values, found nan");
  EXPECT_HB_ERROR(peers_.compress(folder_ / "none.nrrd", 999, folder_ / "out.nrrd"), "none.nrrd: ");
}

/// The greatest values of a ramp along the picture's height, seen from -y with the volume just filling the picture:
/// the value in a pixel's centre is its place along z.
TEST_F(hbRealPeers, vtkDrawsTheScene) {
  if (!peers_.hasVtk()) GTEST_SKIP() << "hbvol_peer_vtk was not built";
  if (std::getenv("DISPLAY") == nullptr && !hbExternalProgram::find("xvfb-run")) GTEST_SKIP() << "no X server";
  const hbVolume volume = writeRamp();
  hbScene scene;
  scene.mode = hbMode::mip;
  scene.width = scene.height = 32;
  scene.colormap = "gray";
  scene.window = {0.0, 1.0};
  scene.camera =
      hbCamera::framing(volume.geometry(), 0.0, 0.0, hbCamera::Projection::orthographic, 1.0, hbCamera::kFramingMargin);
  hb::saveScene(scene, folder_ / "scene.json");
  const hbVtkRun run = peers_.render(in_, folder_ / "scene.json", hbPeers::VtkMapper::gpu, 2, 1, folder_ / "out.png");
  EXPECT_EQ(run.secondsFrames.size(), 2U);
  EXPECT_EQ(run.threads, 1);
  EXPECT_EQ(run.step, 1.0);
  const hbImage8 image = hb::readPng(folder_ / "out.png");
  ASSERT_EQ(image.width, 32);
  ASSERT_EQ(image.height, 32);
  for (int y = 0; y < 32; ++y)
    // Half a level of rounding, and half an entry of VTK's map of 1024 colours, which is an eighth of a level.
    EXPECT_NEAR(image.rgb[std::size_t(3 * (16 + 32 * y))], 255.0 * (31.5 - y) / 32.0, 0.5 + 0.125 + 0.01) << y;

  scene.labels = true;
  hb::saveScene(scene, folder_ / "scene.json");
  EXPECT_THROW(peers_.render(in_, folder_ / "scene.json", hbPeers::VtkMapper::gpu, 1, 0, folder_ / "out.png"),
               hbPeerRefusal);
}

} // namespace
