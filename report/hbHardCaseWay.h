#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "glcombine/hbGlFormat.h"

/// A way to evaluate a sparse grid that hard cases are put to.
struct hbHardCaseWay {
  enum class Engine : std::uint8_t {
    stored, ///< None but storing: the grid in 64 bits with surpluses of 32, against one with surpluses of 64.
    direct,
    seminodal,
    combination,
    lattice,
    blend,        ///< OpenGL, component grids blended.
    fused,        ///< OpenGL, component grids in one shader.
    oglSeminodal, ///< OpenGL, the lines of the semi-nodal grid.
  };
  Engine engine = Engine::direct;
  hbGlFormat format = hbGlFormat::r32f; ///< `blend`: of textures and targets.

  bool isOpenGl() const { return engine >= Engine::blend; }
  /// As `--engine` has it, with the form in the case of OpenGL: "opengl-blend", "opengl-fused", "opengl".
  std::string name() const;
  /// "r32f", ...; "" where there is no choice.
  std::string formatName() const;
  /// Both, as one word.
  std::string label() const;

  static std::vector<hbHardCaseWay> all();

  bool operator==(const hbHardCaseWay&) const = default;
};
