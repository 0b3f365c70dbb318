// Facts about the stretches of rays through noise fog that are asked for, of kernels
// against the oracle's field.

#include <gtest/gtest.h>

#include "fogs_test.h"

namespace {

using namespace brume;
using namespace brume::test;

TEST(NoiseFogStretches, StretchesOfARayAddUp) {
  Random r(2);
  for (int scene = 0; scene < 20; ++scene) {
    const Look s = any_look(r);
    const auto fog = noise_fog::fog_of(s, std::uint64_t(scene) + 1);
    Kernel kernel;
    for (int i = 0; i < 20; ++i) {
      const Point d = unit(r, .3);
      const double c = std::pow(10, r.uniform(1, 4)), b = c * r.uniform();
      const double sigma = s.sigma[0];
      const double T1 = std::exp(-sigma * kernel.integral(fog, d, 0, b)),
                   T2 = std::exp(-sigma * kernel.integral(fog, d, b, c)),
                   T = std::exp(-sigma * kernel.integral(fog, d, 0, c));
      EXPECT_NEAR(T1 * T2, T, 3e-3) << scene << ", " << i;  // each has its tolerance
      EXPECT_GE(T1, T - 1e-3);
    }
  }
}

TEST(NoiseFogStretches, BitsOfARayDoNotDependOnTheRaysBesideIt) {
  // Stretches of a ray without noise, that end anywhere within a step of 1 m.
  Look s;
  s.contrast = 0;
  s.clearing = 1e5;
  grey(s, 1e-7);
  const noise_fog::Fog fog = noise_fog::fog_of(s, 1);
  Random r(5);
  constexpr int kRays = 16;
  Kernel alone, together;
  for (int trial = 0; trial < 200; ++trial) {
    float d[3][kRays], t0[kRays], t1[kRays], D[kRays];
    for (int i = 0; i < kRays; ++i) {
      const Point v = unit(r);
      for (std::size_t c = 0; c < 3; ++c) d[c][i] = float(v[c]);
      t0[i] = 8e-4f;
      t1[i] = float(r.uniform(0, 0.24));
    }
    const brume_rays rays = {kRays, nullptr, nullptr, nullptr, d[0], d[1], d[2]};
    Kernel::table(best_isa()).integral(fog, *together.tracks, rays, t0, t1, D);
    for (int i = 0; i < kRays; ++i)
      ASSERT_EQ(D[i],
                float(alone.integral(fog, {d[0][i], d[1][i], d[2][i]}, t0[i], t1[i])))
          << trial << " " << i;
  }
}

TEST(NoiseFogStretches, WhereAPixelSeesNoNoiseItsMeanIsTaken) {
  // Cells of 20 m at most: a pixel of 1e-2 rad sees none of them beyond 3.3 km.
  Look s;
  s.size = 20;
  s.pixel = Footprint(1e-2).mean();
  grey(s, 1e-5);
  s.tolerance = 1e-4;
  const auto fog = noise_fog::fog_of(s, 1);
  Kernel kernel;
  const Point d = {1, 0, 0};
  const double D = kernel.integral(fog, d, 4000, 1e6);
  EXPECT_NEAR(D, 1e6 - 4000, 1e-6 * 1e6);
}

TEST(NoiseFogStretches, AMillimetreOfClearingIsKnownAlongKilometres) {
  // A ray that rises by some clearings on 2 km, under an up that is no axis: at a place
  // there the terms of the height are 10^6 times it. What rounding leaves of its slope is
  // 1e-7 of it.
  Look s = look_of(100, 4, 0.03, 0);
  s.pixel = {};
  s.clearing = 1e-3;
  Random r(6);
  double least = 1;
  for (int i = 0; i < 40; ++i) {
    const Point up = unit(r);
    std::copy(up.begin(), up.end(), s.up);
    double rises = -1e-3 * r.uniform(-3, 3) / 2000;
    Point d = unit(r);
    for (std::size_t k = 0; k < 3; ++k) rises += d[k] * up[k];
    double n = 0;
    for (std::size_t k = 0; k < 3; ++k) d[k] -= rises * up[k], n += d[k] * d[k];
    // As floats, they rise by some hundredths of a millimetre more or less.
    for (double& x : d) x = rounded(x / std::sqrt(n));
    grey(s, std::pow(10, r.uniform(-3.5, -2.5)));
    const double sigma = s.sigma[0];
    const auto fog = noise_fog::fog_of(s, std::uint64_t(i) + 1);
    Kernel kernel;
    const double T = std::exp(-sigma * kernel.integral(fog, d, 0, 2000)),
                 T1 = std::exp(-sigma * kernel.integral(fog, d, 0, 700)),
                 T2 = std::exp(-sigma * kernel.integral(fog, d, 700, 2000));
    const double want = std::exp(-true_depth(Oracle(s), s, d, 2000, sigma));
    EXPECT_LE(seen(T, want), promised(kKnob)) << i << ": " << T << ", not " << want;
    EXPECT_NEAR(T1 * T2, T, 2e-3 * T) << i;  // each has its tolerance
    least = std::min(least, want);
  }
  EXPECT_LE(least, 0.5);
}

TEST(NoiseFogStretches, FogThatStartsFarAwayHasAllTheStepsThatThereAre) {
  // 88 km of fog, 880 cells, from 2758 km on. A place there is a float to an eighth of a
  // metre, 1e-3 of a cell, which octaves of one cell feel by sqrt(880) x 4e-3 x 88 m.
  Look s = look_of(100, 1, 0.5, 2e-5);
  s.pixel = {};
  s.start = 2758009;
  Random r(7);
  for (int seed = 0; seed < 4; ++seed) {
    s.seed = seed;
    const auto fog = noise_fog::fog_of(s, std::uint64_t(seed) + 1);
    const Point d = rounded(unit(r));
    const float end = 2846825.25f;
    EXPECT_LE(error_of(fog, s, d, end), promised(kKnob)) << seed;
    Kernel kernel;
    kernel.integral(fog, d, s.start, end);
    EXPECT_LE(kernel.looks(), noise_fog::kFineNodes) << seed;
  }
}

TEST(NoiseFogStretches, WhatIsNotThereBeforeTheStartHidesNothing) {
  // Rays from elsewhere that leave the ball about the camera, in which there is no fog:
  // 36 to 180 optical depths, were it there; 6 m behind it. They begin within it or pass
  // through it.
  Look s = look_of(20, 3, 0.7, 0.15);
  s.start = 500;
  const Oracle oracle(s);
  const auto fog = noise_fog::fog_of(s, 1);
  Random r(9);
  for (int i = 0; i < 40; ++i) {
    const Point d = rounded(unit(r));
    Point o = unit(r);
    const double away = i % 2 ? s.start * r.uniform(0.1, 0.99) : s.start * 1.5;
    for (std::size_t k = 0; k < 3; ++k)
      o[k] = rounded(away * (i % 2 ? o[k] : 0.3 * o[k] - d[k]));
    double b = 0, c = -s.start * s.start;
    for (std::size_t k = 0; k < 3; ++k) b += o[k] * d[k], c += o[k] * o[k];
    const double leaves = -b + std::sqrt(b * b - c), t0 = float(leaves),
                 t1 = float(leaves + 6);
    double want = 0;  // by midpoints of 2 cm: 1e-5 of it
    for (int j = 0; j < 300; ++j)
      want += oracle.density(at(o, d, t0 + (j + .5) * (t1 - t0) / 300)) * (t1 - t0) / 300;
    Kernel kernel;
    kernel.integral_from(fog, o, d, 0, 1);
    const double got = kernel.integral_from(fog, o, d, t0, t1);
    EXPECT_LE(seen(std::exp(-0.15 * got), std::exp(-0.15 * want)), promised(kKnob))
        << i << ": " << got << ", not " << want;
  }
}

TEST(NoiseFogStretches, ARayMayWantMoreStepsThanThereAre) {
  // 2 and 20 km of level fog whose finest cells are half a metre, closely: some hundred
  // thousand steps, were they not longer after the first 16384. Stretches near its begin
  // and its end, asked for in any order.
  Look s = look_of(2, 3, 0.9, 1e-4);
  s.pixel = {};
  s.eye[2] = 3;
  s.tolerance = 1e-4;
  const auto fog = noise_fog::fog_of(s, 1);
  const Oracle oracle(s);
  Kernel kernel;
  const Point d = {double(float(.6)), double(float(.8)), 0};
  const auto T = [&](double t0, double t1) {
    return std::exp(-1e-4 * kernel.integral(fog, d, t0, t1));
  };
  const auto truth = [&](double t) {
    return std::exp(-true_depth(oracle, s, d, t, 1e-4));
  };
  const double whole = T(0, 20000), begin = T(0, 300), rest = T(300, 20000);
  EXPECT_NEAR(T(0, 2000), truth(2000), 1e-4);
  // The banks of 2 m are left out over 17 km, 8500 of them: a sqrt(l x e^2), a = 1, of
  // 1.7 in tau.
  EXPECT_NEAR(whole, truth(20000), 0.14 * 1.7 * std::sqrt(0.8 / 8500) * 4);
  EXPECT_NEAR(begin, truth(300), 1e-4);
  EXPECT_NEAR(begin * rest, whole, 1e-3);  // a shorter stretch has other steps
  EXPECT_EQ(T(0, 300), begin);
}

TEST(NoiseFogStretches, DenserThanFloatsItIsTexturedAndClearedAsElsewhere) {
  // Extinction of 10^31 to 10^43 per m: seen at all for less than 10^-30 m. Two exponents
  // of 100 in float, 4 roundings of 60 eps / 2 each.
  Random r(17);
  int seen = 0;
  for (int i = 0; i < 200; ++i) {
    Look s = any_look(r);
    grey(s, 1e6);
    s.falloff = 0.01;
    for (double& x : s.eye) x = 0;  // where doubles know places of 10^-35 m
    s.height = 100 * r.uniform(58, 85);
    if (i % 3 > 0) s.clearing = i % 3 == 1 ? 100 : std::pow(10, r.uniform(-35, -27));
    if (i % 5 == 0) s.height = 100 * r.uniform(50, 54);  // as elsewhere
    const Point d = i % 4 ? unit(r) : Point{1, 0, 0};
    const double sigma = 1e6, most = sigma * std::exp(s.falloff * s.height);
    const float t = float(std::pow(10, r.uniform(-2, 3)) / most);
    if (!(t > 1e-38f)) continue;
    Kernel kernel;
    const double got =
        std::exp(-sigma * kernel.integral(noise_fog::fog_of(s, std::uint64_t(i) + 1), d,
                                          0, t, best_isa()));
    const double want = std::exp(-true_depth(Oracle(s), s, d, t, sigma));
    EXPECT_NEAR(got, want, 1e-4) << i << " clearing " << s.clearing << ", " << t << " m";
    seen += want > 0.05 && want < 0.95;
  }
  EXPECT_GT(seen, 40);
}

}  // namespace
