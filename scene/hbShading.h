#pragma once

#include <string>
#include <vector>

#include <glm/vec3.hpp>

/// How matter reflects light (mode dvr), from the gradient of the field: what changes fast looks like a surface.
///
/// Sources: J. F. Blinn, "Models of Light Reflection for Computer Synthesized Pictures", SIGGRAPH 1977; M. Levoy,
/// "Display of Surfaces from Volume Data", IEEE Computer Graphics and Applications 8(3), 1988, section 3.
struct hbShading {
  /// A point that shines in all directions, as bright far away as near by.
  struct Light {
    glm::dvec3 position{0.0}; ///< World.
    glm::dvec3 colour{1.0};   ///< Linear light, channels in [0, kMostLight].
    bool operator==(const Light&) const = default;
  };

  /// What becomes of a colour c of matter: c * matter + gloss, per channel, in linear light.
  struct Reflection {
    glm::dvec3 matter{1.0}, gloss{0.0};
  };

  static constexpr std::size_t kMostLights = 8;
  static constexpr double kMostLight = 1e3, kMostShininess = 1e4;

  double ambient = 0.3, diffuse = 0.8, specular = 0.2; ///< In [0, kMostLight].
  double shininess = 24.0;                             ///< The gloss's exponent, in [0, kMostShininess].
  std::vector<Light> lights;                           ///< None: a white one where the viewer is.

  /// At a place of the world, seen along `ray` (of length 1, away from the viewer). Both sides of what `gradient` (of
  /// the world, of any length) is normal to are alike: the normal is the one towards the viewer. Where there is no
  /// gradient there is no surface either: lights shine on it from everywhere, without gloss.
  Reflection reflection(const glm::dvec3& place, const glm::dvec3& ray, const glm::dvec3& gradient) const;

  /// Throws hbError beginning with `what` and the name of the member (as in JSON) that is outside its range.
  void validate(const std::string& what) const;

  bool operator==(const hbShading&) const = default;
};
