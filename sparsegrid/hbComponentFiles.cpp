#include "sparsegrid/hbComponentFiles.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <tuple>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "volume/hbError.h"

namespace fs = std::filesystem;

namespace {

constexpr std::array<std::string_view, 3> kBraces{"{i}", "{j}", "{k}"};

/// A file name with three numbers in it: the text around them, and which level each is.
struct Pattern {
  fs::path folder;
  std::array<std::string, 4> text;
  std::array<int, 3> axis{};
};

Pattern parsePattern(const std::string& pattern) {
  const fs::path path(pattern);
  std::string name = path.filename().string();
  Pattern result;
  result.folder = path.parent_path().empty() ? fs::path(".") : path.parent_path();
  std::array<std::pair<std::size_t, int>, 3> places;
  for (int d = 0; d < 3; ++d) {
    const std::size_t at = name.find(kBraces[std::size_t(d)]);
    if (at == std::string::npos || name.find(kBraces[std::size_t(d)], at + 1) != std::string::npos)
      throw hbError(fmt::format("{}: expected {{i}}, {{j}} and {{k}} once each in the file's name", pattern));
    places[std::size_t(d)] = {at, d};
  }
  std::sort(places.begin(), places.end());
  std::size_t from = 0;
  for (std::size_t n = 0; n < 3; ++n) {
    result.text[n] = name.substr(from, places[n].first - from);
    result.axis[n] = places[n].second;
    from = places[n].first + kBraces[n].size();
  }
  result.text[3] = name.substr(from);
  return result;
}

/// The levels in a file's name, or nothing where it does not fit the pattern.
std::optional<glm::ivec3> match(const Pattern& pattern, std::string_view name) {
  glm::ivec3 levels(0);
  for (std::size_t n = 0; n < 3; ++n) {
    if (!name.starts_with(pattern.text[n])) return std::nullopt;
    name.remove_prefix(pattern.text[n].size());
    int level = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), level);
    if (error != std::errc() || level < 0 || level > hbIndexSet::kMaxLevel) return std::nullopt;
    if (name[0] == '0' && end != name.data() + 1) return std::nullopt; // 02: the same level must not have two names
    name.remove_prefix(std::size_t(end - name.data()));
    levels[pattern.axis[n]] = level;
  }
  return name == pattern.text[3] ? std::optional(levels) : std::nullopt;
}

using Files = std::map<std::tuple<int, int, int>, fs::path>;

Files findFiles(const std::string& pattern) {
  const Pattern parsed = parsePattern(pattern);
  Files files;
  std::error_code error;
  const fs::directory_iterator entries(parsed.folder, error);
  if (error)
    throw hbError(
        fmt::format("{}: expected component grids in files of such names, found none: {}", pattern, error.message()));
  for (const auto& entry : entries)
    if (const auto levels = match(parsed, entry.path().filename().string()))
      files.emplace(std::tuple(levels->x, levels->y, levels->z), entry.path());
  if (files.empty())
    throw hbError(fmt::format("{}: expected component grids in files of such names, found none", pattern));
  return files;
}

/// Every subspace within the levels of one of the files.
hbIndexSet enclosedBy(const Files& files, const glm::bvec3& flat, const std::string& what) {
  glm::ivec3 finest(0);
  std::vector<glm::ivec3> grids;
  for (const auto& [key, path] : files) {
    grids.emplace_back(std::get<0>(key), std::get<1>(key), std::get<2>(key));
    finest = glm::max(finest, grids.back());
  }
  for (int d = 0; d < 3; ++d)
    for (const glm::ivec3& grid : grids)
      if (finest[d] > 0 && grid[d] == 0)
        throw hbError(fmt::format("{}: expected levels from 1 along {}, found 0 beside {}", what, "xyz"[d], finest[d]));
  return hbIndexSet::enclosing(grids, flat, what);
}

std::vector<double> samplesOf(const hbVolume& volume, int component, const fs::path& path) {
  const hbSize3 size = volume.geometry().size;
  std::vector<double> values(std::size_t(volume.geometry().samples()));
  for (std::int64_t z = 0; z < size.z; ++z)
    for (std::int64_t y = 0; y < size.y; ++y)
      volume.row(0, y, z, component, {values.data() + size.x * (y + size.y * z), std::size_t(size.x)});
  if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); }))
    throw hbError(fmt::format("{}: expected finite samples, found NaN or infinite ones", path.string()));
  return values;
}

/// Whether two volumes fill the same box of the world, up to the rounding of a text header.
bool sameBox(const hbGeometry& a, const hbGeometry& b) {
  constexpr double kDigits = 1e-5;
  const glm::dvec3 extent = a.extent();
  const double size = std::max({extent.x, extent.y, extent.z});
  return glm::all(glm::lessThan(glm::abs(a.origin - b.origin), glm::dvec3(kDigits * size))) &&
         glm::all(glm::lessThan(glm::abs(extent - b.extent()), glm::dvec3(kDigits * size)));
}

/// No position and no spacing of its own: what a file says that does not say where it lies.
bool isPlaceless(const hbGeometry& g) {
  return g.origin == glm::dvec3(0.0) && g.spacing == glm::dvec3(1.0) && g.direction == glm::dmat3(1.0);
}

/// The box that all component grids fill: their own, or the unit cube where none of them says where it lies.
hbGeometry commonBox(const hbGeometry& first, const hbIndexSet& set) {
  hbGeometry geometry = first;
  for (int d = 0; d < 3; ++d) {
    geometry.size[d] = set.flat()[d] ? 1 : (std::int64_t{1} << set.finest()[d]) + 1;
    const double edge = isPlaceless(first) ? 1.0 : first.extent()[d];
    geometry.spacing[d] = set.flat()[d] ? edge : edge / double(geometry.size[d] - 1);
  }
  return geometry;
}

} // namespace

hbSparseGrid hb::readComponentGrids(const std::string& pattern, const hbReadOptions& options, hbProgress& progress) {
  const Files files = findFiles(pattern);
  const hbVolume first = hb::readVolume(files.begin()->second, options);
  const glm::bvec3 flat(first.geometry().size.x == 1, first.geometry().size.y == 1, first.geometry().size.z == 1);
  const hbIndexSet set = enclosedBy(files, flat, pattern);

  // The grids' values and the surpluses in 64 bits, the surpluses once more in 32.
  const double need = (8.0 * double(set.combinationValues()) + 12.0 * double(set.storedValues())) * first.components();
  if (need > double(options.memoryLimit))
    throw hbError(fmt::format("{}: expected to need at most {} bytes (the memory limit), found {:.0f}", pattern,
                              options.memoryLimit, need));
  const hbSparseGrid::Frame frame{commonBox(first.geometry(), set), {}, {}};
  std::vector<std::vector<hbSparseGrid::ComponentValues>> grids(std::size_t(first.components()));
  const auto wanted = set.componentGrids();
  progress.begin("reading component grids", std::int64_t(wanted.size()), "files");
  for (const auto& grid : wanted) {
    const auto found = files.find({grid.levels.x, grid.levels.y, grid.levels.z});
    if (found == files.end())
      throw hbError(
          fmt::format("{}: expected a file of levels {}, {}, {}, too, as the files' levels need it, found none",
                      pattern, grid.levels.x, grid.levels.y, grid.levels.z));
    const hbVolume volume = hb::readVolume(found->second, options);
    if (volume.geometry().size != grid.nodes || volume.components() != first.components())
      throw hbError(fmt::format("{}: expected {} x {} x {} samples of {} components, found {} x {} x {} of {}",
                                found->second.string(), grid.nodes.x, grid.nodes.y, grid.nodes.z, first.components(),
                                volume.geometry().size.x, volume.geometry().size.y, volume.geometry().size.z,
                                volume.components()));
    if (!(isPlaceless(first.geometry()) && isPlaceless(volume.geometry())) &&
        !sameBox(first.geometry(), volume.geometry()))
      throw hbError(fmt::format("{}: expected the same box in the world as {}, found another", found->second.string(),
                                files.begin()->second.string()));
    for (int c = 0; c < first.components(); ++c)
      grids[std::size_t(c)].push_back({grid.levels, samplesOf(volume, c, found->second)});
    progress.advance(1);
  }
  return hbSparseGrid::fromComponentGrids(frame, set, grids);
}
