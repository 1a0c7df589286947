#include "glcombine/hbGlContext.h"

#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "glcombine/hbGlFunctions.h"
#include "glcombine/hbGlTarget.h"

namespace {

class hbGlContextTest : public testing::TestWithParam<hbGlContext::Kind> {};

/// Clears a 2 x 2 float picture to a value and reads it back.
float drawnBy(hbGlContext& context, float value) {
  const hbGlCurrent current(context);
  const hbGlTarget target(context.gl(), 2, 2, hbGlFormat::r32f);
  target.clear(value);
  std::vector<float> read;
  target.read(read);
  return read[3];
}

} // namespace

TEST_P(hbGlContextTest, DrawsWithoutADisplayAndSaysWhatItIs) {
  const auto context = hbGlContext::create(GetParam());
  EXPECT_EQ(drawnBy(*context, 0.1F), 0.1F);
  EXPECT_FALSE(context->vendor().empty());
  EXPECT_FALSE(context->renderer().empty());
  EXPECT_FALSE(context->version().empty());
  EXPECT_GE(context->maxTextureSize3d(), 256); // OpenGL 3.3's least
}

TEST_P(hbGlContextTest, SeveralLiveAtATimeAndInThreads) {
  const auto first = hbGlContext::create(GetParam()), second = hbGlContext::create(GetParam());
  EXPECT_EQ(drawnBy(*first, 0.25F), 0.25F);
  EXPECT_EQ(drawnBy(*second, 0.5F), 0.5F);
  float inThread[2] = {};
  std::thread one([&] { inThread[0] = drawnBy(*first, 0.75F); });
  std::thread other([&] { inThread[1] = drawnBy(*second, 1.5F); });
  one.join();
  other.join();
  EXPECT_EQ(inThread[0], 0.75F);
  EXPECT_EQ(inThread[1], 1.5F);
  EXPECT_EQ(drawnBy(*first, 2.0F), 2.0F);
}

TEST_P(hbGlContextTest, ErrorsNameTheCall) {
  const auto context = hbGlContext::create(GetParam());
  const hbGlCurrent current(*context);
  try {
    context->gl().Enable(GL_TEXTURE_2D + 12345);
    FAIL() << "no error";
  } catch (const hbError& error) {
    EXPECT_NE(std::string(error.what()).find("glEnable"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("GL_INVALID_ENUM"), std::string::npos) << error.what();
  }
  context->gl().Finish(); // it is not in the way of the next call
}

INSTANTIATE_TEST_SUITE_P(OffScreen, hbGlContextTest, testing::Values(hbGlContext::Kind::osmesa, hbGlContext::Kind::egl),
                         [](const auto& kind) { return kind.param == hbGlContext::Kind::egl ? "egl" : "osmesa"; });

TEST(hbGlContext, BothKindsLiveInOneProgram) {
  const auto osmesa = hbGlContext::create(hbGlContext::Kind::osmesa), egl = hbGlContext::create(hbGlContext::Kind::egl);
  EXPECT_EQ(osmesa->kind(), "osmesa");
  EXPECT_EQ(egl->kind(), "egl");
  EXPECT_EQ(drawnBy(*osmesa, 0.125F), 0.125F);
  EXPECT_EQ(drawnBy(*egl, 0.25F), 0.25F);
  EXPECT_EQ(drawnBy(*osmesa, 0.5F), 0.5F);
  EXPECT_EQ(hbGlContext::create()->kind(), "osmesa");
}
