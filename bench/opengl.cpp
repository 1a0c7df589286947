// Pictures by OpenGL in the sparse-grid paper's setting beside those of the software engines, with their errors, and
// how near blended draws come to the fastest ones there are. The environment variable HBVOL_GL (osmesa, egl) chooses
// the library; the label names the device.

#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/fields.h"
#include "glcombine/hbGlContext.h"
#include "glcombine/hbGlProgram.h"
#include "glcombine/hbGlQuad.h"
#include "glcombine/hbGlTarget.h"
#include "glcombine/hbOglRaycaster.h"
#include "glcombine/hbOglTiles.h"
#include "raycast/hbRaycaster.h"
#include "report/hbPictureDifference.h"
#include "volume/hbError.h"
#include "volume/hbParallel.h"

namespace {

using Order = hbOglSparseGrid::Order;
using Layout = hbTextureLayout::Form;
using Form = hbOglRaycaster::Form;

/// Current for good in this thread, the only one that benchmarks run in.
const hbGlContext& context() {
  static const std::unique_ptr<hbGlContext> made = [] {
    const char* wanted = std::getenv("HBVOL_GL");
    const std::string name = wanted ? wanted : "";
    auto one = hbGlContext::create(name == "egl"      ? hbGlContext::Kind::egl
                                   : name == "osmesa" ? hbGlContext::Kind::osmesa
                                                      : hbGlContext::Kind::automatic);
    one->makeCurrent();
    return one;
  }();
  return *made;
}

/// 200 x 200 pixels, 128 planes, from the default angle in perspective.
hbScene scene() {
  hbScene scene;
  scene.width = scene.height = 200;
  scene.sampling.samples = 128;
  scene.sampling.kind = hbSampling::Kind::planewise;
  return scene;
}

/// The X-ray in 64 bits.
const hbPicture& reference(int level) {
  static std::map<int, hbPicture> known;
  if (const auto found = known.find(level); found != known.end()) return found->second;
  const hbSparseGrid& grid = bench::sparseGrid(level);
  const hbPlaneRays rays(grid, scene());
  std::vector<double> sums(rays.rays().size(), 0.0);
  hb::parallelFor(std::int64_t(sums.size()), [&](std::int64_t i) {
    const auto pixel = std::size_t(i);
    std::vector<double> x, y, z;
    for (int place = rays.rays()[pixel].first; place <= rays.rays()[pixel].last; ++place) {
      const glm::dvec3 point = rays.at(pixel, place);
      x.push_back(point.x);
      y.push_back(point.y);
      z.push_back(point.z);
    }
    std::vector<double> values(x.size());
    grid.values(hbPoints64{x, y, z}, 0, values);
    for (const double value : values) sums[pixel] += value;
  });
  return known.emplace(level, rays.xray(sums)).first->second;
}

void reportErrors(benchmark::State& state, const hbPicture& picture) {
  const hbPictureDifference difference = hb::pictureDifference(reference(int(state.range(0))), picture);
  state.counters["max"] = difference.max;
  state.counters["rmse"] = difference.rmse;
  state.counters["psnr"] = difference.psnr.value_or(999.0);
}

void frameOf(benchmark::State& state, const hbField& field) {
  const hbRaycaster raycaster(field, scene());
  hbPicture picture = raycaster.render();
  for (auto _ : state) picture = raycaster.render();
  reportErrors(state, picture);
}

void frameOpenGl(benchmark::State& state, const hbOglRaycaster::Options& options) {
  try {
    hbOglRaycaster raycaster(context(), bench::sparseGrid(int(state.range(0))), scene(), options);
    hbPicture picture = raycaster.render();
    for (auto _ : state) picture = raycaster.render();
    reportErrors(state, picture);
    state.counters["texture_bytes"] = double(raycaster.textureBytes());
    state.SetLabel(context().renderer());
  } catch (const hbError& error) {
    state.SkipWithError(error.what());
  }
}

hbOglRaycaster::Options blend(hbGlFormat textures, hbGlFormat target, Layout layout, Order order) {
  hbOglRaycaster::Options options;
  options.form = Form::blend;
  options.blend.textures = textures;
  options.blend.target = target;
  options.blend.form = layout;
  options.blend.order = order;
  return options;
}

std::map<std::string, hbOglRaycaster::Options> forms() {
  using enum hbGlFormat;
  std::map<std::string, hbOglRaycaster::Options> list{
      {"blend-r32f-padded", blend(r32f, r32f, Layout::padded, Order::positiveFirst)},
      {"blend-r16f-padded", blend(r16f, r16f, Layout::padded, Order::positiveFirst)},
      {"blend-r16-padded", blend(r16, r16, Layout::padded, Order::positiveFirst)},
      {"blend-r8-padded", blend(r8, r8, Layout::padded, Order::positiveFirst)},
      {"blend-r32f-exact", blend(r32f, r32f, Layout::exact, Order::positiveFirst)},
      {"blend-r32f-exact-interleaved", blend(r32f, r32f, Layout::exact, Order::interleaved)},
      {"blend-r16f-exact-interleaved", blend(r16f, r16f, Layout::exact, Order::interleaved)}};
  list["blend-r32f-exact-interleaved-shader-filter"] = list["blend-r32f-exact-interleaved"];
  list["blend-r32f-exact-interleaved-shader-filter"].blend.filter = hbOglSparseGrid::Filter::exact;
  list["blend-r32f-exact-interleaved-read-back"] = list["blend-r32f-exact-interleaved"];
  list["blend-r32f-exact-interleaved-read-back"].readBack = true;
  list["fused"].form = Form::fused;
  list["seminodal"].form = Form::seminodal;
  return list;
}

/// The planes of the frame, in lots that share a target.
std::vector<std::vector<hbPlaneRays::Plane>> lots(int level, const hbOglTiles& tiles) {
  const hbPlaneRays rays(bench::sparseGrid(level), scene());
  std::vector<std::vector<hbPlaneRays::Plane>> list;
  for (int i = 0; i < rays.planes(); ++i) {
    if (i % tiles.count() == 0) list.emplace_back();
    list.back().push_back(rays.plane(i));
  }
  return list;
}

const hbOglTiles kTiles(200, 200, 128, 8192);
static_assert(hbOglTiles::kMost == 8); // in the shader below

/// Blending alone, all planes into one target.
void draws(benchmark::State& state) {
  const int level = int(state.range(0));
  const hbGlFunctions& gl = context().gl();
  const hbOglSparseGrid grid(context(), bench::combination(level), 0, {});
  const hbGlTarget target(gl, kTiles.targetWidth(), kTiles.targetHeight(), hbGlFormat::r32f);
  for (auto _ : state) {
    for (const auto& planes : lots(level, kTiles)) grid.draw(planes, kTiles, target);
    gl.Finish();
  }
}

/// As many draws of the same rectangles into the same target, with nothing but a look-up, of `count` cubic textures of
/// floats by turns.
void drawCubes(benchmark::State& state, std::size_t count, int side) {
  const int level = int(state.range(0));
  const hbGlFunctions& gl = context().gl();
  const hbGlProgram program(gl, R"(#version 330 core
uniform vec3 corner[8], right[8], down[8];
uniform vec4 window[8];
uniform vec3 target;
out vec3 place;
void main() {
  int i = gl_InstanceID, columns = int(target.x) / 200;
  vec2 pixel = window[i].xy + vec2(gl_VertexID & 1, gl_VertexID >> 1) * window[i].zw;
  place = corner[i] + pixel.x * right[i] + pixel.y * down[i];
  gl_Position = vec4(2.0 * (vec2(i % columns, i / columns) * 200.0 + pixel) / target.xy - 1.0, 0.0, 1.0);
})",
                            R"(#version 330 core
uniform sampler3D nodes;
in vec3 place;
out vec4 value;
void main() { value = vec4(textureLod(nodes, place, 0.0).r); })");
  std::vector<hbGlTexture> textures;
  const std::vector<float> ones(std::size_t(side * side * side), 1.0F);
  for (std::size_t i = 0; i < count; ++i) {
    textures.emplace_back(gl, GL_TEXTURE_3D);
    gl.TexImage3D(GL_TEXTURE_3D, 0, GL_R32F, side, side, side, 0, GL_RED, GL_FLOAT, ones.data());
    textures.back().setFilter(GL_LINEAR);
  }
  const hbGlTarget target(gl, kTiles.targetWidth(), kTiles.targetHeight(), hbGlFormat::r32f);
  const hbGlQuad quad(gl);
  const std::size_t draws = bench::combination(level).grids().size();
  for (auto _ : state) {
    for (const auto& planes : lots(level, kTiles)) {
      target.clear(0.0F);
      quad.bind();
      program.use();
      textures[0].bind(0);
      program.set("nodes", 0);
      program.set("target", glm::vec3(target.width(), target.height(), 0));
      std::vector<glm::vec3> corners, rights, downs;
      std::vector<glm::vec4> windows;
      for (const hbPlaneRays::Plane& plane : planes) {
        corners.emplace_back(plane.corner);
        rights.emplace_back(plane.right);
        downs.emplace_back(plane.down);
        windows.emplace_back(plane.window.x, plane.window.y, plane.window.width, plane.window.height);
      }
      program.set("corner", corners);
      program.set("right", rights);
      program.set("down", downs);
      program.set("window", windows);
      gl.Enable(GL_BLEND);
      gl.BlendFunc(GL_ONE, GL_ONE);
      gl.BlendEquation(GL_FUNC_ADD);
      for (std::size_t i = 0; i < draws; ++i) {
        if (count > 1) textures[i % count].bind(0);
        quad.draw(int(planes.size()));
      }
      gl.Disable(GL_BLEND);
    }
    gl.Finish();
  }
}

void ceiling(benchmark::State& state) { drawCubes(state, 1, 33); }

/// With as many textures as there are component grids, of as many bytes in all: what the caches allow.
void ceilingOfMany(benchmark::State& state) {
  const hbCombinationSparseGrid& grid = bench::combination(int(state.range(0)));
  const double mean = double(grid.values(0).size()) / double(grid.grids().size());
  drawCubes(state, grid.grids().size(), int(std::lround(std::cbrt(mean))));
}

void wall(benchmark::internal::Benchmark* b) {
  b->UseRealTime()->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond)->ArgName("level")->DenseRange(5, 11);
}

const int registered = [] {
  const auto add = [](const std::string& name, auto run) {
    wall(benchmark::RegisterBenchmark(("opengl/" + name).c_str(), run));
  };
  for (const auto& [name, options] : forms())
    add(name, [options = options](benchmark::State& state) { frameOpenGl(state, options); });
  add("software-direct", [](benchmark::State& state) { frameOf(state, bench::sparseGrid(int(state.range(0)))); });
  add("software-combination", [](benchmark::State& state) { frameOf(state, bench::combination(int(state.range(0)))); });
  add("software-seminodal", [](benchmark::State& state) { frameOf(state, bench::semiNodal(int(state.range(0)))); });
  return 0;
}();

} // namespace

BENCHMARK(draws)->Name("opengl-draws/blend")->Apply(wall);
BENCHMARK(ceiling)->Name("opengl-draws/ceiling")->Apply(wall);
BENCHMARK(ceilingOfMany)->Name("opengl-draws/ceiling-of-many")->Apply(wall);
