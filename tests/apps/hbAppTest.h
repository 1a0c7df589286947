#pragma once

#include <cstddef>
#include <fstream>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/apps/hbProgramRun.h"
#include "tests/volume/hbTestFiles.h"
#include "volume/hbVolume.h"
#include "volume/hbVolumeWriter.h"

/// A test that runs the program in a folder of its own, where files are known by their bare names.
class hbAppTest : public ::testing::Test {
protected:
  hbTestFolder folder_;

  hbProgramRun run(std::vector<std::string> arguments, hbProgramRun::Conditions conditions = {}) const {
    conditions.folder = folder_.path().string();
    return {std::move(arguments), conditions};
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::vector<std::byte> bytes(const std::string& name) const { return hb::test::readFile(folder_ / name); }

  void write(const std::string& name, std::string_view text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }

  /// A volume file of size x*y*z whose samples are value(x, y, z, component), as T.
  template <class T>
  void writeVolume(const std::string& name, const hbSize3& size, int components,
                   const std::function<double(std::int64_t, std::int64_t, std::int64_t, int)>& value) const {
    hbGeometry geometry;
    geometry.size = size;
    std::vector<T> samples;
    for (std::int64_t z = 0; z < size.z; ++z)
      for (std::int64_t y = 0; y < size.y; ++y)
        for (std::int64_t x = 0; x < size.x; ++x)
          for (int c = 0; c < components; ++c) samples.push_back(T(value(x, y, z, c)));
    hb::writeVolume(hbVolume::fromSamples(geometry, std::move(samples), components), folder_ / name);
  }

  nlohmann::json json(const std::string& name) const {
    std::ifstream file(folder_ / name);
    const auto parsed = nlohmann::json::parse(file, nullptr, false);
    EXPECT_FALSE(parsed.is_discarded()) << name;
    return parsed;
  }

  /// Expects the run to fail and the folder to keep its files, each with the bytes it had.
  void expectFailureLeavesAll(const std::vector<std::string>& arguments, int code, std::string_view words,
                              const hbProgramRun::Conditions& conditions = {}) const {
    const auto before = contents();
    EXPECT_FAILS(run(arguments, conditions), code, words);
    EXPECT_TRUE(contents() == before) << "changed by " << arguments.front() << ": " << names(contents());
  }

  using Contents = std::vector<std::pair<std::string, std::vector<std::byte>>>;
  /// The names of the regular files, in order, and what is in them.
  Contents contents() const {
    Contents list;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path()))
      if (entry.is_regular_file()) list.emplace_back(entry.path().string(), hb::test::readFile(entry.path()));
    std::sort(list.begin(), list.end());
    return list;
  }
  static std::string names(const Contents& contents) {
    std::string text;
    for (const auto& [name, bytes] : contents) text += name + " ";
    return text;
  }
};
