// Scenes as JSON, from files and from the metadata of pictures; and paths of cameras.

#include <string>

#include "scene/hbCameraPath.h"
#include "scene/hbScene.h"
#include "tests/fuzz/fuzz.h"

namespace {

void readPath(const std::string& text) {
  const std::vector<hbCamera> cameras = hb::pathFromJson(text, "path.json");
  fuzz::expect(hb::pathFromJson(hb::toJson(cameras), "again") == cameras);
  for (const hbCamera& camera : hb::orbit(cameras.front(), 3)) camera.ray(0.5, 0.5, 3, 2);
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  fuzz::allowErrors([&] { readPath(text); });
  fuzz::allowErrors([&] {
    const hbScene scene = hb::sceneFromJson(text, "scene.json");
    fuzz::expect(hb::sceneFromJson(hb::toJson(scene), "again") == scene);
    hbGeometry geometry;
    geometry.size = {3, 2, 1};
    const hbCamera camera = scene.cameraFor(geometry);
    camera.ray(0.5, 0.5, scene.width, scene.height);
    hbSampling::extent(geometry, camera);
    const int planes = scene.sampling.planes(geometry, camera);
    fuzz::expect(planes >= 1 && planes <= hbSampling::kMaxSamples);
    scene.sampling.stepLength(geometry, camera);
    if (scene.shading) scene.shading->reflection(camera.target, camera.viewAxis(), camera.up);
  });
  return 0;
}
