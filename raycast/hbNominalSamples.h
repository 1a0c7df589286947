#pragma once

#include "scene/hbScene.h"
#include "volume/hbGeometry.h"

namespace hb {

/// The length of all pixels' rays in the volume's box over the step: the samples that a renderer that leaves nothing
/// out takes for a picture, whatever its engine. Of the same volume and scene it is the same for all of them, so that
/// samples a second compare frames. The scene's camera must be chosen. O(pixels).
double nominalSamples(const hbGeometry& geometry, const hbScene& scene);

} // namespace hb
