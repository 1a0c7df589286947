#include "glcombine/hbGlProgram.h"

#include <gtest/gtest.h>

#include "glcombine/hbGlContext.h"
#include "glcombine/hbGlTarget.h"

namespace {

constexpr const char* kVertex = R"(#version 330 core
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); })";
constexpr const char* kFragment = R"(#version 330 core
uniform int whole;
uniform float part;
uniform vec3 place;
out vec4 colour;
void main() { colour = vec4(float(whole) + part + place.z); })";

template <class Make>
std::string errorOf(Make make) {
  try {
    make();
  } catch (const hbError& error) {
    return error.what();
  }
  return "no error";
}

} // namespace

TEST(hbGlProgram, DrawsWithItsUniforms) {
  const auto context = hbGlContext::create();
  const hbGlCurrent current(*context);
  const hbGlFunctions& gl = context->gl();
  const hbGlProgram program(gl, kVertex, kFragment);
  const hbGlTarget target(gl, 3, 2, hbGlFormat::r32f);
  GLuint vertices = 0;
  gl.GenVertexArrays(1, &vertices);
  gl.BindVertexArray(vertices);
  program.use();
  program.set("whole", 3);
  program.set("part", 0.25F);
  program.set("place", glm::vec3(7.0F, 8.0F, 0.5F));
  program.set("unknown", 1.0F);
  gl.DrawArrays(GL_TRIANGLES, 0, 3);
  std::vector<float> read;
  target.read(read);
  EXPECT_EQ(read, std::vector<float>(6, 3.75F));
  gl.DeleteVertexArrays(1, &vertices);
}

TEST(hbGlProgram, LogsAreInTheErrors) {
  const auto context = hbGlContext::create();
  const hbGlCurrent current(*context);
  const hbGlFunctions& gl = context->gl();
  const std::string compile =
      errorOf([&] { hbGlProgram(gl, kVertex, "#version 330 core\nvoid main() { nonsense(); }"); });
  EXPECT_NE(compile.find("fragment shader"), std::string::npos) << compile;
  EXPECT_NE(compile.find("nonsense"), std::string::npos) << compile;
  const std::string link = errorOf([&] {
    hbGlProgram(gl, kVertex, "#version 330 core\nvoid other(); out vec4 c; void main() { other(); c = vec4(1); }");
  });
  EXPECT_NE(link.find("glLinkProgram"), std::string::npos) << link;
}
