#pragma once

#include <cstdint>
#include <string_view>

/// The ways to evaluate a field at any point.
enum class hbEngine : std::uint8_t {
  automatic, ///< The best one for the input: full for volumes and analytic fields, seminodal for sparse grids.
  full,      ///< Trilinear interpolation of a plain volume (an analytic field: its formula; a sparse grid: extracted).
  direct,    ///< A sparse grid's basis functions, subspace by subspace.
  seminodal, ///< A sparse grid's lines along x, nodal there and hierarchical across: the fast one.
  combination, ///< A sparse grid's component grids, each trilinear.
  lattice,     ///< A sparse grid on whole slices: pictures by hbShearWarp. At single points as `direct`.
  opengl,      ///< A sparse grid by OpenGL: pictures by hbOglRaycaster. At single points as `direct`.
};

namespace hb {

std::string_view engineName(hbEngine engine);

/// The engine of that name ("auto" for automatic); throws hbError for another one.
hbEngine engineFromName(std::string_view name);

} // namespace hb
