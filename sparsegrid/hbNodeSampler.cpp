#include "sparsegrid/hbNodeSampler.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "volume/hbError.h"
#include "volume/hbParallel.h"

namespace {

std::int64_t planeNodes(const hbSubspace& subspace) { return subspace.nodes.x * subspace.nodes.y; }

} // namespace

int hbNodeSampler::alignedLevel(std::int64_t size) {
  return size <= 2 ? 0 : int(std::bit_width(std::uint64_t(size - 2)));
}

void hbNodeSampler::checkAligned(const hbSize3& size, const hbIndexSet& set) {
  for (int d = 0; d < 3; ++d) {
    const int level = alignedLevel(size[d]);
    if (level > hbIndexSet::kMaxLevel)
      throw hbError(fmt::format("aligned mapping: expected at most {} samples along {}, found {}",
                                (std::int64_t{1} << hbIndexSet::kMaxLevel) + 1, "xyz"[d], size[d]));
    if (set.finest()[d] > level)
      throw hbError(fmt::format("aligned mapping: expected levels up to {} along {} for {} samples, found {}", level,
                                "xyz"[d], size[d], set.finest()[d]));
  }
}

hbNodeSampler::hbNodeSampler(const hbField& source, const hbIndexSet& set, hbLatticeMapping mapping)
    : source_(source), set_(set), size_(source.geometry().size), aligned_(mapping == hbLatticeMapping::aligned) {
  if (aligned_) checkAligned(size_, set);
  for (int d = 0; d < 3; ++d) resolution_[d] = aligned_ ? alignedLevel(size_[d]) : set.finest()[d];
  for (int d = 0; d < 2; ++d)
    for (int level = 0; level <= set.finest()[d]; ++level) plans_[std::size_t(d)].push_back(plan(d, level));
  subspaces_.resize(std::size_t(set.finest().z) + 1);
  for (const hbSubspace& subspace : set.subspaces()) subspaces_[std::size_t(subspace.levels.z)].push_back(subspace);
}

hbNodeSampler::Stencil hbNodeSampler::stencil(int axis, std::int64_t node) const {
  const std::int64_t samples = size_[axis], last = std::int64_t{1} << alignedLevel(samples);
  if (node < samples) return {{node, 1.0}};
  if (node == last) return {{last / 2, 2.0}, {0, -1.0}};
  // Outside: the mean of the neighbours at the distance of the node's own level.
  const std::int64_t distance = std::int64_t{1} << std::countr_zero(std::uint64_t(node));
  std::map<std::int64_t, double> sum;
  for (const std::int64_t neighbour : {node - distance, node + distance})
    for (const auto& [sample, weight] : stencil(axis, neighbour)) sum[sample] += 0.5 * weight;
  return {sum.begin(), sum.end()};
}

hbNodeSampler::AxisPlan hbNodeSampler::plan(int axis, int level) const {
  const int spare = resolution_[axis] - level;
  std::vector<std::int64_t> nodes;
  for (std::int64_t k = 0; k < hbIndexSet::axisNodes(size_[axis] == 1, level); ++k)
    nodes.push_back(level == 0 ? k << spare : (2 * k + 1) << spare);
  return planOf(axis, nodes);
}

hbNodeSampler::AxisPlan hbNodeSampler::planOf(int axis, const std::vector<std::int64_t>& nodes) const {
  AxisPlan plan;
  if (size_[axis] == 1) return {{0.5}, {}};
  if (!aligned_) {
    for (const std::int64_t node : nodes) plan.coordinates.push_back(std::ldexp(double(node), -resolution_[axis]));
    return plan;
  }
  std::vector<Stencil> stencils;
  std::map<std::int64_t, std::size_t> place; // of a sample among those read
  for (const std::int64_t node : nodes) {
    stencils.push_back(stencil(axis, node));
    for (const auto& [sample, weight] : stencils.back()) place.emplace(sample, 0);
  }
  for (auto& [sample, index] : place) {
    index = plan.coordinates.size();
    plan.coordinates.push_back(double(sample) / double(size_[axis] - 1));
  }
  for (const Stencil& one : stencils) {
    plan.nodes.emplace_back();
    for (const auto& [sample, weight] : one) plan.nodes.back().emplace_back(place.at(sample), weight);
  }
  return plan;
}

bool hbNodeSampler::isContinued(const Plane& plane) const {
  // With two nodes along z, the sample in the middle is not among the nodes.
  return aligned_ && plane.lattice >= size_.z && set_.finest().z > 0;
}

void hbNodeSampler::read(const hbSubspace& subspace, const Plane& plane, int component, double* out) const {
  const AxisPlan& x = plans_[0][std::size_t(subspace.levels.x)];
  const AxisPlan& y = plans_[1][std::size_t(subspace.levels.y)];
  const AxisPlan z = planOf(2, {plane.lattice});
  const std::array<std::size_t, 3> read{x.coordinates.size(), y.coordinates.size(), z.coordinates.size()};
  std::vector<float> samples(read[0] * read[1] * read[2]);
  source_.lattice(x.coordinates, y.coordinates, z.coordinates, component, samples.data(), read[0], read[0] * read[1]);
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (!std::isfinite(samples[i]))
      throw hbError(fmt::format("expected finite samples, found {} near ({:.4g}, {:.4g}, {:.4g}) of the unit cube; "
                                "--nan-value V replaces such samples",
                                samples[i], x.coordinates[i % read[0]], y.coordinates[i / read[0] % read[1]],
                                z.coordinates[i / (read[0] * read[1])]));

  // Axis by axis: what was read becomes the nodes' values. [outer][read][inner] -> [outer][nodes][inner]
  std::vector<double> values(samples.begin(), samples.end());
  const auto apply = [&](const AxisPlan& plan, std::size_t inner, std::size_t outer) {
    if (plan.nodes.empty()) return;
    std::vector<double> result(outer * plan.nodes.size() * inner);
    for (std::size_t o = 0; o < outer; ++o)
      for (std::size_t n = 0; n < plan.nodes.size(); ++n)
        for (const auto& [place, weight] : plan.nodes[n])
          for (std::size_t i = 0; i < inner; ++i)
            result[(o * plan.nodes.size() + n) * inner + i] +=
                weight * values[(o * plan.coordinates.size() + place) * inner + i];
    values = std::move(result);
  };
  apply(x, 1, read[1] * read[2]);
  apply(y, std::size_t(subspace.nodes.x), read[2]);
  apply(z, std::size_t(planeNodes(subspace)), 1);
  std::copy(values.begin(), values.end(), out);
}

void hbNodeSampler::continueFrom(const std::vector<double>& values, const hbSubspace& subspace, const Plane& plane,
                                 double* out) const {
  const std::int64_t count = planeNodes(subspace);
  std::fill(out, out + count, 0.0);
  for (const auto& [sample, weight] : stencil(2, plane.lattice)) {
    // The samples it is made of are nodes of coarser levels, whose subspaces are in the set.
    const hbIndexSet::AxisNode node = hbIndexSet::axisNode(false, resolution_.z, sample);
    const hbSubspace& coarser = set_.subspace({subspace.levels.x, subspace.levels.y, node.level});
    const double* from = values.data() + coarser.offset + node.index * count;
    for (std::int64_t i = 0; i < count; ++i) out[i] += weight * from[i];
  }
}

void hbNodeSampler::run(std::span<const Plane> planes, Values& values, hbProgress& progress) const {
  // Some subspaces of a plane each.
  struct Task {
    const Plane* plane;
    std::span<const hbSubspace> subspaces;
    std::int64_t nodes;
  };
  constexpr std::int64_t kNodes = 4096;
  std::vector<Task> tasks;
  for (const Plane& plane : planes) {
    std::span<const hbSubspace> left(subspaces_[std::size_t(plane.level)]);
    while (!left.empty()) {
      std::size_t count = 0;
      std::int64_t nodes = 0;
      while (count < left.size() && nodes < kNodes) nodes += planeNodes(left[count++]);
      tasks.push_back({&plane, left.first(count), nodes});
      left = left.subspan(count);
    }
  }
  const int components = int(values.size());
  hb::parallelFor(std::int64_t(tasks.size()), [&](std::int64_t t) {
    const auto& [plane, subspaces, nodes] = tasks[std::size_t(t)];
    for (const hbSubspace& subspace : subspaces)
      for (int c = 0; c < components; ++c) {
        double* out = values[std::size_t(c)].data() + subspace.offset + plane->index * planeNodes(subspace);
        if (isContinued(*plane))
          continueFrom(values[std::size_t(c)], subspace, *plane, out);
        else
          read(subspace, *plane, c, out);
      }
    progress.advance(nodes * components);
  });
}

std::pair<std::int64_t, std::int64_t> hbNodeSampler::samplesOf(const Plane& plane) const {
  const std::vector<double> z = planOf(2, {plane.lattice}).coordinates;
  const double last = double(size_.z - 1);
  return {std::int64_t(z.front() * last), std::int64_t(std::ceil(z.back() * last))};
}

std::vector<std::vector<double>> hbNodeSampler::sample(hbProgress& progress, const AfterBand& afterBand) const {
  const int finest = set_.finest().z, components = source_.components();
  std::vector<Plane> inside, continued;
  for (std::int64_t k = 0; k < (set_.flat().z ? 1 : (std::int64_t{1} << finest) + 1); ++k) {
    const auto [level, index] = hbIndexSet::axisNode(set_.flat().z, finest, k);
    const Plane plane{level, index, k << (resolution_.z - finest)};
    (isContinued(plane) ? continued : inside).push_back(plane);
  }
  progress.begin("reading nodes", set_.storedValues() * components, "nodes");
  Values values(static_cast<std::size_t>(components));
  for (std::vector<double>& component : values) component.resize(std::size_t(set_.storedValues()));
  // Planes of a band; where nobody waits for its end, the whole is one, which keeps all threads busy.
  const std::int64_t most =
      afterBand ? std::max<std::int64_t>(1, kBandSamples / (size_.x * size_.y * components)) : size_.z + 1;
  for (std::size_t begin = 0; begin < inside.size();) {
    const std::int64_t first = samplesOf(inside[begin]).first;
    std::int64_t last = first;
    std::size_t end = begin;
    for (; end < inside.size() && (end == begin || samplesOf(inside[end]).second < first + most); ++end)
      last = samplesOf(inside[end]).second;
    run({inside.data() + begin, end - begin}, values, progress);
    if (afterBand) afterBand(first, last);
    begin = end;
  }
  run(continued, values, progress); // not from the source, but from the planes inside
  return values;
}
