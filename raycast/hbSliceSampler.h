#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "raycast/hbShearFactorisation.h"
#include "sparsegrid/hbLatticeEvaluator.h"
#include "volume/hbValueMap.h"

/// The values of a sparse grid where the intermediate rays of a factorisation meet its slices.
class hbSliceSampler {
public:
  /// What is looked at: one component, or the length of the vector of all of them in true values.
  struct Source {
    std::span<const hbLatticeEvaluator> components;
    bool magnitude = false;
    hbValueMap map;
  };

  /// Rays: i from u0 to u1, j from v0 to v1, ends not included.
  struct Rectangle {
    int u0 = 0, u1 = 0, v0 = 0, v1 = 0;

    bool isEmpty() const { return u0 >= u1 || v0 >= v1; }
    void cover(const Rectangle& r) {
      *this = isEmpty() ? r : Rectangle{std::min(u0, r.u0), std::max(u1, r.u1), std::min(v0, r.v0), std::max(v1, r.v1)};
    }
    Rectangle intersect(const Rectangle& r) const {
      return {std::max(u0, r.u0), std::min(u1, r.u1), std::max(v0, r.v0), std::min(v1, r.v1)};
    }
  };

  /// A lattice of samples that was prepared before, of one source.
  struct Lattice {
    std::optional<hbLatticePlan> plan;
    std::vector<double> us, vs;

    void restart() { us.clear(); }
  };

  /// Memory that is used again and again; one a thread, to be restarted for every frame.
  struct Scratch {
    hbLatticeWorkspace workspace;
    Lattice lattice;
    std::vector<double> us, vs, squares;
    std::vector<float> component;

    void restart() { lattice.restart(); }
  };

  /// Keeps references to `rays` and what `source` refers to.
  hbSliceSampler(const hbShearFactorisation& rays, const Source& source) : rays_(rays), source_(source) {}

  /// The rays of rows [v0, v1) that lie in the box in slice n.
  Rectangle rectangle(int n, int v0, int v1) const;

  /// Those of the rectangle that surely lie in the box in the slices before and after n, too: they neither begin nor
  /// end there.
  Rectangle inner(int n, const Rectangle& r) const;

  /// out[(i - r.u0) + rays.u().count (j - r.v0)] = the value at ray (i, j) in slice n, over the rectangle; `hidden`
  /// where that lies behind the camera's plane.
  void sample(int n, const Rectangle& r, Scratch& scratch, float hidden, float* out) const;

  /// out[i + rays.u().count j] = the value at us[i], vs[j] and w of the cube. `lattice` is what was prepared before,
  /// and is prepared anew where places have changed.
  void evaluate(std::span<const double> us, std::span<const double> vs, double w, Lattice& lattice, Scratch& scratch,
                float* out) const;

  /// What sample() needs of the scratch at most, in bytes, a band's rays apart.
  double bytes() const { return source_.components.empty() ? 0.0 : source_.components[0].bytes(rays_.u().count); }

private:
  void lengths(double w, const Lattice& lattice, Scratch& scratch, float* out) const;

  const hbShearFactorisation& rays_;
  Source source_;
};
