#include "report/hbComparisonRun.h"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "raycast/hbNominalSamples.h"
#include "raycast/hbRaycaster.h"
#include "report/hbFitJson.h"
#include "report/hbPictureDifference.h"
#include "report/hbSparseCompression.h"
#include "scene/hbDisplay.h"
#include "scene/hbPictureFile.h"
#include "sparsegrid/hbSparseGridFile.h"
#include "tests/report/hbTestVolumes.h"
#include "tests/volume/hbTestFiles.h"
#include "volume/hbError.h"
#include "volume/hbVolumeField.h"
#include "volume/hbVolumeWriter.h"

namespace {

using Json = hb::ReportJson;

/// Cancels itself after so many cases.
class Cancelling final : public hbProgress {
public:
  explicit Cancelling(std::int64_t cases) : cases_(cases) {}

protected:
  void show(std::int64_t done, std::int64_t) override {
    if (done >= cases_) cancel();
  }

private:
  std::int64_t cases_;
};

} // namespace

class hbComparisonRunTest : public ::testing::Test {
protected:
  hbComparisonRunTest() {
    what_.firstLevel = 2;
    what_.lastLevel = 3;
    what_.engines = {hbComparison::engineFromName("seminodal"), hbComparison::engineFromName("direct")};
    what_.modes = {hbMode::xray, hbMode::iso};
    what_.scene.width = what_.scene.height = 12;
    what_.scene.sampling = {hbSampling::Kind::planewise, 8};
    what_.scene.isoValue = 3.0;
    what_.repeats = 2;
    what_.version = "1.2.3";
    what_.peerFolders.reset();
  }

  hbInput field() const { return hbInput::open(name_, {}); }

  Json run(hbProgress& progress = hbProgress::none()) {
    const hbComparisonSource source([this] { return field(); }, 0, std::nullopt);
    hbComparisonFolder folder(folder_ / "out", hbComparisonRun::identity(source, what_), false);
    return hbComparisonRun(source, what_, folder).run(progress);
  }

  static const Json& named(const Json& list, const std::string& key) {
    for (const Json& one : list)
      if (one["key"] == key) return one;
    throw std::out_of_range(key);
  }

  hbTestFolder folder_;
  std::string name_ = "field:hydrogen,size=9";
  hbComparison what_;
};

TEST_F(hbComparisonRunTest, MeasuresEveryChoiceByEveryEngineInEveryMode) {
  const Json report = run();
  std::vector<std::string> choices, cases;
  for (const Json& one : report["choices"]) choices.push_back(one["key"]);
  for (const Json& one : report["cases"]) cases.push_back(one["key"]);
  EXPECT_EQ(choices, (std::vector<std::string>{"original", "sparse-2", "coarse-2", "sparse-3", "coarse-3"}));
  EXPECT_EQ(cases, (std::vector<std::string>{"original-full-xray", "original-full-iso", "sparse-2-seminodal-xray",
                                             "sparse-2-seminodal-iso", "sparse-2-direct-xray", "sparse-2-direct-iso",
                                             "coarse-2-full-xray", "coarse-2-full-iso", "sparse-3-seminodal-xray",
                                             "sparse-3-seminodal-iso", "sparse-3-direct-xray", "sparse-3-direct-iso",
                                             "coarse-3-full-xray", "coarse-3-full-iso"}));
  for (const Json& one : report["cases"]) {
    EXPECT_EQ(one["status"], "done") << one;
    EXPECT_LE(one["seconds_frame"]["min"], one["seconds_frame"]["median"]);
    EXPECT_LE(one["seconds_frame"]["median"], one["seconds_frame"]["max"]);
    EXPECT_EQ(one["seconds_frame"]["repeats"], 2);
    EXPECT_GE(one["seconds_first_picture"], one["seconds_build"]);
    for (const char* image : {"image", "difference"})
      EXPECT_EQ(hb::readPng(folder_ / "out" / one[image].get<std::string>()).width, 12) << one[image];
  }
  EXPECT_EQ(report["version"], "1.2.3");
  EXPECT_EQ(report["runs"], 1);
  EXPECT_EQ(report["input"]["size"], (Json{9, 9, 9}));
  EXPECT_EQ(report["input"]["bytes_uncompressed"], 9 * 9 * 9 * 4);
  EXPECT_EQ(report["settings"]["levels"], (Json{2, 3}));
}

TEST_F(hbComparisonRunTest, FiguresAreThoseOfTheFilesAndPicturesThemselves) {
  const Json report = run();
  const hbInput input = field();
  std::vector<float> samples;
  for (int z = 0; z < 9; ++z)
    for (int y = 0; y < 9; ++y)
      for (int x = 0; x < 9; ++x) samples.push_back(float(input.analytic->value({x / 8.0, y / 8.0, z / 8.0})));
  const hbVolume full = hbVolume::fromSamples(input.geometry(), std::move(samples));
  const std::filesystem::path file = folder_ / "out" / "choices" / "sparse-3.hbv";
  const hbInput sparse = hbInput::open(file.string(), {});
  const hbSparseGrid& grid = sparse.sparse->grid;

  const Json& choice = named(report["choices"], "sparse-3");
  EXPECT_EQ(choice["bytes"], std::filesystem::file_size(file));
  EXPECT_DOUBLE_EQ(choice["bits_per_sample"].get<double>(), 8.0 * double(std::filesystem::file_size(file)) / 729.0);
  EXPECT_EQ(choice["stored_values"], grid.indexSet().storedValues());
  hbErrorStatistics errors;
  const double largest = 100.0; // of the field: the density's greatest value is 95
  for (int z = 0; z < 9; ++z)
    for (int y = 0; y < 9; ++y)
      for (int x = 0; x < 9; ++x) errors.add(full.value(x, y, z), grid.calcValue({x / 8.0, y / 8.0, z / 8.0}, 0));
  // A lattice of a small grid in 32 bits is off by less than 2^-16 of the largest value.
  EXPECT_NEAR(choice["values"]["max"].get<double>(), errors.max, largest * 0x1p-16);
  EXPECT_NEAR(choice["values"]["rmse"].get<double>(), errors.rmse(), largest * 0x1p-16);
  EXPECT_GT(choice["true_values"]["rmse"], 0.0);

  hbScene scene = what_.scene;
  scene.camera = scene.cameraFor(full.geometry());
  const hbVolumeField reference(full);
  const auto seminodal = sparse.field(hbEngine::seminodal);
  const Json& one = named(report["cases"], "sparse-3-seminodal-iso");
  scene.mode = hbMode::iso;
  const hbPicture expected = hbRaycaster(reference, scene).render(), found = hbRaycaster(*seminodal, scene).render();
  EXPECT_EQ(one["picture"], hb::reportJson(hb::pictureDifference(expected, found)));
  const hbPicture truth = hbRaycaster(*input.analytic, scene).render();
  EXPECT_EQ(one["true_picture"], hb::reportJson(hb::pictureDifference(truth, found)));
  EXPECT_DOUBLE_EQ(one["samples"].get<double>(), hb::nominalSamples(full.geometry(), scene));
  EXPECT_DOUBLE_EQ(one["samples_per_second"].get<double>() * one["seconds_frame"]["median"].get<double>(),
                   one["samples"].get<double>());
  EXPECT_EQ(one["compressed_bytes"], choice["bytes"]);
  EXPECT_EQ(named(report["cases"], "original-full-xray")["picture"]["max"], 0.0);
  // The baseline takes no more than the sparse grid.
  EXPECT_LE(named(report["choices"], "coarse-3")["bytes"], choice["bytes"]);
}

TEST_F(hbComparisonRunTest, FitsAreChoicesDrawnByTheFirstEngine) {
  name_ = "field:hydrogen,size=11";
  what_.fits = hbComparison::allFits();
  what_.firstLevel = 3;
  what_.modes = {hbMode::mip};
  const Json report = run();
  std::vector<std::string> choices, cases;
  for (const Json& one : report["choices"]) choices.push_back(one["key"]);
  for (const Json& one : report["cases"]) cases.push_back(one["key"]);
  EXPECT_EQ(choices, (std::vector<std::string>{"original", "sparse-3", "opticom-3", "least-squares-3", "coarse-3"}));
  EXPECT_EQ(cases, (std::vector<std::string>{"original-full-mip", "sparse-3-seminodal-mip", "sparse-3-direct-mip",
                                             "opticom-3-seminodal-mip", "least-squares-3-seminodal-mip",
                                             "coarse-3-full-mip"}));
  for (const Json& one : report["cases"]) EXPECT_EQ(one["status"], "done") << one;

  const hbInput input = field();
  for (const hbComparison::Fit& fit : what_.fits) {
    const Json& choice = named(report["choices"], fit.name + "-3");
    EXPECT_EQ(choice["kind"], fit.name);
    EXPECT_EQ(choice["label"], fit.inWords() + ", level 3");
    EXPECT_EQ(choice["level"], 3);
    EXPECT_EQ(choice["fit"]["method"], fit.name);
    EXPECT_EQ(choice["fit"]["improved"], true);
    EXPECT_EQ(choice["fit"]["samples"].get<int>() + choice["fit"]["held_out"].get<int>(), 11 * 11 * 11);
    EXPECT_LT(choice["fit"]["held_out_rmse"], choice["fit"]["interpolation_held_out_rmse"]);
    EXPECT_LE(choice["fit"]["seconds"], choice["seconds_build"]);

    // The figures are those of the file.
    const std::filesystem::path file = folder_ / "out" / choice["file"].get<std::string>();
    EXPECT_EQ(choice["bytes"], std::filesystem::file_size(file));
    const hbInput sparse = hbInput::open(file.string(), {});
    EXPECT_NE(sparse.sparse->provenance.json.find(fmt::format("\"{}\"", fit.name)), std::string::npos);
    hbErrorStatistics errors;
    for (int z = 0; z < 11; ++z)
      for (int y = 0; y < 11; ++y)
        for (int x = 0; x < 11; ++x) {
          const glm::dvec3 p{x / 10.0, y / 10.0, z / 10.0};
          errors.add(float(input.analytic->value(p)), sparse.sparse->grid.calcValue(p, 0));
        }
    // A lattice of a small grid in 32 bits is off by less than 2^-16 of the largest value, which is below 100.
    EXPECT_NEAR(choice["values"]["rmse"].get<double>(), errors.rmse(), 100.0 * 0x1p-16);
  }
  // All surpluses are free to follow the samples, of opticom only one factor a component grid.
  EXPECT_LT(named(report["choices"], "least-squares-3")["fit"]["residual_rmse"],
            named(report["choices"], "opticom-3")["fit"]["residual_rmse"]);

  const Json again = run();
  EXPECT_EQ(again["choices"], report["choices"]);
  EXPECT_EQ(again["cases"], report["cases"]);
}

TEST_F(hbComparisonRunTest, WithFitsTheRestIsAsWithout) {
  name_ = "field:hydrogen,size=11";
  what_.modes = {hbMode::mip};
  const Json without = run();
  std::filesystem::remove_all(folder_ / "out");
  what_.fits = hbComparison::allFits();
  const Json with = run();
  for (const Json& choice : without["choices"]) {
    const Json& same = named(with["choices"], choice["key"]);
    for (const char* key : {"label", "bytes", "stored_values", "values", "true_values"})
      EXPECT_EQ(same.value(key, Json()), choice.value(key, Json())) << choice["key"] << key;
  }
  for (const Json& one : without["cases"]) EXPECT_EQ(named(with["cases"], one["key"])["picture"], one["picture"]);
}

TEST_F(hbComparisonRunTest, AFitThatIsNoBetterIsInterpolation) {
  name_ = "field:multilinear,size=11"; // which interpolation takes without an error
  what_.fits = {hbComparison::allFits()[1]};
  what_.modes = {hbMode::mip};
  what_.scene.isoValue.reset();
  const Json report = run();
  const Json &fit = named(report["choices"], "least-squares-3"), &sparse = named(report["choices"], "sparse-3");
  EXPECT_EQ(fit["label"], "least squares, level 3 (interpolation kept)");
  EXPECT_EQ(fit["fit"]["improved"], false);
  EXPECT_EQ(fit["values"], sparse["values"]);
  EXPECT_EQ(named(report["cases"], "least-squares-3-seminodal-mip")["picture"],
            named(report["cases"], "sparse-3-seminodal-mip")["picture"]);
}

TEST_F(hbComparisonRunTest, FitsOfVolumesFollowTheComponentAndTheLoss) {
  hbInput input;
  input.name = "noise";
  input.volume = std::make_shared<const hbVolume>(volumeOf({11, 10, 10}, 3, 2));
  what_.scene.component = 1;
  what_.scene.isoValue.reset();
  what_.modes = {hbMode::mip};
  what_.fits = hbComparison::allFits();
  what_.loss = hbFitLoss::Kind::huber;
  const hbComparisonSource source([&] { return input; }, 1, std::nullopt);
  hbComparisonFolder folder(folder_ / "noise", hbComparisonRun::identity(source, what_), false);
  const Json report = hbComparisonRun(source, what_, folder).run(hbProgress::none());
  for (const hbComparison::Fit& fit : what_.fits) {
    const Json& choice = named(report["choices"], fit.name + "-3");
    ASSERT_EQ(choice["status"], "done") << choice;
    EXPECT_EQ(choice["fit"]["loss"], "huber");
    hbSparseCompression how;
    how.set.levels = glm::ivec3(3);
    how.fit.emplace();
    how.fit->method = fit.method;
    how.fit->loss = hbFitLoss::Kind::huber;
    Json expected = hb::toJson(how.compress(input).fits[1]), found = choice["fit"];
    expected.erase("seconds");
    found.erase("seconds");
    EXPECT_EQ(found, expected);
  }
}

TEST_F(hbComparisonRunTest, AFitThatFailsDoesNotEndTheRest) {
  name_ = "field:hydrogen,size=3"; // 27 samples are too few to hold some out
  what_.fits = {hbComparison::allFits()[0]};
  what_.lastLevel = 2;
  what_.modes = {hbMode::mip};
  const Json report = run();
  const Json& fit = named(report["choices"], "opticom-2");
  EXPECT_EQ(fit["status"], "failed");
  EXPECT_NE(fit["error"].get<std::string>().find("expected 1024 samples at least"), std::string::npos) << fit;
  EXPECT_EQ(named(report["cases"], "opticom-2-seminodal-mip")["status"], "failed");
  EXPECT_EQ(named(report["cases"], "coarse-2-full-mip")["status"], "done");
}

TEST_F(hbComparisonRunTest, GoesOnWhereItWasInterrupted) {
  Cancelling progress(5);
  EXPECT_THROW(run(progress), hbCancelled);
  const Json report = run();
  ASSERT_EQ(report["cases"].size(), 14U);
  EXPECT_EQ(report["runs"], 2);
  for (std::size_t i = 0; i < 14; ++i) EXPECT_EQ(report["cases"][i]["run"], i < 5 ? 1 : 2) << i;
  // With nothing left to measure, everything comes from the folder.
  const Json again = run();
  EXPECT_EQ(again["cases"], report["cases"]);
  EXPECT_EQ(again["choices"], report["choices"]);
  EXPECT_EQ(again["runs"], 2);
}

TEST_F(hbComparisonRunTest, WhatFailsIsReportedAndTriedAgain) {
  // `full` extracts 33^3 floats first, and the volume itself takes as much; the other forms do not.
  name_ = "field:hydrogen,size=33";
  what_.engines.push_back(hbComparison::engineFromName("full"));
  what_.modes = {hbMode::mip};
  what_.memoryLimit = 100000;
  const Json report = run();
  const Json& failed = named(report["cases"], "sparse-3-full-mip");
  EXPECT_EQ(failed["status"], "failed");
  EXPECT_NE(failed["error"].get<std::string>().find("memory limit"), std::string::npos) << failed;
  EXPECT_EQ(named(report["cases"], "original-full-mip")["status"], "failed");
  EXPECT_EQ(named(report["cases"], "sparse-3-seminodal-mip")["status"], "done");
  EXPECT_EQ(named(report["cases"], "coarse-3-full-mip")["status"], "done");

  what_.memoryLimit = 1U << 30U;
  const Json again = run();
  EXPECT_EQ(named(again["cases"], "sparse-3-full-mip")["status"], "done");
  EXPECT_EQ(named(again["cases"], "sparse-3-full-mip")["run"], 2);
  EXPECT_EQ(named(again["cases"], "sparse-3-seminodal-mip")["run"], 1);
}

TEST_F(hbComparisonRunTest, TakesVolumesAndTheirComponents) {
  hbInput input;
  input.name = "noise";
  input.volume = std::make_shared<const hbVolume>(volumeOf({7, 6, 5}, 3, 2));
  what_.scene.component = 1;
  what_.scene.isoValue.reset();
  what_.modes = {hbMode::mip, hbMode::dvr};
  const hbComparisonSource source([&] { return input; }, 1, std::nullopt);
  hbComparisonFolder folder(folder_ / "noise", hbComparisonRun::identity(source, what_), false);
  const Json report = hbComparisonRun(source, what_, folder).run(hbProgress::none());
  for (const Json& one : report["cases"]) EXPECT_EQ(one["status"], "done") << one;
  EXPECT_TRUE(report["choices"][1]["true_values"].is_null());
  EXPECT_TRUE(report["cases"][3]["true_picture"].is_null());
  EXPECT_EQ(report["input"]["representation"], "volume");
  EXPECT_EQ(report["input"]["component"], 1);
}

TEST_F(hbComparisonRunTest, WithoutASparseGridThereIsNoBaseline) {
  what_.firstLevel = what_.lastLevel = 4;
  what_.memoryLimit = 9 * 9 * 9 * 4 + 10000; // level 4 takes 593 values, 24 bytes each
  const Json report = run();
  ASSERT_EQ(report["choices"].size(), 2U);
  EXPECT_EQ(report["choices"][1]["status"], "failed");
  EXPECT_NE(report["choices"][1]["error"].get<std::string>().find("memory limit"), std::string::npos);
  // With the grid comes the baseline, of as many bytes.
  what_.memoryLimit = 1U << 30U;
  const Json again = run();
  ASSERT_EQ(again["choices"].size(), 3U);
  EXPECT_GT(again["choices"][2]["stored_values"], 8);
}

TEST_F(hbComparisonRunTest, AnInputThatWasWrittenSinceIsAnother) {
  const std::filesystem::path file = folder_ / "v.nrrd";
  hb::writeVolume(volumeOf({5, 5, 5}, 1), file);
  const auto identity = [&] {
    const hbComparisonSource source([&] { return hbInput::open(file.string(), {}); }, 0, std::nullopt);
    return hbComparisonRun::identity(source, what_);
  };
  const Json before = identity();
  EXPECT_EQ(identity(), before);
  std::filesystem::last_write_time(file, std::filesystem::last_write_time(file) + std::chrono::seconds(1));
  EXPECT_NE(identity(), before);
}

TEST_F(hbComparisonRunTest, ConstantsAndSlicesAreVolumes) {
  hbGeometry geometry;
  geometry.size = {5, 4, 1};
  hbInput input;
  input.name = "constant";
  input.volume = std::make_shared<const hbVolume>(hbVolume::fromSamples(geometry, std::vector<float>(20, 0.1F)));
  what_.scene.isoValue.reset();
  what_.modes = {hbMode::xray, hbMode::mip, hbMode::iso, hbMode::dvr};
  const hbComparisonSource source([&] { return input; }, 0, std::nullopt);
  hbComparisonFolder folder(folder_ / "constant", hbComparisonRun::identity(source, what_), false);
  const Json report = hbComparisonRun(source, what_, folder).run(hbProgress::none());
  for (const Json& one : report["cases"]) {
    // Nothing can be stretched over a constant.
    EXPECT_EQ(one["status"], one["mode"] == "dvr" ? "failed" : "done") << one;
    if (one["mode"] == "dvr") {
      EXPECT_NE(one["error"].get<std::string>().find("values with a range"), std::string::npos);
    }
  }
  for (const Json& one : report["choices"]) EXPECT_LE(one["values"]["max"].get<double>(), 0x1p-20) << one;
}

TEST_F(hbComparisonRunTest, OtherProgramsTakePart) {
  // Peers that are scripts: zfp loses nothing, VTK has one picture for all scenes and refuses X-rays.
  const auto script = [&](const char* name, const std::string& text) {
    std::ofstream(folder_ / name) << "#!/bin/sh\n" << text;
    std::filesystem::permissions(folder_ / name, std::filesystem::perms::owner_all);
  };
  script("hbvol_peer_zfp",
         "[ $1 = --version ] && { echo zfp 9.8.7; exit; }\ncp \"$1\" \"$3\"\n"
         "echo '{\"name\":\"zfp\",\"version\":\"9.8.7\",\"bytes\":500,\"mode\":\"rate\",\"parameter\":1.5,"
         "\"rmse\":0,\"threads\":1,\"seconds_compress\":0.5,\"seconds_decompress\":1000}'\n");
  script("hbvol_peer_vtk",
         "[ $1 = --version ] && { echo vtk 9.1.0; exit; }\n"
         "grep -q xray \"$2\" && { echo 'vtk: no X-ray' >&2; exit 3; }\n[ $3 = gpu ] && { echo broken >&2; exit 1; }\n"
         "[ $5 = 3 ] || exit 1\ncp \"" +
             (folder_ / "gray.png").string() +
             "\" \"$6\"\n"
             "echo '{\"name\":\"vtk\",\"version\":\"9.1.0\",\"renderer\":\"one\",\"threads\":3,\"step\":0.5,"
             "\"seconds_first\":2,\"seconds_frames\":[0.5,0.25]}'\n");
  const hbImage8 gray{12, 12, std::vector<std::uint8_t>(3 * 144, 100)};
  hb::writePng(gray, folder_ / "gray.png");
  what_.peerFolders = {{folder_.path()}};
  what_.threads = 3;

  const Json report = run();
  EXPECT_EQ(report["peers"], (Json{{"zfp", "9.8.7"}, {"vtk", "9.1.0"}}));
  const Json& packed = named(report["choices"], "zfp-3");
  EXPECT_EQ(packed["bytes"], 500);
  EXPECT_EQ(packed["values"]["max"], 0.0);
  EXPECT_EQ(packed["seconds_build"], 0.5);
  // The picture is there when zfp's own decompression is done, too.
  const Json& drawn = named(report["cases"], "zfp-3-full-xray");
  EXPECT_EQ(drawn["picture"]["max"], 0.0);
  EXPECT_GT(drawn["seconds_first_picture"], 1000.0);
  EXPECT_LT(drawn["seconds_warmup"], 1000.0);

  EXPECT_THROW(named(report["cases"], "original-vtk-cpu-xray"), std::out_of_range);
  const Json& vtk = named(report["cases"], "original-vtk-cpu-iso");
  EXPECT_EQ(vtk["seconds_frame"]["median"], 0.375);
  EXPECT_EQ(vtk["seconds_frame"]["min"], 0.25);
  EXPECT_EQ(vtk["image_only"], true);
  const hbPicture reference = hb::readExr(folder_ / "out" / "pictures" / "reference-iso.exr");
  hbScene scene = hb::sceneFromJson(reference.metadata.at(hbPicture::kSceneKey), "scene");
  scene.window = hb::displayWindow(reference, scene);
  EXPECT_EQ(vtk["picture"], hb::reportJson(hb::pictureDifference(hb::displayImage(reference, scene), gray)));
  const Json& broken = named(report["cases"], "original-vtk-gpu-iso");
  EXPECT_EQ(broken["status"], "failed");
  EXPECT_NE(broken["error"].get<std::string>().find("broken"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out" / "peers"));
}

TEST(hbComparisonSource, ChecksTheMemoryOfAFullGrid) {
  const auto field = [] { return hbInput::open("field:hydrogen,size=33", {}); };
  EXPECT_THROW(hbComparisonSource(field, 0, std::nullopt, 4 * 33 * 33 * 33 - 1), hbError);
  EXPECT_EQ(hbComparisonSource(field, 0, std::nullopt, 4 * 33 * 33 * 33).bytes(), 4U * 33U * 33U * 33U);
}

TEST(hbComparisonSource, RefusesWhatCannotBeCompared) {
  const auto grid = [] {
    hbInput input;
    input.name = "grid";
    input.sparse = std::make_shared<const hbSparseGridFile>(
        hbSparseGridFile{hbSparseGrid::interpolate(hbVolumeField(volumeOf({3, 3, 3}, 1)), hbIndexSet::regular(1, {}),
                                                   hbLatticeMapping::fitted),
                         {},
                         {},
                         {},
                         {}});
    return input;
  };
  EXPECT_THROW(hbComparisonSource(grid, 0, std::nullopt), hbError);
  const auto volume = [] {
    hbInput input;
    input.name = "holes";
    hbGeometry geometry;
    geometry.size = {2, 2, 1};
    input.volume = std::make_shared<const hbVolume>(
        hbVolume::fromSamples<float>(geometry, {1.0F, std::numeric_limits<float>::quiet_NaN(), 3.0F, 4.0F}));
    return input;
  };
  EXPECT_THROW(hbComparisonSource(volume, 0, std::nullopt), hbError);
  EXPECT_THROW(hbComparisonSource(volume, 1, 0.0), hbError);
  EXPECT_EQ(hbComparisonSource(volume, 0, 9.0).range(), std::pair(1.0, 9.0));
  const hbComparisonSource source(volume, 0, 0.0);
  EXPECT_EQ(source.errors(source.field(), hbProgress::none()).max, 0.0);
}
