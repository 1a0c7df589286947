#pragma once

#include <optional>
#include <span>
#include <utility>

#include "scene/hbImage8.h"
#include "scene/hbPicture.h"
#include "scene/hbScene.h"

/// From measured pictures to images to be looked at. Colours are mixed in linear light and stored as sRGB; what the
/// picture does not cover (channel "A" is 0 there, or "Y" is NaN) shows the scene's background. A picture without
/// "A" is covered everywhere. All functions throw hbError for pictures that are not valid or lack "Y".
namespace hb {

/// The values shown as the two ends of the colour map: the scene's window, or else the least and greatest finite "Y" of
/// the covered pixels; X-ray begins at 0 if no value is negative. (0, 1) where nothing is covered. The two are equal
/// for a picture of one value.
std::pair<double, double> displayWindow(const hbPicture& picture, const hbScene& scene);

/// X-ray and MIP: "Y" through displayWindow() and the scene's colour map (by default gray for X-ray, heat for MIP).
/// Iso: "Y", the shade in linear light, times a warm neutral surface colour. Both over the background by "A". Values
/// outside the window get the colours of its ends. DVR: "R", "G", "B" in linear light, multiplied by the opacity "A"
/// already, over the background; where one of them is missing, as X-ray. Slices of labels: the transfer function's
/// colours where it has an opacity; of other values, as X-ray.
hbImage8 displayImage(const hbPicture& picture, const hbScene& scene);

/// The same with this window instead of displayWindow(), first <= second: where they are equal, values up to it show
/// the map's low end and greater ones its high end.
hbImage8 displayImage(const hbPicture& picture, const hbScene& scene, const std::pair<double, double>& window);

/// |a - b| of channel "Y" through the map heat, 0 to `limit`; without one, to the greatest finite difference. NaN in
/// both pictures shows the background, NaN in one of them the map's end. Throws hbError for unlike sizes.
hbImage8 absoluteDifferenceImage(const hbPicture& a, const hbPicture& b, std::optional<double> limit = std::nullopt);

/// The same for a - b through the map coolwarm, -limit to limit: warm where a is greater.
hbImage8 signedDifferenceImage(const hbPicture& a, const hbPicture& b, std::optional<double> limit = std::nullopt);

/// What the scene shows where there is nothing, in coded sRGB.
glm::dvec3 backgroundColour(const hbScene& scene);

/// The images in a row from left to right, `gap` pixels of background between them, tops aligned. Throws hbError for
/// no images, a negative gap, or a result wider than hbScene::kMaxPictureSide.
hbImage8 sideBySide(std::span<const hbImage8> images, int gap = 8);

} // namespace hb
