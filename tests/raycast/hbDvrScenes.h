#pragma once

#include "tests/raycast/hbTestScenes.h"

namespace hbTestScenes {

/// Colours and opacities that change all the way, from clear to what nothing is seen through, over most of the values
/// of waves(), with continuous ends. `unitLength`: what opacities are stated for.
inline hbTransferFunction ramp(double unitLength = 0.2) {
  hbTransferFunction::Definition d;
  d.colors = {{-0.8, {0.9, 0.4, 0.1}}, {0.1, {0.1, 0.8, 0.3}}, {0.9, {0.2, 0.3, 1.0}}};
  d.opacities = {{-0.8, 0.0}, {0.3, 0.2}, {0.9, 0.9}};
  d.unitLength = unitLength;
  return hbTransferFunction(std::move(d));
}

inline hbScene dvrScene(const hbTransferFunction& function, const hbCamera& camera, int samples,
                        hbSampling::Kind kind = hbSampling::Kind::equidistant) {
  hbScene scene = sceneOf(hbMode::dvr, camera, 19, 13, samples);
  scene.sampling.kind = kind;
  scene.transfer = function;
  return scene;
}

} // namespace hbTestScenes
