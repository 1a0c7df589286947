#pragma once

#include <map>
#include <string>
#include <vector>

/// A picture of 32-bit floats in named channels: what a renderer measured, before anything is made visible.
///
/// Channels are row-major, the top row first: pixel (x, y) is element x + width * y. Those the renderers use:
/// "Y" (X-ray: the line integral, MIP: the greatest value, iso: the shade in [0,1]), "A" (coverage in [0,1]), "Z"
/// (depth of the iso-surface along the view axis), "N.X", "N.Y", "N.Z" (its world normal), "value"; DVR: "R", "G", "B"
/// in linear light, multiplied by the opacity "A", and their luminance "Y".
struct hbPicture {
  /// Metadata keys begin with kMetadataPrefix; the scene is kept as JSON under kSceneKey.
  static constexpr const char* kMetadataPrefix = "hbvol.";
  static constexpr const char* kSceneKey = "hbvol.scene";

  int width = 0;
  int height = 0;
  std::map<std::string, std::vector<float>> channels;
  std::map<std::string, std::string> metadata;

  /// Adds (or replaces) a channel, filled with `fill`.
  std::vector<float>& add(const std::string& name, float fill = 0.0F);

  /// The channel of that name, or nullptr.
  const std::vector<float>* find(const std::string& name) const;

  /// Throws hbError beginning with `what` unless both sides are 1 to hbScene::kMaxPictureSide and there is at least one
  /// channel, each of width * height values.
  void validate(const std::string& what) const;
};
