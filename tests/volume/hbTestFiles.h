#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "volume/hbError.h"

/// A folder of its own for the running test, removed with everything in it.
class hbTestFolder {
public:
  hbTestFolder() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::path(::testing::TempDir()) /
            (std::string(test->test_suite_name()) + "." + test->name() + "." + std::to_string(::getpid()));
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~hbTestFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  hbTestFolder(const hbTestFolder&) = delete;
  hbTestFolder& operator=(const hbTestFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

  /// How many files lie in the folder, temporary ones included.
  std::ptrdiff_t files() const {
    return std::distance(std::filesystem::directory_iterator(path_), std::filesystem::directory_iterator());
  }

private:
  std::filesystem::path path_;
};

namespace hb::test {

inline std::vector<std::byte> readFile(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  const auto view = std::as_bytes(std::span(bytes));
  return {view.begin(), view.end()};
}

/// Written over what is there and then cut: some file systems flush a file that is emptied first, which takes longer
/// than all the rest of a test with thousands of variants.
inline void writeFile(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  std::ofstream(path, std::ios::app).close();
  std::ofstream(path, std::ios::binary | std::ios::in | std::ios::out)
      .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
  std::filesystem::resize_file(path, bytes.size());
}

inline std::vector<std::byte> bytesOf(std::string_view text) {
  const auto view = std::as_bytes(std::span(text));
  return {view.begin(), view.end()};
}

/// Overwrites the number at `offset`.
template <class T>
void poke(std::vector<std::byte>& bytes, std::size_t offset, T value) {
  ASSERT_LE(offset + sizeof(T), bytes.size());
  std::memcpy(bytes.data() + offset, &value, sizeof(T));
}

/// The text of the hbError that `f` throws; "no error" where it throws none.
template <class F>
std::string errorOf(F&& f) {
  try {
    f();
  } catch (const hbError& error) {
    return error.what();
  }
  return "no error";
}

} // namespace hb::test

/// Expects `statement` to throw an hbError of one line that contains `text`.
#define EXPECT_HB_ERROR(statement, text)                                                                               \
  do {                                                                                                                 \
    const std::string hbErrorText = hb::test::errorOf([&] { statement; });                                             \
    EXPECT_NE(hbErrorText.find(text), std::string::npos) << "found: " << hbErrorText;                                  \
    EXPECT_EQ(hbErrorText.find('\n'), std::string::npos) << "found: " << hbErrorText;                                  \
  } while (false)
