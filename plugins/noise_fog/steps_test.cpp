// Facts about the steps of noise fog along rays, of kernels against the oracle's field.

#include <gtest/gtest.h>

#include <cstdio>
#include <vector>

#include "baseline.h"
#include "curve.h"
#include "fogs_test.h"

namespace {

using namespace brume;
using namespace brume::test;
namespace baseline = noise_fog::baseline;

constexpr double kTolerance = 1e-3;  // the default
constexpr double kKnob = 1.5e-4;     // `error` that the curve has for it

// What the curve promises at a value of the knob.
double promised(double error) {
  double promise = 0;
  for (std::size_t i = 0; i < std::size(noise_fog::kCurve); i += 2)
    if (noise_fog::kCurve[i] >= error) promise = noise_fog::kCurve[i + 1];
  return promise;
}

// Error of the picture, |dC| / (1 + |C|), before the background that shows it most: none
// to 30 whites, as the curve has it; the fog has the colour 1.
double seen(double got, double T) {
  double worst = 0;
  for (const double S : {0., 30.})
    worst = std::max(worst, std::abs((S - 1) * (got - T)) / (2 - T + S * T));
  return worst;
}

TEST(NoiseFogSteps, ErrorOfAStepIsAsTheTableSays) {
  // Rays of 30 cells through one octave, summed in even steps under a window without
  // ends: variance per length, in units of the octave's. Within a third, of 1000 rays,
  // where the octave is not faded out.
  constexpr int kRays = 1000, kFine = 48;
  constexpr double kLength = 30, kEdge = 5;
  const auto window = [](double t) {
    const double u = std::clamp(std::min(t, kLength - t) / kEdge, 0., 1.);
    return u * u * u * u * (35 - u * (84 - u * (70 - 20 * u)));
  };
  for (const double c : {0.5, 1.})
    for (const double h : {0.25, 0.3, 0.4, 0.5, 0.6, 0.7}) {
      Random r(8);
      double square = 0, mean = 0, windows = 0;
      for (int i = 0; i < kRays; ++i) {
        const Point o = {r.uniform(0, 1e3), r.uniform(0, 1e3), r.uniform(0, 1e3)},
                    d = unit(r);
        const auto sum = [&](double step, double from) {
          double f = 0;
          for (double t = from * step; t < kLength; t += step)
            f += window(t) * std::exp(c * noise_fog::gradient_noise(at(o, d, t), 1, 0)) *
                 step;
          return f;
        };
        const double fine = sum(1. / kFine, 0);
        square += std::pow(sum(h, r.uniform()) - fine, 2) / kRays;
        mean += fine / kRays;
      }
      for (int j = 0; j < 1000; ++j)
        windows += std::pow(window((j + .5) / 1000 * kLength), 2) * kLength / 1000;
      mean /= kLength - kEdge;  // the window's own integral
      const double e2 = square / (mean * mean) / windows /
                        std::expm1(c * c * noise_fog::kNoiseVariance);
      const double table = noise_fog::step_error(h);
      EXPECT_LE(e2, table * 4. / 3) << "c " << c << ", h " << h;
      if (c == 1) {
        EXPECT_GE(e2, table / 2) << "h " << h;
      }
    }
}

TEST(NoiseFogSteps, BitsOfARayDoNotDependOnTheRaysBesideIt) {
  // Stretches of a ray without noise, that end anywhere within a step of 1 m.
  Look s;
  s.contrast = 0;
  s.clearing = 1e5;
  s.sigma[0] = s.sigma[1] = s.sigma[2] = 1e-7;
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

TEST(NoiseFogSteps, ErrorAtTheDefaultToleranceAndStepsAgainstUniformMarching) {
  // Ground fog seen from within and above, over plains and hills, into the sky. Uniform
  // marching looks in the middle of equal steps, as many on each ray or as long on each,
  // as many as give the same rms error; it ends where the smooth fog that is left is 1e-4
  // thick.
  const std::uint64_t seed = 12;
  Random r(seed);
  std::vector<double> errors;
  double ours = 0, begin = 0, once = 0, better = 0;
  double uniform[2] = {};  // by count, by length
  const Isa isa = best_isa();
  constexpr int kScenes = 12, kRays = 32;
  for (int scene = 0; scene < kScenes; ++scene) {
    Look s = any_look(r);
    s.tolerance = kKnob;
    const double sigma = s.sigma[0];
    const auto fog = noise_fog::fog_of(s, std::uint64_t(scene) + 1);
    const Oracle oracle(s);
    struct Seen {
      Point d;
      double t, T;
    };
    std::vector<Seen> rays;
    double square = 0, steps = 0;
    for (int i = 0; i < kRays; ++i) {
      const double up = r.uniform(-.25, .2), turn = r.uniform(-.4, .4);
      Point d = {std::cos(up) * std::sin(turn), std::cos(up) * std::cos(turn),
                 std::sin(up)};
      d = rounded(d);
      double t = kInf;
      if (up < 0) t = -s.eye[2] / d[2];
      if (up < .06) t = std::min(t, std::pow(10, r.uniform(2, 4)));
      t = float(t);
      Kernel kernel;
      const double got = std::exp(-sigma * kernel.integral(fog, d, 0, t, isa));
      steps += kernel.looks() / double(kRays);
      double left = 0;
      if (d[2] > 0) {
        const double rate = s.falloff * d[2];
        const double all = sigma * std::exp(-s.falloff * s.eye[2]) / rate;
        const double end = std::max(std::log(all / 1e-4) / rate, 1.);
        if (end < t) t = end, left = 1e-4;
      }
      rays.push_back({d, t, std::exp(-true_depth(oracle, s, d, t, sigma))});
      const double error = seen(got, rays.back().T * std::exp(-left));
      EXPECT_LE(error, promised(kKnob))
          << "seed " << seed << ", scene " << scene << ", ray " << i;
      errors.push_back(error);
      square += error * error;
      const double f =
          baseline::transmittance(sigma, t, oracle.unfiltered(at(eye_of(s), d, t)));
      once = std::max(once, std::abs(f - rays.back().T));
    }
    const auto off = [&](const Seen& x, double n, bool in_the_middle) {
      const auto density = [&](double t) {
        return sigma * oracle.density(at(eye_of(s), x.d, t));
      };
      return std::pow(
          seen(std::exp(-baseline::march(density, x.t, int(n), in_the_middle)), x.T), 2);
    };
    double longest = 0, total = 0;
    for (const Seen& x : rays) longest = std::max(longest, x.t), total += x.t;
    const auto least = [&](bool by_length, bool in_the_middle) {
      for (double n = 4; n < 3e4; n *= 1.25) {
        double sum = 0;
        for (const Seen& x : rays) {
          sum += off(x, std::ceil(by_length ? n * x.t / longest : n), in_the_middle);
          if (sum > square) break;
        }
        if (sum <= square) return by_length ? n * total / kRays / longest : n;
      }
      return 3e4;
    };
    const double by_count = least(false, true), by_length = least(true, true);
    ours += steps / kScenes;
    uniform[0] += by_count / kScenes;
    uniform[1] += by_length / kScenes;
    better += std::min(by_count, by_length) / kScenes;
    if (scene < 2) begin += std::min(least(false, false), least(true, false)) / 2;
  }
  std::sort(errors.begin(), errors.end());
  std::printf(
      "%zu rays, seed %d: error largest %.1e, 99 %% %.1e, median %.1e; steps a ray %.0f; "
      "equal steps, as many on each ray %.0f, as long on each %.0f, the better of both "
      "by "
      "scene %.0f (where steps begin: %.0f, first two scenes); once, at the surface: T "
      "off "
      "by up to %.2f\n",
      errors.size(), int(seed), errors.back(), errors[errors.size() * 99 / 100],
      errors[errors.size() / 2], ours, uniform[0], uniform[1], better, begin, once);
  EXPECT_LE(ours, uniform[0] / 4);
  EXPECT_LE(ours, uniform[1] / 4);
  EXPECT_LE(ours, better / 2.5);
  EXPECT_LE(ours, begin / 4);
}

// Largest error over rays of `look` at an `error` of the knob, of the oracle's field as
// pixels see it.
double largest(Look s, double knob, int rays, double steepest, double shortest,
               double longest) {
  s.tolerance = knob;
  const auto fog = noise_fog::fog_of(s, 1);
  const Oracle oracle(s);
  Random r(4);
  double worst = 0;
  for (int i = 0; i < rays; ++i) {
    Kernel kernel;
    Point d = unit(r, steepest);
    d = rounded(d);
    const double t =
        float(shortest * std::pow(longest / shortest, (i + r.uniform()) / rays));
    worst = std::max(worst, seen(std::exp(-s.sigma[0] * kernel.integral(fog, d, 0, t)),
                                 std::exp(-true_depth(oracle, s, d, t, s.sigma[0]))));
  }
  return worst;
}

// Thousands of densities summed in float, and the truth's own midpoints.
constexpr double kRounding = 3e-5;

TEST(NoiseFogSteps, ErrorFallsWithTheKnob) {
  Random r(3);
  Look s = any_look(r);
  s.sigma[0] = s.sigma[1] = s.sigma[2] = .005;
  s.contrast = 0.9;
  double before = 1;
  for (const double knob : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5}) {
    const double error = largest(s, knob, 60, .2, 30, 2000);
    EXPECT_LE(error, std::max(promised(knob), kRounding));
    EXPECT_LE(error, std::max(before, kRounding));
    std::printf("error %.0e: found %.1e\n", knob, error);
    before = error;
  }
}

TEST(NoiseFogSteps, AStretchMayEndAnywhere) {
  // In thick wisps, within a few of the finest cells: where a rule for whole steps would
  // leave the part of the last one open.
  Look s;
  s.size = 100;
  s.octaves = 4;
  s.contrast = 1.2;
  s.eye[2] = 5;
  s.pixel = Footprint(6e-4).mean();
  for (int seed = 0; seed < 5; ++seed) {
    s.seed = seed;
    s.sigma[0] = s.sigma[1] = s.sigma[2] = 0.05;
    EXPECT_LE(largest(s, kKnob, 60, 1, 0.5, 60), promised(kKnob)) << seed;
  }
}

TEST(NoiseFogSteps, WidePixelsSeeAsWell) {
  // 1/40 rad: every octave is about as large as a pixel somewhere on the way.
  Look s;
  s.size = 160;
  s.octaves = 5;
  s.contrast = 0.9;
  s.falloff = 0.012;
  s.eye[2] = 20;
  s.pixel = Footprint(0.025).mean();
  s.sigma[0] = s.sigma[1] = s.sigma[2] = 0.003;
  for (const double knob : {1e-3, 1e-4, 1e-5})
    EXPECT_LE(largest(s, knob, 60, .3, 10, 3000), std::max(promised(knob), kRounding));
}

TEST(NoiseFogSteps, GapsInThickFogAreFound) {
  // Fog that hides all in the mean, of banks larger than the way: through gaps one sees.
  Look s;
  s.size = 400;
  s.octaves = 4;
  s.contrast = 1.5;
  s.pixel = Footprint(6e-4).mean();
  s.sigma[0] = s.sigma[1] = s.sigma[2] = 0.05;
  int clear = 0;
  for (int seed = 0; seed < 12; ++seed) {
    s.seed = seed;
    const Oracle oracle(s);
    clear += true_depth(oracle, s, {1, 0, 0}, 300, 0.05) < 5;  // 15 in the mean
    for (const double knob : {1e-2, kKnob})
      EXPECT_LE(largest(s, knob, 12, .2, 100, 300), promised(knob)) << seed;
  }
  EXPECT_GE(clear, 2);
}

TEST(NoiseFogSteps, WhatIsClearedIsSteppedThrough) {
  // Level rays through fog that is cleared about the camera: opaque but for that.
  Look s;
  s.size = 160;
  s.octaves = 5;
  s.contrast = 0.9;
  s.falloff = 0.012;
  s.eye[2] = 2;
  s.clearing = 20;
  s.pixel = Footprint(6e-4).mean();
  s.sigma[0] = s.sigma[1] = s.sigma[2] = 0.003;
  for (int seed = 0; seed < 8; ++seed) {
    s.seed = seed;
    for (const double knob : {3e-2, 1e-2, 1e-3})
      EXPECT_LE(largest(s, knob, 20, .001, 1000, 10000), promised(knob)) << seed;
  }
}

TEST(NoiseFogSteps, AMillimetreOfClearingIsKnownAlongKilometres) {
  // A ray that rises by some clearings on 2 km, under an up that is no axis: at a place
  // there the terms of the height are 10^6 times it. What rounding leaves of its slope is
  // 1e-7 of it.
  Look s;
  s.contrast = 0.03;
  s.octaves = 4;
  s.clearing = 1e-3;
  s.tolerance = kKnob;
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
    s.sigma[0] = s.sigma[1] = s.sigma[2] = std::pow(10, r.uniform(-3.5, -2.5));
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

TEST(NoiseFogSteps, FogThatStartsFarAwayHasAllTheStepsThatThereAre) {
  // 88 km of fog, 880 cells, from 2758 km on. A place there is a float to an eighth of a
  // metre, 1e-3 of a cell, which octaves of one cell feel by sqrt(880) x 4e-3 x 88 m.
  Look s;
  s.size = 100;
  s.octaves = 1;
  s.contrast = 0.5;
  s.start = 2758009;
  s.sigma[0] = s.sigma[1] = s.sigma[2] = 2e-5;
  s.tolerance = kKnob;
  Random r(7);
  for (int seed = 0; seed < 4; ++seed) {
    s.seed = seed;
    const auto fog = noise_fog::fog_of(s, std::uint64_t(seed) + 1);
    Point d = unit(r);
    d = rounded(d);
    const float end = 2846825.25f;
    Kernel kernel;
    const double T = std::exp(-2e-5 * kernel.integral(fog, d, s.start, end)),
                 want = std::exp(-true_depth(Oracle(s), s, d, end, 2e-5));
    EXPECT_LE(seen(T, want), promised(kKnob)) << seed << ": " << T << ", not " << want;
    EXPECT_LE(kernel.looks(), noise_fog::kFineNodes) << seed;
  }
}

TEST(NoiseFogSteps, WhatIsNotThereBeforeTheStartHidesNothing) {
  // Rays from elsewhere that leave the ball about the camera, in which there is no fog:
  // 36 to 180 optical depths, were it there; 6 m behind it. They begin within it or pass
  // through it.
  Look s;
  s.size = 20;
  s.octaves = 3;
  s.start = 500;
  s.sigma[0] = s.sigma[1] = s.sigma[2] = 0.15;
  s.tolerance = kKnob;
  s.pixel = Footprint(6e-4).mean();
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

TEST(NoiseFogSteps, ARayMayWantMoreStepsThanThereAre) {
  // 2 and 20 km of level fog whose finest cells are half a metre, closely: some hundred
  // thousand steps, were they not longer after the first 16384. Stretches near its begin
  // and its end, asked for in any order.
  Look s;
  s.size = 2;
  s.octaves = 3;
  s.contrast = 0.9;
  s.eye[2] = 3;
  s.sigma[0] = s.sigma[1] = s.sigma[2] = 1e-4;
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

TEST(NoiseFogSteps, WhereAPixelSeesNoNoiseItsMeanIsTaken) {
  // Cells of 20 m at most: a pixel of 1e-2 rad sees none of them beyond 3.3 km.
  Look s;
  s.size = 20;
  s.pixel = Footprint(1e-2).mean();
  s.sigma[0] = s.sigma[1] = s.sigma[2] = 1e-5;
  s.tolerance = 1e-4;
  const auto fog = noise_fog::fog_of(s, 1);
  Kernel kernel;
  const Point d = {1, 0, 0};
  const double D = kernel.integral(fog, d, 4000, 1e6);
  EXPECT_NEAR(D, 1e6 - 4000, 1e-6 * 1e6);
}

TEST(NoiseFogSteps, StretchesOfARayAddUp) {
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

}  // namespace
