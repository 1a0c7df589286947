#include "raycast/hbSliceLight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "raycast/hbLitPieces.h"
#include "volume/hbParallel.h"

namespace {

constexpr int kTogether = 64; // rays that are looked at for whether anything shows there

} // namespace

hbSliceLight::hbSliceLight(const hbShearFactorisation& rays, const hbSliceSampler::Source& source,
                           const hbMatter& matter, const hbVisibility& visibility, const hbGeometry& geometry,
                           const hbScene& scene, Memory& memory)
    : rays_(rays), sampler_(rays, source), chords_(rays), tasks_(rays), matter_(matter), visibility_(visibility),
      scene_(scene), gradients_(rays, sampler_, geometry), cubeToWorld_(geometry.cubeToWorld()),
      isLit_(hbLitPieces::areIn(scene)), memory_(memory) {
  const glm::dmat3 toWorld(cubeToWorld_);
  const hbShearFactorisation::Slice change = rays.changeOfSlice();
  way_ = toWorld * rays.point(change, 0.0, 0.0);
  wayOfA_ = toWorld * rays.point(change, 1.0, 0.0) - way_;
  wayOfB_ = toWorld * rays.point(change, 0.0, 1.0) - way_;
}

double hbSliceLight::bytes() const {
  const double lit = isLit_ ? hbSliceGradients::bytes(tasks_.raysAPiece()) + sampler_.bytes() : 0.0;
  const double ofThread = tasks_.raysAPiece() * 2 * sizeof(float) + sampler_.bytes() + lit;
  return double(sizeof(glm::vec4) + sizeof(float)) * rays_.u().count * rays_.v().count +
         double(sizeof(hbEmissionAbsorption)) * tasks_.raysAtOnce() + hb::parallelThreads() * ofThread;
}

std::vector<float> hbSliceLight::slabs() const {
  const auto columns = std::size_t(rays_.u().count);
  std::vector<float> lengths(columns * std::size_t(rays_.v().count));
  hb::parallelFor(rays_.v().count, [&](std::int64_t j) {
    const glm::dvec3 ofRow = way_ + rays_.v().at(int(j)) * wayOfB_;
    for (std::size_t i = 0; i < columns; ++i)
      lengths[i + columns * std::size_t(j)] = float(glm::length(ofRow + rays_.u().at(int(i)) * wayOfA_));
  });
  return lengths;
}

void hbSliceLight::composite(const Piece& piece, std::span<const float> slabs, Part& part, hbProgress& progress) const {
  const hbPool<Scratch>::Lease scratch(memory_.scratch);
  scratch->sampler.restart();
  scratch->gradients.restart();
  const auto stride = std::size_t(rays_.u().count);
  const std::size_t size = stride * std::size_t(piece.v1 - piece.v0);
  for (std::vector<float>* slice : {&scratch->before, &scratch->now})
    if (slice->size() < size) slice->resize(size);
  part.light.assign(size, {});
  part.isEmpty = true;
  // A slab lies between two slices: the last one of the chunk before is looked at again.
  const int first = matter_.isPreintegrated() ? std::max(rays_.firstSlice(), piece.begin - 1) : piece.begin;
  for (int n = first; n < piece.end; ++n) {
    const Rectangle r = sampler_.rectangle(n, piece.v0, piece.v1);
    if (!r.isEmpty()) {
      const std::size_t corner = std::size_t(r.u0) + stride * std::size_t(r.v0 - piece.v0);
      sampler_.sample(n, r, scratch->sampler, 0.0F, scratch->now.data() + corner);
      if (n >= piece.begin) addSlice(n, r, piece, slabs, *scratch, part);
    }
    scratch->before.swap(scratch->now);
    if (n >= piece.begin) progress.advance(1);
  }
}

void hbSliceLight::addSlice(int n, const Rectangle& r, const Piece& piece, std::span<const float> slabs,
                            Scratch& scratch, Part& part) const {
  const Rectangle inner = sampler_.inner(n, r);
  const Rectangle shown = isLit_ ? litRows(n, r, piece, slabs, scratch, part) : r;
  if (isLit_ && !shown.isEmpty()) gradients_.evaluate(litAt(n), shown, scratch.gradients);
  part.isEmpty = false;
  for (int j = shown.v0; j < shown.v1; ++j) {
    Row row = rowOf(n, j, piece, slabs, scratch, part);
    if (isLit_) {
      row.gradients = &scratch.gradients;
      row.at = std::size_t(rays_.u().count) * std::size_t(j - shown.v0);
      row.u0 = shown.u0;
    }
    const bool isInner = j >= inner.v0 && j < inner.v1;
    const int u0 = isInner ? inner.u0 : r.u1, u1 = isInner ? inner.u1 : r.u1;
    addEnds(row, r.u0, u0);
    addInner(row, u0, u1);
    addEnds(row, u1, r.u1);
  }
}

hbSliceLight::Row hbSliceLight::rowOf(int n, int j, const Piece& piece, std::span<const float> slabs,
                                      const Scratch& scratch, Part& part) const {
  const auto stride = std::size_t(rays_.u().count);
  const std::size_t at = stride * std::size_t(j - piece.v0);
  Row row;
  row.n = n;
  row.j = j;
  row.before = scratch.before.data() + at;
  row.now = scratch.now.data() + at;
  row.slabs = slabs.data() + stride * std::size_t(j);
  row.light = part.light.data() + at;
  return row;
}

hbSliceLight::Rectangle hbSliceLight::litRows(int n, const Rectangle& r, const Piece& piece,
                                              std::span<const float> slabs, const Scratch& scratch, Part& part) const {
  Rectangle lit{r.u0, r.u1, r.v1, r.v0};
  for (int j = r.v0; j < r.v1; ++j) {
    const Row row = rowOf(n, j, piece, slabs, scratch, part);
    bool shows = false;
    for (int from = r.u0; from < r.u1 && !shows; from += kTogether) {
      const int to = std::min(r.u1, from + kTogether);
      shows = !isInvisible(row, from, to) &&
              std::any_of(row.light + from, row.light + to,
                          [](const hbEmissionAbsorption& light) { return !(light.transmittance() < kOpaque); });
    }
    if (!shows) continue;
    lit.v0 = std::min(lit.v0, j);
    lit.v1 = j + 1;
  }
  return lit;
}

void hbSliceLight::addLit(const Row& row, int i, const glm::vec4& piece, double length) const {
  const glm::dvec3 gradient = gradients_.at(*row.gradients, row.at + std::size_t(i - row.u0));
  if (scene_.gradientOpacity) length *= matter_.shownBy(glm::length(gradient));
  hbShading::Reflection reflection;
  if (scene_.shading) {
    const double a = rays_.u().at(i), b = rays_.v().at(row.j);
    const glm::dvec3 place = rays_.point(rays_.slice(litAt(row.n)), a, b), way = way_ + a * wayOfA_ + b * wayOfB_;
    reflection =
        scene_.shading->reflection(glm::dvec3(cubeToWorld_ * glm::dvec4(place, 1.0)), glm::normalize(way), gradient);
  }
  matter_.addPiece(piece, length, row.light[i], reflection);
}

bool hbSliceLight::isInvisible(const Row& row, int u0, int u1) const {
  // In lanes, which a processor compares at once.
  constexpr int kLanes = 8;
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::array<float, kLanes> least, greatest;
  least.fill(kInfinity);
  greatest.fill(-kInfinity);
  const auto cover = [&](const float* values) {
    const auto take = [&](int i, std::size_t lane) {
      least[lane] = values[i] < least[lane] ? values[i] : least[lane];
      greatest[lane] = values[i] > greatest[lane] ? values[i] : greatest[lane];
    };
    int i = u0;
    for (; i + kLanes <= u1; i += kLanes)
      for (int lane = 0; lane < kLanes; ++lane) take(i + lane, std::size_t(lane));
    for (; i < u1; ++i) take(i, 0);
  };
  cover(row.now);
  if (matter_.isPreintegrated()) cover(row.before);
  return visibility_.isInvisible(*std::min_element(least.begin(), least.end()),
                                 *std::max_element(greatest.begin(), greatest.end()));
}

void hbSliceLight::addInner(const Row& row, int u0, int u1) const {
  for (int from = u0; from < u1; from += kTogether) {
    const int to = std::min(u1, from + kTogether);
    if (isInvisible(row, from, to)) continue;
    for (int i = from; i < to; ++i) {
      if (row.light[i].transmittance() < kOpaque) continue;
      add(row, i, matter_.isPreintegrated() ? matter_.slab(row.before[i], row.now[i]) : matter_.at(row.now[i]),
          row.slabs[i]);
    }
  }
}

void hbSliceLight::addEnds(const Row& row, int u0, int u1) const {
  for (int i = u0; i < u1; ++i) {
    const hbRayChords::Chord chord = chords_.at(i, row.j);
    // Behind the camera's plane, or opaque.
    if (row.n < chord.first || row.n > chord.last || row.light[i].transmittance() < kOpaque) continue;
    if (!matter_.isPreintegrated()) {
      add(row, i, matter_.at(row.now[i]), chord.weight(row.n) * row.slabs[i]);
      continue;
    }
    if (row.n == chord.first)
      add(row, i, matter_.slab(row.now[i], row.now[i]), chord.before * row.slabs[i]);
    else
      add(row, i, matter_.slab(row.before[i], row.now[i]), row.slabs[i]);
    if (row.n == chord.last) add(row, i, matter_.slab(row.now[i], row.now[i]), chord.after * row.slabs[i]);
  }
}

void hbSliceLight::merge(int v0, int v1, std::span<const float> slabs, std::span<const Part> parts,
                         std::span<glm::vec4> result) const {
  const auto columns = std::size_t(rays_.u().count);
  for (int j = v0; j < v1; ++j)
    for (std::size_t i = 0; i < columns; ++i) {
      const std::size_t at = i + columns * std::size_t(j);
      hbEmissionAbsorption light;
      for (const Part& part : parts)
        if (!part.isEmpty) light.add(part.light[at - columns * std::size_t(v0)]);
      const hbRayChords::Chord chord = chords_.at(int(i), j);
      result[at] = chord.isEmpty() ? glm::vec4(std::numeric_limits<float>::quiet_NaN())
                                   : light.matter(chord.length() * double(slabs[at]));
    }
}

std::vector<glm::vec4> hbSliceLight::run(hbProgress& progress) const {
  const auto columns = std::size_t(rays_.u().count);
  std::vector<glm::vec4> result(columns * std::size_t(rays_.v().count));
  const std::vector<float> lengths = slabs();
  const hbPool<std::vector<Part>>::Lease parts(memory_.parts);
  tasks_.run(
      *parts, [&](const Piece& piece, Part& part) { composite(piece, lengths, part, progress); },
      [&](int v0, int v1, std::span<const Part> ofBand) { merge(v0, v1, lengths, ofBand, result); });
  return result;
}
