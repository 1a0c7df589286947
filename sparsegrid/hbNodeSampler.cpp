#include "sparsegrid/hbNodeSampler.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "volume/hbError.h"

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
    : source_(source), size_(source.geometry().size), aligned_(mapping == hbLatticeMapping::aligned) {
  if (aligned_) checkAligned(size_, set);
  for (int d = 0; d < 2; ++d)
    for (int level = 0; level <= set.finest()[d]; ++level) plans_[std::size_t(d)].push_back(plan(d, level));
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
  return plan(axis, level, 0, hbIndexSet::axisNodes(size_[axis] == 1, level));
}

hbNodeSampler::AxisPlan hbNodeSampler::plan(int axis, int level, std::int64_t first, std::int64_t count) const {
  AxisPlan plan;
  if (size_[axis] == 1) return {{0.5}, {}};
  if (!aligned_) {
    for (std::int64_t k = first; k < first + count; ++k)
      plan.coordinates.push_back(level == 0 ? double(k) : std::ldexp(double(2 * k + 1), -level));
    return plan;
  }
  const int finest = alignedLevel(size_[axis]);
  std::vector<Stencil> stencils;
  std::map<std::int64_t, std::size_t> place; // of a sample among those read
  for (std::int64_t k = first; k < first + count; ++k) {
    stencils.push_back(stencil(axis, level == 0 ? k << finest : (2 * k + 1) << (finest - level)));
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

void hbNodeSampler::sample(const hbSubspace& subspace, std::int64_t first, std::int64_t count, int component,
                           std::span<double> out) const {
  const AxisPlan& x = plans_[0][std::size_t(subspace.levels.x)];
  const AxisPlan& y = plans_[1][std::size_t(subspace.levels.y)];
  const AxisPlan z = plan(2, subspace.levels.z, first, count);
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
  apply(z, std::size_t(subspace.nodes.x * subspace.nodes.y), 1);
  std::copy(values.begin(), values.end(), out.begin());
}
