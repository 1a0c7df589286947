#include <cmath>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <glm/matrix.hpp>
#include <nlohmann/json.hpp>

#include "apps/Program.h"
#include "volume/hbError.h"

namespace {

struct Options {
  app::InputOptions input;
  std::string points, space = "world", engine = "auto";
  int component = 0;
};

/// Lines of three numbers, separated by blanks or commas; '#' begins a comment.
std::vector<glm::dvec3> readPoints(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw hbError(fmt::format("{}: cannot be read", path));
  std::vector<glm::dvec3> points;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    line = line.substr(0, line.find('#'));
    std::replace(line.begin(), line.end(), ',', ' ');
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    std::istringstream words(line);
    glm::dvec3 p;
    std::string rest;
    if (!(words >> p.x >> p.y >> p.z) || words >> rest)
      throw hbError(fmt::format("{}: line {}: expected three numbers, found '{}'", path, number, line));
    points.push_back(p);
  }
  if (file.bad()) throw hbError(fmt::format("{}: cannot be read to its end", path)); // a folder, too
  return points;
}

void run(const Options& options, const app::CommonOptions& common) {
  const hbInput input = options.input.open(common, app::progress());
  const auto field = options.input.field(input, options.engine, common);
  if (options.component >= field->components())
    throw hbError(fmt::format("--component: expected 0 to {}, found {}", field->components() - 1, options.component));
  const std::vector<glm::dvec3> points = readPoints(options.points);
  const bool world = options.space == "world";
  const glm::dmat4 toCube = world ? glm::inverse(input.geometry().cubeToWorld()) : glm::dmat4(1.0);
  const glm::dmat3 gradientBack = glm::transpose(glm::dmat3(toCube));
  const hbValueMap map = field->valueMap();

  const std::size_t n = points.size();
  std::vector<float> x(n), y(n), z(n), value(n), dx(n), dy(n), dz(n);
  std::vector<bool> inside(n);
  for (std::size_t i = 0; i < n; ++i) {
    const glm::dvec3 p(toCube * glm::dvec4(points[i], 1.0));
    constexpr double kEdge = 1e-9; // a corner mapped to the cube and back
    inside[i] =
        p.x >= -kEdge && p.y >= -kEdge && p.z >= -kEdge && p.x <= 1 + kEdge && p.y <= 1 + kEdge && p.z <= 1 + kEdge;
    x[i] = float(p.x);
    y[i] = float(p.y);
    z[i] = float(p.z);
  }
  field->gradients({x, y, z}, options.component, value, {dx, dy, dz});
  fmt::print("x,y,z,value,dx,dy,dz\n");
  for (std::size_t i = 0; i < n; ++i) {
    const glm::dvec3 p = points[i], g = gradientBack * glm::dvec3(dx[i], dy[i], dz[i]) * map.scale;
    if (inside[i])
      fmt::print("{},{},{},{},{},{},{}\n", p.x, p.y, p.z, map.toTrue(value[i]), g.x, g.y, g.z);
    else
      fmt::print("{},{},{},nan,nan,nan,nan\n", p.x, p.y, p.z);
  }
  common.writeStats({{"points", n}, {"engine", hb::engineName(input.engine(hb::engineFromName(options.engine)))}});
}

app::Work prepare(const Options& options, const app::CommonOptions& common) {
  options.input.rawLayout();
  hb::engineFromName(options.engine);
  return [&] { run(options, common); };
}

} // namespace

void addProbe(CLI::App& program, const app::CommonOptions& common, app::Work& work) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      program.add_subcommand("probe", "Prints values and gradients at points, as CSV (nan outside the volume)");
  options->input.addTo(*command);
  command->add_option("--points", options->points, "Text file: x y z a line, blanks or commas, # for comments")
      ->required()
      ->type_name("FILE");
  command->add_option("--space", options->space, "What the coordinates and gradients are in: world, or the unit cube")
      ->check(CLI::IsMember({"world", "cube"}))
      ->capture_default_str();
  command->add_option("--engine", options->engine, "auto, full, seminodal, direct or combination")
      ->capture_default_str();
  command->add_option("--component", options->component, "Which component, from 0")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->callback([options, &common, &work] { work = prepare(*options, common); });
}
