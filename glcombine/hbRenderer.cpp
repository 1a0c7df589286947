#include "glcombine/hbRenderer.h"

#include <cstdlib>

#include "raycast/hbRaycaster.h"
#include "raycast/hbShearWarp.h"
#include "volume/hbError.h"

namespace {

class RaycastRenderer final : public hbRenderer {
public:
  RaycastRenderer(const hbField& field, const hbScene& scene) : raycaster_(field, scene) {}

  hbPicture render(hbProgress& progress) override { return raycaster_.render(progress); }
  void look(const hbCamera& camera) override { raycaster_.look(camera); }
  const hbScene& scene() const override { return raycaster_.scene(); }
  Facts facts() const override {
    Facts facts;
    facts.sampling = scene().sampling.kind == hbSampling::Kind::planewise ? "planewise" : "equidistant";
    return facts;
  }

private:
  hbRaycaster raycaster_;
};

class ShearWarpRenderer final : public hbRenderer {
public:
  ShearWarpRenderer(const hbSparseGrid& grid, const hbScene& scene, int supersample)
      : supersample_(supersample), shearWarp_(grid, scene, {supersample}) {}

  hbPicture render(hbProgress& progress) override { return shearWarp_.render(progress); }
  void look(const hbCamera& camera) override { shearWarp_.look(camera); }
  const hbScene& scene() const override { return shearWarp_.scene(); }
  double bytes() const { return shearWarp_.bytes(); }
  Facts facts() const override {
    Facts facts;
    facts.sampling = "object-aligned";
    facts.slices = shearWarp_.slices();
    facts.supersample = supersample_;
    return facts;
  }

private:
  int supersample_;
  hbShearWarp shearWarp_;
};

class OpenGlRenderer final : public hbRenderer {
public:
  OpenGlRenderer(const hbSparseGrid& grid, const hbScene& scene, const Options& options)
      : context_(hbGlContext::create(options.context)), current_(*context_),
        raycaster_(*context_, grid, scene, options.openGl) {}

  hbPicture render(hbProgress& progress) override { return raycaster_.render(progress); }
  void look(const hbCamera& camera) override { raycaster_.look(camera); }
  const hbScene& scene() const override { return raycaster_.scene(); }
  Facts facts() const override {
    Facts facts;
    facts.sampling = "planewise";
    facts.textureBytes = raycaster_.textureBytes();
    facts.residentTextureBytes = raycaster_.residentBytes();
    facts.glContext = context_->kind();
    facts.glVendor = context_->vendor();
    facts.glRenderer = context_->renderer();
    facts.glVersion = context_->version();
    return facts;
  }

private:
  std::unique_ptr<hbGlContext> context_;
  hbGlCurrent current_;
  hbOglRaycaster raycaster_;
};

} // namespace

std::unique_ptr<hbRenderer> hbRenderer::create(hbEngine engine, const hbInput& input, const hbField& field,
                                               const hbScene& scene, const Options& options,
                                               const std::function<void(double)>& checkMemory) {
  // A picture's channels in floats, and copies on the way.
  const double picture = 32.0 * scene.width * scene.height;
  if (engine == hbEngine::lattice) {
    auto made = std::make_unique<ShearWarpRenderer>(input.sparse->grid, scene, options.supersample);
    checkMemory(picture + made->bytes());
    return made;
  }
  if (engine != hbEngine::opengl) {
    checkMemory(picture);
    return std::make_unique<RaycastRenderer>(field, scene);
  }
  if (scene.magnitude)
    throw hbError("--component magnitude: expected another engine than opengl, which draws one component");
  checkMemory(picture + hbOglRaycaster::bytes(input.sparse->grid, scene, options.openGl));
  // Mesa's software renderer has threads of its own, one a core unless its variable says something else.
  if (options.threads > 0) ::setenv("LP_NUM_THREADS", std::to_string(options.threads).c_str(), 0);
  return std::make_unique<OpenGlRenderer>(input.sparse->grid, scene, options);
}
