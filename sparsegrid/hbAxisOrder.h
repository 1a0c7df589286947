#pragma once

#include <glm/vec3.hpp>

#include "sparsegrid/hbIndexSet.h"

/// Which axis of the cube plays which part while a lattice is evaluated: samples along `fast` lie beside each other in
/// a row, rows along `row` make a plane, planes follow each other along `plane`. A permutation of 0, 1, 2.
struct hbAxisOrder {
  int fast = 0, row = 1, plane = 2;

  /// What has three axes, from its three parts.
  template <class T>
  glm::vec<3, T> inCube(T alongFast, T alongRow, T alongPlane) const {
    glm::vec<3, T> result(T(0));
    result[fast] = alongFast;
    result[row] = alongRow;
    result[plane] = alongPlane;
    return result;
  }

  /// The order that takes least time, as far as can be told beforehand, for a lattice of so many samples of a sparse
  /// grid, with its x axis fastest in memory. Any other than the natural one (x, y, z) must save half of its time.
  static hbAxisOrder cheapest(const hbIndexSet& set, const hbSize3& samples);

  bool operator==(const hbAxisOrder&) const = default;
};
