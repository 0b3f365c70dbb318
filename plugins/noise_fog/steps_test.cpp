// Facts about the steps of noise fog along rays, of kernels against the oracle's field.

#include <gtest/gtest.h>

#include <cstdio>
#include <vector>

#include "baseline.h"
#include "fogs_test.h"

namespace {

using namespace brume;
using namespace brume::test;
namespace baseline = noise_fog::baseline;

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
      const Point d = rounded(Point{std::cos(up) * std::sin(turn),
                                    std::cos(up) * std::cos(turn), std::sin(up)});
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
      "by scene %.0f (where steps begin: %.0f, first two scenes); once, at the surface: "
      "T off by up to %.2f\n",
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
  Random r(4);
  double worst = 0;
  for (int i = 0; i < rays; ++i) {
    const Point d = rounded(unit(r, steepest));
    const double t =
        float(shortest * std::pow(longest / shortest, (i + r.uniform()) / rays));
    worst = std::max(worst, error_of(fog, s, d, t));
  }
  return worst;
}

// Thousands of densities summed in float, and the truth's own midpoints.
constexpr double kRounding = 3e-5;

TEST(NoiseFogSteps, ErrorFallsWithTheKnob) {
  Random r(3);
  Look s = any_look(r);
  grey(s, .005);
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
  Look s = look_of(100, 4, 1.2, 0.05);
  s.eye[2] = 5;
  for (int seed = 0; seed < 5; ++seed) {
    s.seed = seed;
    EXPECT_LE(largest(s, kKnob, 60, 1, 0.5, 60), promised(kKnob)) << seed;
  }
}

TEST(NoiseFogSteps, WidePixelsSeeAsWell) {
  // 1/40 rad: every octave is about as large as a pixel somewhere on the way.
  Look s = look_of(160, 5, 0.9, 0.003);
  s.falloff = 0.012;
  s.eye[2] = 20;
  s.pixel = Footprint(0.025).mean();
  for (const double knob : {1e-3, 1e-4, 1e-5})
    EXPECT_LE(largest(s, knob, 60, .3, 10, 3000), std::max(promised(knob), kRounding));
}

TEST(NoiseFogSteps, GapsInThickFogAreFound) {
  // Fog that hides all in the mean, of banks larger than the way: through gaps one sees.
  Look s = look_of(400, 4, 1.5, 0.05);
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

TEST(NoiseFogSteps, AColourThatHardlyDimsIsKnownBesideOneThatIsBlack) {
  // 10 to 20 m through cells of 7 mm: blue is dimmed by a tenth, red is opaque after 3
  // micrometres, and its steps would be too many. Before a background of 16 whites.
  Look s = look_of(0.007, 1, 0.8, 0.004);
  s.sigma[0] = 4e5, s.sigma[1] = 1e-5;
  s.pixel = Footprint(1e-5).mean();  // which sees them all
  s.tolerance = kKnob / 16;
  const auto fog = noise_fog::fog_of(s, 1);
  const Oracle oracle(s);
  Random r(5);
  for (int i = 0; i < 6; ++i) {
    const Point d = rounded(unit(r));
    const double t = r.uniform(10, 20), want = true_depth(oracle, s, d, t, s.sigma[2]);
    Kernel kernel;
    const double D = kernel.integral(fog, d, 0, t);
    EXPECT_NEAR(16 * std::exp(-s.sigma[2] * D), 16 * std::exp(-want), promised(kKnob));
  }
}

TEST(NoiseFogSteps, WhatIsClearedIsSteppedThrough) {
  // Level rays through fog that is cleared about the camera: opaque but for that.
  Look s = look_of(160, 5, 0.9, 0.003);
  s.falloff = 0.012;
  s.eye[2] = 2;
  s.clearing = 20;
  for (int seed = 0; seed < 8; ++seed) {
    s.seed = seed;
    for (const double knob : {3e-2, 1e-2, 1e-3})
      EXPECT_LE(largest(s, knob, 20, .001, 1000, 10000), promised(knob)) << seed;
  }
}

}  // namespace
