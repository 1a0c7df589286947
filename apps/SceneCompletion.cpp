#include "apps/SceneCompletion.h"

#include <cmath>

#include <fmt/format.h>

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
    const double least = field.valueMap().toTrue(range.lo), greatest = field.valueMap().toTrue(range.hi);
    constexpr double kMost = 1 << 24; // whole numbers from there on are not all floats
    if (!(std::abs(least) < kMost && std::abs(greatest) < kMost))
      throw hbError(
          fmt::format("--labels: expected numbers between -{0} and {0}, found {1} to {2}", kMost, least, greatest));
    scene.transfer = hbTransferFunction::ofLabels(std::llround(least), std::llround(greatest));
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
