#include "apps/Program.h"

#include <charconv>
#include <cmath>
#include <cstdio>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "volume/hbError.h"
#include "volume/hbOutputFile.h"

namespace app {

void CommonOptions::addTo(CLI::App& subcommand) {
  subcommand.add_option("--threads", threads, "Threads to use (default: one a core)")
      ->check(CLI::Range(1, 1024))
      ->group("Common");
  subcommand
      .add_option("--memory", memory, "Memory limit, as in 500MB or 2GB (powers of 1024); checked before work starts")
      ->transform(CLI::AsSizeValue(false))
      ->group("Common");
  subcommand.add_option("--stats", stats, "Write what was measured to this JSON file")
      ->type_name("FILE.json")
      ->group("Common");
}

std::uint64_t CommonOptions::memoryLimit() const {
  if (memory > 0) return memory;
  return std::uint64_t(::sysconf(_SC_PHYS_PAGES)) * std::uint64_t(::sysconf(_SC_PAGESIZE));
}

void CommonOptions::checkMemory(std::uint64_t bytes, const std::string& what) const {
  if (bytes > memoryLimit())
    throw hbError(fmt::format("{}: needs about {}, more than the limit of {}{}", what, bytesText(double(bytes)),
                              bytesText(double(memoryLimit())),
                              memory > 0 ? " (--memory)" : " (the machine's memory)"));
}

void CommonOptions::writeStats(nlohmann::ordered_json statistics) const {
  if (stats.empty()) return;
  statistics["version"] = HBVOL_VERSION;
  statistics["command"] = command;
  hbOutputFile file(stats);
  const std::string text = statistics.dump(2) + "\n";
  std::FILE* out = std::fopen(file.path().c_str(), "wb");
  const bool written = out != nullptr && std::fwrite(text.data(), 1, text.size(), out) == text.size();
  if ((out != nullptr && std::fclose(out) != 0) || !written) throw hbError(fmt::format("{}: cannot be written", stats));
  file.commit();
}

void InputOptions::addTo(CLI::App& command, const std::string& positional) {
  command
      .add_option(positional, name,
                  "A volume file, a folder of DICOM slices, an .hbv file, or field:NAME[,parameter=value...]")
      ->required()
      ->type_name("");
  addReadTo(command);
}

void InputOptions::addReadTo(CLI::App& command) {
  command.add_option("--series", series, "Of a folder with several DICOM series: the UID of the one to read")
      ->group("Input");
  command.add_option("--nan-value", nanValue, "Take NaN and infinite samples as this value instead of refusing them")
      ->group("Input");
  const auto add = [&](const char* flag, auto& value, const char* text) {
    return command.add_option(flag, value, text)->group("Raw input");
  };
  add("--raw-size", rawSize, "Samples along x, y, z: 256x256x128; makes IN a raw file")->type_name("XxYxZ");
  add("--raw-type", rawType, "int8, uint8, int16, uint16, int32, uint32, float32 or float64")->capture_default_str();
  add("--raw-byte-order", rawOrder, "little or big")->check(CLI::IsMember({"little", "big"}))->capture_default_str();
  add("--raw-axis-order", rawAxes, "The axes from the file's fastest to its slowest")
      ->check(CLI::IsMember({"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"}))
      ->capture_default_str();
  add("--raw-offset", rawOffset, "Bytes before the first sample")->capture_default_str();
  add("--raw-components", rawComponents, "Components of a sample")->check(CLI::Range(1, 65535))->capture_default_str();
  add("--raw-interleaving", rawInterleaving, "packed: components side by side; planar: one after the other")
      ->check(CLI::IsMember({"packed", "planar"}))
      ->capture_default_str();
  add("--raw-spacing", rawSpacing, "World distances between samples: 1,1,2.5")->type_name("X,Y,Z");
}

hbInput InputOptions::open(const std::string& file, const CommonOptions& common, hbProgress& progress) const {
  hbReadOptions options;
  options.memoryLimit = common.memoryLimit();
  options.series = series;
  if (!rawSize.empty()) {
    hbRawLayout raw;
    const auto sizes = parseSizes(rawSize, 3, "--raw-size");
    raw.size = {sizes[0], sizes[1], sizes[2]};
    raw.type = hb::sampleTypeFromName(rawType);
    raw.bigEndian = rawOrder == "big";
    raw.axisOrder = rawAxes;
    raw.offset = rawOffset;
    raw.components = rawComponents;
    raw.interleaving =
        rawInterleaving == "planar" ? hbRawLayout::Interleaving::planar : hbRawLayout::Interleaving::packed;
    if (!rawSpacing.empty()) {
      const auto spacing = parseNumbers(rawSpacing, 3, 3, "--raw-spacing");
      raw.spacing = {spacing[0], spacing[1], spacing[2]};
    }
    options.raw = raw;
  }
  return hbInput::open(file, options, progress);
}

namespace {

/// The numbers between `separator`s, or nothing where one is none.
template <class T>
std::optional<std::vector<T>> split(const std::string& text, char separator) {
  std::vector<T> list;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (true) {
    T value{};
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc()) return std::nullopt;
    list.push_back(value);
    if (next == end) return list;
    if (*next != separator) return std::nullopt;
    at = next + 1;
  }
}

} // namespace

std::vector<std::int64_t> parseSizes(const std::string& text, std::size_t count, const std::string& option) {
  const auto valid = [](std::int64_t size) { return size >= 1 && size <= (std::int64_t{1} << 40); };
  auto sizes = split<std::int64_t>(text, 'x');
  if (sizes && sizes->size() == 1 && count == 3) sizes->resize(3, sizes->front());
  if (!sizes || sizes->size() != count || !std::all_of(sizes->begin(), sizes->end(), valid))
    throw hbError(fmt::format("{}: expected {}, found '{}'", option,
                              count == 3 ? "sizes such as 256x256x128" : "sizes such as 640x480", text));
  return *sizes;
}

std::vector<double> parseNumbers(const std::string& text, std::size_t least, std::size_t most,
                                 const std::string& option) {
  const auto numbers = split<double>(text, ',');
  if (!numbers || numbers->size() < least || numbers->size() > most ||
      !std::all_of(numbers->begin(), numbers->end(), [](double v) { return std::isfinite(v); }))
    throw hbError(fmt::format("{}: expected {} numbers separated by commas, found '{}'", option,
                              least == most ? std::to_string(least) : fmt::format("{} to {}", least, most), text));
  return *numbers;
}

std::string bytesText(double bytes) {
  constexpr const char* kUnits[] = {"bytes", "kB", "MB", "GB", "TB", "PB", "EB"};
  int unit = 0;
  for (; bytes >= 1024.0 && unit < 6; ++unit) bytes /= 1024.0;
  return unit == 0 ? fmt::format("{:.0f} bytes", bytes)
                   : fmt::format("{:.{}f} {}", bytes,
                                 bytes < 10.0    ? 2
                                 : bytes < 100.0 ? 1
                                                 : 0,
                                 kUnits[unit]);
}

nlohmann::ordered_json finiteOrNull(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json();
}

} // namespace app
