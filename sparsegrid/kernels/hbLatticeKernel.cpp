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

HWY_INLINE void refine(const double* coarse, const double* surpluses, std::int64_t cells, double* fine) {
  const Wide d;
  const auto lanes = std::int64_t(hn::Lanes(d));
  const auto half = hn::Set(d, 0.5);
  std::int64_t k = 0;
  for (; k + lanes <= cells; k += lanes) {
    const auto left = hn::LoadU(d, coarse + k);
    const auto mean = hn::Mul(half, hn::Add(left, hn::LoadU(d, coarse + k + 1)));
    hn::StoreInterleaved2(left, surpluses ? hn::Add(hn::LoadU(d, surpluses + k), mean) : mean, d, fine + 2 * k);
  }
  for (; k < cells; ++k) {
    const double mean = 0.5 * (coarse[k] + coarse[k + 1]);
    fine[2 * k] = coarse[k];
    fine[2 * k + 1] = surpluses ? surpluses[k] + mean : mean;
  }
  fine[2 * cells] = coarse[cells];
}

/// sum += weight * values, or = where `first`.
HWY_INLINE void accumulate(const double* values, std::int64_t count, double weight, bool first, double* sum) {
  const Wide d;
  const auto lanes = std::int64_t(hn::Lanes(d));
  const auto w = hn::Set(d, weight);
  std::int64_t i = 0;
  if (first) {
    for (; i + lanes <= count; i += lanes) hn::StoreU(hn::Mul(w, hn::LoadU(d, values + i)), d, sum + i);
    for (; i < count; ++i) sum[i] = weight * values[i];
  } else {
    for (; i + lanes <= count; i += lanes)
      hn::StoreU(hn::Add(hn::LoadU(d, sum + i), hn::Mul(w, hn::LoadU(d, values + i))), d, sum + i);
    for (; i < count; ++i) sum[i] += weight * values[i];
  }
}

// Interpolations are (1 - t) a + t b: exact at both ends, so that a node has one value whatever cell it is seen from.

/// For every cell of the table the values at its ends.
template <class Real>
struct alignas(64) Table {
  Real begin[hbLatticeParts::kTableCells];
  Real end[hbLatticeParts::kTableCells];
};

template <class Real>
HWY_INLINE void fillTable(const hbLatticeRowsOf<Real>& rows, std::size_t row, Table<Real>& table) {
  const hbLatticeParts& parts = *rows.parts;
  const std::int32_t* node = rows.node + row * rows.slots;
  const double* weight = rows.weight + row * rows.slots;
  alignas(64) double lines[2][hbLatticeParts::kTableCells + 1];
  alignas(64) double surpluses[hbLatticeParts::kTableCells];
  double *line = lines[0], *finer = lines[1];
  for (std::size_t l = 0; l < parts.levels.size(); ++l) {
    const hbLatticeParts::Level& level = parts.levels[l];
    double* sum = l == 0 ? line : surpluses;
    bool first = true;
    for (std::size_t p = level.begin; p < level.end; ++p) {
      const hbLatticeParts::Part& part = parts.parts[p];
      if (weight[part.slot] == 0.0) continue;
      accumulate(rows.sums + part.offset + node[part.slot] * level.count, level.count, weight[part.slot], first, sum);
      first = false;
    }
    if (first) std::fill_n(sum, level.count, 0.0);
    if (l == 0) {
      if (level.count == 1) line[1] = line[0]; // a flat axis
      continue;
    }
    refine(line, surpluses, level.count, finer);
    std::swap(line, finer);
  }
  const int cells = 1 << (parts.levels.size() - 1);
  for (int c = 0; c < cells; ++c) {
    const double slope = rows.tableSlope * (line[c + 1] - line[c]);
    table.begin[c] = Real(rows.tableSlope != 0.0 ? slope : line[c]);
    table.end[c] = Real(rows.tableSlope != 0.0 ? slope : line[c + 1]);
  }
}

#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
/// The table in registers. (Highway 1.0 has no look-up in two of them.)
struct FloatTable {
  __m512 lower, upper;
  HWY_INLINE explicit FloatTable(const float* table)
      : lower(_mm512_load_ps(table)), upper(_mm512_load_ps(table + 16)) {}
  HWY_INLINE hn::Vec<hn::ScalableTag<float>> at(const std::int32_t* cells) const {
    return hn::Vec<hn::ScalableTag<float>>{_mm512_permutex2var_ps(lower, _mm512_loadu_si512(cells), upper)};
  }
};
#else
struct FloatTable {
  const float* table;
  HWY_INLINE explicit FloatTable(const float* from) : table(from) {}
  HWY_INLINE hn::Vec<hn::ScalableTag<float>> at(const std::int32_t* cells) const {
    const hn::ScalableTag<float> d;
    return hn::GatherIndex(d, table, hn::LoadU(hn::RebindToSigned<decltype(d)>(), cells));
  }
};
#endif
struct DoubleTable {
  const double* table;
  HWY_INLINE explicit DoubleTable(const double* from) : table(from) {}
  HWY_INLINE hn::Vec<Wide> at(const std::int32_t* cells) const {
    return hn::GatherIndex(
        Wide(), table, hn::PromoteTo(hn::RebindToSigned<Wide>(), hn::LoadU(hn::Rebind<std::int32_t, Wide>(), cells)));
  }
};
HWY_INLINE FloatTable lookUp(const float* table) { return FloatTable(table); }
HWY_INLINE DoubleTable lookUp(const double* table) { return DoubleTable(table); }

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

template <class Real>
HWY_INLINE void wholeRow(const CoarseRow<Real>& coarse, const Table<Real>& table, const hbLatticeRowsOf<Real>& rows,
                         Real* out) {
  const hn::ScalableTag<Real> d;
  const std::size_t lanes = hn::Lanes(d);
  const auto begin = lookUp(table.begin), end = lookUp(table.end);
  const auto one = hn::Set(d, Real(1));
  std::size_t i = 0;
  for (; i + lanes <= rows.size; i += lanes) {
    const auto step = hn::LoadU(d, rows.step + i);
    const auto fine =
        hn::Add(hn::Mul(hn::Sub(one, step), begin.at(rows.cell + i)), hn::Mul(step, end.at(rows.cell + i)));
    hn::StoreU(hn::Add(coarse.at(i), fine), d, out + i);
  }
  for (; i < rows.size; ++i) {
    const std::int32_t cell = rows.cell[i];
    out[i] = coarse.one(i) + ((Real(1) - rows.step[i]) * table.begin[cell] + rows.step[i] * table.end[cell]);
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
  Table<Real> table;
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

template <class Real>
HWY_INLINE void sample(const double* line, const std::int32_t* cell, const double* step, std::size_t count,
                       double slope, Real* out) {
  const Wide d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto a = DoubleTable(line).at(cell + i), b = DoubleTable(line + 1).at(cell + i);
    const auto t = hn::LoadU(d, step + i);
    storeWide(slope != 0.0 ? hn::Mul(hn::Set(d, slope), hn::Sub(b, a))
                           : hn::Add(hn::Mul(hn::Sub(hn::Set(d, 1.0), t), a), hn::Mul(t, b)),
              out + i);
  }
  for (; i < count; ++i) {
    const double a = line[cell[i]], b = line[cell[i] + 1];
    out[i] = Real(slope != 0.0 ? slope * (b - a) : (1.0 - step[i]) * a + step[i] * b);
  }
}

template <class Real>
HWY_INLINE void round(const double* line, std::size_t count, Real* out) {
  const std::size_t lanes = hn::Lanes(Wide());
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) storeWide(loadWide(line + i), out + i);
  for (; i < count; ++i) out[i] = Real(line[i]);
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

HWY_ATTR void refineOne(const double* coarse, const double* surpluses, std::int64_t cells, double* fine) {
  refine(coarse, surpluses, cells, fine);
}
HWY_ATTR void sample32(const double* line, const std::int32_t* cell, const double* step, std::size_t count,
                       double slope, float* out) {
  sample(line, cell, step, count, slope, out);
}
HWY_ATTR void sample64(const double* line, const std::int32_t* cell, const double* step, std::size_t count,
                       double slope, double* out) {
  sample(line, cell, step, count, slope, out);
}
HWY_ATTR void round32(const double* line, std::size_t count, float* out) { round(line, count, out); }
HWY_ATTR void round64(const double* line, std::size_t count, double* out) { round(line, count, out); }
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
HWY_EXPORT(refineOne);
HWY_EXPORT(sample32);
HWY_EXPORT(sample64);
HWY_EXPORT(round32);
HWY_EXPORT(round64);
HWY_EXPORT(mean32);
HWY_EXPORT(mean64);
HWY_EXPORT(rows32);
HWY_EXPORT(rows64);
} // namespace

void weightedSum(std::span<const hbLatticeTerm> terms, std::int64_t count, double* sum) {
  HWY_DYNAMIC_DISPATCH(sumOfTerms)(terms.data(), terms.size(), count, sum);
}
void refineLine(const double* coarse, const double* surpluses, std::int64_t cells, double* fine) {
  HWY_DYNAMIC_DISPATCH(refineOne)(coarse, surpluses, cells, fine);
}
template <>
void sampleLine(const double* line, const std::int32_t* cell, const double* step, std::size_t count, double slope,
                float* out) {
  HWY_DYNAMIC_DISPATCH(sample32)(line, cell, step, count, slope, out);
}
template <>
void sampleLine(const double* line, const std::int32_t* cell, const double* step, std::size_t count, double slope,
                double* out) {
  HWY_DYNAMIC_DISPATCH(sample64)(line, cell, step, count, slope, out);
}
template <>
void roundLine(const double* line, std::size_t count, float* out) {
  HWY_DYNAMIC_DISPATCH(round32)(line, count, out);
}
template <>
void roundLine(const double* line, std::size_t count, double* out) {
  HWY_DYNAMIC_DISPATCH(round64)(line, count, out);
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
