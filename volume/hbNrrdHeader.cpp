#include "volume/hbNrrdHeader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "volume/hbError.h"
#include "volume/hbHeaderText.h"
#include "volume/hbMappedFile.h"

namespace fs = std::filesystem;

namespace {

// The header is text at the start of a file that may be huge.
constexpr std::uint64_t kMaxHeader = 1 << 20;

/// The fields of a header, their names lower-case and without spaces; keys of key/value pairs start with '='.
using Fields = std::map<std::string, std::string>;

std::string fieldName(std::string_view name) {
  std::string result = hb::lowered(name);
  std::erase(result, ' ');
  return result == "centerings" ? "centers" : result;
}

/// The three-dimensional vectors of a field: "(a,b,c)" with one to three numbers, or "none".
std::vector<std::optional<glm::dvec3>> vectorsOf(const std::string& what, std::string_view text) {
  std::vector<std::optional<glm::dvec3>> result;
  for (text = hb::trimmed(text); !text.empty(); text = hb::trimmed(text)) {
    if (text.starts_with("none")) {
      result.emplace_back();
      text.remove_prefix(4);
      continue;
    }
    const std::size_t end = text.find(')');
    glm::dvec3 v(0.0);
    bool good = text.front() == '(' && end != std::string_view::npos;
    std::string_view inside = good ? text.substr(1, end - 1) : std::string_view{};
    for (int d = 0; good; ++d) {
      const std::size_t comma = inside.find(',');
      const std::optional<double> number = hb::toDouble(inside.substr(0, comma));
      good = number.has_value() && d < 3;
      if (good) v[d] = *number;
      if (comma == std::string_view::npos) break;
      inside.remove_prefix(comma + 1);
    }
    if (!good)
      throw hbError(fmt::format("{}: expected vectors of one to three numbers, as (1,0,0), found '{}'", what, text));
    result.emplace_back(v);
    text.remove_prefix(end + 1);
  }
  return result;
}

/// The numbers of a field, one an axis; empty for a field that is missing.
std::vector<double> numbersOf(const std::string& what, const Fields& fields, const std::string& name,
                              std::size_t axes) {
  std::vector<double> result;
  const auto field = fields.find(name);
  if (field == fields.end()) return result;
  for (const std::string_view word : hb::words(field->second)) {
    const std::optional<double> number = hb::toDouble(word);
    if (!number) throw hbError(fmt::format("{}: {}: expected numbers, found '{}'", what, name, word));
    result.push_back(*number);
  }
  if (result.size() != axes)
    throw hbError(fmt::format("{}: {}: expected {} numbers, found {}", what, name, axes, result.size()));
  return result;
}

/// Splits the fields off; what remains in `text` is the data. Files of a LIST go to `files`.
Fields readFields(const fs::path& path, std::string_view& text, std::vector<fs::path>& files) {
  if (!text.starts_with("NRRD"))
    throw hbError(fmt::format("{}: expected an NRRD file, which starts with NRRD", path.string()));
  Fields fields;
  hb::takeLine(text);
  while (!text.empty()) {
    const std::string_view line = hb::takeLine(text);
    if (line.empty()) break;
    if (line.front() == '#') continue;
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos)
      throw hbError(fmt::format("{}: header: expected 'field: value', found '{}'", path.string(), line.substr(0, 60)));
    if (line.substr(colon).starts_with(":=")) {
      fields[fmt::format("={}", line.substr(0, colon))] = line.substr(colon + 2);
      continue;
    }
    const std::string name = fieldName(line.substr(0, colon));
    fields[name] = hb::trimmed(line.substr(colon + 1));
    if (name != "datafile") continue;
    const std::string& value = fields[name];
    const auto parts = hb::words(value);
    if (value.starts_with("LIST")) {
      while (!text.empty())
        if (const auto file = hb::trimmed(hb::takeLine(text)); !file.empty())
          files.push_back(path.parent_path() / fs::path(file));
    } else if (parts.size() >= 4 && value.find('%') != std::string::npos) {
      throw hbError(fmt::format("{}: data file: expected one file or LIST and the files' names, found the pattern '{}'",
                                path.string(), value));
    } else {
      files.push_back(path.parent_path() / fs::path(value));
    }
  }
  return fields;
}

std::string encodingOf(const fs::path& path, const std::string& name) {
  std::string lower = hb::lowered(name);
  if (lower == "raw" || lower == "hex") return lower;
  if (lower == "gz" || lower == "gzip") return "gzip";
  if (lower == "bz2" || lower == "bzip2") return "bzip2";
  if (lower == "txt" || lower == "text" || lower == "ascii") return "ascii";
  throw hbError(fmt::format("{}: encoding: expected raw, gzip, bzip2, ascii or hex, found '{}'", path.string(), name));
}

/// The world: flips to left-posterior-superior, and the name to keep.
glm::dvec3 flipsOf(std::string& space) {
  const std::string lower = hb::lowered(space);
  glm::dvec3 flips(1.0);
  if (lower == "right-anterior-superior" || lower == "ras")
    flips = {-1.0, -1.0, 1.0};
  else if (lower == "left-anterior-superior" || lower == "las")
    flips = {1.0, -1.0, 1.0};
  else if (lower != "left-posterior-superior" && lower != "lps")
    return flips;
  space = "left-posterior-superior";
  return flips;
}

/// Splits a key's value back into what nrrdEscaped() was given.
std::string unescaped(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && i + 1 < text.size())
      result += text[++i] == 'n' ? '\n' : text[i];
    else
      result += text[i];
  }
  return result;
}

} // namespace

hbNrrdHeader hb::readNrrdHeader(const fs::path& path) {
  std::uint64_t fileSize = 0;
  const std::shared_ptr<const std::byte> file = mapFile(path, fileSize);
  return parseNrrdHeader({reinterpret_cast<const char*>(file.get()), std::min(fileSize, kMaxHeader)}, path);
}

hbNrrdHeader hb::parseNrrdHeader(std::string_view whole, const fs::path& path) {
  std::string_view rest = whole;
  hbNrrdHeader h;
  const Fields fields = readFields(path, rest, h.files);
  h.dataOffset = whole.size() - rest.size();
  const std::string what = path.string();
  const std::string missing;
  const auto field = [&](const std::string& name) -> const std::string& { // a reference, for the views into it
    const auto found = fields.find(name);
    return found == fields.end() ? missing : found->second;
  };
  const auto integer = [&](const std::string& name) {
    const std::string& text = field(name);
    const std::optional<std::int64_t> number = text.empty() ? 0 : toInteger(text);
    if (!number) throw hbError(fmt::format("{}: {}: expected an integer, found '{}'", what, name, text));
    return *number;
  };

  for (const std::string_view word : words(field("sizes"))) {
    const std::optional<std::int64_t> size = toInteger(word);
    if (!size) throw hbError(fmt::format("{}: sizes: expected integers below 2^63, found '{}'", what, word));
    h.sizes.push_back(*size);
  }
  if (h.sizes.empty()) throw hbError(fmt::format("{}: expected a field 'sizes'", what));
  if (!productOf(h.sizes))
    throw hbError(fmt::format("{}: sizes: expected at least one sample along each axis and fewer than 2^60 in all, "
                              "found {}",
                              what, sizesText(h.sizes)));
  h.encoding = encodingOf(path, field("encoding"));
  h.bigEndian = lowered(field("endian")) == "big";
  h.lineSkip = integer("lineskip");
  h.byteSkip = integer("byteskip");
  if (h.lineSkip < 0 || h.byteSkip < -1)
    throw hbError(fmt::format("{}: expected a line skip of 0 or more and a byte skip of -1 or more, found {} and {}",
                              what, h.lineSkip, h.byteSkip));

  // Which axes are space, which one is components.
  const std::size_t axes = h.sizes.size();
  const std::string kinds = lowered(field("kinds"));
  const std::vector<std::string_view> kindOf = words(kinds);
  std::vector<std::size_t> domain;
  for (std::size_t a = 0; a < axes; ++a) {
    constexpr std::array<std::string_view, 5> kDomain{"domain", "space", "time", "???", "none"};
    if (a >= kindOf.size() || std::find(kDomain.begin(), kDomain.end(), kindOf[a]) != kDomain.end()) {
      domain.push_back(a);
    } else if (h.rangeAxis >= 0) {
      throw hbError(fmt::format("{}: kinds: expected one axis of components, found '{}'", what, kinds));
    } else {
      h.rangeAxis = int(a);
      h.masked = kindOf[a].find("masked") != std::string_view::npos;
    }
  }
  while (domain.size() > 3 && h.sizes[domain.back()] == 1) domain.pop_back();
  if (domain.empty() || domain.size() > 3)
    throw hbError(fmt::format("{}: expected one to three axes of space (and `kinds` that tell components apart), "
                              "found {} of sizes {}",
                              what, domain.size(), sizesText(h.sizes)));

  hbGeometry& g = h.geometry;
  const std::vector<std::string_view> centers = words(field("centers"));
  bool cell = false, node = false;
  for (const std::size_t a : domain) {
    cell = cell || (a < centers.size() && centers[a] == "cell");
    node = node || (a < centers.size() && centers[a] == "node");
  }
  if (cell && !node) g.centring = hbGeometry::Centring::cell;

  const auto directions = vectorsOf(what + ": space directions", field("spacedirections"));
  const auto spacings = numbersOf(what, fields, "spacings", axes);
  const auto mins = numbersOf(what, fields, "axismins", axes);
  const auto maxs = numbersOf(what, fields, "axismaxs", axes);
  g.space = field("space");
  const glm::dvec3 flips = flipsOf(g.space);
  if (const std::string& text = field("spaceorigin"); !text.empty()) {
    const auto origin = vectorsOf(what + ": space origin", text);
    if (origin.size() != 1 || !origin[0]) throw hbError(fmt::format("{}: space origin: expected one vector", what));
    g.origin = flips * *origin[0];
  }
  if (!directions.empty() && directions.size() != axes)
    throw hbError(fmt::format("{}: space directions: expected {} vectors, found {}", what, axes, directions.size()));
  for (std::size_t i = 0; i < domain.size(); ++i) {
    const std::size_t a = domain[i];
    const int d = int(i);
    g.size[d] = h.sizes[a];
    if (!directions.empty()) {
      const double length = directions[a] ? glm::length(*directions[a]) : 0.0;
      if (!(length > 0.0) || !std::isfinite(length))
        throw hbError(fmt::format("{}: space directions: expected a finite vector other than 0 for axis {}", what, a));
      g.spacing[d] = length;
      g.direction[d] = flips * *directions[a] / length;
      continue;
    }
    double step = spacings.empty() ? NAN : spacings[a];
    const bool hasMin = !mins.empty() && std::isfinite(mins[a]);
    if (!std::isfinite(step) && hasMin && !maxs.empty() && std::isfinite(maxs[a])) {
      const std::int64_t intervals = cell && !node ? h.sizes[a] : h.sizes[a] - 1;
      if (intervals > 0) step = (maxs[a] - mins[a]) / double(intervals);
    }
    if (!std::isfinite(step) || step == 0.0) step = 1.0;
    g.spacing[d] = std::abs(step);
    g.direction[d] *= step < 0.0 ? -1.0 : 1.0;
    // The least position is the edge of the first cell, or the first node itself.
    if (hasMin) g.origin[d] = cell && !node ? mins[a] + 0.5 * step : mins[a];
  }
  g.validate(what);

  constexpr std::int64_t kMaxComponents = 65536;
  const std::int64_t components = h.rangeAxis < 0 ? 1 : h.sizes[std::size_t(h.rangeAxis)];
  if (components > kMaxComponents)
    throw hbError(fmt::format("{}: sizes: expected at most {} components, found {}", what, kMaxComponents, components));
  h.componentNames.resize(std::size_t(components));
  for (std::size_t c = 0; c < h.componentNames.size(); ++c)
    h.componentNames[c] = unescaped(field(fmt::format("=component name {}", c)));
  return h;
}
