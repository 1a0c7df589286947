#pragma once

#include <memory>
#include <vector>

#include "scene/hbPicture.h"
#include "scene/hbScene.h"
#include "sparsegrid/hbSparseGrid.h"
#include "volume/hbProgress.h"

/// X-ray, MIP, iso-surface and emission-absorption pictures straight from a sparse grid by shear-warp (the engine
/// `lattice`): the grid is evaluated on slices across an axis of its cube, whose samples make rectilinear lattices;
/// what intermediate rays have gathered on them is then warped into the picture. doc/shear-warp.md says how, and how
/// far it is from ray casting.
///
/// Any camera: pixels whose rays lie more than hbShearFactorisation::kSteepest off the view axis' main direction are
/// drawn along another one.
class hbShearWarp {
public:
  struct Options {
    /// Intermediate rays a pixel, along either axis: 1 to kMostSupersample. The time grows with its square.
    int supersample = 1;
  };
  static constexpr int kMostSupersample = 8;

  /// Keeps a reference to `grid`; the surpluses are copied in another order where the main direction needs it (4 bytes
  /// a value, with `scene.magnitude` of all components), and the mode iso builds an hbSemiNodalGrid for shading, where
  /// it fits, the mode dvr an hbMatter. Throws hbError as hbRaycaster does, for the mode slice, and for another
  /// supersampling.
  hbShearWarp(const hbSparseGrid& grid, const hbScene& scene, const Options& options);
  ~hbShearWarp();

  /// From now on pictures are seen from there; surpluses in orders that were needed before are kept. Throws hbError for
  /// a camera that is not valid.
  void look(const hbCamera& camera);

  /// One frame, with the channels and the metadata of hbRaycaster::render(). `scene.sampling.kind` means nothing here:
  /// samples lie on slices, no farther apart along the view axis than hbSampling::stepLength().
  ///
  /// X-ray: the mean of the values along a pixel's ray, between those of the intermediate rays around it, times the
  /// ray's length in the volume; MIP likewise. "A" is 1 exactly where hbRaycaster's is; where no intermediate ray meets
  /// a slice the field's value in the middle of the pixel's ray stands in. Iso: the first crossing between two slices,
  /// linearly interpolated, shaded at the intermediate rays; a pixel shows the surface where at least half of what lies
  /// around it does, and blends only rays that meet it about as deep (see kSameSurface). DVR: colours and opacities of
  /// the intermediate rays around a pixel's, each as constant matter that shows the same, but as long as the pixel's
  /// own ray; lit as hbSliceLight says where `scene.shading` or `gradientOpacity` are there. With `scene.clip` "volume"
  /// means its box in all of this; slices lie where they do without.
  ///
  /// The picture does not depend on the number of threads. Throws hbCancelled.
  hbPicture render(hbProgress& progress = hbProgress::none()) const;

  /// Iso: rays meet the same surface where they are this many pixels or slices, whichever are larger, apart in depth.
  static constexpr double kSameSurface = 4.0;

  /// With the camera that was chosen, and everything else as given.
  const hbScene& scene() const;
  /// The slices in each main direction that the picture needs; none where no ray meets the cube.
  std::vector<int> slices() const;
  /// What a frame takes at its peak beside the picture, in bytes.
  double bytes() const;

private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};
