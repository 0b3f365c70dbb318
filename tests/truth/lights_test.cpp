// Light of suns and lamps in the truth, against closed forms and laws.

#include <gtest/gtest.h>

#include "support.h"

namespace brume {
namespace {

using namespace testing_truth;
using truth::along;
using truth::Answer;

brume_medium white(brume_medium m) {
  for (double& a : m.albedo) a = 1;
  return m;
}

TEST(TruthLights, ALampInThinFogGlowsLikeAnAngle) {
  // sigma -> 0: L = sigma I/(4 pi) Int ds / (h^2 + s^2) = sigma I/(4 pi h) (angle).
  const double sigma = 1e-12, h = .01, power = 1e12;
  const World w = world({white(fog(sigma))}, {lamp({h, 100, 0}, power)});
  const Answer a = along(w, {0, 0, 0}, {0, 1, 0}, 300);
  const double angle = std::atan(100 / h) + std::atan(200 / h);
  EXPECT_NEAR(a.L[0] / (sigma * power / (4 * M_PI * h) * angle), 1,
              1e-9);  // e^-tau: 3e-10
}

TEST(TruthLights, ALampLooksTheSameThroughFogFromBothEnds) {
  // Reciprocity of distance: a symmetric set-up read backwards gives the same L.
  const World w = world({white(fog(.01))}, {lamp({5, 50, 0}, 100, true)});
  const Answer a = along(w, {0, 0, 0}, {0, 1, 0}, 100);
  World back = w;
  back.eye = {0, 100, 0};
  const Answer b = along(back, {0, 100, 0}, {0, -1, 0}, 100);
  EXPECT_NEAR(a.L[0], b.L[0], 1e-9 * (1 + a.L[0]));
  EXPECT_GT(a.L[0], 1e-3);
}

TEST(TruthLights, AttenuatedSunInAHorizontalSlab) {
  // Fog z <= 0, sun at the zenith, seen from above: L = E p / 2 (1 - e^{-2 tau}).
  brume_medium m = white(fog(.05));
  m.shape = BRUME_HALF_SPACE;
  brume_light sun = lamp({}, 10, true);
  sun.kind = BRUME_SUN;
  sun.direction[2] = 1;
  const Answer a = along(world({m}, {sun}), {0, 0, 3}, {0, 0, -1}, 3 + 40);
  EXPECT_NEAR(a.L[0], 10 / (4 * M_PI) / 2 * -std::expm1(-2 * .05 * 40), 1e-8);
}

TEST(TruthLights, ASmallWorldBeforeALampIsSeenOnItsWays) {
  // A ball of fog, opaque, between a lamp and a ray in thin fog: points in its shadow get
  // nothing. Held against the sum over points of the same integrand, where the way of
  // each point is asked for itself (midpoint rule of 20000: the shadow's edges are
  // off by a step, 1e-4 of the whole).
  const World w =
      world({white(fog(1e-3)), bounded(fog(50), BRUME_ELLIPSOID, {2, 10, 0}, {1, 1, 1})},
            {lamp({4, 10, 0}, 100, true)});
  double sum = 0;
  const int n = 20000;
  for (int i = 0; i < n; ++i) {
    const double t = 20 * (i + .5) / n, r = std::hypot(4, 10 - t);
    const auto tau =
        truth::optical_depth(w, {0, t, 0}, {4 / r, (10 - t) / r, 0}, r, 1e-6);
    sum += 1e-3 * 100 / (4 * M_PI) / (r * r) * std::exp(-tau[0] - 1e-3 * t) * 20 / n;
  }
  const Answer a = along(w, {0, 0, 0}, {0, 1, 0}, 20);
  EXPECT_TRUE(a.converged);
  EXPECT_NEAR(a.L[0], sum, 2e-4 * sum);
}

TEST(TruthLights, ErrorsOfWaysAreToldToo) {
  // Fog with creases every 3 m, which no polynomial follows, lit from three places:
  // bright and near, far and faint, a sun.
  brume_medium m = white(fog(.02));
  m.profile = BRUME_CUSTOM;
  m.point = [](const void*, const double x[3], const double*, double* rho,
               double source[3]) {
    *rho = std::abs(std::sin(M_PI / 3 * (x[0] + .3 * x[1]))) +
           std::abs(std::sin(M_PI / 3 * (x[2] - .2 * x[0])));
    source[0] = source[1] = source[2] = 0;
  };
  World w = world({m, bounded(fog(.5), BRUME_BOX, {2, 6, 0}, {.5, 3, 2})},
                  {lamp({3, 9, 1}, 200, true), lamp({-20, 40, 9}, 5, true)});
  brume_light sun = lamp({}, 1, true);
  sun.kind = BRUME_SUN;
  sun.direction[0] = .6, sun.direction[2] = .8;
  // A sun of a fog without end is black: what it shines through ends at 10 m.
  for (auto& medium : w.media)
    if (medium.what.shape == BRUME_EVERYWHERE)
      medium.what = bounded(medium.what, BRUME_BOX, {0, 10, 0}, {10, 10, 10});
  w.lights.push_back({sun, 0, ""});
  const glm::dvec3 d{.1, .99, .05};
  const Answer best =
      along(w, {0, 0, 0}, d, 15, {.tolerance = 1e-8, .evaluations = 200'000'000});
  EXPECT_TRUE(best.converged);
  EXPECT_GT(best.L[0], .1);
  for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
    const Answer a = along(w, {0, 0, 0}, d, 15, {.tolerance = tolerance});
    EXPECT_TRUE(a.converged);
    EXPECT_LE(std::abs(a.L[0] - best.L[0]), a.L_error[0]) << tolerance;
    // Twenty pieces of the march and the ways to all of its points.
    EXPECT_LE(a.L_error[0], 20 * tolerance * (1 + best.L[0])) << tolerance;
    std::printf("tolerance %.0e: off by %.1e, told %.1e, %ld evaluations\n", tolerance,
                std::abs(a.L[0] - best.L[0]), a.L_error[0], a.evaluations);
  }
}

TEST(TruthLights, AShadowsEdgesAreCuts) {
  // Between them light is smooth, so that even a coarse march is right to many digits: 12
  // nodes in each part against the same with all parts halved until 1e-10.
  const World w =
      world({white(fog(.02)), bounded(fog(.5), BRUME_BOX, {2, 6, 0}, {.5, 3, 2}),
             bounded(fog(.2), BRUME_ELLIPSOID, {1, 12, 1}, {.7, 2, .9})},
            {lamp({3, 9, 1}, 200, true)});
  const glm::dvec3 d{.1, .99, .05};
  const Answer best = along(w, {0, 0, 0}, d, 15, {.tolerance = 1e-10});
  const Answer a = along(w, {0, 0, 0}, d, 15, {.tolerance = 1e-3});
  EXPECT_TRUE(a.converged && best.converged);
  EXPECT_NEAR(a.L[0], best.L[0], 1e-6);
}

TEST(TruthLights, WithinALargeLampLightTurnsAboutAtItsMiddle) {
  // Thin fog, a ray all but through the middle: as much light all along it, forward
  // before the foot and back behind it, however little of the ray lies there.
  const double g = .4, radius = 100, before = .0126, sigma = 1e-6, power = 1e6;
  brume_medium m = white(fog(sigma));
  m.g = g;
  brume_light l = lamp({6e-9, before, 0}, power);
  l.radius = radius;
  const World w = world({m}, {l});
  const auto p = [&](double mu) {
    return (1 - g * g) / (4 * M_PI * std::pow(1 + g * g - 2 * g * mu, 1.5));
  };
  for (const double behind : {1e-6, 1e-5, 1e-4, 1e-3, .1}) {
    const double L = along(w, {0, 0, 0}, {0, 1, 0}, before + behind).L[0];
    const double want =
        sigma * power / (radius * radius) * (before * p(1) + behind * p(-1));
    EXPECT_NEAR(L / want, 1, 1e-5) << behind;  // of .0126 m 2e-8 look askew
  }
}

TEST(TruthLights, ARayThatEndsInABodyFarAway) {
  // Half of a box on the ray, at its middle height, under a sun at the zenith: all points
  // see it through the same 50 m. Beyond the ray's end nobody told of the box's other
  // face.
  const double sigma = .01, depth = sigma * 50;
  brume_light sun = lamp({}, 10, true);
  sun.kind = BRUME_SUN;
  sun.direction[2] = 1;
  for (double at = 3e4; at < 1e6; at *= 1.3) {
    const World w =
        world({bounded(white(fog(sigma)), BRUME_BOX, {at, 0, 0}, {50, 50, 50})}, {sun});
    const Answer a = along(w, {0, 0, 0}, {1, 0, 0}, at);
    EXPECT_NEAR(a.L[0], 10 / (4 * M_PI) * std::exp(-depth) * -std::expm1(-depth), 1e-8)
        << at;
  }
}

TEST(TruthLights, ADenseBodyIsLitWhereTheRayEntersIt) {
  // A box of 10.8 per metre begins 390 m away; the lamp hangs 830 m below the eye, so
  // that its ways through the box are 1/cos as long as the ray's: Int sigma e^-(1 +
  // 1/cos) tau. Of distances and angles along the first metre the rest is 1e-3. At every
  // node of a polynomial along the ray the ways are black.
  const World w =
      world({bounded(white(fog(10.8)), BRUME_BOX, {0, 1075, 0}, {300, 685, 3600})},
            {lamp({0, 0, -830}, 1e8, true)});
  const double r = std::hypot(390., 830.), p = 1 / (4 * M_PI);
  const Answer a = along(w, {0, 0, 0}, {0, 1, 0}, 1080);
  EXPECT_NEAR(a.L[0] / (p * 1e8 / (r * r) / (1 + r / 390)), 1, 1e-3);
  EXPECT_TRUE(a.converged);
}

TEST(TruthLights, AThousandBodiesBetweenAreTheFewOnTheWay) {
  // Small balls of fog about a ray and its lamp. Single scattering by the midpoint rule
  // of 4000 with each ball's chord, x - y/2 sqrt... by hand: |chord| = 2 sqrt(r^2 - h^2)
  // clipped to the way. Kinks at tangents leave the rule 1e-5.
  World w = world({white(fog(.01))}, {lamp({3, 12, 1}, 100, true)});
  const double r = .3, sigma = .8;
  std::vector<glm::dvec3> at;
  for (int i = 0; i < 1000; ++i) {
    at.push_back({-8 + 1.7 * (i % 10) + .13 * (i / 100), 1 + 2.1 * (i / 10 % 10),
                  -8 + 1.6 * (i / 100)});
    w.media.push_back(
        {bounded(fog(sigma), BRUME_ELLIPSOID, at.back(), {r, r, r}), 1, ""});
  }
  const auto depth = [&](const glm::dvec3& a, const glm::dvec3& b) {
    const double length = glm::length(b - a);
    const glm::dvec3 u = (b - a) / length;
    double tau = .01 * length;
    for (const glm::dvec3& c : at) {
      const double foot = glm::dot(c - a, u), h2 = glm::dot(c - a, c - a) - foot * foot;
      if (h2 >= r * r) continue;
      const double half = std::sqrt(r * r - h2);
      tau +=
          sigma * std::max(std::min(foot + half, length) - std::max(foot - half, 0.), 0.);
    }
    return tau;
  };
  const glm::dvec3 d = glm::normalize(glm::dvec3(.05, 1, .02));
  const int n = 8000;
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const glm::dvec3 x = 20 * (i + .5) / n * d, to = glm::dvec3(3, 12, 1) - x;
    // The balls answer to no light, only take it.
    sum += .01 * 100 / (4 * M_PI) / glm::dot(to, to) *
           std::exp(-depth(x, {3, 12, 1}) - depth({0, 0, 0}, x)) * 20 / n;
  }
  const Answer a =
      along(w, {0, 0, 0}, d, 20, {.tolerance = 1e-6, .evaluations = 300'000});
  EXPECT_TRUE(a.converged);
  EXPECT_NEAR(a.L[0], sum, 1e-4 * sum);
  std::printf("%.8g by the sum, %.8g in %ld evaluations\n", sum, a.L[0], a.evaluations);
}

TEST(TruthLights, WhatStopsEarlySaysHowFarItIs) {
  // Twenty lamps behind each other in fog that thins: the fewer evaluations, the larger
  // the error it admits, and no less than the one it has.
  World w = world({white(height_fog(.05, .1))});
  for (int i = 0; i < 20; ++i)
    w.lights.push_back({lamp({.1, 5. * i, .3}, 50, true), 0, ""});
  const glm::dvec3 d{0, .8, .6};
  const Answer all = along(w, {0, 0, 0}, d, 80);
  EXPECT_TRUE(all.converged);
  int stopped = 0;
  for (const long most : {50L, 1000L, 20000L, all.evaluations / 2}) {
    const Answer a = along(w, {0, 0, 0}, d, 80, {.evaluations = most});
    EXPECT_FALSE(a.converged);
    EXPECT_LE(a.evaluations, 2 * most + 36 * 30);
    stopped += a.L_error[0] == kInf;
    EXPECT_GE(a.L_error[0], std::abs(a.L[0] - all.L[0]));
    EXPECT_GE(a.T_error[0], std::abs(a.T[0] - all.T[0]));
  }
  EXPECT_GT(stopped, 0);
  EXPECT_LT(stopped, 4);
}

TEST(TruthLights, EveryPhaseFunctionIsOneOverTheSphere) {
  // A sky of many suns of radiance 1 gives an albedo-1 medium the source 1.
  for (const auto kind :
       {BRUME_HENYEY_GREENSTEIN, BRUME_RAYLEIGH, BRUME_CORNETTE_SHANKS}) {
    brume_medium m = white(fog(1));
    m.phase = kind;
    m.g = -.6;
    World w = world({m});
    const int n = 400;
    for (int i = 0; i < n; ++i) {
      const double z = -1 + (2 * i + 1.) / n, s = std::sqrt(1 - z * z);
      brume_light sun = lamp({}, 4 * M_PI / n);
      sun.kind = BRUME_SUN;
      sun.direction[0] = s, sun.direction[1] = 0, sun.direction[2] = z;
      w.lights.push_back({sun, 0, ""});
    }
    const Answer a = along(w, {0, 0, 0}, {0, 0, 1}, kInf);
    EXPECT_NEAR(a.L[0], 1, 2e-4)
        << kind;  // midpoint rule of 400: (1 + g)/(1 - g)^2 / n^2
  }
}

TEST(TruthLights, ASpotLightsItsConeOnly) {
  // Straight down from 10 m, half angle 30 degrees, hard: lit where |x| < 10 tan 30.
  brume_light spot = lamp({0, 0, 10}, 5);
  spot.kind = BRUME_SPOT;
  spot.cone = M_PI / 6;
  const World w = world({white(fog(1e-9))}, {spot});
  const double x = 10 * std::tan(M_PI / 6);
  const Answer a = along(w, {-100, 0, 0}, {1, 0, 0}, 200);
  const double angle = 2 * std::atan(x / 10);
  EXPECT_NEAR(a.L[0], 1e-9 * 5 / (4 * M_PI * 10) * angle, 1e-16);
  EXPECT_EQ(along(w, {-100, 0, 11}, {1, 0, 0}, 200).L[0], 0);  // behind it
}

TEST(TruthLights, AnInterfaceReflectsOnceAndLetsTheRestThrough) {
  // A mirror-like plane y = 10, R = .3, in uniform fog: L, T by hand.
  World w = world({fog(.1, 2)});
  brume_interface plane = {};
  plane.size = sizeof plane;
  plane.hit = [](const void*, const brume_rays* r, float* t, float* nx, float* ny,
                 float* nz, float* R) {
    for (std::size_t i = 0; i < r->n; ++i) {
      const float o = r->oy ? r->oy[i] : 0;
      t[i] = r->dy[i] > 0 && o < 10 ? (10 - o) / r->dy[i] : INFINITY;
      nx[i] = nz[i] = 0, ny[i] = -1, R[i] = .3f;
    }
  };
  w.interfaces.push_back({plane, 0, ""});
  const Answer a = along(w, {0, 0, 0}, {0, 1, 0}, 30);
  const double T1 = std::exp(-1.), T2 = std::exp(-2.), R = double(.3f);
  EXPECT_NEAR(a.T[0], T1 * (1 - R) * T2, 1e-9);
  EXPECT_NEAR(a.L[0], 2 * (1 - T1) + T1 * (R * 2 + (1 - R) * 2 * (1 - T2)), 1e-8);
}

}  // namespace
}  // namespace brume
