#pragma once

#include <glm/vec3.hpp>

/// Conversions between colour spaces in 64 bits. Linear sRGB has its primaries, white D65 and 1 for full intensity; XYZ
/// has Y = 1 for that white. sRGB follows IEC 61966-2-1:1999, L*u*v* and L*a*b* follow CIE 15:2004, section 8.2.
namespace hb {

/// Decodes a stored sRGB value in [0,1] to linear light; values below 0 continue the straight piece.
double srgbToLinear(double coded);
glm::dvec3 srgbToLinear(const glm::dvec3& coded);

/// The inverse of srgbToLinear (to 3e-8 at the join, where the standard's own constants do not quite meet).
double linearToSrgb(double linear);
glm::dvec3 linearToSrgb(const glm::dvec3& linear);

/// By the standard's matrix of four decimals; white is the sum of its columns, (0.9505, 1, 1.089).
glm::dvec3 linearToXyz(const glm::dvec3& linear);
glm::dvec3 xyzToLinear(const glm::dvec3& xyz);

/// L* in [0,100], u*, v*; black is (0, 0, 0).
glm::dvec3 xyzToLuv(const glm::dvec3& xyz);

/// L* in [0,100], a*, b*.
glm::dvec3 xyzToLab(const glm::dvec3& xyz);
glm::dvec3 labToXyz(const glm::dvec3& lab);

} // namespace hb
