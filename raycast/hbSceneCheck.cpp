#include "raycast/hbSceneCheck.h"

#include <fmt/format.h>

#include "volume/hbError.h"

void hb::checkScene(const hbScene& scene, const hbField& field) {
  scene.validate();
  if (scene.component < 0 || scene.component >= field.components())
    throw hbError(fmt::format("component: expected 0 to {}, found {}", field.components() - 1, scene.component));
  if (scene.mode == hbMode::iso && !scene.isoValue) throw hbError("iso: expected an iso-value");
  if (scene.mode == hbMode::dvr && !(scene.transfer && scene.transfer->definition().unitLength))
    throw hbError("dvr: expected a transfer function that states its unit length");
  if (scene.mode == hbMode::slice && !scene.slice) throw hbError("slice: expected a plane");
}
