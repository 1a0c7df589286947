#include "volume/hbVolumeField.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "volume/kernels/hbTrilinearKernel.h"

namespace {

/// The cell of an axis that holds x and where in it, t in [0,1]; the upper neighbour is `step` further (0 on flat
/// axes).
struct Cell {
  std::int64_t index;
  std::int64_t step;
  float t;
};

// The cell of a position counted in cells from the first sample.
inline Cell cellAt(double position, std::int64_t size) {
  const std::int64_t index = std::min(std::int64_t(position), size - 2);
  return {index, 1, float(position - double(index))};
}

// x * cells is exact in 64 bits, so the cell depends on the float coordinate alone. NaN and x < 0 give cell 0, x > 1
// the last.
inline Cell cellOf(float x, std::int64_t size) {
  if (size == 1) return {0, 0, 0.0F};
  return cellAt(x > 0.0F ? double(std::min(x, 1.0F)) * double(size - 1) : 0.0, size);
}

// The same for the 64-bit coordinates of a lattice: i/(size-1) times size-1 may miss i by an ulp, which must not
// matter.
inline Cell cellOfNode(double x, std::int64_t size) {
  if (size == 1) return {0, 0, 0.0F};
  const double position = x > 0.0 ? std::min(x, 1.0) * double(size - 1) : 0.0;
  const double nearest = std::nearbyint(position);
  constexpr double kSame = 0x1p-30; // sizes stay far below 2^22, where an ulp of the position is 2^-31
  if (std::abs(position - nearest) < kSame) return {std::int64_t(nearest), 0, 0.0F};
  return cellAt(position, size);
}

// The nearest sample of a cell, the upper one in its middle.
inline Cell nearestOf(const Cell& cell) { return {cell.index + (cell.t < 0.5F ? 0 : cell.step), 0, 0.0F}; }

inline float lerp(float a, float b, float t) { return a + t * (b - a); }

inline float trilinear(const std::array<float, 8>& v, float tx, float ty, float tz) {
  return lerp(lerp(lerp(v[0], v[1], tx), lerp(v[2], v[3], tx), ty),
              lerp(lerp(v[4], v[5], tx), lerp(v[6], v[7], tx), ty), tz);
}

/// Reads samples as field values; compiled once per type and byte order. `Plain`: value = sample, whatever it is.
template <class T, bool Swapped, bool Plain>
struct Reader {
  const std::byte* first;
  std::array<std::int64_t, 3> stride; // bytes
  double a, b;
  std::optional<float> nonFinite;

  float operator()(const std::byte* at) const {
    const T sample = hb::loadSample<T, Swapped>(at);
    if constexpr (Plain) return float(sample);
    const float value = float(a * double(sample) + b);
    return nonFinite && !std::isfinite(value) ? *nonFinite : value;
  }

  /// The eight corners of the cell, x fastest.
  std::array<float, 8> corners(const Cell& x, const Cell& y, const Cell& z) const {
    const std::byte* at = first + x.index * stride[0] + y.index * stride[1] + z.index * stride[2];
    const std::int64_t dx = x.step * stride[0], dy = y.step * stride[1], dz = z.step * stride[2];
    return {(*this)(at),      (*this)(at + dx),      (*this)(at + dy),      (*this)(at + dx + dy),
            (*this)(at + dz), (*this)(at + dx + dz), (*this)(at + dy + dz), (*this)(at + dx + dy + dz)};
  }
};

/// Calls f with the Reader for the volume's type.
template <class F>
void withReader(const hbVolume& volume, int component, double a, double b, std::optional<float> nonFinite, F&& f) {
  hb::withSampleType(volume.type(), [&](auto tag) {
    using T = decltype(tag);
    const auto& layout = volume.layout();
    const std::int64_t bytes = sizeof(T);
    const std::byte* first = volume.data() + component * layout.componentStride * bytes;
    const std::array<std::int64_t, 3> stride{layout.stride[0] * bytes, layout.stride[1] * bytes,
                                             layout.stride[2] * bytes};
    const bool plain = a == 1.0 && b == 0.0 && !nonFinite;
    if (layout.byteSwapped)
      f(Reader<T, true, false>{first, stride, a, b, nonFinite});
    else if (plain)
      f(Reader<T, false, true>{first, stride, a, b, nonFinite});
    else
      f(Reader<T, false, false>{first, stride, a, b, nonFinite});
  });
}

/// The same for the kernel; none where it has no form for them.
std::optional<hbTrilinearSamples> vectorSamples(const hbVolume& volume, int component, double a, double b) {
  const auto& layout = volume.layout();
  const hbSize3 size = volume.geometry().size;
  if (!hb::hasTrilinearKernel(volume.type()) || layout.byteSwapped || layout.stride[0] != 1 || size.x < 2)
    return std::nullopt;
  const auto bytes = std::int64_t(hb::sampleBytes(volume.type()));
  const std::byte* first = volume.data() + component * layout.componentStride * bytes;
  return hbTrilinearSamples{first, volume.type(), size, layout.stride[1] * bytes, layout.stride[2] * bytes, a, b};
}

} // namespace

hbVolumeField::hbVolumeField(hbVolume volume, const hbValueMap& map, std::optional<double> nonFinite)
    : volume_(std::move(volume)), map_(map) {
  a_ = volume_.slope() / map.scale;
  b_ = (volume_.intercept() - map.offset) / map.scale;
  if (nonFinite) nonFinite_ = float(map.fromTrue(*nonFinite));
}

void hbVolumeField::values(const hbPoints& points, int component, std::span<float> out) const {
  if (const auto samples = vectorSamples(volume_, component, a_, b_); samples && !nonFinite_ && !isNearest_)
    return hb::evaluateTrilinear(*samples, points, out);
  const hbSize3 size = volume_.geometry().size;
  const auto cell = [&](float x, std::int64_t nodes) {
    return isNearest_ ? nearestOf(cellOf(x, nodes)) : cellOf(x, nodes);
  };
  withReader(volume_, component, a_, b_, nonFinite_, [&](const auto& reader) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Cell x = cell(points.x[i], size.x), y = cell(points.y[i], size.y), z = cell(points.z[i], size.z);
      out[i] = trilinear(reader.corners(x, y, z), x.t, y.t, z.t);
    }
  });
}

void hbVolumeField::gradients(const hbPoints& points, int component, std::span<float> out,
                              const hbGradients& gradient) const {
  if (isNearest_) {
    for (const std::span<float> slopes : {gradient.dx, gradient.dy, gradient.dz})
      std::fill(slopes.begin(), slopes.end(), 0.0F);
    return values(points, component, out);
  }
  const hbSize3 size = volume_.geometry().size;
  const glm::vec3 cells(size - std::int64_t(1)); // 0 on a flat axis, whose slope is 0
  withReader(volume_, component, a_, b_, nonFinite_, [&](const auto& reader) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Cell x = cellOf(points.x[i], size.x), y = cellOf(points.y[i], size.y), z = cellOf(points.z[i], size.z);
      const auto v = reader.corners(x, y, z);
      const float x00 = lerp(v[0], v[1], x.t), x10 = lerp(v[2], v[3], x.t), x01 = lerp(v[4], v[5], x.t),
                  x11 = lerp(v[6], v[7], x.t);
      const float xy0 = lerp(x00, x10, y.t), xy1 = lerp(x01, x11, y.t);
      out[i] = lerp(xy0, xy1, z.t);
      gradient.dx[i] = cells.x * lerp(lerp(v[1] - v[0], v[3] - v[2], y.t), lerp(v[5] - v[4], v[7] - v[6], y.t), z.t);
      gradient.dy[i] = cells.y * lerp(x10 - x00, x11 - x01, z.t);
      gradient.dz[i] = cells.z * (xy1 - xy0);
    }
  });
}

void hbVolumeField::lattice(std::span<const double> xs, std::span<const double> ys, std::span<const double> zs,
                            int component, float* out, std::size_t strideY, std::size_t strideZ) const {
  const hbSize3 size = volume_.geometry().size;
  const auto cell = [&](double x, std::int64_t nodes) {
    return isNearest_ ? nearestOf(cellOfNode(x, nodes)) : cellOfNode(x, nodes);
  };
  std::vector<Cell> cells(xs.size());
  std::transform(xs.begin(), xs.end(), cells.begin(), [&](double x) { return cell(x, size.x); });
  withReader(volume_, component, a_, b_, nonFinite_, [&](const auto& reader) {
    for (std::size_t k = 0; k < zs.size(); ++k) {
      const Cell z = cell(zs[k], size.z);
      for (std::size_t j = 0; j < ys.size(); ++j) {
        const Cell y = cell(ys[j], size.y);
        float* row = out + j * strideY + k * strideZ;
        for (std::size_t i = 0; i < xs.size(); ++i)
          row[i] = trilinear(reader.corners(cells[i], y, z), cells[i].t, y.t, z.t);
      }
    }
  });
}

hbRange hbVolumeField::range(const hbBox& box, int component) const {
  const hbSize3 size = volume_.geometry().size;
  hbSize3 from, to; // samples from..to inclusive
  for (int d = 0; d < 3; ++d) {
    const Cell lo = cellOf(box.lo[d], size[d]), hi = cellOf(box.hi[d], size[d]);
    from[d] = lo.index;
    to[d] = hi.index + hi.step;
  }
  float least = std::numeric_limits<float>::infinity(), greatest = -least;
  withReader(volume_, component, a_, b_, nonFinite_, [&](const auto& reader) {
    for (std::int64_t k = from.z; k <= to.z; ++k)
      for (std::int64_t j = from.y; j <= to.y; ++j) {
        const std::byte* at = reader.first + from.x * reader.stride[0] + j * reader.stride[1] + k * reader.stride[2];
        for (std::int64_t i = from.x; i <= to.x; ++i, at += reader.stride[0]) {
          const float value = reader(at);
          least = value < least ? value : least; // false for NaN
          greatest = value > greatest ? value : greatest;
        }
      }
  });
  if (least > greatest) return {0.0F, 0.0F}; // only NaN samples
  // A lerp a + t (b - a) rounds three times an axis and may leave [a, b] by that much.
  constexpr float kRounding = 9.0F * 0x1p-24F;
  const float slack = kRounding * std::max(std::abs(least), std::abs(greatest));
  return {least - slack, greatest + slack};
}
