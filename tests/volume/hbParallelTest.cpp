#include "volume/hbParallel.h"

#include <atomic>
#include <vector>

#include <gtest/gtest.h>

#include "volume/hbError.h"

TEST(hbParallel, CallsEveryIndexOnceAndSeesWhatBodiesWrote) {
  constexpr std::int64_t kCount = 10007;
  std::vector<int> calls(kCount, 0); // plain, so that ThreadSanitizer sees whether the loop orders these accesses
  for (int round = 1; round <= 3; ++round) {
    hb::parallelFor(kCount, [&](std::int64_t i) { calls[std::size_t(i)] += round; });
    for (int& c : calls) {
      ASSERT_EQ(c, round);
      c = 0;
    }
  }
}

TEST(hbParallel, NothingToDoCallsNothing) {
  hb::parallelFor(0, [](std::int64_t) { FAIL(); });
  hb::parallelFor(-1, [](std::int64_t) { FAIL(); });
}

TEST(hbParallel, ThrowsWhatABodyThrows) {
  std::atomic<std::int64_t> begun = 0;
  const auto failing = [&](std::int64_t i) {
    ++begun;
    if (i % 2 == 1) throw hbError("body");
  };
  EXPECT_THROW(hb::parallelFor(1000, failing), hbError);
  EXPECT_LE(begun, 1000);
  // And the next loop is not disturbed.
  std::atomic<std::int64_t> done = 0;
  hb::parallelFor(1000, [&](std::int64_t) { ++done; });
  EXPECT_EQ(done, 1000);
}

TEST(hbParallel, LoopsMayBeNested) {
  std::vector<std::int64_t> sums(8, 0);
  hb::parallelFor(8, [&](std::int64_t i) {
    std::vector<std::int64_t> parts(64);
    hb::parallelFor(64, [&](std::int64_t j) { parts[std::size_t(j)] = i * j; });
    for (const std::int64_t part : parts) sums[std::size_t(i)] += part;
  });
  for (std::int64_t i = 0; i < 8; ++i) EXPECT_EQ(sums[std::size_t(i)], i * 2016); // 0 + ... + 63
}
