#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "sparsegrid/hbIndexSet.h"
#include "volume/hbField.h"
#include "volume/hbLatticeMapping.h"
#include "volume/hbProgress.h"

/// Reads a field's values at all nodes of an index set, under either mapping of samples to the lattice.
///
/// Fitted: a node takes the field's value at its place in the cube. Aligned: lattice node i takes sample i; the nodes
/// outside the volume are continued axis by axis so that their surpluses vanish: the last one, R = 2^n, takes 2 f(m) -
/// f(0) with m = 2^(n-1) (which always lies inside), so that m's surplus vanishes too, and every other one the mean of
/// its neighbours. An axis of N samples thus keeps N surpluses that are not zero.
class hbNodeSampler {
public:
  /// Keeps references to both. Throws hbError where checkAligned() does.
  hbNodeSampler(const hbField& source, const hbIndexSet& set, hbLatticeMapping mapping);

  /// The most samples in a band of planes, all components together: 64 MB where they have 4 bytes.
  static constexpr std::int64_t kBandSamples = std::int64_t{1} << 24;

  /// Told the first and last sample along z between which the last band was read. Nothing is being read then; later
  /// bands begin at the sample before the last one at the earliest.
  using AfterBand = std::function<void(std::int64_t first, std::int64_t last)>;

  /// The values at the nodes, one array a component in the order of set.subspaces(): 8 bytes a node and component. The
  /// source is read in the order of z, all components at once, so that what lies in a file of planes is read once, from
  /// front to back: in bands of planes, up to kBandSamples or one plane of nodes (two of samples where it lies between
  /// them). Throws hbError where a value is NaN or infinite.
  std::vector<std::vector<double>> sample(hbProgress& progress, const AfterBand& afterBand = {}) const;

  /// The least n with 2^n >= size-1: how fine the aligned mapping's lattice is along an axis.
  static int alignedLevel(std::int64_t size);

  /// Throws hbError unless a set can be aligned with `size` samples: no axis finer than alignedLevel(), nor too long.
  static void checkAligned(const hbSize3& size, const hbIndexSet& set);

private:
  /// A node's value along one axis as a weighted sum of samples: pairs of sample index and weight.
  using Stencil = std::vector<std::pair<std::int64_t, double>>;
  Stencil stencil(int axis, std::int64_t latticeNode) const;

  /// The nodes of one level of an axis: the coordinates to read, and each node's weights on what was read.
  struct AxisPlan {
    std::vector<double> coordinates;
    std::vector<std::vector<std::pair<std::size_t, double>>> nodes; ///< Empty: node i is coordinate i.
  };
  AxisPlan plan(int axis, int level) const;
  AxisPlan planOf(int axis, const std::vector<std::int64_t>& nodes) const; ///< Of the lattice of 2^resolution_ cells.

  /// All nodes of one z: `index` of the subspaces of that level of z.
  struct Plane {
    int level = 0;
    std::int64_t index = 0;
    std::int64_t lattice = 0; ///< Of 2^resolution_.z cells.
  };
  using Values = std::vector<std::vector<double>>;

  /// Whether it lies outside an aligned volume, and is made of planes that do not.
  bool isContinued(const Plane& plane) const;
  /// The first and last sample along z that it is read from.
  std::pair<std::int64_t, std::int64_t> samplesOf(const Plane& plane) const;
  void run(std::span<const Plane> planes, Values& values, hbProgress& progress) const;
  void read(const hbSubspace& subspace, const Plane& plane, int component, double* out) const;
  void continueFrom(const std::vector<double>& values, const hbSubspace& subspace, const Plane& plane,
                    double* out) const;

  const hbField& source_;
  const hbIndexSet& set_;
  hbSize3 size_;
  bool aligned_;
  glm::ivec3 resolution_{0};                       ///< The lattice of an axis has 2^resolution_ cells.
  std::array<std::vector<AxisPlan>, 2> plans_;     ///< Of the levels of x and y.
  std::vector<std::vector<hbSubspace>> subspaces_; ///< By level of z.
};
