#include "raycast/hbShearFactorisation.h"

#include <random>
#include <set>

#include <glm/trigonometric.hpp>
#include <glm/vector_relational.hpp>
#include <gtest/gtest.h>

#include "tests/raycast/hbTestScenes.h"

using namespace hbTestScenes;

namespace {

/// Where in the picture a point of the cube is seen; in front of the camera.
glm::dvec2 seen(const hbCamera& camera, const hbGeometry& g, const hbScene& scene, const glm::dvec3& point) {
  const glm::dvec3 p = glm::dvec3(g.cubeToWorld() * glm::dvec4(point, 1.0)) - camera.position;
  const glm::dvec3 axis = camera.viewAxis(), right = glm::normalize(glm::cross(axis, camera.up)),
                   up = glm::cross(right, axis);
  const double half = camera.projection == Projection::orthographic
                          ? 0.5 * camera.height
                          : std::tan(0.5 * glm::radians(camera.fieldOfView)) * glm::dot(p, axis);
  return {0.5 * scene.width + 0.5 * scene.height * glm::dot(p, right) / half,
          0.5 * scene.height - 0.5 * scene.height * glm::dot(p, up) / half};
}

template <class Visit>
void forAllViews(Visit visit) {
  for (const hbGeometry& g : {box({9, 9, 9}, {1.0, 1.0, 1.0}), awkward()})
    for (const hbCamera& camera : cameras(g))
      for (const int supersample : {1, 3})
        for (const hbScene::ClipBox& clip : clipBoxes()) {
          const hbScene scene = sceneOf(hbMode::xray, camera, 16, 12);
          const hbPixelRays rays(camera, scene.width, scene.height, g, clip);
          visit(g, scene, rays, supersample, hbShearFactorisation::of(scene, g, rays, supersample));
        }
}

} // namespace

// Of those that see the volume.
TEST(hbShearFactorisation, EveryPixelHasOneDirectionAlongWhichItIsNotSteep) {
  std::set<std::size_t> directions;
  forAllViews([&](const hbGeometry& g, const hbScene& scene, const hbPixelRays& rays, int, const auto& list) {
    directions.insert(list.size());
    for (int y = 0; y < scene.height; ++y)
      for (int x = 0; x < scene.width; ++x) {
        if (!rays.clip(x + 0.5, y + 0.5)) continue;
        int owners = 0;
        for (const hbShearFactorisation& f : list) {
          if (!f.owns(x + 0.5, y + 0.5)) continue;
          ++owners;
          const glm::dvec3 way = glm::abs(rays.direction(x + 0.5, y + 0.5) * g.extent());
          const hbAxisOrder order = f.order();
          EXPECT_LE(std::max(way[order.fast], way[order.row]), hbShearFactorisation::kSteepest * way[order.plane]);
          EXPECT_LT(order.fast, order.row);
          EXPECT_EQ(order.fast + order.row + order.plane, 3);
        }
        EXPECT_EQ(owners, 1);
      }
  });
  EXPECT_TRUE(directions.contains(1));
  EXPECT_GT(*directions.rbegin(), 2U);
}

// A pixel's base coordinates meet its ray in every slice, and slices follow each other from the camera on.
TEST(hbShearFactorisation, BaseCoordinatesFollowTheRays) {
  forAllViews([&](const hbGeometry&, const hbScene& scene, const hbPixelRays& rays, int, const auto& list) {
    for (const hbShearFactorisation& f : list)
      for (int y = 0; y < scene.height; ++y)
        for (int x = 0; x < scene.width; ++x) {
          const double px = x + 0.5, py = y + 0.5;
          if (!f.owns(px, py) || !rays.clip(px, py)) continue;
          const glm::dvec2 base = f.base(px, py);
          const glm::dvec3 o = rays.origin(px, py), v = rays.direction(px, py);
          double before = -std::numeric_limits<double>::infinity();
          for (int n = f.firstSlice(); n < f.slices(); ++n) {
            const glm::dvec3 p = f.point(f.slice(n), base.x, base.y);
            const double s = (p[f.order().plane] - o[f.order().plane]) / v[f.order().plane];
            // Slopes of up to 2 (in cubes of unequal edges some times that) and a dozen operations.
            EXPECT_LE(glm::distance(p, o + s * v), 1e-12 * (1.0 + glm::length(o)));
            EXPECT_NEAR(f.distance(n, base.x, base.y), s, 1e-12 * (10.0 + glm::length(o)));
            EXPECT_GT(s, before);
            before = s;
            if (scene.camera->projection == Projection::perspective) {
              EXPECT_GT(s, 0.0);
            }
          }
        }
  });
}

// And no others, whatever box is seen: these are where they are for the whole cube.
TEST(hbShearFactorisation, SlicesAreTheMidpointsOfSlabs) {
  forAllViews([&](const hbGeometry& g, const hbScene& scene, const hbPixelRays& rays, int, const auto& list) {
    const double step = scene.sampling.stepLength(g, *scene.camera);
    const glm::dvec3 middle = rays.direction(0.5 * scene.width, 0.5 * scene.height);
    for (const hbShearFactorisation& f : list) {
      const int w = f.order().plane, count = f.slices();
      std::set<double> places;
      for (int n = 0; n < count; ++n) places.insert(f.slice(n).w);
      int k = 0;
      for (const double place : places) EXPECT_NEAR(place, (k++ + 0.5) / count, 0x1p-52);
      EXPECT_EQ(k, count);
      ASSERT_LE(f.firstSlice(), f.endSlice());
      for (int n = 0; n < count; ++n) {
        const double at = f.slice(n).w, eye = rays.origin(0.0, 0.0)[w];
        const bool isBehind =
            scene.camera->projection == Projection::perspective && !((at - eye) * f.changeOfSlice().w > 0.0);
        const bool isIn = at >= rays.box().lo[w] && at <= rays.box().hi[w] && !isBehind;
        EXPECT_EQ(isIn, n >= f.firstSlice() && n < f.endSlice()) << n;
      }
      // The faces' places among them: that of a slice at w is n.
      const double back = f.changeOfSlice().w > 0.0 ? rays.box().hi[w] : rays.box().lo[w];
      EXPECT_NEAR(f.backPlace(), (back - f.slice(0).w) / f.changeOfSlice().w, 1e-12);
      EXPECT_NEAR(f.backPlace() - f.frontPlace(), (rays.box().hi[w] - rays.box().lo[w]) * count, 1e-12);
      if (list.size() > 1) continue;
      // The fewest that are no farther apart along the view axis than the samples of a ray.
      const double apart = 1.0 / (count * std::abs(middle[w]));
      EXPECT_LE(apart, step * (1.0 + 1e-12));
      if (count > 1) {
        EXPECT_GT(apart * count / (count - 1), step * (1.0 - 1e-12));
      }
    }
  });
}

// Neighbouring rays that see the volume are at most a pixel over the supersampling apart where they are seen, and the
// rays cover what pixels see of the slices.
TEST(hbShearFactorisation, RaysAreAsDenseAsPixels) {
  int pairs = 0;
  forAllViews(
      [&](const hbGeometry& g, const hbScene& scene, const hbPixelRays& rays, int supersample, const auto& list) {
        const hbCamera& camera = *scene.camera;
        for (const hbShearFactorisation& f : list) {
          if (f.isEmpty()) continue;
          const auto at = [&](int i, int j) {
            return seen(camera, g, scene, f.point(f.slice(f.slices() - 1), f.u().at(i), f.v().at(j)));
          };
          const auto isInPicture = [&](const glm::dvec2& p) {
            return p.x >= 0.5 && p.x <= scene.width - 0.5 && p.y >= 0.5 && p.y <= scene.height - 0.5 &&
                   f.owns(p.x, p.y) && rays.clip(p.x, p.y);
          };
          const auto isInFront = [&](int i, int j) {
            return rays.distance(f.point(f.slice(f.slices() - 1), f.u().at(i), f.v().at(j))) > 1e-6;
          };
          for (int j = 0; j < f.v().count; ++j)
            for (int i = 0; i < f.u().count; ++i) {
              if (!isInFront(i, j)) continue;
              const glm::dvec2 here = at(i, j);
              for (const auto& [di, dj] : {std::pair(1, 0), {0, 1}}) {
                if (i + di >= f.u().count || j + dj >= f.v().count || !isInFront(i + di, j + dj)) continue;
                const glm::dvec2 next = at(i + di, j + dj);
                if (!isInPicture(here) || !isInPicture(next)) continue;
                ++pairs;
                // Where there are several directions the pixels' own rays were asked, not all between them.
                ASSERT_LE(glm::distance(here, next), (list.size() > 1 ? 2.0 : 1.0 + 1e-9) / supersample);
              }
            }
          for (int y = 0; y < scene.height; ++y)
            for (int x = 0; x < scene.width; ++x) {
              const double px = x + 0.5, py = y + 0.5;
              if (!f.owns(px, py)) continue;
              const glm::dvec2 base = f.base(px, py);
              bool meets = false;
              for (int n = f.firstSlice(); n < f.slices() && !meets; ++n) {
                const glm::dvec3 p = f.point(f.slice(n), base.x, base.y);
                meets = p == glm::clamp(p, rays.box().lo, rays.box().hi);
              }
              const hbShearFactorisation::Neighbours around = f.neighbours(px, py);
              double sum = 0.0;
              for (int k = 0; k < around.count; ++k) sum += around.weight[std::size_t(k)];
              if (meets) {
                ASSERT_NEAR(sum, 1.0, 1e-12) << px << " " << py;
              }
            }
        }
      });
  EXPECT_GT(pairs, 10000);
}

// Along an axis with the picture's edges along the others, every pixel has a ray of its own.
TEST(hbShearFactorisation, PixelsAreRaysAlongAnAxis) {
  const hbGeometry g = box({9, 17, 9}, {2.0, 3.0, 1.5});
  for (const Projection projection : {Projection::orthographic, Projection::perspective})
    for (const auto& [azimuth, elevation] : {std::pair(0.0, 0.0), {270.0, 0.0}, {0.0, 90.0}})
      for (const int supersample : {1, 2, 3}) {
        const hbScene scene = sceneOf(hbMode::xray, hbCamera::framing(g, azimuth, elevation, projection), 16, 12);
        const hbPixelRays rays(*scene.camera, scene.width, scene.height, g);
        const auto list = hbShearFactorisation::of(scene, g, rays, supersample);
        ASSERT_EQ(list.size(), 1U);
        std::set<std::size_t> used;
        for (int y = 0; y < scene.height; ++y)
          for (int x = 0; x < scene.width; ++x) {
            const hbShearFactorisation::Neighbours around = list[0].neighbours(x + 0.5, y + 0.5);
            if (around.count == 0) continue; // beside the volume
            ASSERT_EQ(around.count, 1);
            EXPECT_EQ(around.weight[0], 1.0);
            EXPECT_TRUE(used.insert(around.at[0]).second);
          }
        EXPECT_GT(used.size(), 40U);
      }
}

TEST(hbShearFactorisation, InsideIsWhatLiesBetweenFaces) {
  for (const double bend : {0.0, 0.01, -0.01})
    for (const double offset : {-0.5, 0.0, 0.25, 3.0})
      for (const double scale : {1.0, 0.125, 1e-9})
        for (const hbShearFactorisation::Faces& faces : {hbShearFactorisation::Faces{}, {0.25, 0.5}, {0.3, 0.31}}) {
          const hbShearFactorisation::Axis axis{-1.0, 0.0625, bend, 40};
          const auto [first, end] = hbShearFactorisation::inside(axis, offset, scale, faces);
          ASSERT_LE(first, end);
          for (int i = 0; i < axis.count; ++i) {
            const double u = offset + scale * axis.at(i);
            EXPECT_EQ(i >= first && i < end, u >= faces.lo && u <= faces.hi)
                << bend << " " << offset << " " << scale << " " << i;
            EXPECT_NEAR(axis.place(axis.at(i)), i, 1e-12);
            // 40 steps of 1/16 from -1 on.
            if (i >= 3) {
              EXPECT_NEAR(axis.from(3, 37).at(i - 3), axis.at(i), 1e-14);
            }
          }
        }
}

// Rays of a wide picture are projected rows whose pole lies near the picture's edge, which moving them onto the pixels
// must not cross: every ray that meets a slice has neighbours.
TEST(hbShearFactorisation, WideAnglesKeepTheirRays) {
  const hbGeometry g = box({9, 9, 9}, {1.0, 1.0, 1.0});
  std::mt19937 random(7);
  std::uniform_real_distribution<double> within(-1.0, 1.0);
  const auto anywhere = [&] { return glm::dvec3(within(random), within(random), within(random)); };
  for (int round = 0; round < 1000; ++round) {
    hbCamera camera;
    camera.projection = Projection::perspective;
    camera.position = glm::dvec3(g.cubeToWorld() * glm::dvec4(0.5 + 0.4 * anywhere(), 1.0));
    camera.target = camera.position + anywhere();
    camera.up = anywhere();
    camera.fieldOfView = round % 2 == 0 ? 160.0 : 170.0;
    const hbScene scene = sceneOf(hbMode::xray, camera, 14, 11);
    const hbPixelRays rays(camera, scene.width, scene.height, g);
    for (const hbShearFactorisation& f : hbShearFactorisation::of(scene, g, rays, 1))
      for (int y = 0; y < scene.height; ++y)
        for (int x = 0; x < scene.width; ++x) {
          const double px = x + 0.5, py = y + 0.5;
          if (!f.owns(px, py)) continue;
          const glm::dvec2 base = f.base(px, py);
          bool meets = false;
          for (int n = f.firstSlice(); n < f.slices() && !meets; ++n) {
            const glm::dvec3 p = f.point(f.slice(n), base.x, base.y);
            // Well inside the cube, so that rounding does not decide.
            meets = glm::all(glm::greaterThan(p, glm::dvec3(1e-6))) && glm::all(glm::lessThan(p, glm::dvec3(1 - 1e-6)));
          }
          EXPECT_TRUE(!meets || f.neighbours(px, py).count > 0) << round << " " << x << " " << y;
        }
  }
}
