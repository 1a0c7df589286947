#include "glcombine/hbOglRays.h"

#include <algorithm>

#include <glm/geometric.hpp>

const char* hbOglRays::glsl() {
  return R"(
const float kNowhere = 1e30;
uniform sampler2D rayRanges;
uniform vec3 planeCorner, planeRight, planeDown; // of plane 0
uniform vec3 planeCornerStep, planeRightStep, planeDownStep; // to the next one: planes are affine in their index
ivec2 planesOfRay() { return ivec2(texelFetch(rayRanges, ivec2(gl_FragCoord.xy), 0).rg); }
uniform vec3 rayDirection, rayDirectionRight, rayDirectionDown;
vec3 stepOfRay() { // of length 1 along the view axis
  return rayDirection + gl_FragCoord.x * rayDirectionRight + gl_FragCoord.y * rayDirectionDown;
}
vec3 directionOfRay() { return normalize(stepOfRay()); }
vec3 lengthsOfRay() {
  vec2 ends = texelFetch(rayRanges, ivec2(gl_FragCoord.xy), 0).ba;
  return vec3(ends.x, length(stepOfRay()), ends.y);
}
vec3 pointOfRay(float place) {
  return planeCorner + place * planeCornerStep + gl_FragCoord.x * (planeRight + place * planeRightStep) +
         gl_FragCoord.y * (planeDown + place * planeDownStep);
}
)";
}

hbOglRays::hbOglRays(const hbGlFunctions& gl, const hbPlaneRays& rays) : rays_(rays), ranges_(gl, GL_TEXTURE_2D) {
  const bool isDvr = rays.scene().mode == hbMode::dvr;
  std::vector<float> ranges; // exact: planes are fewer than 2^24
  for (const hbPlaneRays::Ray& ray : rays.rays()) {
    ranges.push_back(float(ray.first));
    ranges.push_back(float(ray.last));
    if (!isDvr) continue;
    ranges.push_back(float(ray.before / rays.step()));
    ranges.push_back(float(ray.behind / rays.step()));
  }
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl.TexImage2D(GL_TEXTURE_2D, 0, isDvr ? GL_RGBA32F : GL_RG32F, rays.scene().width, rays.scene().height, 0,
                isDvr ? GL_RGBA : GL_RG, GL_FLOAT, ranges.data());
  ranges_.setFilter(GL_NEAREST);
}

void hbOglRays::set(const hbGlProgram& program, int unit) const {
  ranges_.bind(unit);
  program.set("rayRanges", unit);
  const hbPlaneRays::Plane first = rays_.plane(0), last = rays_.plane(rays_.planes() - 1);
  const double steps = std::max(1, rays_.planes() - 1);
  program.set("planeCorner", glm::vec3(first.corner));
  program.set("planeRight", glm::vec3(first.right));
  program.set("planeDown", glm::vec3(first.down));
  program.set("planeCornerStep", glm::vec3((last.corner - first.corner) / steps));
  program.set("planeRightStep", glm::vec3((last.right - first.right) / steps));
  program.set("planeDownStep", glm::vec3((last.down - first.down) / steps));
  // Of equal lengths along the view axis, directions are affine in the pixel's place.
  const hbScene& scene = rays_.scene();
  const hbCamera& camera = *scene.camera;
  const auto direction = [&](double x, double y) {
    const glm::dvec3 way = camera.ray(x, y, scene.width, scene.height).direction;
    return way / glm::dot(way, camera.viewAxis());
  };
  const glm::dvec3 corner = direction(0.0, 0.0);
  program.set("rayDirection", glm::vec3(corner));
  program.set("rayDirectionRight", glm::vec3((direction(scene.width, 0.0) - corner) / double(scene.width)));
  program.set("rayDirectionDown", glm::vec3((direction(0.0, scene.height) - corner) / double(scene.height)));
}
