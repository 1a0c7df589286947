#include "fitting/hbPrewavelet.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "sparsegrid/hbLineGroup.h"
#include "volume/hbParallel.h"

namespace {

constexpr std::array<double, 5> kInner{0.1, -0.6, 1.0, -0.6, 0.1};
constexpr std::array<double, 4> kEnd{-1.2, 1.1, -0.6, 0.1};
constexpr std::array<double, 3> kOnly{-1.0, 1.0, -1.0}; ///< Of level 1.

/// The k-th prewavelet of level l >= 1 as values at the nodes of its level.
hbPrewavelet inner(int level, std::int64_t k) {
  const std::int64_t last = (std::int64_t{1} << (level - 1)) - 1;
  hbPrewavelet w{level, std::max<std::int64_t>(2 * k - 1, 0), {}, 0};
  const auto take = [&](auto begin, auto end) {
    w.count = int(std::copy(begin, end, w.values.begin()) - w.values.begin());
  };
  if (last == 0)
    take(kOnly.begin(), kOnly.end());
  else if (k == 0)
    take(kEnd.begin(), kEnd.end());
  else if (k == last)
    take(kEnd.rbegin(), kEnd.rend());
  else
    take(kInner.begin(), kInner.end());
  return w;
}

/// One line along an axis.
class Line {
public:
  Line(double* values, const hbLineGroup& group, std::int64_t outer, std::int64_t inner)
      : values_(values), group_(group), outer_(outer), inner_(inner) {}

  double& at(int level, std::int64_t k) const {
    const std::int64_t nodes = hbIndexSet::axisNodes(false, level);
    return values_[group_.offset[std::size_t(level)] + (outer_ * nodes + k) * group_.inner + inner_];
  }

  /// T: from fine to coarse, what a level's prewavelets have at the nodes of the coarser level being handed on.
  void toSurpluses(std::vector<double>& nodal) const {
    nodal.assign((std::size_t{1} << group_.finest) + 1, 0.0);
    for (int l = group_.finest; l >= 1; --l) {
      const std::int64_t count = hbIndexSet::axisNodes(false, l);
      for (std::int64_t k = 0; k < count; ++k) {
        const hbPrewavelet w = inner(l, k);
        for (int i = 0; i < w.count; ++i) nodal[std::size_t(w.first + i)] += w.values[std::size_t(i)] * at(l, k);
      }
      for (std::int64_t k = 0; k < count; ++k) {
        const double* node = nodal.data() + 2 * k;
        at(l, k) = node[1] - 0.5 * (node[0] + node[2]);
      }
      for (std::int64_t k = 0; k <= count; ++k) nodal[std::size_t(k)] = nodal[std::size_t(2 * k)];
    }
    at(0, 0) += nodal[0];
    at(0, 1) += nodal[1];
  }

  /// The same backwards.
  void transposed(std::vector<double>& nodal, std::vector<double>& finer) const {
    nodal.assign((std::size_t{1} << group_.finest) + 1, 0.0);
    finer = nodal;
    nodal[0] = at(0, 0);
    nodal[1] = at(0, 1);
    for (int l = 1; l <= group_.finest; ++l) {
      const std::int64_t count = hbIndexSet::axisNodes(false, l);
      finer[0] = nodal[0];
      for (std::int64_t k = 0; k < count; ++k) {
        const double own = at(l, k);
        finer[std::size_t(2 * k)] -= 0.5 * own;
        finer[std::size_t(2 * k + 1)] = own;
        finer[std::size_t(2 * k + 2)] = nodal[std::size_t(k + 1)] - 0.5 * own;
      }
      for (std::int64_t k = 0; k < count; ++k) {
        const hbPrewavelet w = inner(l, k);
        double sum = 0.0;
        for (int i = 0; i < w.count; ++i) sum += w.values[std::size_t(i)] * finer[std::size_t(w.first + i)];
        at(l, k) = sum;
      }
      std::swap(nodal, finer);
    }
  }

private:
  double* values_;
  const hbLineGroup& group_;
  std::int64_t outer_, inner_;
};

/// Calls work(line, room, more room) for every line of an axis.
template <class Work>
void forLines(const hbIndexSet& set, int axis, std::span<double> values, Work work) {
  for (const hbLineGroup& group : hb::lineGroups(set, axis))
    hb::parallelFor(group.outer, [&](std::int64_t outer) {
      std::vector<double> nodal, other;
      for (std::int64_t inner = 0; inner < group.inner; ++inner)
        work(Line(values.data(), group, outer, inner), nodal, other);
    });
}

} // namespace

void hb::prewaveletsToSurpluses(const hbIndexSet& set, std::span<double> values) {
  for (int axis = 0; axis < 3; ++axis)
    forLines(set, axis, values, [](const Line& line, auto& nodal, auto&) { line.toSurpluses(nodal); });
}

void hb::prewaveletsToSurplusesTransposed(const hbIndexSet& set, std::span<double> values) {
  for (int axis = 0; axis < 3; ++axis)
    forLines(set, axis, values, [](const Line& line, auto& nodal, auto& other) { line.transposed(nodal, other); });
}

hbPrewavelet hbPrewavelet::at(bool flat, int level, std::int64_t k) {
  if (flat) return {0, 0, {1.0, 1.0}, 2};
  if (level == 0) return {0, k, {1.0}, 1};
  return inner(level, k);
}

double hbPrewavelet::value(double x) const {
  const double place = std::ldexp(x, level) - double(first);
  double sum = 0.0;
  for (int i = 0; i < count; ++i) sum += values[std::size_t(i)] * std::max(0.0, 1.0 - std::abs(place - double(i)));
  return sum;
}
