#include "volume/fields/hbCavityFlow.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "volume/fields/hbAndersonMixing.h"
#include "volume/hbError.h"
#include "volume/hbParallel.h"

namespace {

using Quantity = hbCavityFlow::Quantity;

constexpr std::array<std::pair<Quantity, std::string_view>, 6> kQuantities{{{Quantity::pressure, "pressure"},
                                                                            {Quantity::temperature, "temperature"},
                                                                            {Quantity::velocityX, "velocity-x"},
                                                                            {Quantity::velocityY, "velocity-y"},
                                                                            {Quantity::velocityZ, "velocity-z"},
                                                                            {Quantity::speed, "speed"}}};

constexpr std::int64_t kCoarsest = 16;    // cells an axis
constexpr std::int64_t kStepsBetween = 8; // between two mixings: few enough, and far enough apart to differ
constexpr std::size_t kDepth = 10;

// Six hours on 65^3 nodes: beyond, a wrong parameter is likelier than patience.
constexpr double kMostSteps = 1e6;

[[noreturn]] void throwGrown(double time) {
  throw hbError(fmt::format("cavity: the flow grew without bound at time {:.4g}; expected a smaller reynolds or "
                            "|richardson|, or a finer grid",
                            time));
}

/// The stable step at `time`; throws hbError where there is none any more. The bound keeps speeds finite in 32 bits
/// and, with kMostSteps, every step above the last digits of the time.
double stableStep(const hbStaggeredFlow& flow, const hbStaggeredFlow::Parameters& parameters, double time) {
  constexpr double kLeastShare = 1e-6; // of the step for the fluid at rest
  const double dt = flow.stableStep();
  if (!(dt > kLeastShare * hbStaggeredFlow::stableStep(parameters, flow.cells(), 1.0))) throwGrown(time);
  return dt;
}

/// The largest change since `before` per unit of time; throws hbError where it is not finite.
double changeRate(const hbStaggeredFlow& flow, const std::vector<double>& before, double duration, double time) {
  const double rate = flow.largestChange(before) / duration;
  if (!std::isfinite(rate)) throwGrown(time);
  return rate;
}

/// Advances by `dt`, and stops where the user wants it to.
void step(hbStaggeredFlow& flow, double dt, hbProgress& progress) {
  flow.step(dt);
  progress.advance(0);
}

/// What a relaxation came to.
struct Relaxation {
  double time = 0.0, residual = std::numeric_limits<double>::infinity();
  std::int64_t steps = 0;
};

Relaxation relax(hbStaggeredFlow& flow, const hbStaggeredFlow::Parameters& parameters, double tolerance,
                 std::int64_t maxSteps, hbProgress& progress) {
  const std::int64_t nodes = flow.cells() + 1;
  constexpr std::int64_t kPercent = 100;
  progress.begin(fmt::format("settling {}^3", nodes), kPercent, "percent");
  hbAndersonMixing mixing(flow.state().size(), kDepth);
  Relaxation done;
  double first = 0.0;
  std::int64_t shown = 0;
  for (std::vector<double> state = flow.state();; flow.setState(state)) {
    const double dt = stableStep(flow, parameters, done.time), duration = double(kStepsBetween) * dt;
    for (std::int64_t s = 0; s < kStepsBetween; ++s) step(flow, dt, progress);
    done.steps += kStepsBetween;
    done.time += duration;
    done.residual = changeRate(flow, state, duration, done.time);
    if (first == 0.0) first = std::max(done.residual, 2.0 * tolerance);
    if (done.residual <= tolerance || done.steps >= maxSteps) return done;
    // Residuals shrink by about the same factor each time: their logarithm tells how far the work is.
    const double share = std::log(first / done.residual) / std::log(first / tolerance);
    if (const auto percent = std::int64_t(share * double(kPercent)); percent > shown) {
      progress.advance(percent - shown);
      shown = percent;
    }
    mixing.next(state, flow.state());
  }
}

/// The numbers of cells of the grids, coarsest first: about halved as long as there are enough.
std::vector<std::int64_t> gridSequence(std::int64_t cells) {
  std::vector<std::int64_t> list{cells};
  while (list.front() / 2 >= kCoarsest) list.insert(list.begin(), (list.front() / 2 + 1) / 2 * 2);
  return list;
}

} // namespace

hbCavityFlow::hbCavityFlow(const Parameters& parameters, std::int64_t nodes)
    : parameters_(parameters), nodes_(nodes), flow_(parameters, (check(parameters, nodes), nodes - 1)),
      residual_(std::numeric_limits<double>::infinity()) {}

void hbCavityFlow::check(const Parameters& parameters, std::int64_t nodes) {
  for (const auto& [name, value] : {std::pair("reynolds", parameters.reynolds), {"prandtl", parameters.prandtl}})
    if (!(value > 0.0 && std::isfinite(value)))
      throw hbError(fmt::format("cavity: expected a positive, finite {}, found {}", name, value));
  if (!std::isfinite(parameters.richardson))
    throw hbError(fmt::format("cavity: expected a finite richardson, found {}", parameters.richardson));
  if (nodes < kFewest || nodes > kMost || nodes % 2 == 0)
    throw hbError(
        fmt::format("cavity: expected an odd number of nodes from {} to {}, found {}", kFewest, kMost, nodes));
}

void hbCavityFlow::checkTime(const Parameters& parameters, std::int64_t nodes, double time) {
  const double steps = std::ceil(time / hbStaggeredFlow::stableStep(parameters, nodes - 1, 1.0));
  if (!(steps <= kMostSteps))
    throw hbError(fmt::format("cavity: expected an end-time of at most {:.0f} time steps, found {:.4g}, which takes "
                              "about {:.0f} on {}^3 nodes",
                              kMostSteps, time, steps, nodes));
}

double hbCavityFlow::memory(std::int64_t nodes, bool toSteady) {
  return (toSteady ? 40.0 : 12.0) * double(sizeof(double)) * std::pow(double(nodes), 3.0);
}

void hbCavityFlow::advanceTo(double time, hbProgress& progress) {
  checkTime(parameters_, nodes_, time);
  constexpr double kParts = 1000.0;
  const double start = time_;
  progress.begin(fmt::format("simulating to time {:.3g}", time), std::int64_t(kParts), "parts");
  for (std::int64_t shown = 0; time_ < time;) {
    const double left = time - time_, count = std::ceil(left / stableStep(flow_, parameters_, time_)),
                 dt = left / count;
    const std::vector<double> before = flow_.state();
    step(flow_, dt, progress);
    ++steps_;
    time_ = count > 1.0 ? time_ + dt : time;
    residual_ = changeRate(flow_, before, dt, time_);
    const auto parts = std::int64_t(kParts * (time_ - start) / (time - start));
    progress.advance(parts - shown);
    shown = parts;
  }
}

bool hbCavityFlow::runToSteady(double tolerance, std::int64_t maxSteps, hbProgress& progress) {
  // A coarser grid's flow is only a start: it need not be closer to steady than grids differ.
  constexpr double kCoarse = 1e-3;
  const auto grids = gridSequence(nodes_ - 1);
  for (const std::int64_t cells : grids) {
    hbStaggeredFlow flow(parameters_, cells);
    if (cells != grids.front()) flow.interpolate(flow_);
    flow_ = std::move(flow);
    const bool last = cells == grids.back();
    const Relaxation done =
        relax(flow_, parameters_, last ? tolerance : std::max(tolerance, kCoarse), maxSteps, progress);
    time_ = done.time;
    steps_ = done.steps;
    residual_ = done.residual;
  }
  return residual_ <= tolerance;
}

hbGeometry hbCavityFlow::geometry() const {
  hbGeometry geometry;
  geometry.size = {nodes_, nodes_, nodes_};
  geometry.spacing = geometry.cubeSpacing();
  return geometry;
}

std::vector<float> hbCavityFlow::nodal(Quantity quantity) const {
  const std::int64_t sy = flow_.strideY(), sz = flow_.strideZ(), n = nodes_, middle = n / 2;
  const std::vector<double> pressure = quantity == Quantity::pressure ? flow_.pressure() : std::vector<double>();
  // At a node: the mean over the two values along each axis but a velocity's own, where one lies there.
  const auto mean = [&](const double* field, int own, std::int64_t at) {
    const std::int64_t dx = own == 0 ? 0 : 1, dy = own == 1 ? 0 : sy, dz = own == 2 ? 0 : sz;
    const double* const p = field + at;
    return 0.125 * (((p[0] + p[dx]) + (p[dy] + p[dx + dy])) + ((p[dz] + p[dx + dz]) + (p[dy + dz] + p[dx + dy + dz])));
  };
  std::vector<float> values(std::size_t(n * n * n));
  hb::parallelFor(middle + 1, [&](std::int64_t k) {
    // Symmetric about the middle plane, but for the velocity across it.
    const float mirror = quantity == Quantity::velocityZ ? -1.0F : 1.0F;
    for (std::int64_t j = 0; j < n; ++j)
      for (std::int64_t i = 0; i < n; ++i) {
        const std::int64_t at = k * sz + j * sy + i;
        const auto velocity = [&](int axis) { return mean(flow_.field(hbStaggeredFlow::Field(axis)), axis, at); };
        double value = 0.0;
        switch (quantity) {
        case Quantity::pressure:
          value = mean(pressure.data(), 3, at);
          break;
        case Quantity::temperature:
          value = mean(flow_.field(hbStaggeredFlow::kT), 3, at);
          break;
        case Quantity::velocityX:
          value = velocity(0);
          break;
        case Quantity::velocityY:
          value = velocity(1);
          break;
        case Quantity::velocityZ:
          value = velocity(2);
          break;
        case Quantity::speed:
          value = std::sqrt(velocity(0) * velocity(0) + velocity(1) * velocity(1) + velocity(2) * velocity(2));
          break;
        }
        values[std::size_t((k * n + j) * n + i)] = float(value);
        if (k < middle) values[std::size_t(((n - 1 - k) * n + j) * n + i)] = mirror * float(value);
      }
  });
  return values;
}

std::string_view hb::cavityQuantityName(Quantity quantity) { return kQuantities[std::size_t(quantity)].second; }

Quantity hb::cavityQuantityFromName(std::string_view name) {
  std::string names;
  for (const auto& [quantity, known] : kQuantities) {
    if (known == name) return quantity;
    names += fmt::format("{}{}", names.empty() ? "" : ", ", known);
  }
  throw hbError(fmt::format("field parameter quantity: expected one of {}, found '{}'", names, name));
}
