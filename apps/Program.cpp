#include "apps/Program.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <set>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "volume/hbError.h"
#include "volume/hbInstructionSet.h"
#include "volume/hbOutputFile.h"

namespace app {

void CommonOptions::addTo(CLI::App& subcommand) {
  subcommand.add_option("--threads", threads, "Threads to use (default: one a core)")
      ->check(CLI::Range(1, 1024))
      ->group("Common");
  subcommand
      .add_option("--memory", memory, "Memory limit, as in 500MB or 2GB (powers of 1024); checked before work starts")
      ->transform(CLI::AsSizeValue(false))
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 60, "SIZE"))
      ->group("Common");
  subcommand.add_option("--stats", stats, "Write what was measured to this JSON file")
      ->type_name("FILE.json")
      ->group("Common");
}

std::uint64_t CommonOptions::memoryLimit() const {
  if (memory > 0) return memory;
  return std::uint64_t(::sysconf(_SC_PHYS_PAGES)) * std::uint64_t(::sysconf(_SC_PAGESIZE));
}

void CommonOptions::checkMemory(double bytes, const std::string& what) const {
  if (bytes > double(memoryLimit()))
    throw hbError(fmt::format("{}: needs about {}, more than the limit of {}{}", what, bytesText(bytes),
                              bytesText(double(memoryLimit())),
                              memory > 0 ? " (--memory)" : " (the machine's memory)"));
}

void CommonOptions::checkOutputs(std::vector<std::string> names) const {
  names.push_back(stats);
  std::set<std::filesystem::path> files;
  for (const std::string& name : names) {
    std::error_code none;
    if (!name.empty() && !files.insert(std::filesystem::weakly_canonical(name, none)).second)
      throw hbError(fmt::format("{}: would be written twice", name));
  }
}

void CommonOptions::writeStats(nlohmann::ordered_json statistics) const {
  if (stats.empty()) return;
  statistics["version"] = HBVOL_VERSION;
  statistics["instruction_set"] = hb::instructionSet();
  statistics["command"] = command;
  hbOutputFile file(stats);
  const std::string text = statistics.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
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
      ->group("Input")
      ->check([](const std::string& text) { // "nan" and "inf" are numbers, too
        return std::isfinite(std::strtod(text.c_str(), nullptr)) ? "" : "expected a finite number, found " + text;
      });
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

std::optional<hbRawLayout> InputOptions::rawLayout() const {
  if (rawSize.empty()) return std::nullopt;
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
  return raw;
}

hbInput InputOptions::open(const std::string& file, const CommonOptions& common, hbProgress& progress) const {
  hbReadOptions options;
  options.memoryLimit = common.memoryLimit();
  options.series = series;
  options.raw = rawLayout();
  return hbInput::open(file, options, progress);
}

std::shared_ptr<const hbField> InputOptions::field(const hbInput& input, const std::string& engine,
                                                   const CommonOptions& common) const {
  const hbEngine chosen = input.engine(hb::engineFromName(engine));
  if (input.sparse) {
    const double loaded = double(sizeof(float)) * double(input.sparse->grid.indexSet().storedValues());
    common.checkMemory(loaded * input.components() + input.fieldBytes(chosen), input.name);
  }
  return input.field(chosen, nanValue, app::progress());
}

} // namespace app
