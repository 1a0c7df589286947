// Makes a sparse grid of the hydrogen orbital and prints its value at a node, where it is the orbital's own: at
// (1/2, 1/2, 3/4), that is X = Y = 0 and Z = 12, ((3 - 1) 12^2 exp(-12/3))^2 = 27.8246.

#include <cstdio>

#include "sparsegrid/hbSparseGrid.h"
#include "volume/fields/hbAnalyticField.h"

int main() {
  const auto orbital = hbAnalyticField::create("hydrogen");
  const hbSparseGrid grid = hbSparseGrid::interpolate(*orbital, hbIndexSet::regular(5, {}), hbLatticeMapping::fitted);
  std::printf("%.4f\n", grid.calcValue({0.5, 0.5, 0.75}, 0));
}
