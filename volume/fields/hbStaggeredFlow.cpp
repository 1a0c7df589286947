#include "volume/fields/hbStaggeredFlow.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "volume/hbParallel.h"

namespace {

/// Unlike std::max: NaN where one of them is.
double largerOrNaN(double a, double b) { return a >= b || std::isnan(a) ? a : b; }

/// The distances from a value to its neighbours along x, y, z.
using Strides = std::array<std::int64_t, 3>;

/// out = base + scale (-div(u q) + diffusivity lap q) for `count` values q along x. `carrier`: the velocities along x,
/// y, z at the upper faces of q's own cells are [i] + [i + shift], halved (shift 0 where one lies there), and those at
/// the lower faces the same one stride before.
void convectAndDiffuse(const double* base, double scale, const double* q, const std::array<const double*, 3>& carrier,
                       std::int64_t shift, const Strides& stride, double inverseWidth, double diffusivity,
                       std::int64_t count, double* __restrict out) {
  const double *const u = carrier[0], *const v = carrier[1], *const w = carrier[2];
  const auto [sx, sy, sz] = stride;
  const double convection = 0.25 * inverseWidth, diffusion = diffusivity * inverseWidth * inverseWidth;
  for (std::int64_t i = 0; i < count; ++i) {
    const double c = q[i];
    const double fluxes = (u[i] + u[i + shift]) * (c + q[i + sx]) - (u[i - sx] + u[i - sx + shift]) * (q[i - sx] + c) +
                          (v[i] + v[i + shift]) * (c + q[i + sy]) - (v[i - sy] + v[i - sy + shift]) * (q[i - sy] + c) +
                          (w[i] + w[i + shift]) * (c + q[i + sz]) - (w[i - sz] + w[i - sz + shift]) * (q[i - sz] + c);
    const double spread = q[i - sx] + q[i + sx] + q[i - sy] + q[i + sy] + q[i - sz] + q[i + sz] - 6.0 * c;
    out[i] = base[i] + scale * (diffusion * spread - convection * fluxes);
  }
}

} // namespace

hbStaggeredFlow::hbStaggeredFlow(const Parameters& parameters, std::int64_t cells)
    : parameters_(parameters), n_(cells), nz_(cells / 2), poisson_({cells, cells, cells / 2}, 1.0 / double(cells)),
      state_(std::size_t(4 * fieldSize())), work_(std::size_t(n_ * n_ * nz_)) {
  assert(cells >= 4 && cells % 2 == 0);
  double* const t = state_.data() + kT * fieldSize();
  for (std::int64_t k = 1; k <= nz_; ++k)
    for (std::int64_t j = 1; j <= n_; ++j)
      std::fill_n(t + k * strideZ() + j * strideY() + 1, n_, (double(j) - 0.5) * width());
  fillOutside(state_);
  start_ = next_ = state_;
}

void hbStaggeredFlow::setState(std::vector<double> state) {
  assert(state.size() == state_.size());
  state_ = std::move(state);
}

void hbStaggeredFlow::fillOutside(std::vector<double>& state) const {
  const std::int64_t sy = strideY(), sz = strideZ();
  for (int f = kU; f <= kT; ++f) {
    double* const q = state.data() + f * fieldSize();
    // A reflected value is 2 wall - inside for a given wall value, and the inside value where the slope is zero.
    const double sign = f == kT ? 1.0 : -1.0;
    for (std::int64_t k = 1; k <= nz_; ++k) {
      double* const layer = q + k * sz;
      if (f != kU)
        for (std::int64_t j = 1; j <= n_; ++j) {
          layer[j * sy] = sign * layer[j * sy + 1];
          layer[j * sy + n_ + 1] = sign * layer[j * sy + n_];
        }
      if (f == kV) continue;
      const double lid = f == kW ? 0.0 : 1.0;
      // The lid's own corners belong to the walls that stand still.
      const std::int64_t first = f == kU ? 1 : 0, last = f == kU ? n_ - 1 : n_ + 1;
      for (std::int64_t i = first; i <= last; ++i) {
        layer[i] = -layer[sy + i];
        layer[(n_ + 1) * sy + i] = 2.0 * lid - layer[n_ * sy + i];
      }
    }
    // The plane of symmetry, where w is zero like at the wall.
    if (f == kW) continue;
    for (std::int64_t i = 0; i < sz; ++i) {
      q[i] = sign * q[sz + i];
      q[(nz_ + 1) * sz + i] = q[nz_ * sz + i];
    }
  }
}

void hbStaggeredFlow::addTendency(const double* base, double scale, const std::vector<double>& from,
                                  std::vector<double>& next, std::int64_t k) const {
  const Strides stride{1, strideY(), strideZ()};
  const std::int64_t size = fieldSize();
  const double viscosity = 1.0 / parameters_.reynolds;
  const std::array<std::int64_t, 3> last{n_, n_, nz_};
  for (std::int64_t j = 1; j <= n_; ++j) {
    const std::int64_t at = k * stride[2] + j * stride[1] + 1;
    const std::array<const double*, 3> carrier{from.data() + at, from.data() + size + at, from.data() + 2 * size + at};
    for (std::size_t a = 0; a < 3; ++a) {
      // On walls, and on the plane of symmetry, the normal velocity stays zero.
      if ((a == 1 && j == last[1]) || (a == 2 && k == last[2])) continue;
      const std::int64_t offset = std::int64_t(a) * size + at, count = a == 0 ? n_ - 1 : n_;
      convectAndDiffuse(base + offset, scale, from.data() + offset, carrier, stride[a], stride, double(n_), viscosity,
                        count, next.data() + offset);
    }
    const double* const t = from.data() + kT * size + at;
    if (j < n_ && parameters_.richardson != 0.0) {
      double* const v = next.data() + kV * size + at;
      const double lift = 0.5 * scale * parameters_.richardson;
      for (std::int64_t i = 0; i < n_; ++i) v[i] += lift * (t[i] + t[i + stride[1]] - 1.0);
    }
    convectAndDiffuse(base + kT * size + at, scale, t, carrier, 0, stride, double(n_), viscosity / parameters_.prandtl,
                      n_, next.data() + kT * size + at);
  }
}

void hbStaggeredFlow::divergence(const std::vector<double>& state, std::vector<double>& out) const {
  const std::int64_t sy = strideY(), sz = strideZ(), size = fieldSize();
  hb::parallelFor(nz_, [&](std::int64_t layer) {
    for (std::int64_t j = 0; j < n_; ++j) {
      const std::int64_t at = (layer + 1) * sz + (j + 1) * sy + 1;
      const double *const u = state.data() + at, *const v = u + size, *const w = v + size;
      double* const row = out.data() + (layer * n_ + j) * n_;
      for (std::int64_t i = 0; i < n_; ++i)
        row[i] = double(n_) * ((u[i] - u[i - 1]) + (v[i] - v[i - sy]) + (w[i] - w[i - sz]));
    }
  });
}

void hbStaggeredFlow::project(std::vector<double>& state) {
  divergence(state, work_);
  poisson_.solve(work_);
  const std::int64_t sy = strideY(), sz = strideZ(), size = fieldSize();
  hb::parallelFor(nz_, [&](std::int64_t layer) {
    for (std::int64_t j = 0; j < n_; ++j) {
      const std::int64_t at = (layer + 1) * sz + (j + 1) * sy + 1;
      double *const u = state.data() + at, *const v = u + size, *const w = v + size;
      const double* const p = work_.data() + (layer * n_ + j) * n_;
      for (std::int64_t i = 0; i + 1 < n_; ++i) u[i] -= double(n_) * (p[i + 1] - p[i]);
      if (j + 1 < n_)
        for (std::int64_t i = 0; i < n_; ++i) v[i] -= double(n_) * (p[i + n_] - p[i]);
      if (layer + 1 < nz_)
        for (std::int64_t i = 0; i < n_; ++i) w[i] -= double(n_) * (p[i + n_ * n_] - p[i]);
    }
  });
  fillOutside(state);
}

void hbStaggeredFlow::step(double dt) {
  start_ = state_;
  for (const double share : {0.25, 1.0 / 3.0, 0.5, 1.0}) {
    hb::parallelFor(nz_, [&](std::int64_t layer) { addTendency(start_.data(), share * dt, state_, next_, layer + 1); });
    state_.swap(next_);
    project(state_);
  }
}

double hbStaggeredFlow::stableStep() const {
  const std::int64_t sy = strideY(), sz = strideZ(), size = fieldSize();
  std::vector<double> fastest(std::size_t(nz_), 1.0); // the lid's speed
  hb::parallelFor(nz_, [&](std::int64_t layer) {
    double& most = fastest[std::size_t(layer)];
    for (std::int64_t j = 1; j <= n_; ++j) {
      const double *const u = state_.data() + (layer + 1) * sz + j * sy + 1, *const v = u + size, *const w = v + size;
      for (std::int64_t i = 0; i < n_; ++i) most = largerOrNaN(most, std::abs(u[i]) + std::abs(v[i]) + std::abs(w[i]));
    }
  });
  return stableStep(parameters_, n_, std::accumulate(fastest.begin(), fastest.end(), 1.0, largerOrNaN));
}

double hbStaggeredFlow::stableStep(const Parameters& parameters, std::int64_t cells, double speed) {
  const double convection = speed * double(cells);
  const double diffusion = 12.0 * double(cells * cells) / (parameters.reynolds * std::min(1.0, parameters.prandtl));
  return 1.0 / std::hypot(diffusion / 2.45, convection / 2.6);
}

std::vector<double> hbStaggeredFlow::pressure() const {
  std::vector<double> tendency(state_.size(), 0.0), values(work_.size());
  const std::vector<double> zero(state_.size(), 0.0);
  hb::parallelFor(nz_, [&](std::int64_t layer) { addTendency(zero.data(), 1.0, state_, tendency, layer + 1); });
  divergence(tendency, values);
  poisson_.solve(values);
  const std::int64_t sy = strideY(), sz = strideZ();
  std::vector<double> p(std::size_t(fieldSize()), 0.0);
  for (std::int64_t k = 1; k <= nz_; ++k) {
    for (std::int64_t j = 1; j <= n_; ++j) {
      double* const row = p.data() + k * sz + j * sy;
      std::copy_n(values.data() + ((k - 1) * n_ + j - 1) * n_, n_, row + 1);
      row[0] = 2.0 * row[1] - row[2];
      row[n_ + 1] = 2.0 * row[n_] - row[n_ - 1];
    }
    double* const layer = p.data() + k * sz;
    for (std::int64_t i = 0; i < sy; ++i) {
      layer[i] = 2.0 * layer[sy + i] - layer[2 * sy + i];
      layer[(n_ + 1) * sy + i] = 2.0 * layer[n_ * sy + i] - layer[(n_ - 1) * sy + i];
    }
  }
  for (std::int64_t i = 0; i < sz; ++i) {
    p[std::size_t(i)] = 2.0 * p[std::size_t(sz + i)] - p[std::size_t(2 * sz + i)];
    p[std::size_t((nz_ + 1) * sz + i)] = p[std::size_t(nz_ * sz + i)]; // the plane of symmetry
  }
  return p;
}

double hbStaggeredFlow::largestChange(const std::vector<double>& before) const {
  assert(before.size() == state_.size());
  double most = 0.0;
  for (std::size_t i = 0; i < state_.size(); ++i) most = largerOrNaN(most, std::abs(state_[i] - before[i]));
  return most;
}

double hbStaggeredFlow::largestDivergence() const {
  std::vector<double> values(work_.size());
  divergence(state_, values);
  double most = 0.0;
  for (const double v : values) most = largerOrNaN(most, std::abs(v));
  return most;
}

double hbStaggeredFlow::wallGradient(std::int64_t inside, std::int64_t outside) const {
  const double* const t = field(kT);
  double sum = 0.0;
  for (std::int64_t k = 1; k <= nz_; ++k)
    for (std::int64_t i = 1; i <= n_; ++i)
      sum += t[k * strideZ() + outside * strideY() + i] - t[k * strideZ() + inside * strideY() + i];
  return sum * double(n_) / double(n_ * nz_);
}

double hbStaggeredFlow::nusseltLid() const { return wallGradient(n_, n_ + 1); }
double hbStaggeredFlow::nusseltBottom() const { return -wallGradient(1, 0); }

void hbStaggeredFlow::interpolate(const hbStaggeredFlow& other) {
  // Where value i of this grid lies between those of the other, along the axis of a velocity (faces) or another one.
  struct Place {
    std::int64_t lower;
    double share;
  };
  const auto places = [&](std::int64_t count, bool faces) {
    const double shift = faces ? 0.0 : 0.5, ratio = double(other.n_) / double(n_);
    std::vector<Place> list;
    for (std::int64_t i = 0; i <= count; ++i) {
      const double at = std::max((double(i) - shift) * ratio + shift, 0.0);
      list.push_back({std::int64_t(at), at - std::floor(at)});
    }
    return list;
  };
  for (int f = kU; f <= kT; ++f) {
    const auto xs = places(n_, f == kU), ys = places(n_, f == kV), zs = places(nz_, f == kW);
    const std::int64_t sy = other.strideY(), sz = other.strideZ();
    const auto last = [&](int axis) { return (axis == 2 ? nz_ : n_) - (f == axis ? 1 : 0); };
    hb::parallelFor(last(2), [&](std::int64_t layer) {
      const Place& z = zs[std::size_t(layer + 1)];
      for (std::int64_t j = 1; j <= last(1); ++j) {
        const Place& y = ys[std::size_t(j)];
        double* const row = state_.data() + f * fieldSize() + (layer + 1) * strideZ() + j * strideY();
        for (std::int64_t i = 1; i <= last(0); ++i) {
          const Place& x = xs[std::size_t(i)];
          const double* const q = other.field(Field(f)) + z.lower * sz + y.lower * sy + x.lower;
          const auto along = [&](const double* p) { return p[0] + x.share * (p[1] - p[0]); };
          const auto across = [&](const double* p) { return along(p) + y.share * (along(p + sy) - along(p)); };
          row[i] = across(q) + z.share * (across(q + sz) - across(q));
        }
      }
    });
  }
  project(state_);
}
