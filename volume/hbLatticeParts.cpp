#include "volume/hbLatticeParts.h"

#include <algorithm>
#include <cassert>
#include <span>

namespace {

/// A part may have so few samples before what a call prepares counts.
constexpr std::int64_t kFewSamples = 65536;
/// Where planes are fewer, they are cut for the sake of the threads.
constexpr std::int64_t kFewPlanes = 16;

std::int64_t quotientUp(std::int64_t a, std::int64_t b) { return (a + b - 1) / b; }

} // namespace

hbLatticeParts::hbLatticeParts(std::vector<double> xs, std::vector<double> ys, std::vector<double> zs,
                               std::int64_t mostSamples)
    : xs_(std::move(xs)), ys_(std::move(ys)), zs_(std::move(zs)) {
  assert(!xs_.empty() && !ys_.empty() && !zs_.empty() && mostSamples > 0);
  const hbSize3 all = size();
  const std::int64_t plane = all.x * all.y;
  const std::int64_t forSize = quotientUp(plane, mostSamples),
                     forThreads = std::min(quotientUp(kFewPlanes, all.z), plane / kFewSamples);
  rows_ = std::min(quotientUp(all.y, std::clamp<std::int64_t>(std::max(forSize, forThreads), 1, all.y)),
                   std::max<std::int64_t>(1, mostSamples / all.x));
  if (rows_ == all.y) planes_ = std::clamp<std::int64_t>(std::min(kFewSamples, mostSamples) / plane, 1, all.z);
}

std::int64_t hbLatticeParts::count() const { return quotientUp(size().y, rows_) * quotientUp(size().z, planes_); }

hbLatticeParts::Part hbLatticeParts::part(std::int64_t index) const {
  const hbSize3 all = size();
  const std::int64_t strips = quotientUp(all.y, rows_), y = index % strips * rows_, z = index / strips * planes_;
  return {y, std::min(rows_, all.y - y), z, std::min(planes_, all.z - z)};
}

void hbLatticeParts::evaluate(const hbField& field, int component, const Part& part, float* out) const {
  field.lattice(xs_, std::span(ys_).subspan(std::size_t(part.y), std::size_t(part.rows)),
                std::span(zs_).subspan(std::size_t(part.z), std::size_t(part.planes)), component, out, xs_.size(),
                xs_.size() * std::size_t(part.rows));
}
