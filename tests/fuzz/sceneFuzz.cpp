// Scenes as JSON, from files and from the metadata of pictures.

#include <string>

#include "scene/hbScene.h"
#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::allowErrors([&] {
    const hbScene scene = hb::sceneFromJson(std::string(reinterpret_cast<const char*>(data), size), "scene.json");
    fuzz::expect(hb::sceneFromJson(hb::toJson(scene), "again") == scene);
    hbGeometry geometry;
    geometry.size = {3, 2, 1};
    const hbCamera camera = scene.cameraFor(geometry);
    camera.ray(0.5, 0.5, scene.width, scene.height);
    hbSampling::extent(geometry, camera);
    const int planes = scene.sampling.planes(geometry, camera);
    fuzz::expect(planes >= 1 && planes <= hbSampling::kMaxSamples);
    scene.sampling.stepLength(geometry, camera);
  });
  return 0;
}
