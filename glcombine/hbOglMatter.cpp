#include "glcombine/hbOglMatter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>

namespace {

// exp(-depth) is 2^-halvings exp(rest), with rest in [-ln(2) / 2, ln(2) / 2], of which exp(rest) - 1 is its Taylor
// series to rest^7: what is left is less than 2^-26 of it. ln(2) is split into a number of 9 bits, whose products are
// exact, and the rest (W. J. Cody, W. Waite, "Software Manual for the Elementary Functions", 1980). Thin matter has no
// halvings, so that nothing cancels; what is let through of a depth of 64 does not count.
//
// The logarithm of 1 - opacity = 2^power (1 - missing), missing in [0, 1/2], is that of the power and -2 artanh(s) with
// s = missing / (2 - missing) <= 1/3, of whose series to s^17 less than 2^-32 is left. An opacity of 1 is any depth.
constexpr const char* kLight = R"(
bool isOpaque(vec4 seen) {{ return seen.a > {}; }}
float absorbed(float depth) {{
  depth = min(depth, 64.0);
  float halvings = floor(depth * 1.44269504 + 0.5);
  float rest = (halvings * 0.693359375 - depth) - halvings * 2.12194440e-4;
  float series = 1.0 + rest * (1.0 / 2.0 + rest * (1.0 / 6.0 + rest * (1.0 / 24.0 + rest * (1.0 / 120.0 +
                 rest * (1.0 / 720.0 + rest * (1.0 / 5040.0))))));
  float power = intBitsToFloat((127 - int(halvings)) << 23);
  return (1.0 - power) - power * (rest * series);
}}
float depthOf(float opacity) {{
  float through = 1.0 - opacity, missing = opacity;
  if (through <= 0.0) return 1e30;
  int power = 0;
  if (opacity > 0.5) {{
    power = (floatBitsToInt(through) >> 23) - 126;
    missing = 1.0 - intBitsToFloat(floatBitsToInt(through) - (power << 23));
  }}
  float s = missing / (2.0 - missing), q = s * s;
  float series = 1.0 + q * (1.0 / 3.0 + q * (1.0 / 5.0 + q * (1.0 / 7.0 + q * (1.0 / 9.0 + q * (1.0 / 11.0 +
                 q * (1.0 / 13.0 + q * (1.0 / 15.0 + q * (1.0 / 17.0))))))));
  return 2.0 * s * series - float(power) * 0.693147181;
}}
void show(inout vec4 seen, vec3 colour, float opacity) {{
  seen += (1.0 - seen.a) * opacity * vec4(colour, 1.0);
}}
void shine(inout vec3 colour, inout float depth, float place){}
)";
constexpr const char *kUnlit = " {}", *kLit = ";";

// Behind the entries of the range there are those below, above and of NaN.
constexpr const char* kSamples = R"(
uniform samplerBuffer matterEntries;
uniform vec3 matterRange; // numbers of the first and the last entry, entries a number
vec4 matterAt(float number) {
  int last = textureSize(matterEntries) - 4, cell;
  float t = 0.0;
  if (isnan(number)) cell = last + 3;
  else if (number < matterRange.x) cell = last + 1;
  else if (number > matterRange.y) cell = last + 2;
  else {
    float place = min((number - matterRange.x) * matterRange.z, float(last));
    cell = min(int(place), last - 1);
    t = place - float(cell);
  }
  return mix(texelFetch(matterEntries, cell), texelFetch(matterEntries, cell + int(t > 0.0)), t);
}
void addSample(inout vec4 seen, int plane, ivec2 planes, vec3 lengths, float before, float number) {
  float share = (plane == planes.x ? lengths.x : 0.5 * lengths.y) + (plane == planes.y ? lengths.z : 0.5 * lengths.y);
  vec4 matter = matterAt(number);
  float depth = matter.a * share;
  shine(matter.rgb, depth, float(plane));
  show(seen, matter.rgb, absorbed(depth));
}
)";

constexpr const char* kSlabs = R"(
uniform sampler2D matterEntries; // along x the number at the back
uniform vec3 matterRange;
vec4 slabAt(float front, float back) {
  if (isnan(front) || isnan(back)) return vec4(0.0);
  int last = textureSize(matterEntries, 0).x - 1;
  vec2 place = clamp((vec2(back, front) - matterRange.x) * matterRange.z, 0.0, float(last));
  ivec2 cell = min(ivec2(place), last - 1);
  vec2 t = place - vec2(cell);
  vec4 nearer = mix(texelFetch(matterEntries, cell, 0), texelFetch(matterEntries, cell + ivec2(1, 0), 0), t.x);
  vec4 farther = mix(texelFetch(matterEntries, cell + ivec2(0, 1), 0), texelFetch(matterEntries, cell + 1, 0), t.x);
  return mix(nearer, farther, t.y);
}
void addSlab(inout vec4 seen, vec4 slab, float steps, float middle) {
  if (slab.a > 0.0) {
    vec3 colour = slab.rgb / slab.a;
    float depth = steps * depthOf(slab.a);
    shine(colour, depth, middle);
    show(seen, colour, absorbed(depth));
  }
}
void addSample(inout vec4 seen, int plane, ivec2 planes, vec3 lengths, float before, float number) {
  bool isFirst = plane == planes.x;
  float length = isFirst ? lengths.x : lengths.y;
  addSlab(seen, slabAt(isFirst ? number : before, number), length, float(plane) - 0.5 * length / lengths.y);
  if (plane == planes.y && !isOpaque(seen))
    addSlab(seen, slabAt(number, number), lengths.z, float(plane) + 0.5 * lengths.z / lengths.y);
}
)";

/// The numbers not less than a value, and not greater, begin with these.
float atLeast(double number) {
  const auto nearest = float(number);
  return double(nearest) < number ? std::nextafter(nearest, std::numeric_limits<float>::infinity()) : nearest;
}
float atMost(double number) { return -atLeast(-number); }

} // namespace

hbOglMatter::hbOglMatter(const hbGlFunctions& gl, const hbMatter& matter, const hbValueMap& numbers, bool isLit)
    : isLit_(isLit), glsl_(fmt::format(kLight, 1.0 - hbEmissionAbsorption::kOpaque, isLit ? kLit : kUnlit) +
                           (matter.isPreintegrated() ? kSlabs : kSamples)),
      texture_(gl, matter.isPreintegrated() ? GL_TEXTURE_2D : GL_TEXTURE_BUFFER) {
  if (matter.isPreintegrated()) {
    const hbPreintegration& slabs = matter.slabs();
    const auto size = GLsizei(slabs.size());
    gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, size, size, 0, GL_RGBA, GL_FLOAT, slabs.entries().data());
    texture_.setFilter(GL_NEAREST);
    setRange(slabs.range(), slabs.size(), numbers);
    return;
  }
  const hbTransferTable& table = matter.table();
  std::vector<glm::vec4> entries = table.entries();
  constexpr float kBeyond = std::numeric_limits<float>::infinity();
  for (const float value : {-kBeyond, kBeyond, std::numeric_limits<float>::quiet_NaN()})
    entries.push_back(table.at(value));
  for (glm::vec4& entry : entries) entry.a = float(double(entry.a) * matter.step());
  entries_.emplace(gl, GL_TEXTURE_BUFFER, entries.data(), entries.size() * sizeof(entries[0]));
  gl.TexBuffer(GL_TEXTURE_BUFFER, GL_RGBA32F, entries_->name());
  setRange(table.range(), table.entries().size(), numbers);
}

void hbOglMatter::setRange(std::pair<double, double> range, std::size_t entries, const hbValueMap& numbers) {
  const double low = numbers.fromTrue(range.first), high = numbers.fromTrue(range.second);
  low_ = atLeast(low);
  high_ = atMost(high);
  // Of ranges so narrow that there are hardly two numbers in them, something finite.
  perNumber_ = float(std::min(double(entries - 1) / (high - low), double(std::numeric_limits<float>::max())));
}

void hbOglMatter::set(const hbGlProgram& program, int unit) const {
  texture_.bind(unit);
  program.set("matterEntries", unit);
  program.set("matterRange", glm::vec3(low_, high_, perNumber_));
}

double hbOglMatter::bytes(bool isPreintegrated) {
  const double entries = isPreintegrated ? double(hbMatter::kSlabEntries * hbMatter::kSlabEntries)
                                         : double(hbTransferTable::kDefaultEntries);
  return 2.0 * entries * sizeof(glm::vec4);
}
