#include "volume/hbMemoryMonitor.h"

#include <chrono>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

TEST(hbMemoryMonitor, SeesMemoryThatIsGivenBack) {
  constexpr std::int64_t kBytes = std::int64_t{1} << 26;
  hbMemoryMonitor monitor;
  // It is asked when the memory is gone; how long that has to be there until it looks is the system's affair.
  for (int wait = 1; monitor.growth() < kBytes / 2; wait *= 2) {
    ASSERT_LT(wait, 1 << 14) << "it never looks";
    const std::vector<char> touched(std::size_t(kBytes), 1);
    std::this_thread::sleep_for(std::chrono::milliseconds(wait));
    EXPECT_GE(hbMemoryMonitor::anonymousBytes(), kBytes / 2);
  }
}
