#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "volume/fields/hbBoxPoisson.h"

/// A lid-driven, heated cavity on one staggered grid, advanced in time: the discrete equations and nothing else.
///
/// In the unit cube, with lengths in edges, speeds in that of the lid, temperatures from 0 at the bottom to 1 at the
/// lid:
///
///     du/dt + div(u u) = -grad p + (1/Re) lap u + Ri (T - 1/2) e_y,    div u = 0,
///     dT/dt + div(u T) = 1/(Re Pr) lap T.
///
/// The lid is y = 1 and moves along +x with speed 1; the other walls stand still. Bottom (y = 0) and lid have fixed
/// temperatures, the other walls let no heat through. The problem is symmetric about z = 1/2, and so is its solution
/// from a symmetric start: only z <= 1/2 is computed, with a plane of symmetry for its sixth wall.
///
/// Second order in space: velocities at the centres of the cells' faces, T and p at their centres (Harlow and Welch,
/// Phys. Fluids 8, 1965), central differences in conservative form, walls by reflected values. In time: four stages
/// u_k = P(u_0 + a_k dt F(u_{k-1})), a = 1/4, 1/3, 1/2, 1 (second order; Jameson, Schmidt, Turkel, AIAA 81-1259), P the
/// projection onto fields without divergence, by hbBoxPoisson.
class hbStaggeredFlow {
public:
  struct Parameters {
    double reynolds = 1000.0; ///< Lid speed times edge over viscosity; positive and finite.
    double prandtl = 0.71;    ///< Viscosity over thermal diffusivity; positive and finite.
    double richardson = 0.0;  ///< Buoyancy over inertia; finite; positive: the warm lid lies stably on top.
  };

  enum Field : std::uint8_t { kU, kV, kW, kT };

  /// `cells` along x and y, half as many along z: even, at least 4; `parameters` in their ranges: neither is checked
  /// here (hbCavityFlow does). Starts at rest with T = y (pure conduction).
  /// Memory: 13 doubles for each of the (cells + 2)^2 (cells/2 + 2) places.
  hbStaggeredFlow(const Parameters& parameters, std::int64_t cells);

  std::int64_t cells() const { return n_; }
  double width() const { return 1.0 / double(n_); }

  /// All unknowns: u, v, w, T one after the other, each (cells+2) x (cells+2) x (cells/2+2) values, x fastest, with one
  /// layer of values outside the walls. Along its own axis a velocity's index 0 is the wall and i the upper face of
  /// cell i; along the others, and for T, index 0 is outside, and 1 the first cell.
  const std::vector<double>& state() const { return state_; }
  /// Takes a state of the same size that fulfils the walls' conditions and has no divergence.
  void setState(std::vector<double> state);
  std::int64_t strideY() const { return n_ + 2; }
  std::int64_t strideZ() const { return (n_ + 2) * (n_ + 2); }
  std::int64_t fieldSize() const { return strideZ() * (nz_ + 2); }
  const double* field(Field f) const { return state_.data() + f * fieldSize(); }

  /// Takes the linear interpolant of another grid's flow, made free of divergence.
  void interpolate(const hbStaggeredFlow& other);

  /// The largest stable time step: inside the ellipse with half-axes 2.45 (diffusion, 12/(h^2 Re) or with Re Pr)
  /// and 2.6 (convection, the largest |u|+|v|+|w| over h), which lies in the region of stability of four-stage schemes.
  /// Not finite, or 0, where a velocity is not finite.
  double stableStep() const;
  /// The same where `speed`, at least that of the lid (1), is the largest |u|+|v|+|w|.
  static double stableStep(const Parameters& parameters, std::int64_t cells, double speed);

  /// One time step: four projections. On all threads; the result does not depend on their number.
  void step(double dt);

  /// The pressure at this time, from its own Poisson equation: div grad p = div F. Laid out as T is; mean zero; the
  /// outer layer continues it linearly beyond the walls.
  std::vector<double> pressure() const;

  /// The largest difference between a value of `before`, as large as state(), and the one now; NaN where one is NaN.
  double largestChange(const std::vector<double>& before) const;

  /// The largest |div u| of a cell; NaN where one is NaN.
  double largestDivergence() const;

  /// Mean heat flux from the wall into the fluid, times Re Pr: the Nusselt number, with the scheme's own difference at
  /// the wall. Into the fluid at the lid, out of it at the bottom; equal in a steady state.
  double nusseltLid() const;
  double nusseltBottom() const;

private:
  /// next = base + scale F(from) in the cells of layer k.
  void addTendency(const double* base, double scale, const std::vector<double>& from, std::vector<double>& next,
                   std::int64_t k) const;
  void fillOutside(std::vector<double>& state) const;
  void divergence(const std::vector<double>& state, std::vector<double>& out) const;
  void project(std::vector<double>& state);
  double wallGradient(std::int64_t inside, std::int64_t outside) const;

  Parameters parameters_;
  std::int64_t n_, nz_;
  hbBoxPoisson poisson_;
  std::vector<double> state_, start_, next_;
  std::vector<double> work_; ///< Of project(): one value a cell.
};
