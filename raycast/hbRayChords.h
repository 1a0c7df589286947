#pragma once

#include <vector>

#include "raycast/hbShearFactorisation.h"

/// Where intermediate rays lie in the box that is seen, counted in slices: a place n is slice n, n - 1/2 and n + 1/2
/// are the faces of its slab.
class hbRayChords {
public:
  /// A ray's slices, first to last, and how far it goes on in the box before and after them: a slice stands for half a
  /// slab to either side, the first and the last one for what there is.
  struct Chord {
    int first = 0, last = -1;
    double before = 0.0, after = 0.0;

    bool isEmpty() const { return last < first; }
    double length() const { return last - first + before + after; }
    double weight(int n) const { return (n == first ? before : 0.5) + (n == last ? after : 0.5); }
  };

  /// Keeps a reference to `rays`. O(slices + rays along either axis).
  explicit hbRayChords(const hbShearFactorisation& rays);

  Chord at(int i, int j) const;

private:
  /// Of the rays of one coordinate each.
  struct Runs {
    std::vector<int> first, end;
    std::vector<double> enter, leave;
  };
  Runs runs(bool alongV) const;

  const hbShearFactorisation& rays_;
  Runs u_, v_;
  double start_; ///< The box's front face, or a camera behind it.
};
