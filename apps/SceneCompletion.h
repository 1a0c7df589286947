#pragma once

#include <memory>
#include <optional>

#include "scene/hbScene.h"
#include "volume/hbField.h"
#include "volume/hbHistogram.h"

/// What a scene leaves open that the values decide.
namespace app {

/// The field of a volume's labels; a scene that shows colours without a transfer function gets one that tells them
/// apart, with that unit length where one is given. Throws hbError for what is no plain volume.
std::shared_ptr<const hbField> labelled(const hbField& field, hbScene& scene, std::optional<double> unitLength);

/// Chooses an iso-value and stretches a transfer function, where the scene's mode needs them; the values' histogram, if
/// it was taken for that.
hbHistogram complete(hbScene& scene, const hbField& field);

} // namespace app
