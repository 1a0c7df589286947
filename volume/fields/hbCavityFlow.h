#pragma once

#include <string_view>
#include <vector>

#include "volume/fields/hbStaggeredFlow.h"
#include "volume/hbGeometry.h"
#include "volume/hbProgress.h"

/// The flow in a heated cube under a moving lid, as volumes of samples: a simulated test volume.
///
/// Equations, walls and scheme are those of hbStaggeredFlow; doc/fields.md has them with measured errors. At time 0 the
/// fluid is at rest, T = y, and the lid starts at full speed. All results are the same whatever the number of threads.
class hbCavityFlow {
public:
  using Parameters = hbStaggeredFlow::Parameters;

  enum class Quantity : std::uint8_t { pressure, temperature, velocityX, velocityY, velocityZ, speed };

  /// Numbers of nodes an axis there may be: odd, from kFewest to kMost.
  static constexpr std::int64_t kFewest = 9, kMost = 257;

  /// Throws hbError unless reynolds and prandtl are positive and finite, richardson is finite, and `nodes`, along each
  /// axis, is odd and from kFewest to kMost.
  static void check(const Parameters& parameters, std::int64_t nodes);
  /// Throws hbError where the time steps to `time`, as long as they are for the fluid at rest, are more than a million,
  /// or `time` is not finite.
  static void checkTime(const Parameters& parameters, std::int64_t nodes, double time);

  /// Throws what check() throws.
  hbCavityFlow(const Parameters& parameters, std::int64_t nodes);

  /// Bytes that a flow, and one volume of it, take: about 40 nodes^3 doubles for runToSteady(), 12 for advanceTo().
  static double memory(std::int64_t nodes, bool toSteady);

  /// Advances to exactly `time`, at least time(), in equal steps as long as is stable.
  /// Throws what checkTime() throws, and hbError where the flow grows without bound: it is of no use then.
  void advanceTo(double time, hbProgress& progress = hbProgress::none());

  /// Replaces the flow by the steady one: it is found on grids of a quarter, half and all of the cells (as far as they
  /// have 16 an axis), each started from the one before, by time steps with hbAndersonMixing between them.
  ///
  /// Steady means: over the last eight time steps, no velocity and temperature changed by more than `tolerance` per
  /// unit of time. Gives up after about `maxSteps` steps on one grid. Returns whether the flow is steady. Throws
  /// hbError where the flow grows without bound. Then, and where it is cancelled, the flow is on some grid: of no use
  /// but to start this again. `tolerance` and `maxSteps` are positive.
  bool runToSteady(double tolerance, std::int64_t maxSteps, hbProgress& progress = hbProgress::none());

  /// Simulated so far, in lid passages (edge over lid speed). After runToSteady(): the steps' total on the finest grid,
  /// which says what it cost and is no moment of a history.
  double time() const { return time_; }
  /// Time steps on the finest grid.
  std::int64_t steps() const { return steps_; }
  /// The largest change of a velocity or temperature per unit of time, over the last steps; infinite before the first.
  double residual() const { return residual_; }

  const hbStaggeredFlow& grid() const { return flow_; }

  /// The unit cube with `nodes` samples an axis.
  hbGeometry geometry() const;

  /// A quantity at the nodes, x fastest, walls included, at second order: means of the values around a node. Velocities
  /// and temperatures of walls are exact; the lid's edges stand still and are warm. Pressure has mean zero over the
  /// cells, is measured against the hydrostatic one of T = 1/2, and continued linearly to the walls.
  std::vector<float> nodal(Quantity quantity) const;

private:
  Parameters parameters_;
  std::int64_t nodes_;
  hbStaggeredFlow flow_;
  double time_ = 0.0, residual_;
  std::int64_t steps_ = 0;
};

namespace hb {

/// "pressure", "temperature", "velocity-x", "velocity-y", "velocity-z" or "speed".
std::string_view cavityQuantityName(hbCavityFlow::Quantity quantity);
/// The other way; throws hbError that lists the names.
hbCavityFlow::Quantity cavityQuantityFromName(std::string_view name);

} // namespace hb
