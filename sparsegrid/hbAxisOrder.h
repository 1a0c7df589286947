#pragma once

/// Which axis of the cube plays which part while a lattice is evaluated: samples along `fast` lie beside each other in
/// a row, rows along `row` make a plane, planes follow each other along `plane`. A permutation of 0, 1, 2.
struct hbAxisOrder {
  int fast = 0, row = 1, plane = 2;

  bool operator==(const hbAxisOrder&) const = default;
};
