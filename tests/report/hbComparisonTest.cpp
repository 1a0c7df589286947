#include "report/hbComparison.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "volume/hbError.h"

namespace {

std::string errorOf(const hbComparison& comparison) {
  try {
    comparison.validate();
  } catch (const hbError& error) {
    return error.what();
  }
  return "";
}

hbComparison valid() {
  hbComparison comparison;
  comparison.scene.sampling.samples = 32;
  return comparison;
}

} // namespace

TEST(hbComparison, ValidatesWhatIsAsked) {
  EXPECT_EQ(errorOf(valid()), "");
  hbComparison c = valid();
  c.firstLevel = 9;
  EXPECT_EQ(errorOf(c), "levels: expected A..B with 1 <= A <= B <= 20, found 9..8");
  c = valid();
  c.modes.push_back(hbMode::slice);
  EXPECT_NE(errorOf(c).find("found slice"), std::string::npos);
  c = valid();
  c.engines.clear();
  EXPECT_NE(errorOf(c).find("engines"), std::string::npos);
  c = valid();
  c.modes.clear();
  EXPECT_NE(errorOf(c).find("modes"), std::string::npos);
  c = valid();
  c.scene.magnitude = true;
  EXPECT_NE(errorOf(c).find("magnitudes"), std::string::npos);
  c = valid();
  c.scene.sampling.samples = 0;
  EXPECT_NE(errorOf(c).find("samples"), std::string::npos);
  c = valid();
  c.repeats = 0;
  EXPECT_NE(errorOf(c).find("repeats"), std::string::npos);
  c = valid();
  c.fits = hbComparison::allFits();
  c.loss = hbFitLoss::Kind::huber;
  EXPECT_EQ(errorOf(c), "");
  c.fits.push_back(c.fits.front());
  EXPECT_EQ(errorOf(c), "fits: expected each once, found opticom twice");
  c.fits.clear();
  EXPECT_EQ(errorOf(c), "loss: expected a fit beside it, found interpolation only");
}

TEST(hbComparison, KnowsItsEnginesByName) {
  for (const auto& engine : hbComparison::allEngines()) EXPECT_EQ(hbComparison::engineFromName(engine.name), engine);
  EXPECT_THROW(hbComparison::engineFromName("best"), hbError);
}

TEST(hbComparison, FitsAreSparseGrids) {
  for (const auto& fit : hbComparison::allFits()) EXPECT_TRUE(hbComparison::isSparseGrid(fit.name)) << fit.name;
  EXPECT_TRUE(hbComparison::isSparseGrid("sparse"));
  for (const char* kind : {"original", "coarse", "zfp", ""}) EXPECT_FALSE(hbComparison::isSparseGrid(kind)) << kind;
  EXPECT_EQ(hbComparison::allFits()[1].inWords(), "least squares");
}

TEST(hbComparison, SettingsTellComparisonsApart) {
  const auto settings = valid().settings();
  EXPECT_EQ(settings, valid().settings());
  EXPECT_EQ(settings["levels"], (nlohmann::ordered_json{5, 6, 7, 8}));
  EXPECT_EQ(settings["modes"], (nlohmann::ordered_json{"xray", "mip", "iso", "dvr"}));
  hbComparison c = valid();
  c.scene.isoValue = 2.0;
  EXPECT_NE(c.settings(), settings);
  c = valid();
  c.nonFinite = 0.0;
  EXPECT_NE(c.settings(), settings);
  c = valid();
  c.fits = hbComparison::allFits();
  EXPECT_EQ(c.settings()["fits"], (nlohmann::ordered_json{"opticom", "least-squares"}));
  EXPECT_EQ(c.settings()["loss"], "none");
  EXPECT_FALSE(settings.contains("fits"));
  hbComparison robust = c;
  robust.loss = hbFitLoss::Kind::huber;
  EXPECT_NE(robust.settings(), c.settings());
  c = valid();
  c.limits.maxError = 3.0; // decides what is recommended, not what is measured
  EXPECT_EQ(c.settings(), settings);
}
