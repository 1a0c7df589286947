#include "report/hbSetChoice.h"

#include <algorithm>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "volume/hbError.h"

hbInput hbSetChoice::inputFor(const hbInput& input) const {
  if (!input.analytic || !isGiven()) return input;
  hbSize3 size = input.analytic->geometry().size;
  const glm::ivec3 finest = indexSet(input).finest();
  double samples = 1.0; // powers of two and a little: doubles tell 2^60 from less
  for (int d = 0; d < 3; ++d) {
    if (size[d] > 2) size[d] = (std::int64_t{1} << finest[d]) + 1;
    samples *= double(size[d]);
  }
  if (samples >= 0x1p60)
    throw hbError(fmt::format("{}: expected levels whose full grid has fewer than 2^60 samples, found {},{},{}",
                              input.name, finest.x, finest.y, finest.z));
  hbInput sized = input;
  sized.analytic = input.analytic->withSize(size);
  return sized;
}

hbIndexSet hbSetChoice::indexSet(const hbInput& input) const {
  const hbSize3 size = input.geometry().size;
  if (list) return list->indexSet(size);
  const hbIndexSet::Axes capped = hbIndexSet::axesOf(size);
  const glm::ivec3& c = capped.maxLevel;
  const glm::ivec3 finest = isGiven() ? levels : glm::ivec3(std::max({1, c.x, c.y, c.z}));
  const bool isFree = uncapped || (input.analytic && isGiven());
  const hbIndexSet::Axes axes = isFree ? hbIndexSet::uncappedAxesOf(size) : capped;
  if (!full) return hbIndexSet::anisotropic(finest, axes);
  return hbIndexSet::full({glm::min(axes.maxLevel, finest), axes.flat});
}
