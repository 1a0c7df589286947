#include "volume/fields/hbAnalyticField.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "volume/fields/hbCavitySpecification.h"
#include "volume/hbError.h"

namespace {

using namespace hb::formula;
using hb::fieldNumber;
using Parameters = hbFieldParameters;
constexpr double kPi = std::numbers::pi;
constexpr std::string_view kSize = "size";

/// The three arithmetics of a formula written as a generic function of x, y, z.
template <class F>
hbAnalyticField::Formula formula(F f) {
  return {[f](const glm::dvec3& p) { return f(p.x, p.y, p.z); },
          [f](const glm::dvec3& p) {
            return f(hbDual(p.x, {1, 0, 0}), hbDual(p.y, {0, 1, 0}), hbDual(p.z, {0, 0, 1}));
          },
          [f](const hbInterval& x, const hbInterval& y, const hbInterval& z) { return f(x, y, z); }};
}

// Squared real hydrogen wave functions with m = 0, unnormalised, lengths in Bohr radii: (polynomial * exp(-r/n))^2.
hbAnalyticField::Formula hydrogen(const Parameters& parameters) {
  const std::string& state = parameters.at("state");
  const bool automatic = parameters.at("half-width") == "auto";
  // The half-widths hold nearly all of each state's charge; 24 for 3d is also what published comparisons use.
  const double halfWidth = !automatic      ? fieldNumber(parameters, "half-width", 1e-3, 1e6)
                           : state == "2p" ? 14.0
                           : state == "4f" ? 40.0
                                           : 24.0;
  const auto centred = [halfWidth](const auto& t) { return halfWidth * (2.0 * t - 1.0); };
  if (state == "2p")
    return formula([=](const auto& x, const auto& y, const auto& z) {
      const auto X = centred(x), Y = centred(y), Z = centred(z);
      const auto r = sqrt(square(X) + square(Y) + square(Z));
      return square(Z * exp(-0.5 * r));
    });
  if (state == "3d_z2")
    return formula([=](const auto& x, const auto& y, const auto& z) {
      const auto X = centred(x), Y = centred(y), Z = centred(z);
      const auto r2 = square(X) + square(Y) + square(Z);
      return square((3.0 * square(Z) - r2) * exp(-(1.0 / 3.0) * sqrt(r2)));
    });
  if (state == "4f")
    return formula([=](const auto& x, const auto& y, const auto& z) {
      const auto X = centred(x), Y = centred(y), Z = centred(z);
      const auto r2 = square(X) + square(Y) + square(Z);
      return square(Z * (5.0 * square(Z) - 3.0 * r2) * exp(-0.25 * sqrt(r2)));
    });
  throw hbError(fmt::format("field parameter state: expected 2p, 3d_z2 or 4f, found '{}'", state));
}

// Marschner and Lobb, An Evaluation of Reconstruction Filters for Volume Rendering, 1994.
hbAnalyticField::Formula marschnerLobb(const Parameters& parameters) {
  const double f = fieldNumber(parameters, "frequency", 0.0, 1e4), a = fieldNumber(parameters, "alpha", 0.0, 1e4);
  return formula([=](const auto& x, const auto& y, const auto& z) {
    const auto r = sqrt(square(2.0 * x - 1.0) + square(2.0 * y - 1.0));
    return (1.0 / (2.0 * (1.0 + a))) *
           (1.0 - sin(0.5 * kPi * (2.0 * z - 1.0)) + a * (1.0 + cos(2.0 * kPi * f * cos(0.5 * kPi * r))));
  });
}

hbAnalyticField::Formula vortex(const Parameters&) {
  return formula([](const auto& x, const auto& y, const auto& z) {
    const auto s = square(sin(kPi * x)), s2 = 2.0 * kPi * kPi * cos(2.0 * kPi * x);
    const auto e = exp(4.0 * (z - 1.0)), bump = square(z) * (1.0 - z);
    const auto g = bump * e;
    const auto g2 = ((2.0 - 6.0 * z) + 8.0 * (2.0 * z - 3.0 * square(z)) + 16.0 * bump) * e;
    return -(s2 * g + s * g2) * sin(kPi * y);
  });
}

hbAnalyticField::Formula ball(const Parameters& parameters) {
  const double radius = fieldNumber(parameters, "radius", 0.0, 10.0);
  return formula([=](const auto& x, const auto& y, const auto& z) {
    return step(radius * radius - (square(x - 0.503) + square(y - 0.497) + square(z - 0.5)));
  });
}

hbAnalyticField::Formula kink(const Parameters&) {
  return formula([](const auto& x, const auto& y, const auto& z) { return abs(x + y + z - 1.5); });
}

hbAnalyticField::Formula smooth(const Parameters&) {
  return formula([](const auto& x, const auto& y, const auto& z) {
    return sin(2.0 * x + 0.3) * cos(1.5 * y - 0.2) * exp(0.7 * z);
  });
}

hbAnalyticField::Formula multilinear(const Parameters&) {
  return formula([](const auto& x, const auto& y, const auto& z) {
    return 1.0 + 2.0 * x + 3.0 * y - 4.0 * z + 5.0 * x * y - 6.0 * y * z + 7.0 * x * z + 8.0 * x * y * z;
  });
}

struct Known {
  std::string_view name;
  std::string_view text;
  Parameters parameters;
  hbAnalyticField::Formula (*make)(const Parameters&);
};

// The one list of analytic fields.
const std::vector<Known>& knownFields() {
  static const std::vector<Known> known{
      {"hydrogen", "squared orbital of the hydrogen atom", {{"state", "3d_z2"}, {"half-width", "auto"}}, hydrogen},
      {"marschner-lobb", "the Marschner-Lobb test signal", {{"frequency", "6"}, {"alpha", "0.25"}}, marschnerLobb},
      {"vortex", "vorticity of a smooth closed flow", {}, vortex},
      {"ball", "1 inside a ball around (0.503, 0.497, 0.5), 0 outside", {{"radius", "0.35"}}, ball},
      {"kink", "|x + y + z - 1.5|", {}, kink},
      {"smooth", "sin(2x + 0.3) cos(1.5y - 0.2) exp(0.7z)", {}, smooth},
      {"multilinear", "1 + 2x + 3y - 4z + 5xy - 6yz + 7xz + 8xyz", {}, multilinear},
  };
  return known;
}

const Known& knownField(std::string_view name) {
  if (name == hbCavitySpecification::kName)
    throw hbError(
        fmt::format("field: {0} is a simulation, no formula; make a volume first: hbvol generate {0} OUT.nrrd", name));
  std::string names;
  for (const Known& known : knownFields()) {
    if (known.name == name) return known;
    names += fmt::format("{}{}", names.empty() ? "" : ", ", known.name);
  }
  throw hbError(fmt::format("field: expected one of {}, found '{}'", names, name));
}

/// "129" or "129x65x33".
hbSize3 parseSize(std::string_view text) {
  constexpr std::int64_t kLargest = (1 << 20) + 1; // the full grid of the finest level
  hbSize3 size{0, 0, 0};
  const char* at = text.data();
  const char* const end = at + text.size();
  for (int d = 0; d < 3; ++d) {
    const auto [next, error] = std::from_chars(at, end, size[d]);
    if (error != std::errc() || size[d] < 1 || size[d] > kLargest) break;
    if (next == end && d == 0) return {size.x, size.x, size.x};
    if (next == end && d == 2) return size;
    if (next == end || *next != 'x') break;
    at = next + 1;
  }
  throw hbError(
      fmt::format("field parameter size: expected N or NxNxN with 1 to {} nodes, found '{}'", kLargest, text));
}

} // namespace

std::shared_ptr<const hbAnalyticField> hbAnalyticField::create(std::string_view specification) {
  const std::string_view name = hb::fieldName(specification);
  Parameters defaults = knownField(name).parameters;
  defaults.emplace(kSize, "129");
  Parameters parameters = hb::parseFieldParameters(specification, defaults);
  return std::shared_ptr<const hbAnalyticField>(new hbAnalyticField(std::string(name), std::move(parameters)));
}

std::vector<hbAnalyticField::Description> hbAnalyticField::all() {
  std::vector<Description> list;
  for (const Known& known : knownFields())
    list.push_back({std::string(known.name), std::string(known.text), known.parameters});
  return list;
}

hbAnalyticField::hbAnalyticField(std::string name, Parameters parameters)
    : name_(std::move(name)), parameters_(std::move(parameters)), formula_(knownField(name_).make(parameters_)) {
  specification_ = hb::fieldSpecification(name_, parameters_);
  geometry_.size = parseSize(parameters_.at(std::string(kSize)));
  for (int d = 0; d < 3; ++d) {
    geometry_.spacing[d] = geometry_.cubeSpacing()[d];
    if (geometry_.isFlat(d)) geometry_.origin[d] = 0.5; // a flat axis shows the middle of the cube
  }
}

std::shared_ptr<const hbAnalyticField> hbAnalyticField::withSize(const hbSize3& size) const {
  Parameters parameters = parameters_;
  parameters[std::string(kSize)] = fmt::format("{}x{}x{}", size.x, size.y, size.z);
  return std::shared_ptr<const hbAnalyticField>(new hbAnalyticField(name_, std::move(parameters)));
}

double hbAnalyticField::coordinate(int axis, double x) const {
  if (geometry_.isFlat(axis)) return 0.5;
  return x > 0.0 ? std::min(x, 1.0) : 0.0;
}

glm::dvec3 hbAnalyticField::point(const hbPoints& points, std::size_t i) const {
  return {coordinate(0, points.x[i]), coordinate(1, points.y[i]), coordinate(2, points.z[i])};
}

void hbAnalyticField::values(const hbPoints& points, int, std::span<float> out) const {
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = float(formula_.value(point(points, i)));
}

void hbAnalyticField::gradients(const hbPoints& points, int, std::span<float> out, const hbGradients& gradient) const {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const hbDual f = formula_.gradient(point(points, i));
    out[i] = float(f.value);
    gradient.dx[i] = geometry_.isFlat(0) ? 0.0F : float(f.gradient.x);
    gradient.dy[i] = geometry_.isFlat(1) ? 0.0F : float(f.gradient.y);
    gradient.dz[i] = geometry_.isFlat(2) ? 0.0F : float(f.gradient.z);
  }
}

void hbAnalyticField::lattice(std::span<const double> xs, std::span<const double> ys, std::span<const double> zs, int,
                              float* out, std::size_t strideY, std::size_t strideZ) const {
  for (std::size_t k = 0; k < zs.size(); ++k)
    for (std::size_t j = 0; j < ys.size(); ++j)
      for (std::size_t i = 0; i < xs.size(); ++i)
        out[i + j * strideY + k * strideZ] =
            float(formula_.value({coordinate(0, xs[i]), coordinate(1, ys[j]), coordinate(2, zs[k])}));
}

hbRange hbAnalyticField::range(const hbBox& box, int) const {
  const auto axis = [&](int d) { return hbInterval(coordinate(d, box.lo[d]), coordinate(d, box.hi[d])); };
  const hbInterval v = formula_.interval(axis(0), axis(1), axis(2));
  // Every formula rounds a few dozen times in 64 bits, far below one step of a 32-bit float.
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const double slack = 1e-12 * std::max(std::abs(v.lo), std::abs(v.hi));
  return {std::nextafter(float(v.lo - slack), -kInfinity), std::nextafter(float(v.hi + slack), kInfinity)};
}
