#pragma once

/// What the kernels need to know of one axis of a sparse grid.
struct hbLatticeAxis {
  bool flat = false;
  int finest = 0;
  double scale = 1.0; ///< Lattice coordinate = scale * cube coordinate.
};
