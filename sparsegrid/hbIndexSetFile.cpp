#include "sparsegrid/hbIndexSetFile.h"

#include <cstdint>
#include <map>
#include <set>
#include <tuple>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "volume/hbError.h"
#include "volume/hbHeaderText.h"
#include "volume/hbTextFile.h"

namespace {

constexpr std::uint64_t kMaxFileBytes = std::uint64_t{1} << 20;

std::tuple<int, int, int> key(const glm::ivec3& l) { return {l.x, l.y, l.z}; }

std::string levelsText(const glm::ivec3& l) { return fmt::format("({},{},{})", l.x, l.y, l.z); }

/// The subspace with each level 1 left as it is or made 0, whichever way `corner`'s bits say.
glm::ivec3 withZeros(glm::ivec3 levels, int corner) {
  for (int d = 0; d < 3; ++d)
    if (levels[d] == 1 && (corner >> d & 1) != 0) levels[d] = 0;
  return levels;
}

} // namespace

std::string hbIndexSetFile::place(const Line& line) const { return fmt::format("{}: line {}", source_, line.number); }

hbIndexSetFile hbIndexSetFile::fromText(std::string_view text, const std::string& source) {
  hbIndexSetFile file;
  file.source_ = source;
  std::map<std::tuple<int, int, int>, int> lineOf;
  for (int number = 1; !text.empty(); ++number) {
    std::string_view content = hb::takeLine(text);
    content = hb::trimmed(content.substr(0, content.find('#')));
    if (content.empty()) continue;
    Line line{glm::ivec3(0), number};
    const auto words = hb::words(content);
    bool valid = words.size() == 3;
    for (std::size_t d = 0; d < 3 && valid; ++d) {
      const auto level = hb::toInteger(words[d]);
      valid = level && *level >= 0 && *level <= hbIndexSet::kMaxLevel;
      if (valid) line.levels[int(d)] = int(*level);
    }
    if (!valid)
      throw hbError(fmt::format("{}: expected three levels from 0 to {}, found '{}'", file.place(line),
                                hbIndexSet::kMaxLevel, hb::excerpt(content)));
    if (const auto [first, isNew] = lineOf.emplace(key(line.levels), number); !isNew)
      throw hbError(fmt::format("{}: expected each subspace once, found {} of line {} again", file.place(line),
                                levelsText(line.levels), first->second));
    file.lines_.push_back(line);
  }
  if (file.lines_.empty()) throw hbError(fmt::format("{}: expected a subspace a line, found none", source));
  return file;
}

hbIndexSetFile hbIndexSetFile::load(const std::filesystem::path& path) {
  return fromText(hb::loadText(path, kMaxFileBytes, "an index set"), path.string());
}

std::vector<hbIndexSetFile::Line> hbIndexSetFile::linesOn(const hbIndexSet::Axes& axes) const {
  std::vector<Line> lines = lines_;
  for (Line& line : lines)
    for (int d = 0; d < 3; ++d) {
      if (axes.maxLevel[d] > 0) continue;
      if (line.levels[d] > 1)
        throw hbError(fmt::format("{}: expected level 0 or 1 along {}, which has {}, found {}", place(line), "xyz"[d],
                                  axes.flat[d] ? "one sample" : "two samples", line.levels[d]));
      line.levels[d] = 0;
    }
  return lines;
}

hbIndexSet hbIndexSetFile::indexSet(const hbSize3& size) const {
  const hbIndexSet::Axes axes = hbIndexSet::uncappedAxesOf(size);
  const std::vector<Line> lines = linesOn(axes);
  glm::ivec3 finest(0);
  std::set<std::tuple<int, int, int>> listed;
  for (const Line& line : lines) {
    finest = glm::max(finest, line.levels);
    for (int corner = 0; corner < 8; ++corner) listed.insert(key(withZeros(line.levels, corner)));
  }
  // Checked here and not by fromList() alone, which knows no lines.
  for (const Line& line : lines)
    for (int d = 0; d < 3; ++d) {
      glm::ivec3 needed = line.levels;
      needed[d] = line.levels[d] > 0 ? line.levels[d] - 1 : glm::min(finest[d], 1);
      if (!listed.contains(key(needed)))
        throw hbError(fmt::format("{}: expected {}, which {} needs, found no such line", place(line),
                                  levelsText(needed), levelsText(line.levels)));
    }
  std::vector<glm::ivec3> levels;
  for (const auto& [x, y, z] : listed) levels.emplace_back(x, y, z);
  return hbIndexSet::fromList(levels, axes.flat, source_);
}

std::string hbIndexSetFile::text(const hbIndexSet& set) {
  std::string text = "# lx ly lz\n";
  for (const hbSubspace& subspace : set.subspaces()) {
    const glm::ivec3 l = subspace.levels;
    if (l == glm::max(l, glm::min(set.finest(), 1))) text += fmt::format("{} {} {}\n", l.x, l.y, l.z);
  }
  return text;
}
