#include "apps/SceneCompletion.h"

#include <cmath>

#include "apps/Program.h"
#include "raycast/hbSceneDefaults.h"
#include "volume/hbError.h"
#include "volume/hbVolumeField.h"

std::shared_ptr<const hbField> app::labelled(const hbField& field, hbScene& scene, std::optional<double> unitLength) {
  const auto* volume = dynamic_cast<const hbVolumeField*>(&field);
  if (volume == nullptr)
    throw hbError("--labels: expected a plain volume: what is compressed or computed has values between its samples");
  if (!scene.transfer && (scene.mode == hbMode::dvr || scene.mode == hbMode::slice)) {
    const hbRange range = field.range({}, scene.component);
    const auto label = [&](float value) { return std::llround(field.valueMap().toTrue(value)); };
    scene.transfer = hbTransferFunction::ofLabels(label(range.lo), label(range.hi));
    if (unitLength) scene.transfer = scene.transfer->withUnitLength(*unitLength);
  }
  return std::make_shared<const hbVolumeField>(volume->nearest());
}

hbHistogram app::complete(hbScene& scene, const hbField& field) {
  hbHistogram histogram;
  const bool isStretched = scene.mode == hbMode::dvr && (!scene.transfer || scene.transfer->definition().relative);
  if (scene.mode == hbMode::iso || isStretched) histogram = hb::fieldHistogram(field, scene.component, app::progress());
  if (scene.mode == hbMode::iso && !scene.isoValue) scene.isoValue = histogram.otsuThreshold();
  if (scene.mode == hbMode::dvr) scene.transfer = hb::transferFor(scene.transfer, histogram, field.geometry());
  return histogram;
}
