// Facts about a bolt's bright core, asked of the product's own path.

#include "core_test.h"

#include <gtest/gtest.h>

#include <random>

#include "truth/truth.h"

namespace {

using namespace lightning::test;

TEST(LightningCore, IsTheIntegralOfItsDensityOverTheRay) {
  const unsigned seed = 20061123;
  std::mt19937 random(seed);
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  double worst = 0;
  int asked = 0;
  for (int scene = 0; scene < 100; ++scene) {
    const double away = std::pow(10, uniform(0, 3)),
                 radius = std::pow(10, uniform(-3, 0.5)),
                 pixel = scene % 3 ? std::pow(10, uniform(-4, -2)) : 0;
    const double size = away * std::pow(10, uniform(-2, 0));
    const auto place = [&](double x) {
      return Point{uniform(-x, x), uniform(-x, x), uniform(-x, x)};
    };
    const Point middle = away * unit(place(1)), p = middle + place(size),
                q = middle + place(size);
    const double r = radius / 2, s = std::hypot(r, kPixel * pixel * away);
    ThroughAir air(frame_of(pixel));
    air.add("lightning", line({p, q}, radius))
        .compile(1e-3, Isa(random() % (unsigned(best_isa()) + 1)));
    std::vector<Ray> rays;
    for (int i = 0; i < 24; ++i) {
      // Near some place of it, through or past it, ending anywhere about it; some from
      // beside the eye, and some along the stretch.
      const Point target = p + uniform(-.1, 1.1) * (q + -1. * p) + place(3 * s);
      const Point from = i % 4 == 1   ? place(0.3 * away)
                         : i % 8 == 3 ? p + -2. * (q + -1. * p) + place(s)
                                      : Point{};
      const double there = length(target + -1. * from);
      rays.push_back(toward(from, target,
                            i % 3 == 0   ? kInf
                            : i % 3 == 1 ? there + uniform(-4, 4) * s
                                         : uniform(0, 2) * there));
      if (!(rays.back().t > 0)) rays.back().t = float(there);
    }
    const auto got = air(rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const double want = light(p, q, r, pixel, rays[i]);
      // On the axis, for a ray at this angle to the stretch.
      const Point a = unit(q + -1. * p), d = {rays[i].d[0], rays[i].d[1], rays[i].d[2]};
      const double seen = std::min(
          kRoot2Pi * s / std::max(length(a + -dot(a, d) * d), 1e-9), length(q + -1. * p));
      const double peak = r * seen / (s * s * kRoot2Pi);
      // A place is a float relative to the eye, half an eps off; the light across the
      // core is exp(-x^2/2), whose steepest slope is 0.61.
      const Point o = {rays[i].o[0], rays[i].o[1], rays[i].o[2]};
      const double off = kEps / 2 * (away + size + length(o)) / s;
      const double error = std::max(0., std::abs(got[i].L[0] - want) - 0.61 * off * peak);
      worst = std::max(worst, error / peak);
      ++asked;
      EXPECT_LE(error, 1e-5 * peak) << "scene " << scene << ", ray " << i << ": "
                                    << got[i].L[0] << ", not " << want;
      EXPECT_EQ(got[i].T[0], 1);
    }
  }
  std::printf(
      "%d rays, seed %u: largest error %.1e of the peak, beside "
      "the rounding of places\n",
      asked, seed, worst);
}

TEST(LightningCore, ShowsItsRadianceWhereItIsWiderThanAPixel) {
  ThroughAir air(frame_of(1e-4));
  air.add("lightning", line({{-3, 0, 20}, {3, 0, 20}}, 0.4, "7,1,2")).compile();
  // (r/s) with r = 0.2, s^2 = r^2 + (0.65 x 1e-4 x 20)^2.
  const double share = 0.2 / std::hypot(0.2, 0.65e-4 * 20);
  const auto got = air({{0, 0, 0}, {0, 0, 1}, kInf});
  EXPECT_NEAR(got.L[0], 7 * share, 7e-6);
  EXPECT_NEAR(got.L[1], 1 * share, 1e-6);
  EXPECT_NEAR(got.L[2], 2 * share, 2e-6);
}

TEST(LightningCore, AShortRayWithinSeesWhatALongerOneDoesPerMetre) {
  // A kilometre wide, its axis 300 m from the eye: over t metres light changes by up to
  // 300 t / s^2 = 3e-4 t of itself.
  for (int set = 0; set <= int(best_isa()); ++set) {
    const Isa isa = Isa(set);
    ThroughAir air(frame_of(1e-4));
    air.add("lightning", line({{-900, 250, 160}, {1200, 250, 160}}, 2000, "1e6"))
        .compile(1e-3, isa);
    const auto per_metre = [&](float t) {
      return double(air({{0, 0, 0}, {0.6f, 0.8f, 0}, t}).L[0]) / double(t);
    };
    const double one = per_metre(1);
    for (const float t : {1e-6f, 1e-4f, 2e-3f, 0.05f})
      EXPECT_NEAR(per_metre(t) / one, 1, 3e-4 + 1e-5) << name(isa) << " " << t;
  }
}

TEST(LightningCore, ARowOfPixelsGetsTheSameLightAtAnyDistanceAndPlace) {
  // Int L dx = sqrt(2 pi) r per radiance, whatever the pixel: from 20 pixels wide to a
  // fiftieth of one.
  const double pixel = 1e-3, r = 0.05;
  for (const double away : {2.5, 20., 100., 1000., 2500.})
    for (const double shift : {0., 0.25, 0.5, 0.8}) {
      ThroughAir air(frame_of(pixel));
      air.add("lightning", line({{0, -away, away}, {0, away, away}}, 2 * r)).compile();
      double sum = 0;
      for (int i = -400; i <= 400; ++i) {
        const double x = (i + shift) * pixel;
        // Pixels evenly on the plane at the core's distance.
        sum += air(toward({}, {x * away, 0, away}, kInf)).L[0] * pixel * away;
      }
      EXPECT_NEAR(sum / (kRoot2Pi * r), 1, 1e-3) << away << ", " << shift;
    }
}

TEST(LightningCore, JointsShowNeitherKnotNorGap) {
  // The same straight line in one piece and in sixteen, resolved and not.
  for (const double radius : {0.01, 0.3, 3.}) {
    std::vector<Point> whole = {{-2, 1, 30}, {6, 3, 34}}, parts;
    for (int i = 0; i <= 16; ++i)
      parts.push_back(whole[0] + i / 16. * (whole[1] + -1. * whole[0]));
    ThroughAir one(frame_of(1e-3)), many(frame_of(1e-3));
    one.add("lightning", line(whole, radius)).compile();
    many.add("lightning", line(parts, radius)).compile();
    for (int i = 0; i <= 200; ++i) {
      const Point at = whole[0] + (i / 200.) * (whole[1] + -1. * whole[0]);
      const double a = one(toward({}, at, kInf)).L[0],
                   b = many(toward({}, at, kInf)).L[0];
      // A pixel's width changes by 1e-4 from one end of a stretch's share to the other.
      EXPECT_NEAR(b, a, 2e-4 * a) << radius << ", " << i;
    }
  }
}

TEST(LightningCore, ABendIsAsBrightAsTheRest) {
  // Along a zigzag with bends of 60 degrees, a pixel wide: what a pixel's Gaussian gets
  // of two arms is between one arm's light and what the longer way in it adds, 1/cos 30.
  const double pixel = 1e-3, away = 100;
  std::vector<Point> zigzag;
  for (int i = 0; i < 6; ++i)
    zigzag.push_back({(i % 2 ? .5774 : -.5774) * 2, 2. * i, away});
  ThroughAir air(frame_of(pixel));
  air.add("lightning", line(zigzag, 0.01)).compile();
  double least = kInf, most = 0;
  for (std::size_t k = 1; k < zigzag.size(); ++k)
    for (int i = k == 1 ? 20 : 0; i <= (k + 1 == zigzag.size() ? 80 : 100); ++i) {
      const Point at = zigzag[k - 1] + i / 100. * (zigzag[k] + -1. * zigzag[k - 1]);
      const double L = air(toward({}, at, kInf)).L[0];
      least = std::min(least, L);
      most = std::max(most, L);
    }
  EXPECT_GT(least / most, 0.8);
}

}  // namespace
