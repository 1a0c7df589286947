#include "report/hbMachine.h"

#include <cmath>

#include <gtest/gtest.h>

#include "report/hbReportJson.h"
#include "volume/hbInstructionSet.h"

TEST(hbMachine, SaysWhatItIs) {
  const hbMachine machine = hbMachine::current();
  EXPECT_FALSE(machine.processor.empty());
  EXPECT_GE(machine.cores, 1);
  EXPECT_GT(machine.memoryBytes, std::uint64_t{1} << 26U);
  EXPECT_TRUE(machine.system.starts_with("Linux ")) << machine.system;
  EXPECT_TRUE(machine.compiler.starts_with("GCC ") || machine.compiler.starts_with("clang ")) << machine.compiler;
  EXPECT_EQ(machine.instructionSet, hb::instructionSet());
  EXPECT_EQ(hb::reportJson(machine)["cores"], machine.cores);
}

TEST(hbReportJson, HasNullWhereThereIsNoNumber) {
  hbErrorStatistics same;
  same.add(1.0, 1.0);
  EXPECT_EQ(hb::reportJson(same, 8.0).dump(), R"({"max":0.0,"rmse":0.0,"psnr":null,"points":1})");
  same.add(1.0, 3.0);
  EXPECT_TRUE(hb::reportJson(same, 0.0)["psnr"].is_null());
  EXPECT_DOUBLE_EQ(hb::reportJson(same, 8.0)["psnr"].get<double>(), 20.0 * std::log10(8.0 / std::sqrt(2.0)));
  EXPECT_TRUE(hb::finiteOrNull(std::numeric_limits<double>::infinity()).is_null());
  EXPECT_TRUE(hb::numberOrNull(std::nullopt).is_null());
  hbPictureDifference picture;
  picture.luvMean = 2.0;
  EXPECT_EQ(hb::reportJson(picture).dump(),
            R"({"max":0.0,"rmse":0.0,"psnr":null,"ssim":null,"luv_mean":2.0,"luv_max":0.0})");
}

TEST(hbReportJson, TextIsUtf8WhateverTheName) {
  const hb::ReportJson stored = hb::storedJson({{"name", "a\xff.nrrd"}});
  EXPECT_EQ(stored["name"], "a\xef\xbf\xbd.nrrd");
  EXPECT_EQ(hb::storedJson(stored), stored);
}
