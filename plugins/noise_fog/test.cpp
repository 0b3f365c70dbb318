// Facts about noise fog, asked of the product's own path (registry, module, stage, World,
// integrator); those about its field and its steps of kernels and oracle.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <vector>

#include "../../tests/stage/generated.h"
#include "fogs_test.h"
#include "scene/scene_file.h"
#include "truth/truth.h"

namespace {

using namespace brume;
using namespace brume::test;

constexpr double kTolerance = 1e-3;   // the default
constexpr double kLogDensity = 2e-5;  // of ln rho near the eye, absolute

// ---- the field

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
  Look s;
  s.period = 3;
  s.seed = 9;
  s.shift[0] = 33;
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
  Look s;
  s.size = 64;
  s.octaves = 6;
  s.pixel = Footprint(1e-3).mean();
  s.contrast = 1;
  const double t = 10000;  // pixels of 10 m, cells of 64 to 2 m
  const Oracle oracle(s);
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
  Look s;
  s.contrast = 0;
  s.clearing = 100;
  s.eye[2] = 500;
  const Oracle oracle(s);
  EXPECT_NEAR(oracle.density({7, 8, 500}), 0.001, 1e-12);
  // n dY^2 / 2 + 0.001 (Intel 2008) to first order: it ends at 1 where theirs grows on.
  EXPECT_NEAR(oracle.density({7, 8, 505}), 0.001 + 0.05 * 0.05 / 2, 4e-6);
  EXPECT_NEAR(oracle.density({7, 8, -1e6}), 1, 1e-6);
}

// ---- its integral

// ---- through the product

TEST(NoiseFog, SmoothFogIsHeightFog) {
  ThroughAir noise, height;
  noise.add("noise_fog", {{"contrast", "0"}, {"color", "1"}}).compile();
  height.add("height_fog", {{"density", "0.004"}, {"color", "1"}}).compile();
  Random r(3);
  for (int i = 0; i < 300; ++i) {
    const Ray ray = toward(unit(r, .1), i % 9 ? std::pow(10, r.uniform(0, 5)) : kInf);
    for (int c = 0; c < 3; ++c) {
      // Two closed forms of some ten roundings each.
      EXPECT_NEAR(noise(ray).T[c], height(ray).T[c], 10 * kEps);
      EXPECT_NEAR(noise(ray).L[c], height(ray).L[c], 10 * kEps);
    }
  }
}

Set drifting(double wind = 0) {
  return {{"density", "0.004"},      {"falloff", "0.01"}, {"size", "80"},
          {"octaves", "4"},          {"contrast", "0.9"}, {"color", "1"},
          {"wind", text(wind, 0, 0)}};
}

TEST(NoiseFog, StaysPutInTheWorldWhenTheCameraMoves) {
  // Two views: what the second sees between two places of the world, the first sees
  // between them too.
  FrameInfo first = eye_at(100, -40, 30), second = eye_at(400, -40, 30);
  first.pixel_footprint = second.pixel_footprint = 1e-6;  // the pixel blurs nothing
  ThroughAir a(first), b(second);
  a.add("noise_fog", drifting()).compile(1e-4);
  b.add("noise_fog", drifting()).compile(1e-4);
  double moved = 0;
  for (int i = 1; i <= 40; ++i) {
    const double T =
        a(toward({1, 0, 0}, 300 + 20. * i)).T[1] / double(a(toward({1, 0, 0}, 300)).T[1]);
    EXPECT_NEAR(b(toward({1, 0, 0}, 20. * i)).T[1], T, 6e-4) << i;  // 3 answers, T > .3
    moved = std::max(moved, std::abs(double(a(toward({1, 0, 0}, 20. * i)).T[1]) - T));
  }
  EXPECT_GT(moved, 0.02);  // fog that went along with the camera would not be told
}

TEST(NoiseFog, MovesWithTheWind) {
  FrameInfo later = eye_at(0, 0, 30);
  later.time = 20;
  ThroughAir now(eye_at(60, 0, 30)), blown(later);
  now.add("noise_fog", drifting()).compile(1e-4);
  blown.add("noise_fog", drifting(-3)).compile(1e-4);
  for (int i = 1; i <= 20; ++i) {
    const Ray ray = toward({0.6, 0.8, 0}, 50. * i);
    EXPECT_NEAR(now(ray).T[0], blown(ray).T[0], 2e-4) << i;
  }
}

TEST(NoiseFog, DenserThanFloatsItIsTexturedAndClearedAsElsewhere) {
  // Extinction of 10^31 to 10^43 per m: seen at all for less than 10^-30 m. Two exponents
  // of 100 in float, 4 roundings of 60 eps / 2 each.
  Random r(17);
  int seen = 0;
  for (int i = 0; i < 200; ++i) {
    Look s = any_look(r);
    for (double& x : s.sigma) x = 1e6;
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

TEST(NoiseFog, AgreesWithTheTruthAloneAndAmongOthers) {
  Random r(31);
  double worst = 0;
  for (int scene = 0; scene < 6; ++scene) {
    FrameInfo frame =
        eye_at(r.uniform(-1e3, 1e3), r.uniform(-1e3, 1e3), r.uniform(2, 60));
    frame.pixel_footprint = 1e-3;
    ThroughAir air(frame);
    Set set = drifting();
    set.push_back({"seed", std::to_string(scene)});
    if (scene == 1) set.push_back({"clearing", "20"});
    if (scene == 2) set.push_back({"max_opacity", "0.5"});
    if (scene == 3) set.push_back({"start", "100"});
    air.add("noise_fog", set);
    if (scene >= 4)
      air.add("height_fog", {{"density", "0.003"}, {"color", "0.1,0.2,0.9"}});
    air.compile(1e-3);
    for (int i = 0; i < 8; ++i) {
      Point d = unit(r, .2);
      d = rounded(d);
      const Ray ray = toward(d, std::pow(10, r.uniform(1.5, 3)));
      const auto got = air(ray);
      const auto want = truth::along(air.world(), frame.eye, {d[0], d[1], d[2]}, ray.t,
                                     {.tolerance = 1e-6});
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(got.T[c], want.T[c], kTolerance) << scene << ", " << i;
        EXPECT_NEAR(got.L[c], want.L[c], kTolerance * (1 + want.L[c]))
            << scene << ", " << i;
        worst = std::max(worst, std::abs(got.L[c] - want.L[c]));
      }
    }
  }
  std::printf("6 scenes against the truth: largest error of L %.1e\n", worst);
}

TEST(NoiseFog, InAnOrthographicViewPixelsAreNoWiderFarAway) {
  // 2 m wide, a fifth of the finest cells: an octave keeps e^(-10 x 0.01) of itself. Read
  // as an angle it would be a pixel of a kilometre at 500 m.
  FrameInfo flat = eye_at(100, 50, 10), fine = flat;
  flat.projection = Projection::orthographic;
  flat.pixel_footprint = 2;
  fine.pixel_footprint = 1e-6;
  FrameInfo angle = flat;
  angle.projection = Projection::perspective;
  ThroughAir a(flat), b(fine), c(angle);
  for (ThroughAir* air : {&a, &b, &c}) air->add("noise_fog", drifting()).compile(1e-4);
  double near = 0, far = 0;
  for (int i = 1; i <= 20; ++i) {
    const Ray ray = toward({0.6, 0.8, 0}, 50. * i);
    near = std::max(near, std::abs(double(a(ray).T[0]) - b(ray).T[0]));
    far = std::max(far, std::abs(double(c(ray).T[0]) - b(ray).T[0]));
  }
  EXPECT_LE(near, far / 10);
  EXPECT_GE(far, 0.02);  // or it said nothing
}

TEST(NoiseFog, ALampGlowsInItAsTheTruthSays) {
  FrameInfo frame = eye_at(0, 0, 10);
  frame.pixel_footprint = 1e-3;
  ThroughAir air(frame);
  Set set = drifting();
  set.push_back({"albedo", "0.9"});
  set.push_back({"g", "0.3"});
  air.add("noise_fog", set);
  air.add("point_light",
          {{"position", "60,0,12"}, {"power", "800,600,300"}, {"radius", "0.2"}});
  air.compile(1e-3);
  for (const Point& d : {Point{1, 0, 0}, Point{.995, .0998749, 0}, Point{.6, .8, 0}}) {
    const Ray ray = toward(d, 150);
    const auto got = air(ray);
    const auto want = truth::along(air.world(), frame.eye, {ray.d[0], ray.d[1], ray.d[2]},
                                   ray.t, {.tolerance = 1e-5});
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(got.L[c], want.L[c], kTolerance * (1 + want.L[c])) << d[1];
  }
}

TEST(NoiseFog, TheOrderOfStagesChangesNoBit) {
  const Set other = {{"density", "0.01"}, {"color", "0.9,0.1,0.1"}};
  ThroughAir ab, ba;
  ab.add("noise_fog", drifting()).add("height_fog", other).compile();
  ba.add("height_fog", other).add("noise_fog", drifting()).compile();
  std::vector<Ray> rays;
  for (int i = 0; i < 37; ++i)
    rays.push_back(toward({std::cos(.1 * i), std::sin(.1 * i), 0}, 30. * i));
  EXPECT_TRUE(same_bits(ab(rays), ba(rays)));
}

TEST(NoiseFog, HasNothingToDoWithoutDensityOrOpacity) {
  ThroughAir air;
  air.add("noise_fog", {{"density", "0"}}).add("noise_fog", {{"max_opacity", "0"}});
  EXPECT_EQ(air.needs(0).idle, "density is 0");
  EXPECT_EQ(air.needs(1).idle, "max_opacity is 0");
}

TEST(NoiseFog, ItsReadmeIsFresh) {
  expect_generated("plugins/noise_fog/README.md", "parameters",
                   markdown_table(ThroughAir::registry().specs("noise_fog")));
}

}  // namespace
