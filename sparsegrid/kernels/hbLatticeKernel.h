#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

/// An array of surpluses and the weight it has in a sum.
struct hbLatticeTerm {
  const float* surpluses = nullptr;
  double weight = 0.0;
};

/// One level of a line along the fast axis: its surpluses (none: 0), one in each cell of the next coarser level.
struct hbLatticeLineLevel {
  static constexpr std::int64_t kNone = -1;
  std::int64_t offset = kNone; ///< Of [rows][count] surpluses in the plane's sums.
  std::int64_t count = 0;
  std::int64_t cells = 0; ///< Cells of the next coarser level.
  std::int64_t shift = 0; ///< So many of the 2 cells + 1 nodes, at the beginning, are not needed any more.
};

/// The coarse rows of one level of the row axis: lines along the fast axis are dehierarchised, then sampled.
template <class Real>
struct hbLatticeLinesOf {
  std::span<const hbLatticeLineLevel> levels; ///< The first one has the ends (of a flat axis one value).
  const double* sums = nullptr;
  double *line = nullptr, *finer = nullptr; ///< Memory for a line's nodes.
  Real* rounded = nullptr;                  ///< The same.

  std::size_t size = 0;               ///< Samples of a row.
  std::int64_t firstNode = 0;         ///< The samples are the line's nodes from this one on, where there is no
  const std::int32_t* cell = nullptr; ///< cell in the line for each sample,
  const Real* step = nullptr;         ///< and the step towards the cell's end, in [0,1].
  std::int64_t cells = 0;             ///< Of the line.
  Real slope = 0;                     ///< Other than 0: the slope, this times the difference of the cell's ends.
};

/// How the fine part of a row is put together: for every level of the fast axis, its parts from the levels of the row
/// axis. Beside those the fast axis is at most so fine that the sum's values at both ends of all its cells fit one or
/// two vector registers: the *table*.
struct hbLatticeTableParts {
  static constexpr int kTableLevel = 4;
  static constexpr int kTableCells = 1 << kTableLevel;
  /// So many numbers past the end of the sums are read (and not used).
  static constexpr std::size_t kPastSums = 8;

  /// An array [nodes of row][count] in the plane's sums.
  struct Part {
    std::size_t slot = 0;    ///< Which of a row's nodes and weights.
    std::int64_t offset = 0; ///< Of the array.
  };
  struct Level {
    std::int64_t count = 0; ///< Nodes along the fast axis.
    std::size_t begin = 0, end = 0;
  };
  std::vector<Part> parts;
  std::vector<Level> levels; ///< From 0 to at most kTableLevel; empty: no fine part.
};

/// What the rows of one plane are made of: row j's sample i is a step between two coarse rows, and a step within a cell
/// of a table.
template <class Real>
struct hbLatticeRowsOf {
  std::size_t size = 0;  ///< Samples of a row.
  std::size_t count = 0; ///< Rows.

  const Real* const* coarse = nullptr;      ///< The nodal coarse rows.
  const std::int32_t* coarseCell = nullptr; ///< Of each row: the first of its two coarse rows,
  const Real* coarseStep = nullptr;         ///< and the step towards the second one, in [0,1].

  const hbLatticeTableParts* parts = nullptr;
  const double* sums = nullptr;
  std::size_t slots = 0;              ///< Nodes and weights a row.
  const std::int32_t* node = nullptr; ///< [row][slot]
  const double* weight = nullptr;     ///< [row][slot]

  const std::int32_t* cell = nullptr; ///< Of each sample: its cell in the table,
  const Real* step = nullptr;         ///< and the step towards the cell's end, in [0,1].

  Real coarseSlope = 0; ///< Other than 0: the slope along the row axis, this times the difference of coarse rows.
  Real tableSlope = 0;  ///< Other than 0: the slope along the fast axis, this times the differences in the table.
};

namespace hb {

/// sum[i] = the terms' weighted sum, added up in their order.
void weightedSum(std::span<const hbLatticeTerm> terms, std::int64_t count, double* sum);

/// out[i + stride j] = coarse row j's sample i.
template <class Real>
void coarseRows(const hbLatticeLinesOf<Real>& lines, std::int64_t rows, Real* out, std::size_t stride);

/// row[i] += the mean of a[i] and b[i].
template <class Real>
void addMean(const Real* a, const Real* b, std::size_t count, Real* row);

/// out[i + stride j] = row j's sample i. `buffer`, if there is one, takes a row, and `out` is then written past the
/// caches.
template <class Real>
void latticeRows(const hbLatticeRowsOf<Real>& rows, Real* buffer, Real* out, std::size_t stride);

} // namespace hb
