#pragma once

#include <optional>

#include <glm/vec3.hpp>

#include "raycast/hbInput.h"
#include "sparsegrid/hbIndexSetFile.h"

/// Which index set the sparse grid of an input has.
struct hbSetChoice {
  /// The finest level of each axis, each from 1 to hbIndexSet::kMaxLevel: equal ones are the level of the regular set,
  /// others make it anisotropic. All 0: the level that resolves the longest axis.
  glm::ivec3 levels{0};
  bool full = false;     ///< Every subspace up to these levels instead of the sparse set.
  bool uncapped = false; ///< Axes may go finer than the samples.
  /// These subspaces, whatever the samples resolve; nothing of the above counts then.
  std::optional<hbIndexSetFile> list;

  /// The input that is compressed. With levels or a list, an analytic field stands for the full grid of the set, 2^l +
  /// 1 nodes an axis (where it has more than two), and no axis is capped; every other input is left as it is. Throws
  /// hbError where that grid had 2^60 nodes or more, or indexSet() does.
  hbInput inputFor(const hbInput& input) const;

  /// The set for an input. Throws hbError for levels out of range, a list that does not fit or is not closed, and
  /// 2^60 values or more.
  hbIndexSet indexSet(const hbInput& input) const;

private:
  /// Whether an analytic field is to be what the set makes of it.
  bool isGiven() const { return list || levels != glm::ivec3(0); }
};
