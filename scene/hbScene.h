#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "scene/hbCamera.h"
#include "scene/hbMode.h"
#include "scene/hbSampling.h"
#include "scene/hbShading.h"
#include "scene/hbTransferFunction.h"
#include "volume/hbGeometry.h"

/// What is looked at and what is seen. What is left empty is chosen from the volume or the picture.
struct hbScene {
  static constexpr int kMaxPictureSide = 16384;

  /// A part of the volume's cube, lo < hi in each axis, within [0,1].
  struct ClipBox {
    glm::dvec3 lo{0.0}, hi{1.0};
    bool operator==(const ClipBox&) const = default;
  };
  /// A plane of the world.
  struct Plane {
    glm::dvec3 point{0.0};
    glm::dvec3 normal{0.0, 0.0, 1.0}; ///< Of any length but 0.
    bool operator==(const Plane&) const = default;
  };

  hbMode mode = hbMode::xray;
  std::optional<hbCamera> camera; ///< None: the whole volume from the default angle, see cameraFor().
  hbSampling sampling;
  std::optional<double> isoValue;                  ///< In the data's own values.
  std::optional<std::pair<double, double>> window; ///< Picture values shown as the map's two ends, first < second.
  std::string colormap;                            ///< One of hbColormap::names(); "": the mode's default.
  std::optional<hbTransferFunction> transfer;      ///< The mode dvr's, over the data's own values.
  bool preintegrated = false;                      ///< DVR: whole slabs between samples, see hbPreintegration.
  std::optional<hbShading> shading;                ///< DVR: how light is reflected; none: colours as they are.
  /// DVR: gradients, in true values per world length, up to which nothing is seen and from which on all is, at least 0
  /// and the first less than the second; in between extinction grows linearly.
  std::optional<std::pair<double, double>> gradientOpacity;
  std::optional<ClipBox> clip;          ///< What of the volume is seen; the step and the planes are those of all of it.
  std::optional<Plane> slice;           ///< The mode slice's.
  std::optional<glm::dvec3> background; ///< Coded sRGB, channels in [0,1]; none: a dark gray.
  bool labels = false;                  ///< Values are labels: the nearest sample's, none between them.
  int component = 0;
  bool magnitude = false;        ///< Show the Euclidean length of all components instead of one of them.
  int width = 512, height = 512; ///< Of the picture in pixels, 1 to kMaxPictureSide.

  /// `camera`, or where there is none the default framing of this volume for the picture's shape.
  hbCamera cameraFor(const hbGeometry& geometry) const;

  /// Throws hbError beginning with `what` and the name of the member (as in JSON) that is outside its range.
  void validate(const std::string& what = "scene") const;

  bool operator==(const hbScene&) const = default;
};

namespace hb {

/// The scene as a JSON object, indented, ending with a line feed; equal scenes give equal text, and sceneFromJson()
/// gives back the very same numbers. Throws hbError for a scene that is not valid.
std::string toJson(const hbScene& scene);

/// Reads what toJson() writes. Keys may be left out (their members keep the default), except `version`, the camera's
/// `position` and `target`, and the `height` of an orthographic camera. Anything else throws hbError: one line that
/// begins with `name` and gives the key, or the line and column where the text is no JSON.
hbScene sceneFromJson(const std::string& text, const std::string& name);

/// Reads a scene from a file of at most 1 MB; throws hbError as sceneFromJson() does.
hbScene loadScene(const std::filesystem::path& path);

/// Writes toJson(scene); the file appears whole or not at all.
void saveScene(const hbScene& scene, const std::filesystem::path& path);

} // namespace hb
