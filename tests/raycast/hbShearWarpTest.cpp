#include "raycast/hbShearWarp.h"

#include <array>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "raycast/hbShearReference.h"
#include "sparsegrid/hbRoundingBounds.h"
#include "tests/raycast/hbTestScenes.h"
#include "tests/sparsegrid/hbTestSets.h"
#include "volume/hbError.h"

using namespace hbTestScenes;

namespace {

/// Compares every pixel of an X-ray or a MIP with the reference.
int expectReference(const hbSparseGrid& grid, const hbScene& scene, int supersample = 1) {
  hbShearReference reference(grid, scene, supersample);
  const hbPicture picture = draw(grid, scene, supersample);
  const std::vector<float> ys = channel(picture, "Y"), as = channel(picture, "A");
  const double rounding = reference.rounding();
  int covered = 0;
  for (int y = 0; y < scene.height; ++y)
    for (int x = 0; x < scene.width; ++x) {
      const std::size_t at = std::size_t(x + scene.width * y);
      const auto in = inCube(grid.geometry(), reference.scene(), x, y);
      EXPECT_EQ(as[at], in ? 1.0F : 0.0F) << x << " " << y;
      if (!in) continue;
      ++covered;
      double sum = 0.0, weights = 0.0, largest = 0.0;
      for (const auto& n : reference.neighbours(x + 0.5, y + 0.5)) {
        const hbShearReference::Samples& samples = reference.samples(*n.rays, n.i, n.j);
        if (samples.values.empty()) continue;
        const double gathered = scene.mode == hbMode::xray
                                    ? samples.mean()
                                    : *std::max_element(samples.values.begin(), samples.values.end());
        sum += n.weight * gathered;
        weights += n.weight;
        largest = std::max(largest, std::abs(gathered));
      }
      double expected = weights > 0.0 ? sum / weights : reference.value(0.5 * (in->enter + in->leave));
      // A value's rounding; the place between two rays to 1e-9 of a step, which changes the blend by that of the
      // largest; of a lone point also its coordinates' rounding to floats.
      double tolerance = rounding + 4e-9 * largest;
      if (weights == 0.0) tolerance += glm::dot(reference.slopes(), glm::dvec3(0x1p-25));
      if (scene.mode == hbMode::xray) {
        expected *= in->length;
        tolerance *= in->length;
      }
      tolerance += 0x1p-23 * std::abs(expected); // of the result, and the length's 64-bit rounding
      EXPECT_NEAR(ys[at], expected, tolerance) << x << " " << y;
    }
  return covered;
}

} // namespace

TEST(hbShearWarp, XrayAndMipAreTheReference) {
  for (const hbGeometry& g : {box({9, 9, 9}, {1.0, 1.0, 1.0}), awkward()}) {
    const hbSparseGrid grid = gridOf(g, 3, {waves});
    int covered = 0;
    for (const hbCamera& camera : cameras(g))
      for (const hbMode mode : {hbMode::xray, hbMode::mip}) {
        SCOPED_TRACE(testing::Message() << "camera at " << camera.position.x << " " << camera.position.y << " "
                                        << camera.position.z << " projection " << int(camera.projection));
        covered += expectReference(grid, sceneOf(mode, camera));
        if (testing::Test::HasFailure()) return;
      }
    EXPECT_GT(covered, 14 * 11 * 10);
  }
}

TEST(hbShearWarp, SetsThatAreNotRegularAreTheReference) {
  const hbGeometry g = box({9, 9, 9}, {1.0, 0.8, 0.6});
  for (const hbIndexSet& set : {hbIndexSet::anisotropic({3, 1, 2}, {}), hbTestSets::uneven()}) {
    const hbSparseGrid grid = gridOf(g, set, {waves});
    for (const hbCamera& camera : cameras(g))
      for (const hbMode mode : {hbMode::xray, hbMode::mip}) {
        expectReference(grid, sceneOf(mode, camera));
        if (testing::Test::HasFailure()) return;
      }
  }
}

TEST(hbShearWarp, ClipBoxesAreTheReference) {
  const hbSparseGrid grid = gridOf(awkward(), 3, {waves});
  for (const hbScene::ClipBox& clip : clipBoxes()) {
    int covered = 0;
    for (const hbCamera& camera : cameras(awkward()))
      for (const hbMode mode : {hbMode::xray, hbMode::mip})
        for (const int samples : {9, 60}) {
          SCOPED_TRACE(testing::Message() << "camera at " << camera.position.x << " " << camera.position.y << " "
                                          << camera.position.z << " projection " << int(camera.projection)
                                          << " box from " << clip.lo.x << " " << clip.lo.y << " " << samples);
          hbScene scene = sceneOf(mode, camera, 14, 11, samples);
          scene.clip = clip;
          covered += expectReference(grid, scene);
          if (testing::Test::HasFailure()) return;
        }
    EXPECT_GT(covered, 14 * 11 * 4);
  }
}

// Nothing is clipped by a box that is all of the volume.
TEST(hbShearWarp, AClipBoxOfAllIsNone) {
  const hbSparseGrid grid = gridOf(awkward(), 3, {waves});
  for (const hbCamera& camera : cameras(awkward()))
    for (const hbMode mode : {hbMode::xray, hbMode::mip, hbMode::iso}) {
      hbScene scene = sceneOf(mode, camera);
      const hbPicture whole = draw(grid, scene);
      scene.clip.emplace();
      EXPECT_EQ(draw(grid, scene).channels, whole.channels);
    }
}

TEST(hbShearWarp, FlatVolumesAreTheReference) {
  for (const hbSize3& size : {hbSize3(9, 6, 1), hbSize3(1, 9, 9), hbSize3(7, 1, 1), hbSize3(1, 1, 1)}) {
    const hbGeometry g = box(size, {2.0, 1.0, 0.4});
    const hbSparseGrid grid = gridOf(g, 3, {waves});
    for (const double azimuth : {0.0, 25.0, 90.0})
      for (const Projection projection : {Projection::orthographic, Projection::perspective})
        for (const hbMode mode : {hbMode::xray, hbMode::mip})
          EXPECT_GT(expectReference(grid, sceneOf(mode, hbCamera::framing(g, azimuth, 15.0, projection))), 0);
  }
}

TEST(hbShearWarp, SupersampledPicturesAreTheReference) {
  const hbSparseGrid grid = gridOf(awkward(), 3, {waves});
  for (const int supersample : {2, 3, 8})
    EXPECT_GT(expectReference(grid, sceneOf(hbMode::xray, hbCamera::framing(awkward(), 35.0, 20.0)), supersample), 0);
}

TEST(hbShearWarp, ShowsComponentsTheirLengthAndTrueValues) {
  // Values around 1e6 with a small signal, as doubles: the grid's value map takes the offset away.
  const auto offset = [](const glm::dvec3& p) { return 1e9 + waves(p); };
  const auto other = [](const glm::dvec3& p) { return 2.0 - 3.0 * p.x * p.y; };
  const hbGeometry g = box({9, 9, 9}, {1.0, 2.0, 1.0});
  const hbSparseGrid far = gridOf(g, 3, {offset}), two = gridOf(g, 3, {waves, other});
  EXPECT_NE(far.valueMap().offset, 0.0);
  for (const hbMode mode : {hbMode::xray, hbMode::mip}) {
    hbScene scene = sceneOf(mode, hbCamera::framing(g, 35.0, 20.0));
    expectReference(far, scene);
    scene.component = 1;
    expectReference(two, scene);
    scene.component = 0;
    scene.magnitude = true;
    expectReference(two, scene);
  }
}

// The first crossing between slices, then value and central differences at its place, and their blend.
TEST(hbShearWarp, IsoSurfacesAreTheReference) {
  for (const hbGeometry& g : {box({17, 17, 17}, {1.0, 1.0, 1.0}), awkward()}) {
    const hbSparseGrid grid = gridOf(g, 4, {waves});
    int hits = 0, misses = 0;
    std::vector<std::pair<hbCamera, std::optional<hbScene::ClipBox>>> views;
    for (const hbCamera& camera : cameras(g)) views.emplace_back(camera, std::nullopt);
    for (const hbCamera& camera : cameras(g)) views.emplace_back(camera, clipBoxes()[1]);
    for (const auto& [camera, clip] : views) {
      hbScene scene = sceneOf(hbMode::iso, camera, 14, 11, 12);
      scene.clip = clip;
      hbShearReference reference(grid, scene);
      const hbPixelRays& pixelRays = reference.rays();
      const hbPicture picture = draw(grid, scene);
      const std::vector<float> a = channel(picture, "A"), z = channel(picture, "Z"), value = channel(picture, "value"),
                               shade = channel(picture, "Y");
      const std::array<std::vector<float>, 3> normals{channel(picture, "N.X"), channel(picture, "N.Y"),
                                                      channel(picture, "N.Z")};
      const double iso = *scene.isoValue, rounding = reference.rounding();
      const glm::dvec3 slopes = reference.slopes();
      const glm::dmat3 toWorld(g.cubeToWorld()), gradientToWorld = glm::transpose(glm::inverse(toWorld));
      const double step = scene.sampling.stepLength(g, camera);
      for (int y = 0; y < scene.height; ++y)
        for (int x = 0; x < scene.width; ++x) {
          struct Hit {
            double weight, z, zError, value, valueError, normalError;
            glm::dvec3 normal;
          };
          std::vector<Hit> found;
          double coverage = 0.0;
          bool unsure = false;
          for (const auto& n : reference.neighbours(x + 0.5, y + 0.5)) {
            const hbShearReference::Samples& s = reference.samples(*n.rays, n.i, n.j);
            for (const double v : s.values) unsure = unsure || std::abs(v - iso) <= rounding;
            for (std::size_t k = 1; k < s.values.size(); ++k) {
              const double before = s.values[k - 1], now = s.values[k];
              if ((before >= iso) == (now >= iso)) continue;
              const double t = (iso - before) / (now - before);
              const glm::dvec3 from = hbShearReference::point(*n.rays, n.i, n.j, s.first + int(k) - 1),
                               to = hbShearReference::point(*n.rays, n.i, n.j, s.first + int(k));
              const glm::dvec3 place = from + t * (to - from), ray = glm::normalize(toWorld * (to - from));
              // Both values are rounded, which moves the crossing; so does the place's rounding to floats.
              const glm::dvec3 moved =
                  std::min(1.0, 2.0 * rounding / std::abs(now - before)) * glm::abs(to - from) + glm::dvec3(0x1p-24);
              const double valueError = glm::dot(slopes, moved) + hb::semiNodalBound(grid);
              const glm::dvec3 h = g.cubeSpacing();
              glm::dvec3 gradient(0.0), gradientError(0.0);
              for (int d = 0; d < 3; ++d) {
                glm::dvec3 lower = place, upper = place;
                lower[d] = std::max(0.0, place[d] - h[d]);
                upper[d] = std::min(1.0, place[d] + h[d]);
                gradient[d] = (reference.value(upper) - reference.value(lower)) / (upper[d] - lower[d]);
                // At a face the span itself shrinks by `moved`.
                gradientError[d] = (2.0 * valueError + std::abs(gradient[d]) * 2.0 * moved[d]) / (upper[d] - lower[d]);
              }
              glm::dvec3 normal = gradientToWorld * gradient;
              double error = 0.0;
              for (int d = 0; d < 3; ++d) error += glm::length(gradientToWorld[d]) * gradientError[d];
              error = 2.0 * error / glm::length(normal) + 0x1p-22; // normalising at most doubles it
              normal = glm::normalize(normal);
              // Turned towards the viewer, which rounding decides where the ray grazes.
              unsure = unsure || std::abs(glm::dot(normal, ray)) <= error;
              if (glm::dot(normal, ray) > 0.0) normal = -normal;
              found.push_back({n.weight, pixelRays.distance(place), glm::length(toWorld * moved),
                               reference.value(place), valueError, error, normal});
              coverage += n.weight;
              break;
            }
          }
          if (unsure || std::abs(coverage - 0.5) < 1e-8) continue;
          const std::size_t at = std::size_t(x + scene.width * y);
          const bool isHit = coverage > 0.5 && inCube(g, reference.scene(), x, y);
          ASSERT_EQ(a[at], isHit ? 1.0F : 0.0F) << x << " " << y;
          if (!isHit) {
            ++misses;
            ASSERT_EQ(z[at], std::numeric_limits<float>::infinity());
            continue;
          }
          const auto heaviest = std::max_element(found.begin(), found.end(),
                                                 [](const Hit& l, const Hit& r) { return l.weight < r.weight; });
          const double apart = hbShearWarp::kSameSurface * std::max(step, pixelRays.pixelSize(heaviest->z));
          Hit sum{0, 0, 0, 0, 0, 0, glm::dvec3(0.0)};
          for (const Hit& hit : found) {
            const double difference = std::abs(hit.z - heaviest->z);
            unsure = unsure || std::abs(difference - apart) <= hit.zError + heaviest->zError;
            // Two as heavy as each other: either may be the one.
            unsure = unsure || (&hit != &*heaviest && heaviest->weight - hit.weight < 1e-8);
            if (difference > apart) continue;
            sum.weight += hit.weight;
            sum.z += hit.weight * hit.z;
            sum.value += hit.weight * hit.value;
            sum.normal += hit.weight * hit.normal;
            sum.zError = std::max(sum.zError, hit.zError);
            sum.valueError = std::max(sum.valueError, hit.valueError);
            sum.normalError = std::max(sum.normalError, hit.normalError);
          }
          if (unsure) continue;
          ++hits;
          const double largest = std::abs(sum.z / sum.weight);
          ASSERT_NEAR(z[at], sum.z / sum.weight, sum.zError + (0x1p-22 + 4e-9) * largest);
          ASSERT_NEAR(value[at], sum.value / sum.weight, sum.valueError + (0x1p-22 + 4e-9) * hb::amplitude(grid));
          const double blended = glm::length(sum.normal / sum.weight), error = 2.0 * (sum.normalError + 4e-9) / blended;
          const glm::dvec3 normal = glm::normalize(sum.normal);
          for (int d = 0; d < 3; ++d) ASSERT_NEAR(normals[std::size_t(d)][at], normal[d], error);
          const glm::dvec3 ray = camera.ray(x + 0.5, y + 0.5, scene.width, scene.height).direction;
          ASSERT_NEAR(shade[at], std::clamp(-glm::dot(normal, ray), 0.0, 1.0), error + 0x1p-22);
        }
    }
    EXPECT_GT(hits, 300);
    EXPECT_GT(misses, 300);
  }
}

TEST(hbShearWarp, AConstantFieldShowsTheExactLengths) {
  const hbGeometry g = awkward();
  const hbSparseGrid grid = gridOf(g, 3, {[](const glm::dvec3&) { return 2.5; }});
  for (const hbCamera& camera : cameras(g))
    for (const auto& [samples, clip] : {std::pair(1, 0), {7, 0}, {7, 1}, {7, 2}, {60, 3}}) {
      hbScene scene = sceneOf(hbMode::xray, camera, 14, 11, samples);
      scene.clip = clipBoxes()[std::size_t(clip)];
      const hbPicture picture = draw(grid, scene);
      for (int y = 0; y < scene.height; ++y)
        for (int x = 0; x < scene.width; ++x) {
          const auto in = inCube(g, scene, x, y);
          const double expected = in ? 2.5 * in->length : 0.0;
          // Level 0 alone is not zero: the values' rounding (hbShearReference::rounding() with 2.5 for all eight
          // corners), and the result's.
          const double rounding = (15 + 8) * 0x1p-24 * 2.5 * (in ? in->length : 0.0) + 0x1p-24 * expected;
          EXPECT_NEAR(channel(picture, "Y")[std::size_t(x + 14 * y)], expected, rounding);
        }
    }
}

TEST(hbShearWarp, ThePictureDoesNotDependOnTheNumberOfThreads) {
  const hbGeometry g = box({5, 5, 5}, {1.0, 1.0, 1.0});
  const hbSparseGrid grid = gridOf(g, 2, {waves});
  for (const hbMode mode : {hbMode::xray, hbMode::mip, hbMode::iso}) {
    // More rays than a round of bands has, more slices than a chunk.
    const hbScene scene = sceneOf(mode, hbCamera::framing(g, 30.0, 20.0), 190, 180, 20);
    std::map<std::string, std::vector<float>> first;
    for (const std::size_t threads : {1U, 2U, 7U}) {
      const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
      const hbShearWarp warp(grid, scene, {3});
      const hbPicture picture = warp.render();
      if (first.empty()) first = picture.channels;
      EXPECT_TRUE(picture.channels == first) << threads;
      EXPECT_TRUE(warp.render().channels == first) << "with the memory of the frame before";
    }
  }
}

// Bands of rays and chunks of slices join without a seam.
TEST(hbShearWarp, LargePicturesAreTheReference) {
  const hbGeometry g = box({3, 3, 3}, {1.0, 1.0, 1.0});
  const hbSparseGrid grid = gridOf(g, 1, {waves});
  for (const hbMode mode : {hbMode::xray, hbMode::mip})
    EXPECT_GT(expectReference(grid, sceneOf(mode, hbCamera::framing(g, 20.0, 15.0), 40, 330, 3), 2), 0);
  hbScene scene = sceneOf(hbMode::mip, hbCamera::framing(g, 0.0, 0.0), 12, 9, 150);
  EXPECT_GT(expectReference(grid, scene), 0);
}

TEST(hbShearWarp, KeepsTheSceneAndSaysItsSlices) {
  const hbGeometry g = box({9, 9, 9}, {1.0, 1.0, 1.0});
  const hbSparseGrid grid = gridOf(g, 3, {waves});
  hbScene scene;
  scene.width = scene.height = 8;
  const hbShearWarp chosen(grid, scene, {});
  ASSERT_TRUE(chosen.scene().camera);
  EXPECT_EQ(*chosen.scene().camera, hbCamera::framing(g));
  const hbPicture picture = chosen.render();
  EXPECT_EQ(hb::sceneFromJson(picture.metadata.at(hbPicture::kSceneKey), "test"), chosen.scene());
  // Along an axis as many slices as samples; their distance in general is that of a ray's samples.
  scene.sampling.samples = 128;
  for (const Projection projection : {Projection::orthographic, Projection::perspective}) {
    scene.camera = hbCamera::framing(g, 90.0, 0.0, projection);
    EXPECT_EQ(hbShearWarp(grid, scene, {}).slices(), std::vector<int>{128});
    scene.camera = hbCamera::framing(g, 30.0, 0.0, projection);
    // A slab of 1/N is 1 / (N cos 30) along the axis, the step (cos 30 + sin 30) / 128.
    const double c = std::sqrt(0.75);
    EXPECT_EQ(hbShearWarp(grid, scene, {}).slices(), std::vector<int>{int(std::ceil(128.0 / (c * (c + 0.5))))});
  }
  EXPECT_GE(chosen.bytes(), 8.0 * 8 * 8);
  EXPECT_GT(hbShearWarp(grid, scene, {8}).bytes(), 10.0 * chosen.bytes());
}

// Nothing is left of where it was seen from before.
TEST(hbShearWarp, LooksFromElsewhere) {
  const hbGeometry g = awkward();
  const hbSparseGrid grid = gridOf(g, 3, {waves, waves});
  for (const hbMode mode : {hbMode::xray, hbMode::iso})
    for (const bool magnitude : {false, true}) {
      hbScene scene = sceneOf(mode, cameras(g).front());
      scene.magnitude = magnitude;
      hbShearWarp moved(grid, scene, {1});
      for (const hbCamera& camera : cameras(g)) {
        moved.look(camera);
        scene.camera = camera;
        EXPECT_EQ(moved.render().channels, draw(grid, scene).channels);
        EXPECT_EQ(moved.scene().camera, camera);
      }
      hbCamera wrong;
      wrong.target = wrong.position;
      EXPECT_THROW(moved.look(wrong), hbError);
    }
}

TEST(hbShearWarp, SeesNothingWhereThereIsNothing) {
  const hbGeometry g = box({9, 9, 9}, {1.0, 1.0, 1.0});
  const hbSparseGrid grid = gridOf(g, 3, {waves});
  hbCamera away;
  away.position = {0.5, 2.0, 0.5};
  away.target = {0.5, 3.0, 0.5};
  for (const Projection projection : {Projection::orthographic, Projection::perspective})
    for (const hbMode mode : {hbMode::xray, hbMode::mip, hbMode::iso}) {
      away.projection = projection;
      const hbShearWarp warp(grid, sceneOf(mode, away), {});
      // Parallel rays meet the cube behind the camera's plane.
      EXPECT_EQ(warp.slices().empty(), projection == Projection::perspective);
      const hbPicture picture = warp.render();
      EXPECT_EQ(channel(picture, "A"), std::vector<float>(14 * 11, 0.0F));
      EXPECT_EQ(channel(picture, "Y"), std::vector<float>(14 * 11, 0.0F));
    }
}

TEST(hbShearWarp, RefusesWhatItCannotDraw) {
  const hbGeometry g = box({9, 9, 9}, {1.0, 1.0, 1.0});
  const hbSparseGrid grid = gridOf(g, 3, {waves});
  hbScene scene = sceneOf(hbMode::xray, hbCamera::framing(g));
  const auto refusal = [&](const hbShearWarp::Options& options = {}) {
    try {
      hbShearWarp(grid, scene, options);
    } catch (const hbError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refusal(), "");
  EXPECT_EQ(refusal({0}), "supersample: expected 1 to 8, found 0");
  EXPECT_EQ(refusal({9}), "supersample: expected 1 to 8, found 9");
  scene.component = 1;
  EXPECT_EQ(refusal(), "component: expected 0 to 0, found 1");
  scene.component = 0;
  scene.mode = hbMode::iso;
  EXPECT_EQ(refusal(), "iso: expected an iso-value");
  scene = sceneOf(hbMode::xray, hbCamera::framing(g), 0);
  EXPECT_NE(refusal().find("width"), std::string::npos);
}

TEST(hbShearWarp, StopsWhenCancelled) {
  const hbGeometry g = box({9, 9, 9}, {1.0, 1.0, 1.0});
  const hbSparseGrid grid = gridOf(g, 3, {waves});
  for (const hbMode mode : {hbMode::xray, hbMode::iso}) {
    hbProgress progress;
    progress.cancel();
    EXPECT_THROW(hbShearWarp(grid, sceneOf(mode, hbCamera::framing(g)), {}).render(progress), hbCancelled);
  }
}
