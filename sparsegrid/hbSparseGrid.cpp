#include "sparsegrid/hbSparseGrid.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "sparsegrid/hbHierarchise.h"
#include "sparsegrid/hbLatticeEvaluator.h"
#include "sparsegrid/hbNodeSampler.h"
#include "sparsegrid/kernels/hbDirectKernel.h"
#include "volume/hbError.h"
#include "volume/hbParallel.h"

namespace {

/// A lattice of so many bytes is not read again before it has left the caches.
constexpr std::size_t kPastCaches = 4 << 20;

std::vector<float> toFloats(const std::vector<double>& values) {
  std::vector<float> floats(values.begin(), values.end());
  for (const float value : floats)
    if (!std::isfinite(value))
      throw hbError(
          "sparse grid: expected finite values whose differences fit a 32-bit float, found one that does not");
  return floats;
}

void checkLengths(const hbIndexSet& set, std::size_t components, auto&& lengthOf) {
  if (components == 0) throw hbError("sparse grid: expected at least one component");
  for (std::size_t c = 0; c < components; ++c)
    if (std::int64_t(lengthOf(c)) != set.storedValues())
      throw hbError(fmt::format("sparse grid: expected {} values, found {}", set.storedValues(), lengthOf(c)));
}

/// The slots (see hbHat) of one level: first and number.
struct Slots {
  int first, count;
};
Slots slotsOf(int level, bool flat) { return level > 0 ? Slots{level + 1, 1} : Slots{0, flat ? 1 : 2}; }

hbDirectTerms termsOf(const hbIndexSet& set, const glm::dvec3& scale) {
  hbDirectTerms terms;
  for (int d = 0; d < 3; ++d) terms.axes[std::size_t(d)] = {set.flat()[d], set.finest()[d], scale[d]};
  for (const hbSubspace& subspace : set.subspaces()) {
    if (subspace.count() > std::numeric_limits<std::int32_t>::max())
      throw hbError(fmt::format("sparse grid: expected fewer than 2^31 nodes a subspace, found {}", subspace.count()));
    if (subspace.levels.x != 0) continue;
    const std::size_t first = terms.offsets.size();
    for (glm::ivec3 l = subspace.levels; set.contains(l); ++l.x) terms.offsets.push_back(set.subspace(l).offset);
    const Slots ys = slotsOf(subspace.levels.y, set.flat().y), zs = slotsOf(subspace.levels.z, set.flat().z);
    for (int z = zs.first; z < zs.first + zs.count; ++z)
      for (int y = ys.first; y < ys.first + ys.count; ++y)
        terms.rows.push_back({y, z, std::int32_t(subspace.nodes.y), std::int32_t(terms.offsets.size() - first), first});
  }
  return terms;
}

} // namespace

hbSparseGrid::hbSparseGrid(const Frame& frame, const hbIndexSet& set, std::vector<std::vector<float>> surpluses)
    : frame_(frame), set_(set), surpluses_(std::move(surpluses)) {
  frame_.geometry.validate("sparse grid");
  for (int d = 0; d < 3; ++d) {
    const std::int64_t size = frame_.geometry.size[d];
    if (frame_.geometry.isFlat(d) != set_.flat()[d])
      throw hbError(fmt::format("sparse grid: expected an index set {} along {}, as the volume is",
                                size == 1 ? "flat" : "not flat", "xyz"[d]));
    if (frame_.mapping == hbLatticeMapping::aligned && size > 1)
      scale_[d] = double(size - 1) / std::exp2(hbNodeSampler::alignedLevel(size));
  }
  if (frame_.mapping == hbLatticeMapping::aligned) hbNodeSampler::checkAligned(frame_.geometry.size, set_);
  terms_ = std::make_shared<const hbDirectTerms>(termsOf(set_, scale_));
}

hbSparseGrid hbSparseGrid::interpolate(const hbField& source, const hbIndexSet& set, hbLatticeMapping mapping,
                                       hbProgress& progress,
                                       const std::function<void(std::int64_t, std::int64_t)>& afterBand) {
  const Frame frame{source.geometry(), source.valueMap(), mapping};
  std::vector<std::vector<double>> values = hbNodeSampler(source, set, mapping).sample(progress, afterBand);
  std::vector<std::vector<float>> surpluses;
  for (std::vector<double>& component : values) {
    std::vector<double> own = std::move(component); // freed as soon as its floats are there
    hb::hierarchise(set, own, progress);
    surpluses.push_back(toFloats(own));
  }
  return {frame, set, std::move(surpluses)};
}

hbSparseGrid hbSparseGrid::fromNodalValues(const Frame& frame, const hbIndexSet& set,
                                           std::vector<std::vector<double>> values) {
  checkLengths(set, values.size(), [&](std::size_t c) { return values[c].size(); });
  std::vector<std::vector<float>> surpluses;
  for (std::vector<double>& component : values) {
    hb::hierarchise(set, component);
    surpluses.push_back(toFloats(component));
  }
  return {frame, set, std::move(surpluses)};
}

hbSparseGrid hbSparseGrid::fromSurpluses(const Frame& frame, const hbIndexSet& set,
                                         std::vector<std::vector<float>> surpluses) {
  checkLengths(set, surpluses.size(), [&](std::size_t c) { return surpluses[c].size(); });
  for (const auto& component : surpluses)
    if (!std::all_of(component.begin(), component.end(), [](float s) { return std::isfinite(s); }))
      throw hbError("sparse grid: expected finite surpluses, found NaN or infinity");
  return {frame, set, std::move(surpluses)};
}

namespace {

/// Copies a component grid's nodal values into the subspaces it consists of.
std::vector<double> inSubspaces(const hbIndexSet& part, const hbSize3& nodes, const std::vector<double>& values) {
  std::vector<double> result(std::size_t(part.storedValues()));
  for (const hbSubspace& subspace : part.subspaces()) {
    double* out = result.data() + subspace.offset;
    // Node k of level l lies at place first + k step of the component grid's axis.
    hbSize3 first(0), step(0);
    for (int d = 0; d < 3; ++d) {
      const std::int64_t cells = nodes[d] - 1;
      const int level = subspace.levels[d];
      step[d] = level == 0 ? cells : cells >> (level - 1);
      first[d] = level == 0 ? 0 : cells >> level;
    }
    for (std::int64_t k = 0; k < subspace.nodes.z; ++k)
      for (std::int64_t j = 0; j < subspace.nodes.y; ++j)
        for (std::int64_t i = 0; i < subspace.nodes.x; ++i)
          *out++ = values[std::size_t(first.x + i * step.x +
                                      nodes.x * (first.y + j * step.y + nodes.y * (first.z + k * step.z)))];
  }
  return result;
}

/// The surpluses of one component of a combination solution.
std::vector<double> combine(const hbIndexSet& set, const std::vector<hbSparseGrid::ComponentValues>& grids) {
  std::vector<double> surpluses(static_cast<std::size_t>(set.storedValues()));
  for (const hbIndexSet::ComponentGrid& wanted : set.componentGrids()) {
    const glm::ivec3 l = wanted.levels;
    const auto grid = std::find_if(grids.begin(), grids.end(), [&](const auto& g) { return g.levels == l; });
    if (grid == grids.end())
      throw hbError(fmt::format("component grids: expected one of levels ({},{},{}), found none", l.x, l.y, l.z));
    if (std::int64_t(grid->values.size()) != wanted.nodes.x * wanted.nodes.y * wanted.nodes.z)
      throw hbError(fmt::format("component grid ({},{},{}): expected {} x {} x {} values, found {}", l.x, l.y, l.z,
                                wanted.nodes.x, wanted.nodes.y, wanted.nodes.z, grid->values.size()));
    const hbIndexSet part = hbIndexSet::full({l, set.flat()});
    std::vector<double> values = inSubspaces(part, wanted.nodes, grid->values);
    hb::hierarchise(part, values);
    for (const hbSubspace& subspace : part.subspaces()) {
      const std::int64_t to = set.subspace(subspace.levels).offset;
      for (std::int64_t i = 0; i < subspace.count(); ++i)
        surpluses[std::size_t(to + i)] += wanted.coefficient * values[std::size_t(subspace.offset + i)];
    }
  }
  return surpluses;
}

} // namespace

hbSparseGrid hbSparseGrid::fromComponentGrids(const Frame& frame, const hbIndexSet& set,
                                              const std::vector<std::vector<ComponentValues>>& grids) {
  std::vector<std::vector<float>> surpluses;
  for (const std::vector<ComponentValues>& component : grids) surpluses.push_back(toFloats(combine(set, component)));
  return fromSurpluses(frame, set, std::move(surpluses));
}

std::vector<double> hbSparseGrid::nodalValues(int component) const {
  const auto stored = surpluses(component);
  std::vector<double> values(stored.begin(), stored.end());
  hb::dehierarchise(set_, values);
  return values;
}

double hbSparseGrid::latticeCoordinate(double x, int axis) const {
  return (x > 0.0 ? std::min(x, 1.0) : 0.0) * scale_[axis];
}

template <class Real>
void hbSparseGrid::hats(const glm::dvec3& point, hbHat<Real>& x, hbHat<Real>& y, hbHat<Real>& z) const {
  x.evaluate(Real(latticeCoordinate(point.x, 0)), set_.flat().x, set_.finest().x);
  y.evaluate(Real(latticeCoordinate(point.y, 1)), set_.flat().y, set_.finest().y);
  z.evaluate(Real(latticeCoordinate(point.z, 2)), set_.flat().z, set_.finest().z);
}

// Sums over rows are in 64 bits, for there are hundreds of terms of either sign.
template <class Real>
Real hbSparseGrid::evaluate(const hbHat<Real>& x, const hbHat<Real>& y, const hbHat<Real>& z,
                            const float* surpluses) const {
  const int boundary = set_.flat().x ? 1 : 2; // nodes of level 0
  double sum = 0.0;
  for (const hbDirectTerms::Row& row : terms_->rows) {
    const std::int64_t line = std::int64_t(z.node[row.slotZ]) * row.nodesY + y.node[row.slotY];
    const std::int64_t* offsets = terms_->offsets.data() + row.firstOffset;
    const float* ends = surpluses + offsets[0] + line * boundary;
    Real inner = x.weight[0] * Real(ends[0]);
    if (boundary == 2) inner += x.weight[1] * Real(ends[1]);
    for (int l = 1; l < row.levels; ++l)
      inner += x.weight[l + 1] * Real(surpluses[offsets[l] + (line << (l - 1)) + x.node[l + 1]]);
    sum += double(y.weight[row.slotY] * z.weight[row.slotZ] * inner);
  }
  return Real(sum);
}

template <class Real>
Real hbSparseGrid::evaluate(const hbHat<Real>& x, const hbHat<Real>& y, const hbHat<Real>& z, const float* surpluses,
                            glm::vec<3, Real>& gradient) const {
  const int boundary = set_.flat().x ? 1 : 2;
  double sum = 0.0;
  glm::dvec3 slopes(0.0);
  for (const hbDirectTerms::Row& row : terms_->rows) {
    const std::int64_t line = std::int64_t(z.node[row.slotZ]) * row.nodesY + y.node[row.slotY];
    const std::int64_t* offsets = terms_->offsets.data() + row.firstOffset;
    Real inner(0), innerSlope(0);
    const auto add = [&](int slot, float surplus) {
      inner += x.weight[slot] * Real(surplus);
      innerSlope += x.slope[slot] * Real(surplus);
    };
    for (int s = 0; s < boundary; ++s) add(s, surpluses[offsets[0] + line * boundary + s]);
    for (int l = 1; l < row.levels; ++l) add(l + 1, surpluses[offsets[l] + (line << (l - 1)) + x.node[l + 1]]);
    const Real wy = y.weight[row.slotY], wz = z.weight[row.slotZ];
    sum += double(wy * wz * inner);
    slopes.x += double(wy * wz * innerSlope);
    slopes.y += double(y.slope[row.slotY] * wz * inner);
    slopes.z += double(wy * z.slope[row.slotZ] * inner);
  }
  gradient = glm::vec<3, Real>(slopes * scale_);
  return Real(sum);
}

void hbSparseGrid::values(const hbPoints& points, int component, std::span<float> out) const {
  hb::evaluateDirect(*terms_, surpluses(component).data(), points, out, nullptr);
}

void hbSparseGrid::gradients(const hbPoints& points, int component, std::span<float> out,
                             const hbGradients& gradient) const {
  hb::evaluateDirect(*terms_, surpluses(component).data(), points, out, &gradient);
}

void hbSparseGrid::values(const hbPoints64& points, int component, std::span<double> out) const {
  hb::evaluateDirect(*terms_, surpluses(component).data(), points, out, nullptr);
}

void hbSparseGrid::gradients(const hbPoints64& points, int component, std::span<double> out,
                             const hbGradients64& gradient) const {
  hb::evaluateDirect(*terms_, surpluses(component).data(), points, out, &gradient);
}

float hbSparseGrid::calcValue32(const glm::vec3& point, int component) const {
  hbHat<float> x, y, z;
  hats(point, x, y, z);
  return evaluate(x, y, z, surpluses(component).data());
}

float hbSparseGrid::calcValue32(const glm::vec3& point, int component, glm::vec3& gradient) const {
  hbHat<float> x, y, z;
  hats(point, x, y, z);
  return evaluate(x, y, z, surpluses(component).data(), gradient);
}

double hbSparseGrid::calcValue(const glm::dvec3& point, int component) const {
  hbHat<double> x, y, z;
  hats(point, x, y, z);
  return evaluate(x, y, z, surpluses(component).data());
}

double hbSparseGrid::calcValue(const glm::dvec3& point, int component, glm::dvec3& gradient) const {
  hbHat<double> x, y, z;
  hats(point, x, y, z);
  return evaluate(x, y, z, surpluses(component).data(), gradient);
}

void hbSparseGrid::lattice(std::span<const double> xs, std::span<const double> ys, std::span<const double> zs,
                           int component, float* out, std::size_t strideY, std::size_t strideZ) const {
  const std::array<std::span<const double>, 3> places{xs, ys, zs};
  const std::array<std::size_t, 3> strides{1, strideY, strideZ};
  const hbAxisOrder order =
      hbAxisOrder::cheapest(set_, {std::int64_t(xs.size()), std::int64_t(ys.size()), std::int64_t(zs.size())});
  const auto fast = std::size_t(order.fast), row = std::size_t(order.row), plane = std::size_t(order.plane);
  const bool pastCaches = xs.size() * ys.size() * zs.size() * sizeof(float) >= kPastCaches;
  const hbLatticeEvaluator evaluator(*this, component, order);
  const hbLatticePlan plan = evaluator.plan(places[fast], places[row]);
  hbLatticeWorkspace workspace;
  std::vector<float> values(fast == 0 ? 0 : places[fast].size() * places[row].size());
  for (std::size_t k = 0; k < places[plane].size(); ++k) {
    float* to = out + k * strides[plane];
    if (fast == 0) {
      evaluator.plane(plan, places[plane][k], workspace, to, strides[row], pastCaches);
      continue;
    }
    evaluator.plane(plan, places[plane][k], workspace, values.data(), places[fast].size());
    for (std::size_t j = 0; j < places[row].size(); ++j)
      for (std::size_t i = 0; i < places[fast].size(); ++i)
        to[i * strides[fast] + j * strides[row]] = values[i + j * places[fast].size()];
  }
}

hbRange hbSparseGrid::range(const hbBox& box, int component) const {
  double lo = 0.0, hi = 0.0, magnitude = 0.0;
  for (const hbSubspace& subspace : set_.subspaces()) {
    // The nodes whose hats meet the box, first to last, and whether the weights at a point sum to 1 (level 0
    // throughout).
    hbSize3 first(0), last(0);
    bool convex = true;
    for (int d = 0; d < 3; ++d) {
      last[d] = subspace.nodes[d] - 1;
      if (subspace.levels[d] == 0) continue;
      convex = false;
      hbHat<double> from, to;
      from.evaluate(latticeCoordinate(box.lo[d], d), false, subspace.levels[d]);
      to.evaluate(latticeCoordinate(box.hi[d], d), false, subspace.levels[d]);
      first[d] = from.node[subspace.levels[d] + 1];
      last[d] = to.node[subspace.levels[d] + 1];
    }
    const auto stored = surpluses(subspace, component);
    double least = convex ? std::numeric_limits<double>::infinity() : 0.0, greatest = -least;
    for (std::int64_t k = first.z; k <= last.z; ++k)
      for (std::int64_t j = first.y; j <= last.y; ++j)
        for (std::int64_t i = first.x; i <= last.x; ++i) {
          const double s = stored[std::size_t(i + subspace.nodes.x * (j + subspace.nodes.y * k))];
          least = std::min(least, s);
          greatest = std::max(greatest, s);
        }
    lo += least;
    hi += greatest;
    magnitude += std::max(std::abs(least), std::abs(greatest));
  }
  // Each term of evaluate() rounds a dozen times in 32 bits: three weights, their products, and the sum over lx.
  const double slack = (12.0 + set_.finest().x) * 0x1p-24 * magnitude;
  return {float(lo - slack), float(hi + slack)};
}
