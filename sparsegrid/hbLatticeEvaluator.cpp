#include "sparsegrid/hbLatticeEvaluator.h"

hbLatticeEvaluator::hbLatticeEvaluator(const hbSparseGrid& grid, int component, const hbAxisOrder& order)
    : grid_(grid), component_(component), order_(order) {}

hbLatticePlan hbLatticeEvaluator::plan(std::span<const double> us, std::span<const double> vs) const {
  return {{us.begin(), us.end()}, {vs.begin(), vs.end()}};
}

template <class Real>
void hbLatticeEvaluator::plane(const hbLatticePlan& plan, double w, hbLatticeWorkspace&, Real* out,
                               std::size_t strideRow, Quantity quantity) const {
  for (std::size_t j = 0; j < plan.vs.size(); ++j)
    for (std::size_t i = 0; i < plan.us.size(); ++i) {
      glm::dvec3 point{0.0}, gradient{0.0};
      point[order_.fast] = plan.us[i];
      point[order_.row] = plan.vs[j];
      point[order_.plane] = w;
      const double value = grid_.calcValue(point, component_, gradient);
      const int axes[] = {0, order_.fast, order_.row, order_.plane};
      out[i + strideRow * j] = Real(quantity == Quantity::value ? value : gradient[axes[int(quantity)]]);
    }
}

template void hbLatticeEvaluator::plane(const hbLatticePlan&, double, hbLatticeWorkspace&, float*, std::size_t,
                                        Quantity) const;
template void hbLatticeEvaluator::plane(const hbLatticePlan&, double, hbLatticeWorkspace&, double*, std::size_t,
                                        Quantity) const;
