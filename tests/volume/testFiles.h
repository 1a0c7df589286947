#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "volume/hbError.h"
#include "volume/hbGeometry.h"

/// Small files for the tests of readers and writers.
namespace test {

/// An empty folder of the running test's own.
inline std::filesystem::path folder() {
  const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
  std::filesystem::path path = std::filesystem::path(::testing::TempDir()) /
                               (std::string("hbvol-") + info->test_suite_name() + "-" + info->name());
  std::filesystem::remove_all(path);
  std::filesystem::create_directories(path);
  return path;
}

inline std::filesystem::path write(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

inline std::string read(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The bytes of a list of samples, big-endian where asked.
template <class T>
std::string bytes(const std::vector<T>& samples, bool bigEndian = false) {
  std::string result;
  for (const T& sample : samples) {
    std::string one(reinterpret_cast<const char*>(&sample), sizeof(T));
    if (bigEndian) one = std::string(one.rbegin(), one.rend());
    result += one;
  }
  return result;
}

/// first, first + 1, ...
template <class T>
std::vector<T> ramp(std::size_t count, T first = T{}) {
  std::vector<T> result(count);
  for (std::size_t i = 0; i < count; ++i) result[i] = T(first + T(i));
  return result;
}

inline hbGeometry sized(std::int64_t x, std::int64_t y, std::int64_t z) {
  hbGeometry g;
  g.size = {x, y, z};
  return g;
}

/// The one line that `f` fails with; "" where it does not.
template <class F>
std::string errorOf(F&& f) {
  try {
    f();
  } catch (const hbError& e) {
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
    return e.what();
  }
  return "";
}

} // namespace test

/// `expression` throws an hbError of one line that contains `text`.
#define EXPECT_ERROR(expression, text)                                                                                 \
  EXPECT_PRED2([](const std::string& message, const std::string& part) { return message.find(part) != message.npos; }, \
               test::errorOf([&] { (void)(expression); }), text)
