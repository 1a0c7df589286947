#include "raycast/hbNominalSamples.h"

#include <glm/matrix.hpp>

#include "raycast/hbRaySegment.h"

double hb::nominalSamples(const hbGeometry& geometry, const hbScene& scene) {
  const glm::dmat4 worldToCube = glm::inverse(geometry.cubeToWorld());
  const hbCamera::Rays rays(*scene.camera);
  double length = 0.0;
  for (int y = 0; y < scene.height; ++y)
    for (int x = 0; x < scene.width; ++x)
      if (const auto segment = clipToCube(rays.at(x + 0.5, y + 0.5, scene.width, scene.height), worldToCube))
        length += segment->length();
  return length / scene.sampling.stepLength(geometry, *scene.camera);
}
