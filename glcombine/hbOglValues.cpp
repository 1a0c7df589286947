#include "glcombine/hbOglValues.h"

#include <bit>
#include <vector>

#include <fmt/format.h>
#include <glm/vec4.hpp>
#include <glm/vector_relational.hpp>

#include "glcombine/hbGlContext.h"
#include "glcombine/hbTermOrder.h"
#include "sparsegrid/kernels/hbSemiNodalKernel.h"

namespace {

// Axes have 2^l cells, so the products of coordinates and cells are exact, and so are places within cells. Of a row,
// only what is needed is loaded, and what can be computed is not: loads of uniform data, too, cost more than
// arithmetic.
constexpr const char* kCommon = R"(
const ivec3 kNext = ivec3({}, {}, {}); // nodes from one to the next along each axis: 0 along flat ones
uniform samplerBuffer gridValues;
uniform vec3 latticeScale; // 0 along flat axes
uniform int rowCount;
layout(std140) uniform Terms {{ ivec4 termRows[{}]; }};
vec3 latticePoint(vec3 point) {{
  return latticeScale * mix(vec3(0.0), min(point, 1.0), greaterThan(point, vec3(0.0)));
}}
float nodeValue(int index) {{ return texelFetch(gridValues, index).r; }}
)";

// A term's rows: cells along each axis (1 along flat ones) and the place of its first value; the coefficient.
constexpr const char* kCombination = R"(
float alongX(int index, float t) {
  float lower = nodeValue(index);
  return lower + t * (nodeValue(index + kNext.x) - lower);
}
float alongY(int index, int next, vec3 t) {
  float lower = alongX(index, t.x);
  return lower + t.y * (alongX(index + next, t.x) - lower);
}
float valueAt(vec3 point) {
  vec3 u = latticePoint(point);
  float sum = 0.0;
  for (int row = 0; row < rowCount; row += 2) {
    ivec4 term = termRows[row];
    vec3 at = u * vec3(term.xyz);
    ivec3 cell = min(ivec3(at), term.xyz - 1);
    vec3 t = at - vec3(cell);
    ivec2 nodes = term.xy + kNext.xy;
    int nextY = kNext.y * nodes.x, nextZ = kNext.z * nodes.x * nodes.y;
    int index = term.w + cell.x + nextY * cell.y + nextZ * cell.z;
    float lower = alongY(index, nextY, t), upper = alongY(index + nextZ, nextY, t);
    sum += intBitsToFloat(termRows[row + 1].x) * (lower + t.z * (upper - lower));
  }
  return sum;
}
)";

// Terms with lines of one length follow a row with the cells of these and the row after them all. A term's rows: cells
// along y and z (1 along flat axes), the place of its first value and the distance between its nodes along z; the kinds
// of its weights along y and z. At the place t in the cell, the weight is 1 - |kind t - max(kind - 1, -1)|: of a hat
// over the cell 2, of the cell's lower end (and of a flat axis, where t is 0) 1, of its upper end -1.
constexpr const char* kSemiNodal = R"(
float valueAt(vec3 point) {
  vec3 u = latticePoint(point);
  float sum = 0.0;
  for (int row = 0; row < rowCount;) {
    ivec2 lines = termRows[row++].xy;
    float atX = u.x * float(lines.x);
    int cellX = min(int(atX), lines.x - 1), length = lines.x + 1;
    vec2 ends = vec2(0.0);
    for (; row < lines.y; row += 2) {
      ivec4 term = termRows[row];
      vec2 at = u.yz * vec2(term.xy), kind = intBitsToFloat(termRows[row + 1].xy);
      ivec2 cell = min(ivec2(at), term.xy - 1);
      vec2 weights = 1.0 - abs(kind * (at - vec2(cell)) - max(kind - 1.0, -1.0));
      int index = term.z + cellX + length * cell.x + term.w * cell.y;
      ends += weights.x * weights.y * vec2(nodeValue(index), nodeValue(index + 1));
    }
    sum += ends.x + (atX - float(cellX)) * (ends.y - ends.x);
  }
  return sum;
}
)";

std::int32_t bitsOf(float value) { return std::bit_cast<std::int32_t>(value); }

} // namespace

struct hbOglValues::Table {
  const char* glsl = nullptr;
  glm::vec3 scale{1.0F}; ///< Lattice coordinate = scale * cube coordinate.
  glm::bvec3 isFlat{false};
  std::vector<glm::ivec4> rows;
  int turns = 0; ///< Of both loops, with those that end them.

  Table(const hbCombinationSparseGrid& grid, const Limits& limits);
  Table(const hbSemiNodalGrid& grid, const Limits& limits);

  std::int64_t bytes() const { return std::int64_t(rows.size() * sizeof(glm::ivec4)); }

private:
  /// Before places are narrowed to 32 bits.
  static void checkValues(std::size_t count, const Limits& limits) {
    if (std::int64_t(count) > limits.values)
      throw hbError(
          fmt::format("texture buffer of a sparse grid: expected {} values at most, found {}", limits.values, count));
  }
  void checkBlock(const Limits& limits) const {
    if (bytes() > limits.blockBytes)
      throw hbError(fmt::format("uniform block of a sparse grid: expected {} bytes at most, found {}",
                                limits.blockBytes, bytes()));
  }
};

hbOglValues::Table::Table(const hbCombinationSparseGrid& grid, const Limits& limits)
    : glsl(kCombination), scale(grid.latticeScale()) {
  checkValues(grid.values(0).size(), limits);
  std::vector<double> coefficients;
  for (const hbCombinationSparseGrid::Grid& one : grid.grids()) coefficients.push_back(one.coefficient);
  for (int d = 0; d < 3; ++d) isFlat[d] = grid.grids().front().nodes[d] == 1;
  for (const std::size_t i : hb::interleaved(coefficients)) {
    const hbCombinationSparseGrid::Grid& one = grid.grids()[i];
    const auto cells = [&](int d) { return isFlat[d] ? 1 : int(one.nodes[d] - 1); };
    rows.push_back({cells(0), cells(1), cells(2), int(one.offset)});
    rows.push_back({bitsOf(float(one.coefficient)), 0, 0, 0});
  }
  turns = int(grid.grids().size()) + 1;
  checkBlock(limits);
}

hbOglValues::Table::Table(const hbSemiNodalGrid& grid, const Limits& limits) : glsl(kSemiNodal) {
  checkValues(grid.values(0).size(), limits);
  const hbSemiNodalTerms& terms = grid.terms();
  for (int d = 0; d < 3; ++d) {
    const hbSemiNodalTerms::Axis& axis = terms.axes[std::size_t(d)];
    isFlat[d] = axis.baseCells == 0;
    scale[d] = float(axis.scale);
  }
  struct Slot {
    int cells = 1, node = 0; // the term's node is the cell's index and this
    float kind = 1.0F;
  };
  const auto slotOf = [&](std::int32_t slot, int d) -> Slot {
    if (isFlat[d]) return {};
    if (slot >= 2) return {1 << (slot - 1), 0, 2.0F};
    return {terms.axes[std::size_t(d)].baseCells, slot, slot == 0 ? 1.0F : -1.0F};
  };
  for (const hbSemiNodalTerms::Group& group : terms.groups) {
    const int cellsX = 1 << group.level, length = cellsX + 1;
    rows.push_back({cellsX, int(rows.size() + 1 + 2 * (group.end - group.begin)), 0, 0});
    for (std::size_t i = group.begin; i < group.end; ++i) {
      const hbSemiNodalTerms::Term& term = terms.terms[i];
      const Slot y = slotOf(term.slotY, 1), z = slotOf(term.slotZ, 2);
      const int plane = length * term.nodesY;
      rows.push_back({y.cells, z.cells, int(term.offset) + length * y.node + plane * z.node, plane});
      rows.push_back({bitsOf(y.kind), bitsOf(z.kind), 0, 0});
    }
  }
  turns = int(terms.terms.size() + 2 * terms.groups.size()) + 2;
  checkBlock(limits);
}

hbOglValues::Limits hbOglValues::Limits::of(const hbGlFunctions& gl) {
  GLint values = 0, bytes = 0;
  gl.GetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &values);
  gl.GetIntegerv(GL_MAX_UNIFORM_BLOCK_SIZE, &bytes);
  return {values, bytes};
}

hbOglValues::hbOglValues(const hbGlContext& context, const hbCombinationSparseGrid& grid, int component,
                         const std::optional<Limits>& limits)
    : hbOglValues(context.gl(), Table(grid, limits ? *limits : Limits::of(context.gl())), grid.values(component)) {}

hbOglValues::hbOglValues(const hbGlContext& context, const hbSemiNodalGrid& grid, int component,
                         const std::optional<Limits>& limits)
    : hbOglValues(context.gl(), Table(grid, limits ? *limits : Limits::of(context.gl())), grid.values(component)) {}

hbOglValues::hbOglValues(const hbGlFunctions& gl, const Table& table, std::span<const float> values)
    : gl_(gl),
      glsl_(fmt::format(kCommon, int(!table.isFlat.x), int(!table.isFlat.y), int(!table.isFlat.z), table.rows.size()) +
            table.glsl),
      rows_(int(table.rows.size())), turns_(table.turns), scale_(glm::vec3(glm::not_(table.isFlat)) * table.scale),
      bytes_(std::int64_t(values.size_bytes())), values_(gl, GL_TEXTURE_BUFFER, values.data(), values.size_bytes()),
      block_(gl, GL_UNIFORM_BUFFER, table.rows.data(), std::size_t(table.bytes())), texture_(gl, GL_TEXTURE_BUFFER) {
  gl.TexBuffer(GL_TEXTURE_BUFFER, GL_R32F, values_.name());
}

void hbOglValues::set(const hbGlProgram& program, int unit) const {
  texture_.bind(unit);
  program.set("gridValues", unit);
  program.set("latticeScale", scale_);
  program.set("rowCount", rows_);
  program.setBlock("Terms", 0);
  gl_.BindBufferBase(GL_UNIFORM_BUFFER, 0, block_.name());
}
