// Command lines, as far as they are checked before anything is opened. The first byte chooses the command, the lines
// after it are its arguments: i info, g generate, c compress, e extract, r render, p probe, d diff; w: the lines are
// the whole command line; s: the options of a scene, which is made; m: the limits of metrics, which are applied; x: the
// text of an index set.

#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/CommandLine.h"
#include "apps/MetricLimits.h"
#include "apps/Program.h"
#include "apps/SceneOptions.h"
#include "sparsegrid/hbIndexSetFile.h"
#include "tests/fuzz/fuzz.h"
#include "volume/fields/hbCavitySpecification.h"

namespace {

/// The lines of a text, each up to its first zero byte, as arguments are.
std::vector<std::string> linesOf(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    lines.emplace_back(line.substr(0, line.find('\0')));
  }
  return lines;
}

/// Parses arguments into `program`; false where they are wrong, or ask for help.
bool parse(CLI::App& program, const std::vector<std::string>& arguments) {
  try {
    program.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend())); // CLI11 takes them from the back
    return true;
  } catch (const CLI::ParseError&) {
    return false;
  }
}

using Add = void (*)(CLI::App&, const app::CommonOptions&, app::Work&);

void parseCommand(Add add, std::vector<std::string> arguments) {
  CLI::App program;
  app::CommonOptions common;
  app::Work work;
  add(program, common, work);
  CLI::App* command = program.get_subcommands({}).front();
  common.addTo(*command);
  arguments.insert(arguments.begin(), command->get_name());
  if (parse(program, arguments)) fuzz::expect(bool(work));
}

void parseWhole(const std::vector<std::string>& arguments) {
  std::vector<const char*> pointers{"hbvol"};
  for (const std::string& argument : arguments) pointers.push_back(argument.c_str());
  app::CommandLine line;
  try {
    fuzz::expect(bool(line.parse(int(pointers.size()), pointers.data())));
  } catch (const app::WrongUsage& error) {
    fuzz::expect(!std::string_view(error.what()).empty());
  }
}

void parseScene(const std::vector<std::string>& arguments) {
  CLI::App program;
  app::SceneOptions options;
  options.addTo(program);
  // Another target reads scene files; here they would be any file of the machine.
  if (!parse(program, arguments) || !options.file.empty()) return;
  hbGeometry geometry;
  geometry.size = {3, 2, 1};
  hbScene scene = options.scene(geometry);
  scene.validate();
  fuzz::expect(scene.sampling.planes(geometry, scene.cameraFor(geometry)) >= 1);
}

void parseLimits(const std::vector<std::string>& arguments) {
  app::MetricLimits limits{arguments, arguments};
  limits.check();
  limits.apply(
      {{"max", 0.5}, {"rmse", nullptr}, {"psnr", nullptr}, {"ssim", nullptr}, {"luv_mean", 2.0}, {"luv_max", 3.0}});
}

/// A set that is read is the one that its own text gives.
void parseIndexSet(std::string_view text) {
  const hbIndexSetFile file = hbIndexSetFile::fromText(text, "set.txt");
  for (const hbSize3& size : {hbSize3(33, 9, 5), hbSize3(9, 2, 1)})
    fuzz::allowErrors([&] {
      const std::string written = hbIndexSetFile::text(file.indexSet(size));
      fuzz::expect(hbIndexSetFile::text(hbIndexSetFile::fromText(written, "again").indexSet(size)) == written);
    });
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::vector<std::string> arguments = linesOf({reinterpret_cast<const char*>(data) + 1, size - 1});
  for (const std::string& argument : arguments)
    if (argument.starts_with(hbInput::kFieldPrefix))
      fuzz::allowErrors(
          [&] { hbAnalyticField::create(std::string_view(argument).substr(hbInput::kFieldPrefix.size())); });
  for (const std::string& argument : arguments)
    if (argument.starts_with(hbCavitySpecification::kName))
      fuzz::allowErrors([&] { hbCavitySpecification::parse(argument); });
  constexpr std::string_view kCommands = "igcerpd";
  constexpr Add kAdds[] = {addInfo, addGenerate, addCompress, addExtract, addRender, addProbe, addDiff, addCompare};
  fuzz::allowErrors([&] {
    if (const std::size_t command = kCommands.find(char(data[0])); command != std::string_view::npos)
      parseCommand(kAdds[command], arguments);
    else if (data[0] == 'w')
      parseWhole(arguments);
    else if (data[0] == 's')
      parseScene(arguments);
    else if (data[0] == 'm')
      parseLimits(arguments);
    else if (data[0] == 'x')
      parseIndexSet({reinterpret_cast<const char*>(data) + 1, size - 1});
  });
  return 0;
}
