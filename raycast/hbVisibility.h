#pragma once

#include "raycast/hbMatter.h"
#include "scene/hbOpacityRange.h"

/// Which values show nothing at all: what has only these can be left out, and pictures do not change by a bit. It
/// belongs to one transfer function.
class hbVisibility {
public:
  /// `matter` was made of `function`.
  hbVisibility(const hbTransferFunction& function, const hbMatter& matter);

  /// Whether samples with field values from `least` to `greatest`, or NaN, and slabs between them show nothing. O(1).
  bool isInvisible(float least, float greatest) const {
    return !showsNaN_ && opacities_.maximum(map_.toTrue(least) - margin_, map_.toTrue(greatest) + margin_) == 0.0;
  }

private:
  hbOpacityRange opacities_;
  hbValueMap map_;
  double margin_; ///< No value farther away has a part in what a table says of one.
  bool showsNaN_;
};
