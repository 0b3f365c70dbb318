// The truth against what is known in closed form. Tolerances: what was asked of it (1e-9
// by default), unless a line says more.

#include <gtest/gtest.h>

#include <random>

#include "support.h"

namespace brume {
namespace {

using namespace testing_truth;
using truth::along;
using truth::Answer;

constexpr glm::dvec3 kEye{0, 0, 0};

TEST(Truth, EmptyAirIsClear) {
  const Answer a = along({}, kEye, {1, 2, 3}, kInf);
  EXPECT_EQ(a.T[0], 1);
  EXPECT_EQ(a.L[0], 0);
  EXPECT_TRUE(a.converged);
}

TEST(Truth, UniformFogHidesAsBeerAndLambertSay) {
  const World w = world({fog(0.02, 3)});
  for (const double t : {0., 1e-9, 1., 30., 400., 1e4}) {
    const Answer a = along(w, kEye, {0, 1, 0}, t);
    const double tau = 0.02 * t;
    EXPECT_NEAR(a.T[0], std::exp(-tau), 1e-12);
    EXPECT_NEAR(a.L[0], -3 * std::expm1(-tau), 1e-9) << t;
  }
}

TEST(Truth, StiffFogIsAWallOfItsColour) {
  for (const double sigma : {1e2, 1e6, 1e20, 1e300})
    for (const double t : {1e4, 1e30, kInf}) {
      const Answer a = along(world({fog(sigma, 7)}), kEye, {0, 0, 1}, t);
      EXPECT_LT(a.T[0], 1e-80);  // the march ends at e^-200
      EXPECT_NEAR(a.L[0], 7, 7e-9) << sigma << " over " << t;
      EXPECT_TRUE(a.converged);
    }
}

TEST(Truth, AWallBehindAGapIsStillAWall) {
  // 1e20 per metre 100 m away: thinner than the numbers there.
  const World w = world({bounded(fog(1e20, 7), BRUME_BOX, {0, 0, 150}, {9, 9, 50})});
  const Answer a = along(w, kEye, {0, 0, 1}, 1e3);
  EXPECT_NEAR(a.L[0], 7, 7e-9);
  EXPECT_LT(a.T[0], 1e-80);
}

TEST(Truth, HeightFogOverHeightsAndSlopes) {
  // tau = sigma e^{-c z} t exprel(-c mu t); rounding of c z in double: 1e-16 x 1e4.
  std::mt19937_64 random(7);
  RecordProperty("seed", 7);
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  double worst = 0;
  for (int i = 0; i < 400; ++i) {
    const double c = std::pow(10, uniform(-5, 3)), z = uniform(-20, 20) / c;
    const double sigma = std::pow(10, uniform(-6, 2)), t = std::pow(10, uniform(-3, 6));
    const double mu = i % 5 == 0 ? 0 : uniform(-1, 1) * std::pow(10, -uniform(0, 8));
    World w = world({height_fog(sigma, c, 2)});
    w.eye = {3, -4, z};
    const glm::dvec3 d(std::sqrt((1 - mu) * (1 + mu)), 0, mu);
    const Answer a = along(w, w.eye, d, t);
    const long double x = (long double)c * mu * t;
    const long double tau =
        sigma * std::exp(-(long double)c * z) * t * (x == 0 ? 1 : -std::expm1(-x) / x);
    const double T = double(std::exp(-tau)), L = double(-2 * std::expm1(-tau));
    worst = std::max({worst, std::abs(a.T[0] - T), std::abs(a.L[0] - L) / (1 + L)});
    EXPECT_NEAR(a.T[0], T, 1e-9 + a.T_error[0]) << c << " " << z << " " << mu << " " << t;
    EXPECT_NEAR(a.L[0], L, 3e-9) << c << " " << z << " " << mu << " " << t;
  }
  EXPECT_LT(worst, 1e-9);
  RecordProperty("worst", std::to_string(worst));
}

TEST(Truth, ALayerThinnerThanTheStepIsSeen) {
  // A ray that ends just inside fog of 1e-3 m scale, 1 km below it.
  const World w = world({height_fog(1, 1e3, 1)});
  for (const double deep : {0., 1e-3, 5e-3}) {
    const Answer a = along(w, {0, 0, 1000}, {0, 0, -1}, 1000 + deep);
    const double tau = std::exp(1e3 * deep) * 1e-3;
    EXPECT_NEAR(a.T[0], std::exp(-tau), 1e-9);
  }
}

TEST(Truth, UpwardThereIsAnEndToHeightFog) {
  const Answer a = along(world({height_fog(0.01, 1e-3, 1)}), kEye, {0.6, 0, 0.8}, kInf);
  const double tau = 0.01 / (1e-3 * 0.8);
  EXPECT_NEAR(a.T[0], std::exp(-tau), 1e-9);
  EXPECT_NEAR(a.L[0], -std::expm1(-tau), 1e-9);
}

TEST(Truth, DownwardItIsMetHoweverFar) {
  // 8000 scale heights above a fog, e^-8000 of its density, on a way without end that
  // falls by 1e-25: depth .01 at 8e28 m.
  World w = world({height_fog(1e-2, 1, 2)});
  w.eye = {0, 0, 8e3};
  const Answer a = along(w, w.eye, {1, 0, -1e-25}, kInf);
  EXPECT_LT(a.T[0], 1e-80);
  EXPECT_NEAR(a.L[0], 2, 2e-9);
  w.media[0].what.max_opacity = 0.5;
  EXPECT_NEAR(along(w, w.eye, {1, 0, -1e-25}, kInf).T[0], 0.5, 1e-9);
}

TEST(Truth, LorentzianFarAndNear) {
  brume_medium m = fog(0.3, 1);
  m.profile = BRUME_LORENTZIAN;
  m.falloff = 4e4;  // half density 5 mm from the axis
  m.origin[0] = 1e-3;
  m.origin[1] = 500;
  const Answer a = along(world({m}), kEye, {0, 1, 0}, kInf);
  // Int ds / (1 + f (h^2 + s^2)) = q (atan(inf) + atan(f q 500)), q = 1/sqrt(f (1 + f
  // h^2))
  const double h2 = 1e-6, f = 4e4, q = 1 / std::sqrt(f * (1 + f * h2));
  const double tau = 0.3 * q * (M_PI / 2 + std::atan(f * q * 500));
  EXPECT_NEAR(a.T[0], std::exp(-tau), 1e-12);
}

TEST(Truth, TwoFogsThatShareFiftyMetres) {
  // sigma .02 with source 1, .05 with source .2 (DESIGN "Air is one integral").
  const World w = world({fog(.02, 1), fog(.05, .2)});
  const Answer a = along(w, kEye, {1, 0, 0}, 50);
  EXPECT_NEAR(a.L[0], (.02 * 1 + .05 * .2) / .07 * -std::expm1(-.07 * 50), 1e-9);
  truth::Options first, second;
  first.only_stage = 0, second.only_stage = 1;
  EXPECT_NEAR(along(w, kEye, {1, 0, 0}, 50, first).L[0] +
                  along(w, kEye, {1, 0, 0}, 50, second).L[0],
              a.L[0], 1e-9);
}

TEST(Truth, BoxAndEllipsoidFarFromTheOrigin) {
  // Chords known by hand: the box 20 m, the ellipsoid 2 x 30 sqrt(1 - (6/10)^2) m.
  const glm::dvec3 far(6.4e6, -3e6, 2e6);
  World w = world(
      {bounded(fog(.01), BRUME_BOX, far + glm::dvec3(0, 100, 0), {5, 10, 5}),
       bounded(fog(.02), BRUME_ELLIPSOID, far + glm::dvec3(6, 300, 0), {10, 30, 10})});
  w.eye = far;
  const Answer a = along(w, far, {0, 1, 0}, kInf);
  EXPECT_NEAR(a.T[0], std::exp(-.01 * 20 - .02 * 60 * .8), 1e-9);
}

TEST(Truth, StartAndMaxOpacityAreBoundaries) {
  brume_medium m = height_fog(.01, 1e-3, 1);
  m.start = 30;
  m.max_opacity = .5;
  m.extinction[1] = .02;  // each colour ends where it hides half
  m.extinction[2] = 0;
  const World w = world({m});
  EXPECT_EQ(along(w, kEye, {0, 1, 0}, 30).T[0], 1);
  EXPECT_NEAR(along(w, kEye, {0, 1, 0}, 40).T[0], std::exp(-.1), 1e-9);
  for (const glm::dvec3 d : {glm::dvec3(0, 1, 0), glm::dvec3(0, .8, -.6)}) {
    const Answer a = along(w, kEye, d, 1e9);
    for (int c = 0; c < 2; ++c) EXPECT_NEAR(a.T[c], .5, 1e-11);
    for (int c = 0; c < 2; ++c) EXPECT_NEAR(a.L[c], .5, 1e-9);
    EXPECT_EQ(a.T[2], 1);
  }
}

TEST(Truth, ThinFogEndsWhereItHidesHalfToo) {
  // ln 2 / 1e-7 m from the eye, on a ray without end.
  brume_medium m = fog(1e-7, 1);
  m.max_opacity = .5;
  EXPECT_NEAR(along(world({m}), kEye, {0, 0, 1}, kInf).L[0], .5, 1e-9);
}

TEST(Truth, ACapNearTheEyeIsFoundOnARayOfAnyLength) {
  // Waves of 30 cm that are over after some metres, before a cap ends the fog: on a ray
  // of 1000 km they are far narrower than what is looked at first.
  brume_medium m = fog(.004, 1);
  m.profile = BRUME_CUSTOM;
  m.max_opacity = .05;
  m.point = [](const void*, const double x[3], const double*, double* rho,
               double source[3]) {
    *rho = 1 + 2 * std::exp(-x[1] * x[1]) * (1 + std::cos(20 * x[1]));
    source[0] = source[1] = source[2] = 0;
  };
  for (const double end : {1e2, 1e4, 1e6, 1e9, kInf}) {
    const Answer a = along(world({m}), kEye, {0, 1, 0}, end);
    EXPECT_TRUE(a.converged) << end;
    EXPECT_NEAR(a.T[0], .95, 1e-8) << end;
    EXPECT_NEAR(a.L[0], .05, 1e-8) << end;
  }
}

TEST(Truth, ACapInALayerFarAwayIsFound) {
  // Fog that grows by e in 40 cm, and ends where it hides 70 %, 100 m to 100 km away.
  brume_medium m = fog(.004, 1);
  m.profile = BRUME_CUSTOM;
  m.max_opacity = .7;
  m.falloff = 2.5;
  m.direction[1] = -1, m.direction[2] = 0;
  static double away;
  m.point = [](const void*, const double x[3], const double*, double* rho,
               double source[3]) {
    *rho = std::exp(2.5 * (x[1] - away));
    source[0] = source[1] = source[2] = 0;
  };
  for (int i = 0; i < 60; ++i) {
    away = std::pow(10, 2 + i / 20.);
    const Answer a = along(world({m}), kEye, {0, 1, 0}, 10.7 * away);
    EXPECT_TRUE(a.converged) << away;
    EXPECT_NEAR(a.T[0], .3, 1e-7) << away;
  }
}

TEST(Truth, WeightsScaleAStage) {
  const double half[] = {.5};
  truth::Options o;
  o.weights = half;
  EXPECT_NEAR(along(world({fog(.1, 1)}), kEye, {0, 0, 1}, 10, o).T[0], std::exp(-.5),
              1e-12);
}

TEST(Truth, MediaBesideTheRayCostNothing) {
  // 2000 boxes and balls, none on the ray, though the planes of their faces cross it.
  World w = world({height_fog(.01, .02, 1)});
  const Answer alone = along(w, kEye, {0, .8, .6}, 200);
  for (int i = 0; i < 2000; ++i)
    w.media.push_back({bounded(fog(1, 5), i % 2 ? BRUME_BOX : BRUME_ELLIPSOID,
                               {20 + i % 7, .1 * i, .05 * i}, {9, 3, 3}),
                       0, ""});
  const Answer among = along(w, kEye, {0, .8, .6}, 200);
  EXPECT_EQ(among.evaluations, alone.evaluations);
  EXPECT_EQ(among.L[0], alone.L[0]);
  EXPECT_EQ(among.T[0], alone.T[0]);
}

// exp(-|x - at|^2 / 2 s^2) in a box of six s about it.
struct Blob {
  glm::dvec3 at;
  double s;
};
brume_medium shining(const Blob& b, double emission) {
  brume_medium m = bounded(fog(0), BRUME_BOX, b.at, glm::dvec3(6 * b.s));
  m.profile = BRUME_CUSTOM;
  for (double& e : m.emission) e = emission;
  m.self = &b;
  m.point = [](const void* self, const double x[3], const double*, double* rho,
               double source[3]) {
    const Blob& blob = *static_cast<const Blob*>(self);
    const glm::dvec3 v = glm::dvec3(x[0], x[1], x[2]) - blob.at;
    *rho = std::exp(-glm::dot(v, v) / (2 * blob.s * blob.s));
    source[0] = source[1] = source[2] = 0;
  };
  return m;
}

TEST(Truth, HundredsOfGaussiansOnARayAreTheirSum) {
  // A core of lightning: narrow and wide, over each other, a few on the ray at a time. In
  // clear air, Int exp(-(h^2 + t^2)/2s^2) dt = sqrt(2 pi) s exp(-h^2/2s^2) erf(6/sqrt 2);
  // the box's ends are 2e-9 of it. In fog the light that is there is dimmed.
  std::vector<Blob> blobs;
  double clear = 0, dimmed = 0;
  const double sigma = 1e-3;
  for (int i = 0; i < 400; ++i) {
    const double s = std::pow(10, -2 + i % 5 * .4), h = i % 3 * s;
    blobs.push_back({{h, 5 + 1.3 * i, 0}, s});
    const double own =
        std::sqrt(2 * M_PI) * s * std::exp(-h * h / (2 * s * s)) * std::erf(6 / M_SQRT2);
    clear += own;
    // Int e^(-sigma t) of a Gaussian about t0: e^(-sigma t0 + sigma^2 s^2/2).
    dimmed += own * std::exp(-sigma * (5 + 1.3 * i) + sigma * sigma * s * s / 2);
  }
  World w;
  for (const Blob& b : blobs) w.media.push_back({shining(b, 2), 0, ""});
  truth::Options o;
  o.tolerance = 1e-5;
  o.evaluations = 100'000;
  for (const double end : {1e3, kInf}) {
    const Answer a = along(w, kEye, {0, 1, 0}, end, o);
    EXPECT_TRUE(a.converged);
    EXPECT_NEAR(a.L[0], 2 * clear, 1e-6 * clear);
  }
  w.media.push_back({fog(sigma), 1, ""});
  const Answer a = along(w, kEye, {0, 1, 0}, 1e3, o);
  EXPECT_TRUE(a.converged);
  EXPECT_NEAR(a.L[0], 2 * dimmed, 1e-6 * dimmed);
}

TEST(Truth, AFarGaussianIsSeen) {
  // Alone on a ray without end, a hundred thousandth of its distance wide.
  for (const double far : {20., 2e3, 2e5}) {
    const Blob b{{0, far, 0}, 1e-5 * far};
    World w;
    w.media.push_back({shining(b, .1 / b.s), 0, ""});
    for (const double end : {2 * far, kInf})
      EXPECT_NEAR(along(w, kEye, {0, 1, 0}, end, {.tolerance = 1e-5}).L[0],
                  .1 * std::sqrt(2 * M_PI), 1e-7);
  }
}

TEST(Truth, WhatShinesAtItsEndsOrBeyondThemEndsThere) {
  // Waves of light in the box 10 <= y <= 11, in fog: sin^2 is nothing at the box's faces
  // and goes on outside, cos^2 jumps there. Both: Int_10^11 = 1/2, and another box cuts
  // their pieces.
  for (const bool jumps : {false, true}) {
    brume_medium m = bounded(fog(0), BRUME_BOX, {0, 10.5, 0}, {1, .5, 1});
    m.profile = BRUME_CUSTOM;
    for (double& e : m.emission) e = 1;
    m.self = &jumps;
    m.point = [](const void* self, const double x[3], const double*, double* rho,
                 double source[3]) {
      const double phase = *static_cast<const bool*>(self) ? M_PI / 2 : 0;
      *rho = std::pow(std::sin(M_PI * x[1] + phase), 2);
      source[0] = source[1] = source[2] = 0;
    };
    const World w =
        world({m, fog(1e-12), bounded(fog(1e-12), BRUME_BOX, {0, 11, 0}, {1, .7, 1})});
    for (const double end : {30., kInf})
      EXPECT_NEAR(along(w, kEye, {0, 1, 0}, end, {.tolerance = 1e-6}).L[0], .5, 1e-7)
          << jumps;
    EXPECT_NEAR(along(w, kEye, {0, 1, 0}, 10.5, {.tolerance = 1e-6}).L[0], .25, 1e-7);
  }
}

TEST(Truth, AGlowIsSeenHoweverLongTheRay) {
  // One lorentzian from a millimetre to 1000 km wide, before, beside and behind the eye,
  // on rays up to 1e28 m: the closed form of LorentzianFarAndNear.
  for (const double width : {1e-3, 1., 1e6})
    for (const double a : {-3e4, 0., 7., 3e9})
      for (const double end : {1e2, 1e10, 1e28, kInf}) {
        brume_medium m = fog(0);
        m.profile = BRUME_LORENTZIAN;
        m.falloff = 1 / (width * width);
        m.origin[0] = .01, m.origin[1] = a;
        for (double& e : m.emission) e = 1 / width;
        const double q = 1 / std::sqrt(m.falloff * (1 + m.falloff * 1e-4));
        const double L =
            q / width *
            (std::atan(m.falloff * q * (end - a)) + std::atan(m.falloff * q * a));
        // Places near a are known to a's rounding.
        EXPECT_NEAR(along(world({m}), kEye, {0, 1, 0}, end).L[0], L,
                    1e-8 + 2e-16 * std::abs(a) / width)
            << width << " " << a << " " << end;
      }
}

TEST(Truth, HundredsOfLightsInARowAreTheirSum) {
  // Lorentzians of emission alone, from a millimetre to 10 m off the ray: Int ds / (1 + f
  // (h^2 + s^2)) = q (atan(f q (t - a)) + atan(f q a)), q = 1/sqrt(f (1 + f h^2)).
  World w;
  double sum = 0;
  const double f = 2.5, end = 300;
  for (int i = 0; i < 256; ++i) {
    brume_medium m = fog(0);
    m.profile = BRUME_LORENTZIAN;
    m.falloff = i % 4 ? f : 1e4;
    const double a = 1 + .9 * i, h = std::pow(10, -3 + i % 9 * .5);
    m.origin[0] = h, m.origin[1] = a;
    for (double& e : m.emission) e = .1;
    w.media.push_back({m, 0, ""});
    const double q = 1 / std::sqrt(m.falloff * (1 + m.falloff * h * h));
    sum += .1 * q * (std::atan(m.falloff * q * (end - a)) + std::atan(m.falloff * q * a));
  }
  const Answer a = along(w, kEye, {0, 1, 0}, end, {.evaluations = 100'000});
  EXPECT_TRUE(a.converged);
  EXPECT_NEAR(a.L[0], sum, 1e-9 * (1 + sum));
}

TEST(Truth, ErrorsToldAreErrorsMade) {
  // A sphere of fog before exponential fog, asked for ever more: what is told bounds it.
  const World w = world({bounded(fog(.3, 2), BRUME_ELLIPSOID, {0, 50, 0}, {10, 10, 10}),
                         height_fog(.01, .02, .5)});
  truth::Options best;
  best.tolerance = 1e-14;
  const Answer truth = along(w, {0, 0, 30}, {0, .9, -.43}, 500, best);
  for (const double tolerance : {1e-2, 1e-5, 1e-8}) {
    truth::Options o;
    o.tolerance = tolerance;
    const Answer a = along(w, {0, 0, 30}, {0, .9, -.43}, 500, o);
    EXPECT_LE(std::abs(a.L[0] - truth.L[0]), a.L_error[0] + 1e-14);
    EXPECT_LE(std::abs(a.T[0] - truth.T[0]), a.T_error[0] + 1e-14);
  }
}

}  // namespace
}  // namespace brume
