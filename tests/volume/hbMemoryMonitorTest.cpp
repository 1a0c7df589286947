#include "volume/hbMemoryMonitor.h"

#include <vector>

#include <gtest/gtest.h>

TEST(hbMemoryMonitor, SeesMemoryThatIsTouched) {
  hbMemoryMonitor monitor;
  constexpr std::int64_t kBytes = std::int64_t{1} << 26;
  const std::vector<char> touched(std::size_t(kBytes), 1);
  // What else the process gives back meanwhile is far less.
  EXPECT_GE(monitor.growth(), kBytes / 2);
  EXPECT_GE(hbMemoryMonitor::anonymousBytes(), kBytes / 2);
  EXPECT_EQ(touched.back(), 1);
}
