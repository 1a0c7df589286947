#pragma once

#include "scene/hbScene.h"
#include "volume/hbField.h"

namespace hb {

/// Throws hbError where no renderer can show this scene of that field: an invalid scene, a component the field lacks,
/// an iso mode without an iso-value, a DVR mode without a transfer function that states its unit length,
/// a mode slice without a plane.
void checkScene(const hbScene& scene, const hbField& field);

} // namespace hb
