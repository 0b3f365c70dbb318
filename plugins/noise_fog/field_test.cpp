// Facts about the field of noise fog: of kernels and oracle at points.

#include <gtest/gtest.h>

#include <cstdio>

#include "fogs_test.h"

namespace {

using namespace brume;
using namespace brume::test;

constexpr double kLogDensity = 2e-5;  // of ln rho near the eye, absolute

TEST(NoiseFogField, KernelAndOracleSeeTheSameDensity) {
  Random r(5);
  double worst = 0;
  for (int scene = 0; scene < 40; ++scene) {
    Look s = any_look(r);
    s.period = scene % 2 ? 3 : 0;
    s.smoothing = scene % 3 ? 0 : 4;
    s.clearing = scene % 5 ? 0 : 30;
    s.contrast = r.uniform(0, 2);
    for (double& x : s.shift) x = r.uniform(-1e5, 1e5);
    const auto fog = noise_fog::fog_of(s, 1);
    const Oracle oracle(s);
    const Kernel kernel;
    for (int i = 0; i < 200; ++i) {
      const Point d = unit(r);
      const double t = float(s.size * std::pow(10, r.uniform(-2, 1)));
      const Isa isa = Isa(r.word() % (unsigned(best_isa()) + 1));
      const Point df = {float(d[0]), float(d[1]), float(d[2])};
      const double want = oracle.density(at(eye_of(s), df, t));
      // Beyond that it is opaque, or nothing, and no number for a float.
      if (want < 1e-25 || want > 1e25) continue;
      const double got = kernel.density(fog, {0, 0, 0}, d, t, isa);
      const double error = std::abs(std::log(got / want));
      // The fit of the mean is good to 4e-7 in float, noise in float to 1.5e-6 c, c
      // < 7.4. A place t away is good to eps t, the steepest slope of c n is 4 c cells of
      // the finest octave; the clearing has its square's digits near the eye's height.
      const double finest = noise_fog::cell_of(s, s.octaves - 1);
      const double c = noise_fog::amplitude(s, 0);
      EXPECT_LE(error, kLogDensity + kEps * 4 * c * t / finest + 1e-4 * (s.clearing > 0))
          << "scene " << scene << ", " << i << ", " << name(isa) << ": " << got
          << ", not " << want;
      if (t < s.size && s.clearing == 0) worst = std::max(worst, error);
    }
  }
  std::printf("ln rho within a cell of the eye: %.1e\n", worst);
}

TEST(NoiseFogField, MeanOfTheExponentialIsAsTheFitSays) {
  for (double c = 0; c <= 8; c += 0.01)
    EXPECT_NEAR(noise_fog::log_mean_of(c), noise_fog::log_mean_exponential(c), 1e-7) << c;
}

TEST(NoiseFogField, MeanDensityDoesNotDependOnNoiseOrPixel) {
  // Whatever octaves and contrast, and however much of them the pixel blurs away.
  for (const double contrast : {0.5, 1.0})
    for (const double pixel : {0., 20., 50., 1e4}) {
      Look s;
      s.size = 100;
      s.octaves = 3;
      s.contrast = contrast;
      s.pixel = Footprint(1).mean();  // the pixel is as wide as the eye is far
      const Oracle oracle(s);
      Random r(77);
      double mean = 0, square = 0;
      constexpr int n = 200'000;
      for (int i = 0; i < n; ++i) {
        // The eye is moved with the point, so that every point has that pixel.
        Look here = s;
        const Point x = {r.uniform(0, 1e6), r.uniform(0, 1e6), r.uniform(0, 1e6)};
        here.eye[0] = x[0] - pixel, here.eye[1] = x[1], here.eye[2] = x[2];
        const double rho = Oracle(here).density(x);
        mean += rho / n, square += rho * rho / n;
      }
      const double error = std::sqrt(std::max(square - mean * mean, 0.) / n);
      // Octaves are independent but for their lattices' alignment (README): 2e-3.
      EXPECT_NEAR(mean, 1, 4 * error + 2e-3) << contrast << ", pixel " << pixel;
    }
}

TEST(NoiseFogField, ContrastIsTheDeviationOfTheLogarithm) {
  for (const int octaves : {1, 4}) {
    Look s;
    s.octaves = octaves;
    s.contrast = 0.7;
    const Oracle oracle(s);
    Random r(3);
    double mean = 0, square = 0;
    constexpr int n = 100'000;
    for (int i = 0; i < n; ++i) {
      const double x = std::log(
          oracle.unfiltered({r.uniform(0, 1e6), r.uniform(0, 1e6), r.uniform(0, 1e6)}));
      mean += x / n, square += x * x / n;
    }
    // Of a sample's deviation 1/sqrt(2 n): 0.2 %; times four.
    EXPECT_NEAR(std::sqrt(square - mean * mean), 0.7, 0.7 * 0.009) << octaves;
  }
}

TEST(NoiseFogField, RepeatsWithoutASeam) {
  const Look s{.seed = 9, .period = 3, .shift = {33, 0, 0}};
  const Oracle oracle(s);
  Random r(1);
  const double turn = s.period * s.size;
  double seam = 0, inside = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Point x = {r.uniform(-1e3, 1e3), r.uniform(-1e3, 1e3), r.uniform(-1e3, 1e3)};
    if (i < 1000) {
      // Places are doubles near 1e5 m: 1e-11 m, times slopes of 4/cell x c.
      EXPECT_NEAR(oracle.unfiltered(x),
                  oracle.unfiltered({x[0] + turn, x[1] - 7 * turn, x[2] + 99 * turn}),
                  1e-9);
    }
    // Across the place where the coarsest lattice starts again, and across any other.
    const double wrap = s.shift[0] - noise_fog::stagger(s, 0)[0] * s.size;
    const auto jump = [&](double place) {
      return std::abs(std::log(oracle.unfiltered({place + .01, x[1], x[2]}) /
                               oracle.unfiltered({place - .01, x[1], x[2]})));
    };
    seam = std::max(seam, jump(wrap));
    inside = std::max(inside, jump(x[0]));
  }
  EXPECT_LE(seam, 1.1 * inside);  // METHODS B11
}

TEST(NoiseFogField, PascalsRowLeavesOfAnOctaveWhatTheBlurSays) {
  // The document's blur done as it does it: weights of row 4 along each axis.
  const double row[5] = {1 / 16., 4 / 16., 6 / 16., 4 / 16., 1 / 16.};
  Random r(8);
  for (const double spacing : {0.125, 0.25}) {  // in cells
    double blurred = 0, plain = 0;
    for (int i = 0; i < 20'000; ++i) {
      const Point q = {r.uniform(0, 1e4), r.uniform(0, 1e4), r.uniform(0, 1e4)};
      double sum = 0;
      for (int k = 0; k < 125; ++k) {
        const int a = k % 5, b = k / 5 % 5, c = k / 25;
        sum +=
            row[a] * row[b] * row[c] *
            noise_fog::gradient_noise({q[0] + (a - 2) * spacing, q[1] + (b - 2) * spacing,
                                       q[2] + (c - 2) * spacing},
                                      1, 0);
      }
      blurred += sum * sum;
      plain += std::pow(noise_fog::gradient_noise(q, 1, 0), 2);
    }
    const double W = std::exp(-10 * 4 * spacing * spacing / 4);  // variance n s^2 / 4
    // The Gaussian W is that of the noise's spectrum to 3 % where half of it is left.
    EXPECT_NEAR(std::sqrt(blurred / plain), W, 0.1 * W) << spacing;
  }
}

TEST(NoiseFogField, ADistantPixelSeesTheMeanOfWhatIsInIt) {
  // Against 1024 samples in the pixel, where it is wider than the finest cells: one look
  // at the whole noise is off by the noise itself, the filtered field by what the shape
  // of the filters differs.
  const double t = 10000;  // pixels of 10 m, cells of 64 to 2 m
  const Oracle oracle(
      {.size = 64, .octaves = 6, .contrast = 1, .pixel = Footprint(1e-3).mean()});
  Random r(21);
  double whole = 0, filtered = 0;
  constexpr int n = 400;
  for (int i = 0; i < n; ++i) {
    const double a = r.uniform(-1, 1), b = r.uniform(-1, 1);
    const auto looking = [&](double u, double v) {
      const Point x = {t, 2000 * a + 10 * u, 2000 * b + 10 * v};
      return x;
    };
    double mean = 0;
    for (int k = 0; k < 1024; ++k) {
      // Gaussian of half a pixel's deviation, by Box and Muller.
      const double radius = .5 * std::sqrt(-2 * std::log(1 - r.uniform())),
                   angle = 2 * M_PI * r.uniform();
      mean +=
          oracle.unfiltered(looking(radius * std::cos(angle), radius * std::sin(angle))) /
          1024;
    }
    whole += std::pow(oracle.unfiltered(looking(0, 0)) / mean - 1, 2) / n;
    filtered += std::pow(oracle.density(looking(0, 0)) / mean - 1, 2) / n;
  }
  std::printf("beside 1024 samples a pixel: one look %.3f, filtered %.3f rms\n",
              std::sqrt(whole), std::sqrt(filtered));
  EXPECT_LE(filtered, whole / 2);
}

TEST(NoiseFogField, ClearsWithTheSquareOfTheHeightAboveTheEye) {
  const Oracle oracle({.contrast = 0, .clearing = 100, .eye = {0, 0, 500}});
  EXPECT_NEAR(oracle.density({7, 8, 500}), 0.001, 1e-12);
  // n dY^2 / 2 + 0.001 (Intel 2008) to first order: it ends at 1 where theirs grows on.
  EXPECT_NEAR(oracle.density({7, 8, 505}), 0.001 + 0.05 * 0.05 / 2, 4e-6);
  EXPECT_NEAR(oracle.density({7, 8, -1e6}), 1, 1e-6);
}

}  // namespace
