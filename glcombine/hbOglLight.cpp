#include "glcombine/hbOglLight.h"

#include <algorithm>
#include <cmath>

#include <glm/matrix.hpp>

static_assert(hbShading::kMostLights == 8); // the shader's

// Processors that run fragments side by side go through the loop as often as any of them needs to; where none does,
// once, with no turn of valueAt()'s.
//
// Powers are exp(shininess log(x)), by the functions of known error. 1 - x is exact where x is above 1/2.
const char* hbOglLight::glsl() {
  return R"(
const int kMostLights = 8;
uniform vec3 sampleSpacing; // in the cube
uniform mat3 gradientToWorld; // the inverse transpose of cube to world
uniform mat3 cubeToWorld; // from the cube's corner
uniform vec3 reflected; // ambient, diffuse, specular
uniform float shininess;
uniform vec3 shownGradients; // of the values' scale, the least, and how much more the one from which on all is shown
uniform int lightCount;
uniform vec3 lightPlaces[kMostLights], lightColours[kMostLights];
float greatestOf(vec3 v) { return max(abs(v.x), max(abs(v.y), abs(v.z))); }
vec3 unit(vec3 v) { // squares of what is scaled do not go under or over
  float greatest = greatestOf(v);
  return greatest > 0.0 ? normalize(v / greatest) : v;
}
void shineFrom(vec3 towards, vec3 light, vec3 normal, vec3 ray, inout vec3 matter, inout vec3 gloss) {
  float cosine = dot(normal, towards);
  if (cosine > 0.0) {
    float along = clamp(dot(normal, unit(towards - ray)), 0.0, 1.0);
    matter += reflected.y * cosine * light;
    gloss += reflected.z * (1.0 - absorbed(shininess * depthOf(1.0 - along))) * light;
  }
}
void shine(inout vec3 colour, inout float depth, float place) {
  vec3 point = pointOfRay(place);
  vec3 below = max(point - sampleSpacing, 0.0), above = min(point + sampleSpacing, 1.0);
  vec3 difference = vec3(0.0);
  int steps = depth > 0.0 ? 6 : 0;
  for (int i = 0; i < steps; ++i) {
    bvec3 isAxis = equal(ivec3(0, 1, 2), ivec3(i / 2));
    bool isAbove = (i & 1) == 1;
    float value = valueAt(mix(point, isAbove ? above : below, isAxis));
    difference += mix(vec3(0.0), vec3(isAbove ? value : -value), isAxis);
  }
  vec3 gradient = gradientToWorld * (difference / (above - below));
  float greatest = greatestOf(gradient);
  vec3 direction = greatest > 0.0 ? gradient / greatest : vec3(0.0);
  float slope = length(direction) * greatest * shownGradients.x;
  if (shownGradients.x > 0.0) depth *= clamp((slope - shownGradients.y) / shownGradients.z, 0.0, 1.0);

  vec3 ray = directionOfRay(), normal = unit(direction), at = cubeToWorld * point;
  if (dot(normal, ray) > 0.0) normal = -normal;
  vec3 matter = vec3(reflected.x), gloss = vec3(0.0);
  for (int i = 0; i < max(lightCount, 1); ++i) {
    vec3 towards = lightCount > 0 ? unit(lightPlaces[i] - at) : -ray;
    vec3 light = lightCount > 0 ? lightColours[i] : vec3(1.0);
    if (greatest > 0.0)
      shineFrom(towards, light, normal, ray, matter, gloss);
    else
      matter += reflected.y * light;
  }
  colour = colour * matter + gloss;
}
)";
}

// Of the loop over the differences, of whose end valueAt()'s two loops are part, and of that over the lights.
int hbOglLight::turns(int ofValue) { return 6 * (1 + ofValue) + 3 + int(hbShading::kMostLights) + 1; }

hbOglLight::hbOglLight(const hbField& field, const hbScene& scene) : spacing_(field.geometry().cubeSpacing()) {
  const glm::dmat4 cubeToWorld = field.geometry().cubeToWorld();
  cubeToWorld_ = glm::mat3(cubeToWorld);
  gradientToWorld_ = glm::mat3(glm::transpose(glm::inverse(glm::dmat3(cubeToWorld))));
  if (scene.gradientOpacity) {
    const auto [lo, hi] = *scene.gradientOpacity;
    shown_ = {std::abs(field.valueMap().scale), lo, hi - lo};
  }
  if (!scene.shading) return;
  const hbShading& shading = *scene.shading;
  reflected_ = {shading.ambient, shading.diffuse, shading.specular};
  shininess_ = float(shading.shininess);
  for (const hbShading::Light& light : shading.lights) {
    glm::dvec3 place = light.position - glm::dvec3(cubeToWorld[3]);
    // One that no float reaches shines from the same direction.
    constexpr double kFarthest = 1e30;
    const double farthest = std::max({std::abs(place.x), std::abs(place.y), std::abs(place.z)});
    if (farthest > kFarthest) place *= kFarthest / farthest;
    places_.emplace_back(place);
    colours_.emplace_back(light.colour);
  }
}

void hbOglLight::set(const hbGlProgram& program) const {
  program.set("sampleSpacing", spacing_);
  program.set("gradientToWorld", gradientToWorld_);
  program.set("cubeToWorld", cubeToWorld_);
  program.set("reflected", reflected_);
  program.set("shininess", shininess_);
  program.set("shownGradients", shown_);
  program.set("lightCount", int(places_.size()));
  if (places_.empty()) return;
  program.set("lightPlaces", places_);
  program.set("lightColours", colours_);
}
