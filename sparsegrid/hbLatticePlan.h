#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sparsegrid/hbLatticeBlocks.h"
#include "sparsegrid/kernels/hbLatticeKernel.h"

/// What is evaluated: the value, or its slope along one of the parts' axes, in field values per unit of the cube (at
/// kinks the slope towards +, at the upper faces towards -).
enum class hbLatticeQuantity : std::uint8_t { value, slopeFast, slopeRow, slopePlane };

/// Where the samples of a lattice's planes lie, prepared once for all of them; see hbLatticeEvaluator. `Real`, float or
/// double, is the type of the values.
template <class Real>
struct hbLatticePlanOf {
  /// Cells [begin, end) of the 2^level ones of a level.
  struct Cells {
    std::int32_t begin = 0, end = 1;
  };
  /// The part of a block whose hats meet the lattice, and where its sum over the levels of the
  /// plane axis goes: [rows][count].
  struct Window {
    std::size_t block = 0;
    std::int64_t firstRow = 0, rows = 0;
    std::int64_t first = 0, count = 0; ///< Nodes along the fast axis.
    std::int64_t offset = 0;           ///< In the sums.
  };
  /// The samples along the fast axis as cells of one level and steps within them.
  struct Places {
    std::vector<std::int32_t> cell;
    std::vector<Real> step;
  };
  /// The coarse rows of one level of the row axis.
  struct CoarseLevel {
    std::int64_t firstRow = 0, rows = 0;
    std::vector<hbLatticeLineLevel> line;
    std::size_t level = 0; ///< Of the fast axis, at which the line ends.
  };

  /// Of samples at us along the fast axis and vs along the row axis: coordinates of the cube, increasing; clamped to it
  /// (NaN to 0). O((us + vs) levels).
  hbLatticePlanOf(const hbLatticeBlocks& blocks, std::span<const double> us, std::span<const double> vs,
                  hbLatticeQuantity quantity);

  hbLatticeQuantity quantity;
  std::size_t size = 0, rows = 0; ///< Samples of a row, rows of a plane.
  std::vector<Window> windows;
  std::int64_t sums = 0;               ///< Numbers in all windows.
  std::vector<Cells> fast;             ///< Of each level: the cells that hold samples.
  std::vector<Cells> row;              ///< The same of the row axis.
  std::vector<CoarseLevel> coarse;     ///< By level of the row axis.
  std::vector<Places> places;          ///< By level of the fast axis; those that coarse rows end at are filled.
  bool adjacent = false;               ///< The samples are adjacent nodes of the finest level of `fast`,
  std::int64_t firstNode = 0;          ///< from this one on (counted from its cells' begin).
  std::vector<std::int32_t> cell;      ///< Of each row: its cell between coarse rows,
  std::vector<Real> step;              ///< and the step within it.
  hbLatticeTableParts parts;           ///< The fine part.
  std::size_t slots = 0;               ///< Levels of the row axis in the fine part.
  std::vector<std::int32_t> node;      ///< [row][slot], in the part's window.
  std::vector<double> weight;          ///< [row][slot]
  std::vector<std::int32_t> tableCell; ///< Of each sample: its cell of the table's level,
  std::vector<Real> tableStep;         ///< and the step within it.

private:
  void addWindow(std::size_t block, std::int64_t firstRow, std::int64_t windowRows, std::int64_t first,
                 std::int64_t count);
  void addCoarse(const hbLatticeBlocks& blocks, int level);
  void addFine(const hbLatticeBlocks& blocks, int begin);
  void placeAlongFast(const std::vector<double>& at);
  void placeAlongRow(const std::vector<double>& at, double scale);
};
using hbLatticePlan = hbLatticePlanOf<float>;
using hbLatticePlan64 = hbLatticePlanOf<double>;

/// Memory that hbLatticeEvaluator::plane() uses again and again; one a thread.
template <class Real>
struct hbLatticeWorkspaceOf {
  std::vector<double> sums;
  std::vector<double> line, finer;
  std::vector<Real> rounded; ///< A line.
  std::vector<Real> coarse;  ///< Of all coarse rows.
  std::vector<Real> buffer;  ///< One row.
  std::vector<Real*> rows, finerRows;
  std::vector<hbLatticeTerm> terms;
};
using hbLatticeWorkspace = hbLatticeWorkspaceOf<float>;
using hbLatticeWorkspace64 = hbLatticeWorkspaceOf<double>;
