#pragma once

#include <optional>

#include "raycast/hbMatter.h"
#include "raycast/hbVisibleBlocks.h"
#include "scene/hbPicture.h"
#include "scene/hbScene.h"
#include "volume/hbField.h"
#include "volume/hbProgress.h"

/// The software ray caster: pictures of any hbField, in all modes.
///
/// Source: the sparse-grid paper, section 4, Fig. 4 and 5. A ray that spends the length L inside the volume takes
/// - equidistant: ceil(L/d) samples at the midpoints of equal steps (iso: at their ends, entry and exit included); d is
///   hbSampling::stepLength();
/// - planewise: a sample on each of the planes, midpoints of equal slabs across the view axis, that it meets inside the
///   volume, weighted by the planes' distance over the cosine of its angle to the axis.
/// X-ray sums values times weights in 64 bits; MIP takes the greatest sample. An iso-surface is where a value and the
/// next one lie on different sides of the iso-value (a value equal to it counts as above); two crossings between two
/// samples are missed. Equidistant crossings are refined, planewise ones interpolated linearly between the planes, as
/// the OpenGL path can do no better. DVR composites samples front to back by hbEmissionAbsorption, each for its share
/// of the ray, or pre-integrated slabs between them, lit by hbShading in their middles, and ends where nothing behind
/// would show. A slice has the value where a ray meets the scene's plane.
class hbRaycaster {
public:
  /// Iso-surface: so many bisections bracket the crossing to kIsoBracket of a step; then it is placed by linear
  /// interpolation.
  static constexpr int kIsoRounds = 10;
  static constexpr double kIsoBracket = 1.0 / (1 << kIsoRounds);

  /// Keeps a reference to `field`. Throws hbError for an invalid scene, a component the field lacks, an iso mode
  /// without an iso-value, a DVR mode without a transfer function that states its unit length, a slice without a plane.
  /// `scene.magnitude` and `scene.labels` are not looked at: pass an hbMagnitudeField, or hbVolumeField::nearest().
  hbRaycaster(const hbField& field, const hbScene& scene);

  /// From now on pictures are seen from there; what does not depend on that is kept. Throws hbError for a camera that
  /// is not valid.
  void look(const hbCamera& camera);

  /// One frame. Channels: "Y" (X-ray: value x world length; MIP: value; iso: shade in [0,1]) and "A" (1 where the ray
  /// meets the volume, or the surface); iso also "Z" (distance along the view axis; infinite where there is no
  /// surface), "N.X/Y/Z" (world normal towards the viewer; its gradient is the central difference over one sample
  /// spacing) and "value" (the field at the crossing). DVR: "R", "G", "B" in linear light, multiplied by the opacity
  /// "A", and their luminance "Y". Slice: as MIP. All in true data values. Metadata: the scene, with the camera in
  /// full.
  ///
  /// Threads take tiles; the picture does not depend on their number. Throws hbCancelled.
  hbPicture render(hbProgress& progress = hbProgress::none()) const;

  /// With the camera that was chosen, and everything else as given.
  const hbScene& scene() const { return scene_; }

private:
  void prepare();

  const hbField& field_;
  hbScene scene_;                         ///< With its camera.
  std::optional<hbMatter> matter_;        ///< DVR; pre-integrated, of the camera's step.
  std::optional<hbVisibleBlocks> blocks_; ///< DVR, where they pay.
};
