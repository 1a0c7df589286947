#include "volume/fields/hbCavitySpecification.h"

#include <gtest/gtest.h>

#include "tests/volume/hbTestFiles.h"
#include "volume/fields/hbAnalyticField.h"

TEST(hbCavitySpecification, DefaultsAndValues) {
  const auto plain = hbCavitySpecification::parse("cavity");
  EXPECT_EQ(plain.flow.reynolds, 1000.0);
  EXPECT_EQ(plain.flow.prandtl, 0.71);
  EXPECT_EQ(plain.flow.richardson, 0.0);
  EXPECT_EQ(plain.quantity, hbCavityFlow::Quantity::pressure);
  EXPECT_FALSE(plain.endTime.has_value());
  EXPECT_EQ(plain.tolerance, 5e-4);
  EXPECT_EQ(plain.maxSteps, 4000);
  const auto given = hbCavitySpecification::parse(
      "cavity,quantity=velocity-z,reynolds=50,prandtl=7,richardson=-0.5,end-time=2.5,tolerance=1e-6,max-steps=10");
  for (const auto& s : {given, hbCavitySpecification::parse(given.text)}) {
    EXPECT_EQ(s.flow.reynolds, 50.0);
    EXPECT_EQ(s.flow.prandtl, 7.0);
    EXPECT_EQ(s.flow.richardson, -0.5);
    EXPECT_EQ(s.quantity, hbCavityFlow::Quantity::velocityZ);
    EXPECT_EQ(s.endTime, 2.5);
    EXPECT_EQ(s.tolerance, 1e-6);
    EXPECT_EQ(s.maxSteps, 10);
  }
}

TEST(hbCavitySpecification, RefusesWhatIsNone) {
  for (const char* bad : {"reynolds=0", "prandtl=-1", "richardson=11", "tolerance=0", "max-steps=0", "max-steps=1.5"})
    EXPECT_HB_ERROR(hbCavitySpecification::parse("cavity," + std::string(bad)),
                    "field parameter " + std::string(bad).substr(0, std::string(bad).find('=')));
  EXPECT_HB_ERROR(hbCavitySpecification::parse("cavity,max-steps=1.5"), "expected a whole number, found '1.5'");
  for (const char* bad : {"0", "-1", "soon", "1s", "", "inf", "nan", "10001"})
    EXPECT_HB_ERROR(hbCavitySpecification::parse("cavity,end-time=" + std::string(bad)),
                    "field parameter end-time: expected a positive time up to 10000, or steady, found '" +
                        std::string(bad) + "'");
  EXPECT_HB_ERROR(hbCavitySpecification::parse("cavity,quantity=heat"),
                  "expected one of pressure, temperature, velocity-x, velocity-y, velocity-z, speed, found 'heat'");
  EXPECT_HB_ERROR(hbCavitySpecification::parse("cavity,lid=1"), "field cavity: expected parameters among");
}

TEST(hbCavitySpecification, IsNoAnalyticField) {
  EXPECT_HB_ERROR(hbAnalyticField::create("cavity,reynolds=50"), "hbvol generate cavity");
}
