#include "glcombine/hbOglSparseGrid.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numeric>
#include <string>

#include <fmt/format.h>

#include "glcombine/hbFixedPointTarget.h"
#include "glcombine/hbGlContext.h"
#include "glcombine/hbGlPixels.h"
#include "glcombine/hbGlProgram.h"
#include "glcombine/hbGlQuad.h"
#include "glcombine/hbGlTarget.h"
#include "glcombine/hbOglRays.h"
#include "glcombine/hbOglTiles.h"
#include "glcombine/hbTermOrder.h"

namespace {

// Each instance is the window of one plane, in its tile.
constexpr const char* kPlaneVertices = R"(#version 330 core
uniform vec3 corner[kMost], right[kMost], down[kMost]; // in the grids' coordinates, a pixel to the right and down
uniform vec4 window[kMost];
uniform vec3 tiles; // columns, width, height
uniform vec3 target; // width, height
uniform mat3 toTexture;
uniform vec3 offset;
out vec3 place, coordinates;
void main() {
  int i = gl_InstanceID, columns = int(tiles.x);
  vec2 pixel = window[i].xy + vec2(gl_VertexID & 1, gl_VertexID >> 1) * window[i].zw;
  place = corner[i] + pixel.x * right[i] + pixel.y * down[i];
  coordinates = offset + toTexture * place;
  gl_Position = vec4(2.0 * (vec2(i % columns, i / columns) * tiles.yz + pixel) / target.xy - 1.0, 0.0, 1.0);
})";

/// texel(coordinates): a texture's value there.
constexpr const char* kHardwareFilter = R"(
uniform sampler3D nodes;
float texel(vec3 coordinates) { return textureLod(nodes, coordinates, 0.0).r; }
)";
constexpr const char* kExactFilter = R"(
uniform sampler3D nodes;
uniform vec3 texels; // with nodes
float texel(vec3 coordinates) {
  vec3 at = clamp(coordinates * vec3(textureSize(nodes, 0)) - 0.5, vec3(0.0), texels - 1.0);
  ivec3 low = ivec3(min(at, max(texels - 2.0, 0.0))), high = min(low + 1, ivec3(texels) - 1);
  vec3 t = at - vec3(low);
  float v[4];
  for (int i = 0; i < 4; ++i) {
    ivec2 yz = ivec2((i & 1) == 0 ? low.y : high.y, (i & 2) == 0 ? low.z : high.z);
    v[i] = mix(texelFetch(nodes, ivec3(low.x, yz), 0).r, texelFetch(nodes, ivec3(high.x, yz), 0).r, t.x);
  }
  return mix(mix(v[0], v[1], t.y), mix(v[2], v[3], t.y), t.z);
}
)";

constexpr const char* kPlaneFragments = R"(
uniform float weight;
in vec3 place, coordinates;
out vec4 value;
#ifdef PIECES
uniform vec3 from, beyond;
bool isHere() { return !any(lessThan(place, from)) && !any(greaterThanEqual(place, beyond)); }
#endif
void main() {
#ifdef PIECES
  if (!isHere()) discard;
#endif
  value = vec4(weight * texel(coordinates));
})";

constexpr const char* kDifferencesFragments = R"(
uniform sampler2D places;
uniform vec3 latticeScale, spacing; // spacing: of the samples in the cube, 0 along flat axes
uniform mat3 toTexture;
uniform vec3 offset, from, beyond;
uniform float weight;
out vec4 result;
float value(vec3 point) {
  vec3 place = latticeScale * point;
  bool isHere = !any(lessThan(place, from)) && !any(greaterThanEqual(place, beyond));
  return isHere ? texel(offset + toTexture * place) : 0.0;
}
void main() {
  vec3 point = pointOfRay(texelFetch(places, ivec2(gl_FragCoord.xy), 0).r);
  vec3 low = max(point - spacing, 0.0), high = min(point + spacing, 1.0), span = high - low;
  vec3 difference = vec3(value(vec3(high.x, point.yz)) - value(vec3(low.x, point.yz)),
                         value(vec3(point.x, high.y, point.z)) - value(vec3(point.x, low.y, point.z)),
                         value(vec3(point.xy, high.z)) - value(vec3(point.xy, low.z)));
  result = weight * vec4(value(point), mix(difference / span, vec3(0.0), equal(spacing, vec3(0.0))));
})";

std::string planeVertices() {
  std::string text = kPlaneVertices;
  text.insert(text.find('\n') + 1, fmt::format("#define kMost {}\n", hbOglTiles::kMost));
  return text;
}

std::string fragments(hbOglSparseGrid::Filter filter, const char* rest, bool inPieces = false, const char* more = "") {
  return std::string("#version 330 core\n") + (inPieces ? "#define PIECES\n" : "") + more +
         (filter == hbOglSparseGrid::Filter::exact ? kExactFilter : kHardwareFilter) + rest;
}

/// One texture and what its samples are multiplied with. Texture coordinate = offset + toTexture * place; the texture's
/// first axis is the one with the most nodes, see axesByLength().
struct Term {
  glm::mat3 toTexture{0.0F};
  glm::vec3 offset{0.0F}, from{0.0F}, beyond{0.0F};
  glm::ivec3 texels{1}, nodes{1};
  float weight = 0.0F; ///< Of the coefficient, with its sign.
  bool isPiece = false;
  std::optional<hbGlTexture> texture;
  std::vector<float> values; ///< Of its texels, where it is handed over anew.
};

using Pieces = std::array<const hbTextureLayout::Piece*, 3>;

/// The axes of a grid from the longest to the shortest, which is the order in which a texture has them: Mesa pads rows
/// to lines of the cache, and short ones would take several times their size of it.
std::array<int, 3> axesByLength(const hbSize3& nodes) {
  std::array<int, 3> axes{0, 1, 2};
  std::stable_sort(axes.begin(), axes.end(), [&](int a, int b) { return nodes[a] > nodes[b]; });
  return axes;
}

/// The texels of one piece of a component grid, its axes in that order; those without a node are 0: the filter
/// multiplies them with 0, which must not meet what is no number.
std::vector<float> texelsOf(std::span<const float> values, const hbSize3& nodes, const Pieces& pieces,
                            const std::array<int, 3>& axes) {
  const auto& [fast, row, plane] = axes;
  const auto piece = [&](int axis) -> const hbTextureLayout::Piece& { return *pieces[std::size_t(axis)]; };
  const hbSize3 stride(1, nodes.x, nodes.x * nodes.y);
  std::int64_t first = 0;
  for (int d = 0; d < 3; ++d) first += stride[d] * piece(d).firstNode;
  std::vector<float> texels(std::size_t(piece(fast).texels * piece(row).texels * piece(plane).texels), 0.0F);
  for (std::int64_t k = 0; k < piece(plane).nodes; ++k)
    for (std::int64_t j = 0; j < piece(row).nodes; ++j)
      for (std::int64_t i = 0; i < piece(fast).nodes; ++i)
        texels[std::size_t(i + piece(fast).texels * (j + piece(row).texels * k))] =
            values[std::size_t(first + stride[fast] * i + stride[row] * j + stride[plane] * k)];
  return texels;
}

/// How field values are mapped into textures, and drawn ones divided.
struct Mapping {
  double low = 0.0, size = 1.0, divisor = 1.0;
  double zero = 0.0; ///< The field value that a number 0 in the target stands for.

  Mapping(const hbCombinationSparseGrid& grid, int component, const hbOglSparseGrid::Options& options) {
    const auto either = [&](auto test) { return test(options.textures) || test(options.target); };
    const bool isFixed = either(hb::isFixedPoint);
    if (!isFixed && !either([](hbGlFormat format) { return format == hbGlFormat::r16f; })) return;
    float least = std::numeric_limits<float>::infinity(), greatest = -least;
    double positive = 0.0, whole = 0.0;
    for (const hbCombinationSparseGrid::Grid& one : grid.grids()) {
      const auto values = grid.values(one, component);
      const auto [lo, hi] = std::minmax_element(values.begin(), values.end());
      least = std::min(least, *lo);
      greatest = std::max(greatest, *hi);
      whole += one.coefficient;
      positive += std::max(one.coefficient, 0.0);
    }
    if (isFixed) low = hb::fixedPointLow(double(least), whole);
    zero = whole * low;
    size = isFixed ? double(greatest) - low : std::max(std::abs(double(least)), std::abs(double(greatest)));
    if (!(size > 0.0)) size = 1.0;
    if (hb::isFixedPoint(options.target) && positive > 0.0) divisor = positive;
  }
};

} // namespace

struct hbOglSparseGrid::Parts {
  const hbGlContext& context;
  const hbGlFunctions& gl;
  Options options;
  Order order;
  Mapping mapping;
  glm::dvec3 latticeScale;
  glm::vec3 spacing{0.0F};
  hbGlQuad quad;
  hbGlProgram whole, pieces, differences;
  std::vector<Term> terms; ///< In the order they are drawn.
  std::int64_t bytes = 0, resident = 0;

  Parts(const hbGlContext& context, const hbCombinationSparseGrid& grid, int component, const Options& options);

  std::vector<std::size_t> sequenceOf(const hbCombinationSparseGrid& grid) const;
  std::vector<Term> termsOf(const hbCombinationSparseGrid& grid, int component);
  void keep();
  std::int64_t bytesOf(const Term& term) const {
    return std::int64_t(term.texels.x) * term.texels.y * term.texels.z * hb::glFormatBytes(options.textures);
  }
  void upload(hbGlTexture& texture, const Term& term) const;
  void set(const hbGlProgram& program, const Term& term) const;

  /// Calls draw(term) with each term's texture in unit 0.
  template <class Draw>
  void forEachTerm(Draw draw) const {
    std::optional<hbGlTexture> passing;
    for (const Term& term : terms) {
      if (!term.texture) upload(passing ? *passing : passing.emplace(gl, GL_TEXTURE_3D), term);
      (term.texture ? *term.texture : *passing).bind(0);
      draw(term);
    }
  }
};

hbOglSparseGrid::Parts::Parts(const hbGlContext& c, const hbCombinationSparseGrid& grid, int component,
                              const Options& choice)
    : context(c), gl(c.gl()), options(choice),
      order(choice.order.value_or(hb::isFixedPoint(choice.target) ? Order::positiveFirst : Order::interleaved)),
      mapping(grid, component, choice), latticeScale(grid.latticeScale()), quad(gl),
      whole(gl, planeVertices(), fragments(choice.filter, kPlaneFragments)),
      pieces(gl, planeVertices(), fragments(choice.filter, kPlaneFragments, true)),
      differences(gl, hbGlQuad::kVertexShader,
                  fragments(choice.filter, kDifferencesFragments, false, hbOglRays::glsl())) {
  if (hb::isFixedPoint(options.target) && order == Order::interleaved)
    throw hbError(fmt::format("order of blending: expected positive terms first for the target {}, which clamps what "
                              "is negative",
                              hb::glFormatName(options.target)));
  for (int d = 0; d < 3; ++d)
    if (!grid.geometry().isFlat(d)) spacing[d] = float(grid.geometry().cubeSpacing()[d]);
  terms = termsOf(grid, component);
  keep();
}

/// The component grids' places in the order they are drawn.
std::vector<std::size_t> hbOglSparseGrid::Parts::sequenceOf(const hbCombinationSparseGrid& grid) const {
  std::vector<double> coefficients;
  for (const hbCombinationSparseGrid::Grid& one : grid.grids()) coefficients.push_back(one.coefficient);
  if (order == Order::interleaved) return hb::interleaved(coefficients);
  std::vector<std::size_t> sequence(coefficients.size());
  std::iota(sequence.begin(), sequence.end(), std::size_t{0});
  std::stable_partition(sequence.begin(), sequence.end(), [&](std::size_t i) { return coefficients[i] > 0.0; });
  return sequence;
}

std::vector<Term> hbOglSparseGrid::Parts::termsOf(const hbCombinationSparseGrid& grid, int component) {
  std::vector<Term> list;
  glm::bvec3 flat;
  for (int d = 0; d < 3; ++d) flat[d] = grid.geometry().isFlat(d);
  for (const std::size_t place : sequenceOf(grid)) {
    const hbCombinationSparseGrid::Grid& one = grid.grids()[place];
    const auto stored = grid.values(one, component);
    std::vector<float> values(stored.size());
    std::transform(stored.begin(), stored.end(), values.begin(),
                   [&](float value) { return float((double(value) - mapping.low) / mapping.size); });
    const hbTextureLayout layout(one.levels, flat, options.form, context.maxTextureSize3d());
    const std::array<int, 3> axes = axesByLength(one.nodes);
    for (const auto& z : layout.pieces(2))
      for (const auto& y : layout.pieces(1))
        for (const auto& x : layout.pieces(0)) {
          Term& term = list.emplace_back();
          const Pieces all{&x, &y, &z};
          for (int t = 0; t < 3; ++t) {
            const int d = axes[std::size_t(t)];
            const hbTextureLayout::Piece& piece = *all[std::size_t(d)];
            term.toTexture[d][t] = float(piece.scale);
            term.offset[t] = float(piece.offset);
            term.texels[t] = int(piece.texels);
            term.nodes[t] = int(piece.nodes);
            // A plane that two pieces share belongs to the second; beyond the first and the last one the texels at the
            // border go on.
            constexpr float kFar = 1e30F;
            term.from[d] = piece.from > 0.0 ? float(piece.from) : -kFar;
            term.beyond[d] = piece.to < 1.0 ? float(piece.to) : kFar;
          }
          term.weight = float(one.coefficient / mapping.divisor);
          term.isPiece = layout.textures() > 1;
          term.values = texelsOf(values, one.nodes, all, axes);
        }
  }
  return list;
}

/// Uploads what there is memory for; where that is not all, room is left for the largest.
void hbOglSparseGrid::Parts::keep() {
  std::int64_t largest = 0;
  for (const Term& term : terms) {
    bytes += bytesOf(term);
    largest = std::max(largest, bytesOf(term));
  }
  const bool isTight = bytes > options.memory;
  const std::int64_t least = options.stream ? largest : bytes;
  if (least > options.memory)
    throw hbError(fmt::format("textures: expected memory for {} bytes, found a limit of {}{}", least, options.memory,
                              options.stream ? "" : fmt::format(" (streaming needs {})", largest)));
  for (Term& term : terms) {
    if (isTight && resident + bytesOf(term) + largest > options.memory) continue;
    upload(term.texture.emplace(gl, GL_TEXTURE_3D), term);
    term.values = {};
    resident += bytesOf(term);
  }
}

void hbOglSparseGrid::Parts::upload(hbGlTexture& texture, const Term& term) const {
  texture.bind(0);
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl.TexImage3D(GL_TEXTURE_3D, 0, hb::internalFormat(options.textures), term.texels.x, term.texels.y, term.texels.z, 0,
                GL_RED, GL_FLOAT, term.values.data());
  texture.setFilter(GL_LINEAR);
}

void hbOglSparseGrid::Parts::set(const hbGlProgram& program, const Term& term) const {
  program.use();
  program.set("toTexture", term.toTexture);
  program.set("offset", term.offset);
  if (options.filter == Filter::exact) program.set("texels", glm::vec3(term.nodes));
  if (&program == &whole) return;
  program.set("from", term.from);
  program.set("beyond", term.beyond);
}

hbOglSparseGrid::hbOglSparseGrid(const hbGlContext& context, const hbCombinationSparseGrid& grid, int component,
                                 const Options& options)
    : parts_(std::make_unique<Parts>(context, grid, component, options)) {}

hbOglSparseGrid::~hbOglSparseGrid() = default;

std::int64_t hbOglSparseGrid::textureBytes() const { return parts_->bytes; }
std::int64_t hbOglSparseGrid::residentBytes() const { return parts_->resident; }
std::int64_t hbOglSparseGrid::textures() const { return std::int64_t(parts_->terms.size()); }

double hbOglSparseGrid::valueOf(double number) const {
  return parts_->mapping.zero + parts_->mapping.size * parts_->mapping.divisor * number;
}

void hbOglSparseGrid::draw(std::span<const Plane> planes, const hbOglTiles& tiles, const hbGlTarget& target) const {
  assert(!planes.empty() && int(planes.size()) <= tiles.count());
  assert(target.width() == tiles.targetWidth() && target.height() == tiles.targetHeight());
  const hbGlFunctions& gl = parts_->gl;
  std::vector<glm::vec3> corners, rights, downs;
  std::vector<glm::vec4> windows;
  for (const Plane& plane : planes) {
    corners.emplace_back(parts_->latticeScale * plane.corner);
    rights.emplace_back(parts_->latticeScale * plane.right);
    downs.emplace_back(parts_->latticeScale * plane.down);
    windows.emplace_back(plane.window.x, plane.window.y, plane.window.width, plane.window.height);
  }
  for (const hbGlProgram* program : {&parts_->whole, &parts_->pieces}) {
    program->use();
    program->set("nodes", 0);
    program->set("corner", corners);
    program->set("right", rights);
    program->set("down", downs);
    program->set("window", windows);
    program->set("tiles", glm::vec3(tiles.columns(), tiles.width(), tiles.height()));
    program->set("target", glm::vec3(target.width(), target.height(), 0));
  }
  target.clear(0.0F);
  parts_->quad.bind();
  gl.Enable(GL_BLEND);
  gl.BlendFunc(GL_ONE, GL_ONE);
  gl.BlendEquation(GL_FUNC_ADD);
  const bool isPaper = parts_->order == Order::positiveFirst;
  bool isSubtracting = false;
  parts_->forEachTerm([&](const Term& term) {
    const hbGlProgram& program = term.isPiece ? parts_->pieces : parts_->whole;
    parts_->set(program, term);
    if (isPaper && term.weight < 0.0F && !isSubtracting) {
      gl.BlendEquation(GL_FUNC_REVERSE_SUBTRACT);
      isSubtracting = true;
    }
    program.set("weight", isPaper ? std::abs(term.weight) : term.weight);
    parts_->quad.draw(int(planes.size()));
  });
  gl.Disable(GL_BLEND);
}

void hbOglSparseGrid::differences(const hbOglRays& rays, const hbGlTarget& places, const hbGlTarget& out) const {
  const hbGlFunctions& gl = parts_->gl;
  const hbGlProgram& program = parts_->differences;
  out.clear(0.0F);
  parts_->quad.bind();
  gl.Enable(GL_BLEND);
  gl.BlendFunc(GL_ONE, GL_ONE);
  gl.BlendEquation(GL_FUNC_ADD);
  program.use();
  program.set("nodes", 0);
  places.texture().bind(1);
  program.set("places", 1);
  rays.set(program, 2);
  program.set("latticeScale", glm::vec3(parts_->latticeScale));
  program.set("spacing", parts_->spacing);
  parts_->forEachTerm([&](const Term& term) {
    parts_->set(program, term);
    program.set("weight", float(double(term.weight) * parts_->mapping.divisor * parts_->mapping.size));
    parts_->quad.draw();
  });
  gl.Disable(GL_BLEND);
}
