// A bolt's core in the pixels of every projection: as wide in all of them, and of the
// same light.

#include <gtest/gtest.h>

#include <glm/gtc/constants.hpp>
#include <random>

#include "../../tests/stage/through_air.h"
#include "truth/truth.h"

namespace {

using namespace brume;
using namespace brume::test;
using glm::dvec3;

constexpr double kPixel = 0.65;  // of a pixel: the Gaussian that it is (README, eq. 4)

// 64 x 32 degrees of a perspective view's 120, metres, or all around: pixels of a degree,
// a decimetre, a degree.
View view_of(Projection projection) {
  View v;
  v.projection = projection;
  v.eye = {100, -20, 3};
  v.display = {0, 0, 360, 180};
  if (projection == Projection::latlong) {
    v.corner = {-0.5, 0.25, 0};
    v.across = {1. / 360, 0, 0};
    v.down = {0, -1. / 360, 0};
    return v;
  }
  const bool fan = projection == Projection::perspective;
  v.across = (fan ? 0.01 : 0.1) * v.right;
  v.down = (fan ? -0.01 : -0.1) * v.up;
  v.corner = -180. * v.across - 90. * v.down + (fan ? v.forward : dvec3(0));
  return v;
}

FrameInfo seen_by(const View& view) {
  FrameInfo f;
  f.look(view);
  return f;
}

Ray ray_of(const View& view, double x, double y) {
  const View::RayAt at = view.ray(x, y);
  Ray ray;
  for (int k = 0; k < 3; ++k) {
    ray.o[k] = float(at.origin[k] - view.eye[k]);
    ray.d[k] = float(at.direction[k]);
  }
  ray.t = std::numeric_limits<float>::infinity();
  return ray;
}

Set line(const dvec3& from, const dvec3& to, double radius) {
  return {{"form", "line"},
          {"points", text(from.x, from.y, from.z) + "," + text(to.x, to.y, to.z)},
          {"intensity", "0"},
          {"core_radiance", "1"},
          {"core_radius", text(radius)}};
}

TEST(LightningPixels, TheCoreIsAsManyPixelsWideEverywhere) {
  // Straight stretches through the middle of a pixel, upright and level, leaning and
  // going away from the eye: a row (of level ones a column) across them has the Gaussian
  // of 0.65 pixels square to them, as a parallelogram cuts it. Up to 85 degrees high, and
  // 61 degrees off a perspective view's axis.
  struct Place {
    Projection projection;
    double x, y;
  };
  double worst = 0;
  for (const Place& p : {Place{Projection::latlong, 180, 90},
                         {Projection::latlong, 20, 45},
                         {Projection::latlong, 200, 20},
                         {Projection::latlong, 300, 10},
                         {Projection::latlong, 70, 174},
                         {Projection::perspective, 180, 90},
                         {Projection::perspective, 355, 90},
                         {Projection::perspective, 340, 12},
                         {Projection::orthographic, 30, 30}})
    for (const double turn : {0., 45., 90., 120.})
      for (const double away : {1., 1.3}) {
        const View view = view_of(p.projection);
        const double a = turn * glm::pi<double>() / 180, x = p.x + 0.5, y = p.y + 0.5;
        // Square to the pixel's own axes: 0.02 pixels to both sides, made a hundred
        // times as long, which is four pixels each way at 100 m.
        const auto at = [&](double s, double t) {
          const View::RayAt r = view.ray(x + s * std::cos(a), y + s * std::sin(a));
          return r.origin + t * r.direction;
        };
        const dvec3 middle = (at(-.02, 100) + at(.02, 100 * away)) / 2.;
        const dvec3 way = 200. * (at(.02, 100) - at(-.02, 100)) +
                          (away - 1) * 10 * view.ray(x, y).direction;
        ThroughAir air(seen_by(view));
        air.add("lightning", line(middle - way, middle + way, 1e-3)).compile();
        const bool rows = turn > 40 && turn < 140;  // it stands rather than lies
        double sum = 0, first = 0, second = 0;
        for (int i = -8; i <= 8; ++i) {
          const double L = air(ray_of(view, x + (rows ? i : 0), y + (rows ? 0 : i))).L[0];
          sum += L, first += i * L, second += i * i * L;
        }
        const double variance = second / sum - first / sum * (first / sum);
        const double slant = rows ? std::sin(a) : std::cos(a);
        const double got = std::sqrt(variance) * std::abs(slant);
        // Of a Gaussian of 0.65 pixels by sums: 0.4 %. Of a great circle near a pole, or
        // of a line whose pixels change across it: 2 %.
        EXPECT_NEAR(got, kPixel, 0.02 * kPixel)
            << int(p.projection) << " (" << p.x << ", " << p.y << ") " << turn << " "
            << away;
        worst = std::max(worst, std::abs(got / kPixel - 1));
      }
  std::printf("largest error of a width %.1e\n", worst);
}

TEST(LightningPixels, TheSameBoltGivesTheSameLightAtTheHorizonAndNearThePole) {
  // Twelve metres at 100 m, far thinner than a pixel: Sum L Omega over the pixels of a
  // latlong is radiance x sqrt(2 pi) r x length / distance^2, in the mean over where
  // between pixels it lies (its ends are as sharp as it is narrow).
  const View view = view_of(Projection::latlong);
  const double r = 0.005, t = 100, half = 6, pixel = glm::two_pi<double>() / 360;
  double worst = 0;
  for (const double elevation : {0., 30., 60., 80., 86.})
    for (const double turn : {0., 90., 30.}) {
      constexpr int kShifts = 8;
      double sum = 0;
      for (int shift = 0; shift < kShifts; ++shift) {
        const double a = glm::radians(turn), y = 90 - elevation + (shift + .5) / kShifts;
        const dvec3 d = view.ray(200 + 0.37 * shift, y).direction;
        const dvec3 east = glm::normalize(glm::cross(d, view.up)),
                    north = glm::cross(east, d);
        const dvec3 way = half * (std::cos(a) * east + std::sin(a) * north);
        ThroughAir air(seen_by(view));
        air.add("lightning", line(view.eye + t * d - way, view.eye + t * d + way, 2 * r))
            .compile();
        for (int j = std::max(0, int(y) - 12); j < std::min(180., y + 12); ++j) {
          std::vector<Ray> row;
          for (int i = 0; i < 360; ++i) row.push_back(ray_of(view, i + .5, j + .5));
          double light = 0;
          for (const Answer& got : air(row)) light += double(got.L[0]);
          sum += light * pixel * pixel * std::cos(pixel * (90 - j - .5)) / kShifts;
        }
      }
      // Seen from t, its ends are farther off: the mean of (1 + (u/t)^2)^-3/2 over it.
      const double want = std::sqrt(glm::two_pi<double>()) * r * 2 * half / (t * t) *
                          (1 - half * half / (2 * t * t));
      // A Gaussian of 0.65 pixels by sums over rows and columns: 5e-4 each. At 86 degrees
      // pixels narrow by a quarter from row to row.
      EXPECT_NEAR(sum / want, 1, elevation > 80 ? 5e-3 : 2e-3)
          << elevation << ", " << turn;
      worst = std::max(worst, std::abs(sum / want - 1));
    }
  std::printf("largest error of the light %.1e\n", worst);
}

TEST(LightningPixels, TheTruthSeesThePixelsThatKernelsDo) {
  std::mt19937 random(5);
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  double worst = 0;
  int met = 0;
  for (int scene = 0; scene < 60; ++scene) {
    const View view = view_of(Projection(scene % 3));
    const auto place = [&] {
      const View::RayAt r = view.ray(uniform(0, 360), uniform(0, 180));
      return r.origin + std::exp(uniform(0, 6)) * r.direction;
    };
    const dvec3 p = place(), q = scene % 4 ? place() : p + 1e-3 * (place() - p);
    ThroughAir air(seen_by(view));
    air.add("lightning", line(p, q, std::exp(uniform(-6, 0))))
        .compile(1e-3, Isa(random() % (unsigned(best_isa()) + 1)));
    for (int i = 0; i < 12; ++i) {
      // Near some place of it; one of four from beside the eye.
      const dvec3 on = p + uniform(0, 1) * (q - p);
      const bool flat = view.projection == Projection::orthographic;
      dvec3 o =
          flat ? on - glm::dot(on - view.eye, view.forward) * view.forward : view.eye;
      if (i % 4 == 0) o += dvec3(uniform(-2, 2), uniform(-2, 2), uniform(-2, 2));
      const double t = glm::length(on - o);
      dvec3 d = (on - o) / t;
      if (flat && i % 4) d = view.forward;
      d = glm::normalize(d + (flat ? 0.01 / t : 0.005) *
                                 dvec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)));
      Ray ray;
      for (int k = 0; k < 3; ++k) {
        ray.o[k] = float(o[k] - view.eye[k]);
        ray.d[k] = float(d[k]);
      }
      ray.t = std::numeric_limits<float>::infinity();
      const auto want =
          truth::along(air.world(), view.eye + dvec3(ray.o[0], ray.o[1], ray.o[2]),
                       {ray.d[0], ray.d[1], ray.d[2]}, ray.t, {.tolerance = 1e-6});
      const double got = air(ray).L[0];
      ASSERT_TRUE(std::isfinite(got));
      if (!want.converged) continue;
      EXPECT_NEAR(got, want.L[0], 1e-3 * (1 + want.L[0])) << scene << ", " << i;
      met += want.L[0] > 1e-3;
      worst = std::max(worst, std::abs(got - want.L[0]) / (1 + want.L[0]));
    }
  }
  EXPECT_GE(met, 100);  // or it said nothing
  std::printf("%d rays meet a core: largest error %.1e\n", met, worst);
}

}  // namespace
