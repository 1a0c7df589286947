#pragma once

#include <optional>

#include "raycast/hbEmissionAbsorption.h"
#include "scene/hbPreintegration.h"
#include "scene/hbScene.h"
#include "scene/hbTransferTable.h"
#include "volume/hbValueMap.h"

/// What the matter of a DVR scene is at the values of a field, in the form that is fast to look up. It belongs to one
/// scene and step.
class hbMatter {
public:
  static constexpr std::size_t kSlabEntries = 1024; ///< For either value.

  /// `scene` has a transfer function that states its unit length. `step`: the world length between two samples, which
  /// pre-integrated slabs are made for.
  hbMatter(const hbScene& scene, const hbValueMap& map, double step);

  /// Whether rays add up slabs between samples, by slab(), or pieces around samples, by at().
  bool isPreintegrated() const { return slabs_.has_value(); }

  /// At a field value: hbTransferTable::at(), where it has extinction.
  glm::vec4 at(float value) const {
    const auto trueValue = float(map_.toTrue(value));
    return table_->isClear(trueValue) ? glm::vec4(0.0F) : table_->at(trueValue);
  }
  /// Of a slab one step thick between two field values: hbPreintegration::at(), where it has opacity.
  glm::vec4 slab(float front, float back) const {
    const auto trueFront = float(map_.toTrue(front)), trueBack = float(map_.toTrue(back));
    return slabs_->isClear(trueFront, trueBack) ? glm::vec4(0.0F) : slabs_->at(trueFront, trueBack);
  }
  double step() const { return step_; }
  /// Of true values; one or the other is there.
  const hbTransferTable& table() const { return *table_; }
  const hbPreintegration& slabs() const { return *slabs_; }

  /// Adds a piece, of at() or slab(), to what a ray sees, so long in the world.
  void addPiece(const glm::vec4& piece, double length, hbEmissionAbsorption& light,
                const hbShading::Reflection& reflection = {}) const {
    if (slabs_)
      light.addSlab(piece, length / step_, reflection);
    else
      light.add(piece, length, reflection);
  }
  /// The piece of one field value.
  glm::vec4 piece(float value) const { return slabs_ ? slab(value, value) : at(value); }
  /// Adds a piece of one field value to what a ray sees, and a pre-integrated slab between two, so long in the world.
  void add(float value, double length, hbEmissionAbsorption& light) const { addPiece(piece(value), length, light); }
  void addSlab(float front, float back, double length, hbEmissionAbsorption& light) const {
    light.addSlab(slab(front, back), length / step_);
  }

  const hbValueMap& map() const { return map_; }
  /// How far apart the entries of the table in use are, in true values.
  double cell() const { return cell_; }
  /// What the table takes.
  double bytes() const;

  /// How much of its extinction matter has by scene.gradientOpacity, for a gradient of this length in field values.
  double shownBy(double gradient) const;

private:
  hbValueMap map_;
  double step_, cell_;
  std::optional<hbTransferTable> table_;
  std::optional<hbPreintegration> slabs_;
  std::optional<std::pair<double, double>> gradientOpacity_;
};
