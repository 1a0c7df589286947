#include "sparsegrid/kernels/hbLatticeKernel.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sparsegrid/kernels/hbLatticeKernel.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hb::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

// No fused multiply-add, as in the other kernels: with it, values would depend on the instruction set.

using Wide = hn::ScalableTag<double>;
using Narrow = hn::Rebind<float, Wide>;

/// A vector of doubles from either type, and back.
HWY_INLINE hn::Vec<Wide> loadWide(const float* from) { return hn::PromoteTo(Wide(), hn::LoadU(Narrow(), from)); }
HWY_INLINE hn::Vec<Wide> loadWide(const double* from) { return hn::LoadU(Wide(), from); }
HWY_INLINE void storeWide(hn::Vec<Wide> v, float* to) { hn::StoreU(hn::DemoteTo(Narrow(), v), Narrow(), to); }
HWY_INLINE void storeWide(hn::Vec<Wide> v, double* to) { hn::StoreU(v, Wide(), to); }

#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
/// (Two instructions, where Highway 1.0 takes eight.)
HWY_INLINE void storeInTurns(hn::Vec<Wide> even, hn::Vec<Wide> odd, double* to) {
  const __m512i lower = _mm512_setr_epi64(0, 8, 1, 9, 2, 10, 3, 11),
                upper = _mm512_setr_epi64(4, 12, 5, 13, 6, 14, 7, 15);
  _mm512_storeu_pd(to, _mm512_permutex2var_pd(even.raw, lower, odd.raw));
  _mm512_storeu_pd(to + 8, _mm512_permutex2var_pd(even.raw, upper, odd.raw));
}
#else
HWY_INLINE void storeInTurns(hn::Vec<Wide> even, hn::Vec<Wide> odd, double* to) {
  hn::StoreInterleaved2(even, odd, Wide(), to);
}
#endif

/// The 2 cells + 1 nodal values of the next level: those of the coarser one, and between them surplus (none: 0) plus
/// mean.
HWY_INLINE void refine(const double* coarse, const double* surpluses, std::int64_t cells, double* fine) {
  const Wide d;
  const auto lanes = std::int64_t(hn::Lanes(d));
  const auto half = hn::Set(d, 0.5);
  std::int64_t k = 0;
  for (; k + lanes <= cells; k += lanes) {
    const auto left = hn::LoadU(d, coarse + k);
    const auto mean = hn::Mul(half, hn::Add(left, hn::LoadU(d, coarse + k + 1)));
    storeInTurns(left, surpluses ? hn::Add(hn::LoadU(d, surpluses + k), mean) : mean, fine + 2 * k);
  }
  for (; k < cells; ++k) {
    const double mean = 0.5 * (coarse[k] + coarse[k + 1]);
    fine[2 * k] = coarse[k];
    fine[2 * k + 1] = surpluses ? surpluses[k] + mean : mean;
  }
  fine[2 * cells] = coarse[cells];
}

// Interpolations are (1 - t) a + t b: exact at both ends, so that a node has one value whatever cell it is seen from.

/// The values at the ends of a few cells: all beginnings, then all ends.
template <class Real, int cells>
struct alignas(64) Table {
  Real at[2 * cells];
};
template <class Real>
using RowTable = Table<Real, hbLatticeTableParts::kTableCells>;

/// Longer lines are looked up in memory.
constexpr int kLineCells = 32;
template <class Real>
using LineTable = Table<Real, kLineCells>;

template <class Real>
HWY_INLINE hn::Vec<hn::ScalableTag<Real>> gather(const Real* values, const std::int32_t* index) {
  const hn::ScalableTag<Real> d;
  const auto narrow = hn::LoadU(hn::Rebind<std::int32_t, decltype(d)>(), index);
  if constexpr (sizeof(Real) == 4)
    return hn::GatherIndex(d, values, narrow);
  else
    return hn::GatherIndex(d, values, hn::PromoteTo(hn::RebindToSigned<decltype(d)>(), narrow));
}

/// Looks both ends of cells up.
template <class Real, int cells>
struct LookUp {
  using D = hn::ScalableTag<Real>;
  const Real* table;
  HWY_INLINE explicit LookUp(const Table<Real, cells>& from) : table(from.at) {}
  HWY_INLINE hn::Vec<D> begin(const std::int32_t* cell) const { return gather(table, cell); }
  HWY_INLINE hn::Vec<D> end(const std::int32_t* cell) const { return gather(table + cells, cell); }
};
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
// (Highway 1.0 has no look-up in two registers.)
template <>
struct LookUp<float, hbLatticeTableParts::kTableCells> {
  using V = hn::Vec<hn::ScalableTag<float>>;
  __m512 begins, ends;
  HWY_INLINE explicit LookUp(const RowTable<float>& from)
      : begins(_mm512_load_ps(from.at)), ends(_mm512_load_ps(from.at + 16)) {}
  HWY_INLINE V begin(const std::int32_t* cell) const {
    return V{_mm512_permutexvar_ps(_mm512_loadu_si512(cell), begins)};
  }
  HWY_INLINE V end(const std::int32_t* cell) const { return V{_mm512_permutexvar_ps(_mm512_loadu_si512(cell), ends)}; }
};
template <>
struct LookUp<float, kLineCells> {
  using V = hn::Vec<hn::ScalableTag<float>>;
  __m512 begins[2], ends[2];
  HWY_INLINE explicit LookUp(const LineTable<float>& from)
      : begins{_mm512_load_ps(from.at), _mm512_load_ps(from.at + 16)}, ends{_mm512_load_ps(from.at + 32),
                                                                            _mm512_load_ps(from.at + 48)} {}
  HWY_INLINE V begin(const std::int32_t* cell) const {
    return V{_mm512_permutex2var_ps(begins[0], _mm512_loadu_si512(cell), begins[1])};
  }
  HWY_INLINE V end(const std::int32_t* cell) const {
    return V{_mm512_permutex2var_ps(ends[0], _mm512_loadu_si512(cell), ends[1])};
  }
};
#elif HWY_TARGET == HWY_AVX2
template <>
struct LookUp<float, hbLatticeTableParts::kTableCells> {
  using V = hn::Vec<hn::ScalableTag<float>>;
  __m256 begins[2], ends[2];
  HWY_INLINE explicit LookUp(const RowTable<float>& from)
      : begins{_mm256_load_ps(from.at), _mm256_load_ps(from.at + 8)}, ends{_mm256_load_ps(from.at + 16),
                                                                           _mm256_load_ps(from.at + 24)} {}
  HWY_INLINE V begin(const std::int32_t* cell) const { return at(begins, cell); }
  HWY_INLINE V end(const std::int32_t* cell) const { return at(ends, cell); }
  static HWY_INLINE V at(const __m256* halves, const std::int32_t* cell) {
    const __m256i index = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(cell));
    const __m256 upper = _mm256_castsi256_ps(_mm256_slli_epi32(index, 28)); // bit 3 becomes the sign
    return V{_mm256_blendv_ps(_mm256_permutevar8x32_ps(halves[0], index), _mm256_permutevar8x32_ps(halves[1], index),
                              upper)};
  }
};
#endif

/// What the hierarchical values of a line (the two ends, then level by level) give at both ends of the table's cells.
template <class Real>
struct alignas(64) TableWeights {
  static constexpr int kNodes = hbLatticeTableParts::kTableCells + 1, kEntries = 2 * hbLatticeTableParts::kTableCells;
  Real at[kNodes][kEntries];

  constexpr TableWeights() : at{} {
    for (int entry = 0; entry < kEntries; ++entry) {
      const int node = entry < kEntries / 2 ? entry : entry - kEntries / 2 + 1;
      at[0][entry] = Real(kEntries / 2 - node) / Real(kEntries / 2);
      at[1][entry] = Real(node) / Real(kEntries / 2);
      for (int level = 1, value = 2; level <= hbLatticeTableParts::kTableLevel; ++level)
        for (int k = 0; k < 1 << (level - 1); ++k, ++value) {
          const int width = kEntries / 2 >> level, distance = node - (2 * k + 1) * width;
          const int inside = width - (distance < 0 ? -distance : distance);
          at[value][entry] = inside > 0 ? Real(inside) / Real(width) : Real(0);
        }
    }
  }
};
template <class Real>
constexpr TableWeights<Real> kTableWeights;

template <class Real>
HWY_INLINE void fillTable(const hbLatticeRowsOf<Real>& rows, std::size_t row, RowTable<Real>& table) {
  constexpr std::size_t kPast = 8; // a vector of doubles at the most
  static_assert(kPast <= hbLatticeTableParts::kPastSums && hn::MaxLanes(Wide()) <= kPast);
  const Wide wide;
  const auto lanes = std::int64_t(hn::Lanes(wide));
  const hbLatticeTableParts& parts = *rows.parts;
  const std::int32_t* node = rows.node + row * rows.slots;
  const double* weight = rows.weight + row * rows.slots;
  Real values[hbLatticeTableParts::kTableCells + 1 + kPast];
  std::int64_t count = 0;
  for (const hbLatticeTableParts::Level& level : parts.levels) {
    // Whole vectors: what lies past a short array is read, and its sum overwritten by the next level's.
    for (std::int64_t i = 0; i < level.count; i += lanes) {
      auto total = hn::Zero(wide);
      for (std::size_t p = level.begin; p < level.end; ++p) {
        const hbLatticeTableParts::Part& part = parts.parts[p];
        const double* from = rows.sums + part.offset + node[part.slot] * level.count + i;
        total = hn::Add(total, hn::Mul(hn::Set(wide, weight[part.slot]), hn::LoadU(wide, from)));
      }
      storeWide(total, values + count + i);
    }
    count += level.count;
  }
  if (count == 1) values[count++] = values[0]; // a flat axis

  const hn::CappedTag<Real, 2 * hbLatticeTableParts::kTableCells> d;
  for (std::size_t i = 0; i < 2 * hbLatticeTableParts::kTableCells; i += hn::Lanes(d)) {
    auto total = hn::Mul(hn::Set(d, values[0]), hn::Load(d, kTableWeights<Real>.at[0] + i));
    for (std::int64_t v = 1; v < count; ++v)
      total = hn::Add(total, hn::Mul(hn::Set(d, values[v]), hn::Load(d, kTableWeights<Real>.at[v] + i)));
    hn::Store(total, d, table.at + i);
  }
  if (rows.tableSlope == Real(0)) return;
  for (int c = 0; c < hbLatticeTableParts::kTableCells; ++c) {
    Real &begin = table.at[c], &end = table.at[c + hbLatticeTableParts::kTableCells];
    begin = end = rows.tableSlope * (end - begin);
  }
}

/// The step between two coarse rows: their weighted sum.
template <class Real>
struct CoarseRow {
  const Real *a, *b;
  Real weightA, weightB;

  HWY_INLINE hn::Vec<hn::ScalableTag<Real>> at(std::size_t i) const {
    const hn::ScalableTag<Real> d;
    return hn::Add(hn::Mul(hn::Set(d, weightA), hn::LoadU(d, a + i)),
                   hn::Mul(hn::Set(d, weightB), hn::LoadU(d, b + i)));
  }
  HWY_INLINE Real one(std::size_t i) const { return weightA * a[i] + weightB * b[i]; }
};

template <class Real>
HWY_INLINE void coarseRow(const CoarseRow<Real>& coarse, std::size_t size, Real* out) {
  const std::size_t lanes = hn::Lanes(hn::ScalableTag<Real>());
  std::size_t i = 0;
  for (; i + lanes <= size; i += lanes) hn::StoreU(coarse.at(i), hn::ScalableTag<Real>(), out + i);
  for (; i < size; ++i) out[i] = coarse.one(i);
}

/// The step within a cell.
template <class Look, class Real>
HWY_INLINE hn::Vec<hn::ScalableTag<Real>> withinCell(const Look& look, const std::int32_t* cell, const Real* step) {
  const hn::ScalableTag<Real> d;
  const auto t = hn::LoadU(d, step);
  return hn::Add(hn::Mul(hn::Sub(hn::Set(d, Real(1)), t), look.begin(cell)), hn::Mul(t, look.end(cell)));
}

template <class Real>
HWY_INLINE void wholeRow(const CoarseRow<Real>& coarse, const RowTable<Real>& table, const hbLatticeRowsOf<Real>& rows,
                         Real* out) {
  const hn::ScalableTag<Real> d;
  const std::size_t lanes = hn::Lanes(d), size = rows.size;
  const LookUp<Real, hbLatticeTableParts::kTableCells> look(table);
  const std::int32_t* cell = rows.cell;
  const Real* step = rows.step;
  std::size_t i = 0;
  for (; i + lanes <= size; i += lanes)
    hn::StoreU(hn::Add(coarse.at(i), withinCell(look, cell + i, step + i)), d, out + i);
  for (; i < size; ++i) {
    const Real* const at = table.at + cell[i];
    out[i] = coarse.one(i) + ((Real(1) - step[i]) * at[0] + step[i] * at[hbLatticeTableParts::kTableCells]);
  }
}

/// Whole vectors past the caches, what is left at both ends through them.
template <class Real>
HWY_INLINE void streamRow(const Real* row, std::size_t size, Real* out) {
  const hn::ScalableTag<Real> d;
  const std::size_t lanes = hn::Lanes(d);
  const std::size_t misaligned = reinterpret_cast<std::uintptr_t>(out) / sizeof(Real) % lanes;
  std::size_t i = 0;
  for (const std::size_t head = std::min(size, (lanes - misaligned) % lanes); i < head; ++i) out[i] = row[i];
  for (; i + lanes <= size; i += lanes) hn::Stream(hn::LoadU(d, row + i), d, out + i);
  for (; i < size; ++i) out[i] = row[i];
}

template <class Real>
HWY_INLINE void allRows(const hbLatticeRowsOf<Real>& rows, Real* buffer, Real* out, std::size_t stride) {
  RowTable<Real> table;
  for (std::size_t j = 0; j < rows.count; ++j) {
    const std::int32_t cell = rows.coarseCell[j];
    const bool slope = rows.coarseSlope != Real(0);
    const CoarseRow<Real> coarse{rows.coarse[cell], rows.coarse[cell + 1],
                                 slope ? -rows.coarseSlope : Real(1) - rows.coarseStep[j],
                                 slope ? rows.coarseSlope : rows.coarseStep[j]};
    Real* to = buffer ? buffer : out + j * stride;
    if (rows.parts->levels.empty()) {
      coarseRow(coarse, rows.size, to);
    } else {
      fillTable(rows, j, table);
      wholeRow(coarse, table, rows, to);
    }
    if (buffer) streamRow(buffer, rows.size, out + j * stride);
  }
  if (buffer) hwy::FlushStream();
}

template <class Look, class Real>
HWY_INLINE void sampleCells(const Look& look, const Real* line, const std::int32_t* cell, const Real* step,
                            std::size_t count, Real slope, Real* out) {
  const hn::ScalableTag<Real> d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes)
    hn::StoreU(slope != Real(0) ? hn::Mul(hn::Set(d, slope), hn::Sub(look.end(cell + i), look.begin(cell + i)))
                                : withinCell(look, cell + i, step + i),
               d, out + i);
  for (; i < count; ++i) {
    const Real a = line[cell[i]], b = line[cell[i] + 1];
    out[i] = slope != Real(0) ? slope * (b - a) : (Real(1) - step[i]) * a + step[i] * b;
  }
}

/// A line as it lies in memory.
template <class Real>
struct InMemory {
  const Real* line;
  HWY_INLINE explicit InMemory(const Real* from) : line(from) {}
  HWY_INLINE hn::Vec<hn::ScalableTag<Real>> begin(const std::int32_t* cell) const { return gather(line, cell); }
  HWY_INLINE hn::Vec<hn::ScalableTag<Real>> end(const std::int32_t* cell) const { return gather(line + 1, cell); }
};

template <class Real>
HWY_INLINE void round(const double* line, std::size_t count, Real* out) {
  const std::size_t lanes = hn::Lanes(Wide());
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) storeWide(loadWide(line + i), out + i);
  for (; i < count; ++i) out[i] = Real(line[i]);
}

template <class Real>
HWY_INLINE void sample(const hbLatticeLinesOf<Real>& lines, const double* line, Real* out) {
  if (!lines.cell) return round(line + lines.firstNode, lines.size, out);
  Real* const nodes = lines.rounded;
  round(line, std::size_t(lines.cells) + 1, nodes);
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  if (sizeof(Real) == 4 && lines.cells <= kLineCells) {
    LineTable<Real> table;
    round(line, std::size_t(lines.cells), table.at);
    round(line + 1, std::size_t(lines.cells), table.at + kLineCells);
    return sampleCells(LookUp<Real, kLineCells>(table), nodes, lines.cell, lines.step, lines.size, lines.slope, out);
  }
#endif
  sampleCells(InMemory<Real>(nodes), nodes, lines.cell, lines.step, lines.size, lines.slope, out);
}

template <class Real>
HWY_INLINE void allCoarseRows(const hbLatticeLinesOf<Real>& lines, std::int64_t rows, Real* out, std::size_t stride) {
  for (std::int64_t row = 0; row < rows; ++row) {
    const auto surpluses = [&](const hbLatticeLineLevel& level)
                               HWY_ATTR { return lines.sums + level.offset + row * level.count; };
    double *memory = lines.line, *finer = lines.finer;
    const double* line = surpluses(lines.levels[0]);
    if (lines.levels[0].count == 1) { // a flat axis
      memory[0] = memory[1] = line[0];
      line = memory;
    }
    for (std::size_t l = 1; l < lines.levels.size(); ++l) {
      const hbLatticeLineLevel& level = lines.levels[l];
      refine(line, level.offset == hbLatticeLineLevel::kNone ? nullptr : surpluses(level), level.cells, finer);
      line = finer + level.shift;
      std::swap(memory, finer);
    }
    sample(lines, line, out + std::size_t(row) * stride);
  }
}

template <class Real>
HWY_INLINE void mean(const Real* a, const Real* b, std::size_t count, Real* row) {
  const hn::ScalableTag<Real> d;
  const std::size_t lanes = hn::Lanes(d);
  const auto half = hn::Set(d, Real(0.5));
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes)
    hn::StoreU(hn::Add(hn::LoadU(d, row + i), hn::Mul(half, hn::Add(hn::LoadU(d, a + i), hn::LoadU(d, b + i)))), d,
               row + i);
  for (; i < count; ++i) row[i] += Real(0.5) * (a[i] + b[i]);
}

} // namespace

HWY_ATTR void sumOfTerms(const hbLatticeTerm* terms, std::size_t termCount, std::int64_t count, double* sum) {
  const Wide d;
  const auto lanes = std::int64_t(hn::Lanes(d));
  std::int64_t i = 0;
  for (; i + 2 * lanes <= count; i += 2 * lanes) {
    auto lower = hn::Zero(d), upper = hn::Zero(d);
    for (std::size_t t = 0; t < termCount; ++t) {
      const auto w = hn::Set(d, terms[t].weight);
      lower = hn::Add(lower, hn::Mul(w, loadWide(terms[t].surpluses + i)));
      upper = hn::Add(upper, hn::Mul(w, loadWide(terms[t].surpluses + i + lanes)));
    }
    hn::StoreU(lower, d, sum + i);
    hn::StoreU(upper, d, sum + i + lanes);
  }
  for (; i < count; ++i) {
    double one = 0.0;
    for (std::size_t t = 0; t < termCount; ++t) one += terms[t].weight * double(terms[t].surpluses[i]);
    sum[i] = one;
  }
}

HWY_ATTR void coarse32(const hbLatticeLinesOf<float>& lines, std::int64_t rows, float* out, std::size_t stride) {
  allCoarseRows(lines, rows, out, stride);
}
HWY_ATTR void coarse64(const hbLatticeLinesOf<double>& lines, std::int64_t rows, double* out, std::size_t stride) {
  allCoarseRows(lines, rows, out, stride);
}
HWY_ATTR void mean32(const float* a, const float* b, std::size_t count, float* row) { mean(a, b, count, row); }
HWY_ATTR void mean64(const double* a, const double* b, std::size_t count, double* row) { mean(a, b, count, row); }
HWY_ATTR void rows32(const hbLatticeRowsOf<float>& rows, float* buffer, float* out, std::size_t stride) {
  allRows(rows, buffer, out, stride);
}
HWY_ATTR void rows64(const hbLatticeRowsOf<double>& rows, double* buffer, double* out, std::size_t stride) {
  allRows(rows, buffer, out, stride);
}

} // namespace hb::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hb {
namespace {
HWY_EXPORT(sumOfTerms);
HWY_EXPORT(coarse32);
HWY_EXPORT(coarse64);
HWY_EXPORT(mean32);
HWY_EXPORT(mean64);
HWY_EXPORT(rows32);
HWY_EXPORT(rows64);
} // namespace

void weightedSum(std::span<const hbLatticeTerm> terms, std::int64_t count, double* sum) {
  HWY_DYNAMIC_DISPATCH(sumOfTerms)(terms.data(), terms.size(), count, sum);
}
template <>
void coarseRows(const hbLatticeLinesOf<float>& lines, std::int64_t rows, float* out, std::size_t stride) {
  HWY_DYNAMIC_DISPATCH(coarse32)(lines, rows, out, stride);
}
template <>
void coarseRows(const hbLatticeLinesOf<double>& lines, std::int64_t rows, double* out, std::size_t stride) {
  HWY_DYNAMIC_DISPATCH(coarse64)(lines, rows, out, stride);
}
template <>
void addMean(const float* a, const float* b, std::size_t count, float* row) {
  HWY_DYNAMIC_DISPATCH(mean32)(a, b, count, row);
}
template <>
void addMean(const double* a, const double* b, std::size_t count, double* row) {
  HWY_DYNAMIC_DISPATCH(mean64)(a, b, count, row);
}
template <>
void latticeRows(const hbLatticeRowsOf<float>& rows, float* buffer, float* out, std::size_t stride) {
  HWY_DYNAMIC_DISPATCH(rows32)(rows, buffer, out, stride);
}
template <>
void latticeRows(const hbLatticeRowsOf<double>& rows, double* buffer, double* out, std::size_t stride) {
  HWY_DYNAMIC_DISPATCH(rows64)(rows, buffer, out, stride);
}
} // namespace hb
#endif
