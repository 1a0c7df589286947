#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "sparsegrid/hbHat.h"
#include "sparsegrid/hbIndexSet.h"
#include "volume/hbField.h"
#include "volume/hbLatticeMapping.h"
#include "volume/hbProgress.h"

struct hbDirectTerms;

/// A sparse grid with boundary: a function stored as hierarchical surpluses over an index set, evaluated directly (the
/// `direct` engine: every subspace adds the one basis function that is not zero at the point).
///
/// The field's coordinates are the volume's cube; with the aligned mapping the lattice's own coordinates are those
/// times latticeScale(). Immutable. Source: Teitzel, Hopf, Grosso, Ertl, Volume Visualization on Sparse Grids, sections
/// 2 and 5.
class hbSparseGrid final : public hbField {
public:
  /// Everything about a grid but its surpluses.
  struct Frame {
    hbGeometry geometry; ///< Of the volume it stands for.
    hbValueMap valueMap;
    hbLatticeMapping mapping = hbLatticeMapping::fitted;
  };

  /// Interpolates `source` at the nodes of `set`, all components. Reads nothing but the nodes (fitted: the cells around
  /// them), once, in bands across z; `afterBand` may have the pages of a large file forgotten
  /// (hbNodeSampler::AfterBand). Throws hbError where a value is NaN or infinite. O(nodes); at the peak 8 bytes a node
  /// and component, and 4 for one component after the other.
  static hbSparseGrid interpolate(const hbField& source, const hbIndexSet& set, hbLatticeMapping mapping,
                                  hbProgress& progress = hbProgress::none(),
                                  const std::function<void(std::int64_t first, std::int64_t last)>& afterBand = {});

  /// From the values at the nodes, one array a component in the order of set.subspaces(): for a sparse grid that comes
  /// from a solver. Throws hbError for another length or values that are not finite.
  static hbSparseGrid fromNodalValues(const Frame& frame, const hbIndexSet& set,
                                      std::vector<std::vector<double>> values);

  /// From surpluses, in the same order. Throws hbError likewise.
  static hbSparseGrid fromSurpluses(const Frame& frame, const hbIndexSet& set,
                                    std::vector<std::vector<float>> surpluses);

  /// The values on one component grid of a combination solution: (2^l+1) nodes an axis (1 on a flat one), x fastest.
  struct ComponentValues {
    glm::ivec3 levels{0};
    std::vector<double> values;
  };
  /// The sparse grid that a combination solution stands for: surplus(k) = sum over l >= k of c_l times the surplus of
  /// component grid l. One list of grids a component, each with every grid of set.componentGrids(); others are ignored.
  /// Throws hbError naming a missing grid or a wrong size.
  static hbSparseGrid fromComponentGrids(const Frame& frame, const hbIndexSet& set,
                                         const std::vector<std::vector<ComponentValues>>& grids);

  const hbIndexSet& indexSet() const { return set_; }
  const Frame& frame() const { return frame_; }
  std::span<const float> surpluses(int component) const { return surpluses_[std::size_t(component)]; }
  /// The dense array of one subspace, x fastest.
  std::span<const float> surpluses(const hbSubspace& subspace, int component) const {
    return surpluses(component).subspan(std::size_t(subspace.offset), std::size_t(subspace.count()));
  }

  /// The values at the nodes, in 64 bits: the surpluses dehierarchised.
  std::vector<double> nodalValues(int component) const;

  /// Lattice coordinate = latticeScale() * cube coordinate: 1, or (N-1)/2^n with the aligned mapping.
  const glm::dvec3& latticeScale() const { return scale_; }
  /// That of a cube coordinate, which is clamped to the cube first (NaN to 0).
  double latticeCoordinate(double x, int axis) const;

  const hbGeometry& geometry() const override { return frame_.geometry; }
  int components() const override { return int(surpluses_.size()); }
  hbValueMap valueMap() const override { return frame_.valueMap; }

  /// O(subspaces) a point; weights in 32 bits, sums over the rows along x in 64. hbSemiNodalGrid is the faster way.
  void values(const hbPoints& points, int component, std::span<float> out) const override;
  void gradients(const hbPoints& points, int component, std::span<float> out,
                 const hbGradients& gradient) const override;
  /// The same with everything but the surpluses in 64 bits.
  void values(const hbPoints64& points, int component, std::span<double> out) const;
  void gradients(const hbPoints64& points, int component, std::span<double> out, const hbGradients64& gradient) const;

  /// Axis by axis (hbLatticeEvaluator), so that surpluses are touched once a plane, not once a sample. The order of the
  /// axes is the cheapest for a lattice of these sizes: parts of a lattice that are evaluated in another order than the
  /// whole equal it up to rounding, others bit for bit. Orders other than the natural one copy the component, 4 bytes a
  /// value. The workspace takes 8 bytes a surplus of one plane and 4 a sample of the coarse rows.
  void lattice(std::span<const double> xs, std::span<const double> ys, std::span<const double> zs, int component,
               float* out, std::size_t strideY, std::size_t strideZ) const override;

  /// Sums each subspace's least and greatest surplus among the hats that meet the box: conservative, often loose.
  hbRange range(const hbBox& box, int component) const override;

  /// One value, everything but the surpluses in 64 bits: the reference for every other way to evaluate.
  double calcValue(const glm::dvec3& point, int component) const;
  /// The same with the gradient (in cube units).
  double calcValue(const glm::dvec3& point, int component, glm::dvec3& gradient) const;
  /// One value as values() gives it, without vector instructions.
  float calcValue32(const glm::vec3& point, int component) const;
  float calcValue32(const glm::vec3& point, int component, glm::vec3& gradient) const;

private:
  hbSparseGrid(const Frame& frame, const hbIndexSet& set, std::vector<std::vector<float>> surpluses);

  template <class Real>
  Real evaluate(const hbHat<Real>& x, const hbHat<Real>& y, const hbHat<Real>& z, const float* surpluses) const;
  template <class Real>
  Real evaluate(const hbHat<Real>& x, const hbHat<Real>& y, const hbHat<Real>& z, const float* surpluses,
                glm::vec<3, Real>& gradient) const;
  template <class Real>
  void hats(const glm::dvec3& point, hbHat<Real>& x, hbHat<Real>& y, hbHat<Real>& z) const;

  Frame frame_;
  hbIndexSet set_;
  std::vector<std::vector<float>> surpluses_; ///< One array a component.
  glm::dvec3 scale_{1.0};
  std::shared_ptr<const hbDirectTerms> terms_;
};
