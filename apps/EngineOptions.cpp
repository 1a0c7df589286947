#include "apps/EngineOptions.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/Program.h"
#include "raycast/hbShearWarp.h"
#include "volume/hbError.h"

void app::EngineOptions::addTo(CLI::App& subcommand) {
  subcommand
      .add_option("--engine", name,
                  "auto; full (plain volumes and fields; sparse grids extracted first); of sparse grids seminodal, "
                  "direct, combination, lattice (shear-warp) or opengl")
      ->group("Rendering")
      ->capture_default_str();
  subcommand.add_option("--supersample", supersample, "Lattice: rays a pixel along either axis (default 1)")
      ->check(CLI::Range(1, hbShearWarp::kMostSupersample))
      ->group("Rendering");
  openGl.addTo(subcommand);
}

hbEngine app::EngineOptions::engine() const {
  const hbEngine engine = hb::engineFromName(name);
  if (engine != hbEngine::lattice && supersample)
    throw hbError(fmt::format("--supersample: expected --engine lattice with it, found {}", hb::engineName(engine)));
  openGl.raycaster(engine == hbEngine::opengl);
  return engine;
}

hbRenderer::Options app::EngineOptions::renderer(const CommonOptions& common) const {
  return {supersample.value_or(1), openGl.kind(), openGl.raycaster(engine() == hbEngine::opengl), common.threads};
}

void app::EngineOptions::describe(const hbRenderer::Facts& facts, nlohmann::ordered_json& statistics) const {
  statistics["sampling"] = facts.sampling;
  if (facts.supersample > 0) {
    statistics["slices"] = facts.slices;
    statistics["supersample"] = facts.supersample;
  }
  if (facts.glContext.empty()) return;
  statistics["texture_bytes"] = facts.textureBytes;
  statistics["texture_bytes_resident"] = facts.residentTextureBytes;
  statistics["gl_form"] = openGl.form;
  statistics["gl_context"] = facts.glContext;
  statistics["gl_vendor"] = facts.glVendor;
  statistics["gl_renderer"] = facts.glRenderer;
  statistics["gl_version"] = facts.glVersion;
}
