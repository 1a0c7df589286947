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

/// Of coded sRGB: hue in [0,1] from red over green and blue, saturation and value in [0,1]. Grays have hue 0.
glm::dvec3 rgbToHsv(const glm::dvec3& rgb);
glm::dvec3 hsvToRgb(const glm::dvec3& hsv);

/// L*a*b* in polar form (Moreland 2009, section 4): magnitude from black, angle from the gray axis, hue; angles in
/// radians. Black and grays have hue 0.
glm::dvec3 labToMsh(const glm::dvec3& lab);
glm::dvec3 mshToLab(const glm::dvec3& msh);

/// Moreland's diverging interpolation from `a` at t = 0 to `b` at t = 1, in Msh: over white where both are saturated
/// and of unlike hue, and with a hue for an unsaturated end that makes the way to the other one look straight. Hue goes
/// the short way round. K. Moreland, "Diverging Color Maps for Scientific Visualization", ISVC 2009, with the
/// thresholds of his code in VTK.
glm::dvec3 mixMsh(glm::dvec3 a, glm::dvec3 b, double t);

} // namespace hb
