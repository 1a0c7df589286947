#include "bench/fields.h"

#include <map>
#include <random>

#include "volume/fields/hbAnalyticField.h"

namespace {

std::shared_ptr<const hbAnalyticField> orbital(std::int64_t size) {
  return hbAnalyticField::create("hydrogen")->withSize({size, size, size});
}

/// The entry of that key, made by `make(key)` if it is the first time.
template <class Value, class Make>
const Value& once(std::map<int, Value>& known, int key, const Make& make) {
  const auto found = known.find(key);
  return found != known.end() ? found->second : known.emplace(key, make(key)).first->second;
}

} // namespace

bench::Points::Points(std::size_t count) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  for (std::vector<float>* axis : {&x_, &y_, &z_})
    for (std::size_t i = 0; i < count; ++i) axis->push_back(unit(random));
}

const hbSparseGrid& bench::sparseGrid(int level) {
  static std::map<int, hbSparseGrid> known;
  return once(known, level, [](int n) {
    return hbSparseGrid::interpolate(*orbital((std::int64_t{1} << n) + 1), hbIndexSet::regular(n, {}),
                                     hbLatticeMapping::fitted);
  });
}

const hbSemiNodalGrid& bench::semiNodal(int level) {
  static std::map<int, hbSemiNodalGrid> known;
  return once(known, level, [](int n) { return hbSemiNodalGrid(sparseGrid(n)); });
}

const hbCombinationSparseGrid& bench::combination(int level) {
  static std::map<int, hbCombinationSparseGrid> known;
  return once(known, level, [](int n) { return hbCombinationSparseGrid(sparseGrid(n)); });
}

const hbVolumeField& bench::volume(int size) {
  static std::map<int, hbVolumeField> known;
  return once(known, size, [](int n) {
    const auto field = orbital(n);
    std::vector<double> nodes;
    for (int i = 0; i < n; ++i) nodes.push_back(double(i) / double(n - 1));
    const auto row = std::size_t(n);
    std::vector<float> samples(row * row * row);
    field->lattice(nodes, nodes, nodes, 0, samples.data(), row, row * row);
    return hbVolumeField(hbVolume::fromSamples(field->geometry(), std::move(samples)));
  });
}
