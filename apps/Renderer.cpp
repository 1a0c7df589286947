#include "apps/Renderer.h"

#include <cstdlib>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "raycast/hbRaycaster.h"
#include "raycast/hbShearWarp.h"
#include "volume/hbError.h"

namespace {

class RaycastRenderer final : public app::Renderer {
public:
  RaycastRenderer(const hbField& field, const hbScene& scene) : raycaster_(field, scene) {}

  hbPicture render() override { return raycaster_.render(app::progress()); }
  void look(const hbCamera& camera) override { raycaster_.look(camera); }
  const hbScene& scene() const override { return raycaster_.scene(); }
  void describe(nlohmann::ordered_json& statistics) const override {
    statistics["sampling"] = scene().sampling.kind == hbSampling::Kind::planewise ? "planewise" : "equidistant";
  }

private:
  hbRaycaster raycaster_;
};

class ShearWarpRenderer final : public app::Renderer {
public:
  ShearWarpRenderer(const hbSparseGrid& grid, const hbScene& scene, int supersample)
      : supersample_(supersample), shearWarp_(grid, scene, {supersample}) {}

  hbPicture render() override { return shearWarp_.render(app::progress()); }
  void look(const hbCamera& camera) override { shearWarp_.look(camera); }
  const hbScene& scene() const override { return shearWarp_.scene(); }
  double bytes() const { return shearWarp_.bytes(); }
  void describe(nlohmann::ordered_json& statistics) const override {
    statistics["sampling"] = "object-aligned";
    statistics["slices"] = shearWarp_.slices();
    statistics["supersample"] = supersample_;
  }

private:
  int supersample_;
  hbShearWarp shearWarp_;
};

class OpenGlRenderer final : public app::Renderer {
public:
  OpenGlRenderer(const hbSparseGrid& grid, const hbScene& scene, const app::OpenGlOptions& options)
      : form_(options.form), context_(hbGlContext::create(options.kind())), current_(*context_),
        raycaster_(*context_, grid, scene, options.raycaster(true)) {}

  hbPicture render() override { return raycaster_.render(app::progress()); }
  void look(const hbCamera& camera) override { raycaster_.look(camera); }
  const hbScene& scene() const override { return raycaster_.scene(); }
  void describe(nlohmann::ordered_json& statistics) const override {
    statistics["sampling"] = "planewise";
    statistics["texture_bytes"] = raycaster_.textureBytes();
    statistics["texture_bytes_resident"] = raycaster_.residentBytes();
    statistics["gl_form"] = form_;
    statistics["gl_context"] = context_->kind();
    statistics["gl_vendor"] = context_->vendor();
    statistics["gl_renderer"] = context_->renderer();
    statistics["gl_version"] = context_->version();
  }

private:
  std::string form_;
  std::unique_ptr<hbGlContext> context_;
  hbGlCurrent current_;
  hbOglRaycaster raycaster_;
};

} // namespace

void app::Renderer::check(hbEngine engine, const Options& options) {
  if (engine != hbEngine::lattice && options.supersample)
    throw hbError(fmt::format("--supersample: expected --engine lattice with it, found {}", hb::engineName(engine)));
  options.openGl.raycaster(engine == hbEngine::opengl);
}

std::unique_ptr<app::Renderer> app::Renderer::create(hbEngine engine, const hbInput& input, const hbField& field,
                                                     const hbScene& scene, const Options& options,
                                                     const CommonOptions& common, const std::string& picture) {
  const auto check = [&](double more) { common.checkMemory(32.0 * scene.width * scene.height + more, picture); };
  if (engine == hbEngine::lattice) {
    auto made = std::make_unique<ShearWarpRenderer>(input.sparse->grid, scene, options.supersample.value_or(1));
    check(made->bytes());
    return made;
  }
  if (engine != hbEngine::opengl) {
    check(0.0);
    return std::make_unique<RaycastRenderer>(field, scene);
  }
  if (scene.magnitude)
    throw hbError("--component magnitude: expected another engine than opengl, which draws one component");
  check(hbOglRaycaster::bytes(input.sparse->grid, scene, options.openGl.raycaster(true)));
  // Mesa's software renderer has threads of its own, one a core unless its variable says something else.
  if (common.threads > 0) ::setenv("LP_NUM_THREADS", std::to_string(common.threads).c_str(), 0);
  return std::make_unique<OpenGlRenderer>(input.sparse->grid, scene, options.openGl);
}
