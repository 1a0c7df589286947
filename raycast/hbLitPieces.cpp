#include "raycast/hbLitPieces.h"

#include <glm/geometric.hpp>

hbLitPieces::hbLitPieces(const hbField& field, const hbScene& scene, const hbMatter& matter)
    : scene_(scene), matter_(matter), differences_(field, scene.component),
      cubeToWorld_(field.geometry().cubeToWorld()) {}

void hbLitPieces::add(const glm::vec4& piece, double length, const glm::dvec3& middle, const glm::dvec3& ray,
                      hbEmissionAbsorption& light) {
  waiting_.push_back({piece, length, ray, &light});
  places_.push_back(middle);
}

void hbLitPieces::clear() {
  waiting_.clear();
  places_.clear();
}

void hbLitPieces::compose() {
  if (waiting_.empty()) return;
  const std::vector<glm::dvec3>& gradients = differences_.at(places_);
  for (std::size_t i = 0; i < waiting_.size(); ++i) {
    const Piece& piece = waiting_[i];
    if (piece.light->isOpaque()) continue;
    const double length = piece.length * matter_.shownBy(glm::length(gradients[i]));
    const glm::dvec3 place(cubeToWorld_ * glm::dvec4(places_[i], 1.0));
    matter_.addPiece(piece.matter, length, *piece.light,
                     scene_.shading ? scene_.shading->reflection(place, piece.ray, gradients[i])
                                    : hbShading::Reflection{});
  }
  clear();
}
