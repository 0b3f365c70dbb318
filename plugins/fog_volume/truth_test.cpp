// Fog volumes against their truth (oracle.cpp): flat, far, seen from inside, grazed,
// with hard edges and with soft ones.

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "truth/truth.h"
#include "volumes_test.h"

namespace fog_volume {
namespace {

// The truth, and what numbers of the kernel with that eps can do to it. Rounding moves
// the local ray at t by at most delta_i = 2 eps (|o_i| + t |d|/half_i) along axis i: what
// it sees lies between the shape shrunk by that and grown by it. (A ball mixes its axes.)
// The ends of the stretch move by eps t, the exponent by eps of its terms.
struct Truth {
  double tau, opacity, opacity_slack;
};
Truth truth_of(const Volume& v, const Point& eye, const Ray& r, double eps) {
  const Point d = {r.d[0], r.d[1], r.d[2]};
  const Depth at = optical_depth(v, eye, d, r.t);
  const Point lo = to_local(v, eye, false);
  const long double far = std::min<long double>(
      r.t, std::hypot(eye[0] - v.center[0], eye[1] - v.center[1], eye[2] - v.center[2]) +
               std::hypot(v.half[0], v.half[1], v.half[2]));
  Point delta;
  for (std::size_t i = 0; i < 3; ++i)
    delta[i] = 2 * eps * (std::abs(lo[i]) + far / v.half[i]);
  if (!v.box) delta.fill(std::max({delta[0], delta[1], delta[2]}));
  Volume grown = v, shrunk = v;
  for (std::size_t i = 0; i < 3; ++i) {
    grown.half[i] *= 1 + delta[i];
    shrunk.half[i] *= std::max(1 - delta[i], 1e-9L);
  }
  long double slack =
      optical_depth(grown, eye, d, r.t).tau - optical_depth(shrunk, eye, d, r.t).tau;
  slack += eps * (at.sigma0 * at.t0 + at.sigma1 * at.t1);
  long double exponent = 0;
  for (std::size_t i = 0; i < 3; ++i)
    exponent += std::abs(v.falloff * v.gradient[i] * (eye[i] - v.origin[i])) +
                std::abs(v.falloff * v.gradient[i] * d[i]) * at.t1;
  slack += at.tau * eps * std::min(exponent, 1e6L);
  const long double tau = at.tau;
  return {double(tau), double(-std::expm1(-tau)),
          double(std::exp(-std::max(tau - slack, 0.L)) * -std::expm1(-2 * slack))};
}

struct Worst {
  double error = 0, all = 0;
  int asked = 0, well = 0;
};
void expect_near(const Answer& got, const Truth& t, const std::string& where, Worst& w) {
  ++w.asked;
  const bool well = t.opacity_slack <= 5e-6 * t.opacity;
  w.well += well;
  for (int c = 0; c < 3; ++c) {
    ASSERT_TRUE(got.T[c] >= 0 && got.T[c] <= 1 && got.L[c] >= 0 && got.L[c] <= 1)
        << where << ": T " << got.T[c] << ", L " << got.L[c];
    // 1 - T of a T that is a float near 1 is good to eps / 2: L is the opacity.
    const double of_L = std::abs(got.L[c] - t.opacity) - t.opacity_slack;
    const double of_T = std::abs(1. - got.T[c] - t.opacity) - t.opacity_slack - kEps;
    const double error = std::max(of_L, of_T) / std::max(t.opacity, 1e-30);
    EXPECT_LE(error, kError) << where << ": L " << got.L[c] << ", not " << t.opacity
                             << " +- " << t.opacity_slack << "; T " << got.T[c];
    w.all = std::max(w.all, error);
    if (well)
      w.error =
          std::max(w.error, std::abs(got.L[c] - t.opacity) / std::max(t.opacity, 1e-30));
  }
}

TEST(FogVolumeOracle, AgreesWithWhatCanBeSaidByHand) {
  Volume v{.half = {1, 2, 3}, .density = 0.5L};
  EXPECT_NEAR(double(optical_depth(v, {-5, 0, 0}, {1, 0, 0}, kInf).tau), 1, 1e-15);
  EXPECT_NEAR(double(optical_depth(v, {0, 0, 0}, {0, 1, 0}, 1).tau), 0.5, 1e-15);
  EXPECT_EQ(optical_depth(v, {5, 0, 0}, {1, 0, 0}, kInf).tau, 0);
  v.degrees = {0, 0, 90};  // its y axis lies along -x of the world
  EXPECT_NEAR(double(optical_depth(v, {-5, 0, 0}, {1, 0, 0}, kInf).tau), 2, 1e-15);
  v.box = false;
  EXPECT_NEAR(double(optical_depth(v, {0, 0, -9}, {0, 0, 1}, kInf).tau), 3, 1e-15);
  // x = 1 off the axis of semi-axis 2: half chord 3 sqrt(3)/2.
  EXPECT_NEAR(double(optical_depth(v, {1, 0, -9}, {0, 0, 1}, kInf).tau),
              1.5 * std::sqrt(3.), 1e-15);
}

// Flatness to 1e6, the eye in, on and off the shape and at 300 times its size, rays
// through its middle, at its rim and at random: calls f(volume, eye, rays, its name).
template <class F>
void over_the_grid(std::mt19937& random, F f) {
  const auto uniform = [&](long double a, long double b) {
    return a + (b - a) * std::uniform_real_distribution<double>(0, 1)(random);
  };
  const Point halves[] = {{1, 1, 1},       {1, 1e3, 1},    {1e6, 1, 1e3},
                          {1, 1e-6, 1e-3}, {1e-3, 1e3, 1}, {30, 30, 0.03L}};
  const Point turns[] = {{0, 0, 0}, {0, 90, 0}, {20, -35, 130}};
  const long double places[] = {0, 0.5L, 1 - 1e-3L, 1, 1 + 1e-7L, 1 + 1e-3L, 3, 300};
  for (const bool box : {true, false})
    for (const Point& half : halves)
      for (const Point& turn : turns)
        for (const long double place : places) {
          Volume v{.box = box, .center = {3, -2, 5}, .half = half, .degrees = turn};
          v.origin = v.center;
          v.gradient = {0.6L, 0, 0.8L};
          Point local = {uniform(-.5, .5), uniform(-.5, .5), uniform(-.5, .5)};
          long double n = 0;
          for (const auto x : local)
            n = box ? std::max(n, std::abs(x)) : std::hypot(n, x);
          for (auto& x : local) x *= place / n;
          Point eye = in_world(v, local);
          for (auto& x : eye) x = double(x);
          std::vector<Ray> rays;
          for (int i = 0; i < 12; ++i) {
            Point aim = {uniform(-1.1L, 1.1L), uniform(-1.1L, 1.1L),
                         uniform(-1.1L, 1.1L)};
            if (i % 4 == 1) aim[0] = i < 6 ? 1 - 1e-6L : 1;  // grazing
            rays.push_back(toward(eye, in_world(v, aim)));
            if (i % 3 == 0)
              rays.back().t = float(uniform(0.2L, 2) * std::hypot(half[0], half[2]));
          }
          rays.push_back({{0, 0, 0}, {1, 0, 0}, float(kInf)});
          rays.push_back({{0, 0, 0}, {0, 0, -1}, float(kInf)});
          f(v, eye, rays,
            std::string(box ? "box" : "ellipsoid") + ", half " + text(half) + ", turn " +
                text(turn) + ", place " + text(double(place)));
          if (testing::Test::HasFatalFailure()) return;
        }
}

std::vector<Answer> ask(const Volume& v, const Point& eye, const std::vector<Ray>& rays,
                        Isa isa) {
  return ThroughAir(eye_at(double(eye[0]), double(eye[1]), double(eye[2])))
      .add("fog_volume", settings(v))
      .compile(1e-3, isa)(rays);
}

Isa any_isa(std::mt19937& random) { return Isa(random() % (unsigned(best_isa()) + 1)); }

TEST(FogVolume, AgreesWithTheOracleFromInsideOutsideAndOnTheSurface) {
  const unsigned seed = 20040614;
  std::mt19937 random(seed);
  Worst worst[3];
  over_the_grid(random, [&](Volume v, const Point& eye, const std::vector<Ray>& rays,
                            const std::string& name) {
    for (const long double depth : {1e-4L, 1.L, 1e6L})
      for (const long double spread : {0.L, 3.L}) {
        v.density =
            std::min(1e9, double(depth / std::min({v.half[0], v.half[1], v.half[2]})));
        v.falloff = double(spread / std::hypot(v.half[0], v.half[1], v.half[2]));
        const Isa isa = any_isa(random);
        const auto got = ask(v, eye, rays, isa);
        for (std::size_t i = 0; i < rays.size(); ++i)
          expect_near(got[i], truth_of(v, eye, rays[i], kEps),
                      name + ", depth " + text(double(depth)) + ", spread " +
                          text(double(spread)) + ", ray " + std::to_string(i) + ", " +
                          brume::name(isa),
                      worst[int(isa)]);
      }
  });
  for (const Worst& w : worst)
    if (w.asked)
      std::printf(
          "%d rays, seed %u: largest error %.1e where well conditioned (%d rays), "
          "%.1e beyond the conditioning elsewhere\n",
          w.asked, seed, w.error, w.well, w.all);
}

TEST(FogVolume, ItsOwnIntegralAgreesWithTheOracleHoweverFlatOrFarItIs) {
  // Soft edges, and hard ones from two thousand thicknesses on. Nothing is left to the
  // conditioning of floats here; what a sum of two floats does not know of a place is
  // asked for where an error looks too large.
  constexpr double kTwoFloats = 0x1p-46;
  const unsigned seed = 20070801;
  std::mt19937 random(seed);
  double worst = 0;
  int asked = 0;
  over_the_grid(random, [&](Volume v, const Point& eye, const std::vector<Ray>& rays,
                            const std::string& name) {
    for (const long double spread : {0.L, random() % 2 ? 3.L : 30.L}) {
      const Point& h = v.half;
      const long double thin = std::min({h[0], h[1], h[2]}),
                        away = std::hypot(eye[0] - v.center[0], eye[1] - v.center[1],
                                          eye[2] - v.center[2]);
      v.softness = std::array{1e-3, 0.1, 1., away > 2000 * thin ? 0. : 0.3}[random() % 4];
      v.density = double(1 / thin);
      v.falloff = double(spread / std::hypot(h[0], h[1], h[2]));
      const Isa isa = any_isa(random);
      const auto got = ask(v, eye, rays, isa);
      for (std::size_t i = 0; i < rays.size(); ++i, ++asked) {
        const Depth at =
            optical_depth(v, eye, {rays[i].d[0], rays[i].d[1], rays[i].d[2]}, rays[i].t);
        const double opacity = double(-std::expm1(-at.tau));
        double of_L = std::abs(got[i].L[1] - opacity),
               of_T = std::abs(1. - got[i].T[1] - opacity) - kEps;
        if (std::max(of_L, of_T) > kError * opacity) {
          const double slack = truth_of(v, eye, rays[i], kTwoFloats).opacity_slack;
          of_L -= slack, of_T -= slack;
        } else if (opacity > 1e-10) {
          worst = std::max(worst, of_L / opacity);
        }
        // On the surface a double tells u = 1e-16 from 0 at best, and fog begins as u^2.
        EXPECT_LE(std::max(of_L, of_T), kError * opacity + 1e-20)
            << name << ", softness " << v.softness << ", spread " << spread << ", ray "
            << i << ", " << brume::name(isa) << ": L " << got[i].L[1] << ", 1 - T "
            << 1. - got[i].T[1] << ", not " << opacity;
      }
    }
  });
  std::printf("%d rays, seed %u: largest relative error of its own integral %.1e\n",
              asked, seed, worst);
}

TEST(FogVolume, SoftEdgesAgreeWithTheTruth) {
  // Boxes and ellipsoids, every softness, even and thinning fog, from inside and outside;
  // the truth marches through the stage's density at points.
  const unsigned seed = 1123;
  std::mt19937 random(seed);
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  double worst = 0;
  for (int scene = 0; scene < 80; ++scene) {
    const double s = scene % 4 == 0 ? 1 : std::pow(10, uniform(-3, 0));
    const double half[3] = {uniform(2, 12), uniform(2, 12), scene % 5 ? 3 : 0.01};
    const double falloff = scene % 3 ? std::pow(10, uniform(-2, 1.5)) : 0;
    ThroughAir air;
    air.add("fog_volume",
            {{"shape", scene % 2 ? "box" : "ellipsoid"},
             {"center", text(uniform(-2, 2), uniform(-2, 2), uniform(0, 25))},
             {"half", text(half[0], half[1], half[2])},
             {"rotation", text(uniform(0, 360), uniform(0, 360), uniform(0, 360))},
             {"density", text(std::pow(10, uniform(-2, 0.5)))},
             {"gradient", text(uniform(-1, 1), uniform(-1, 1), 1)},
             {"falloff", text(falloff)},
             {"softness", text(s)},
             {"color", "1"}});
    std::vector<Ray> rays;
    for (int i = 0; i < 8; ++i)
      rays.push_back(toward({0, 0, 0}, {uniform(-9, 9), uniform(-9, 9), uniform(5, 20)},
                            i % 2 ? kInf : uniform(5, 40)));
    const Isa isa = Isa(random() % (unsigned(best_isa()) + 1));
    const auto got = air.compile(1e-3, isa)(rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const auto t =
          truth::along(air.world(), {0, 0, 0}, {rays[i].d[0], rays[i].d[1], rays[i].d[2]},
                       rays[i].t, {.tolerance = 1e-9});
      // The exponent is a float, e-folds over 60 m of it; the rest is the rule's 2e-6.
      const double allowed = (1e-5 + 60 * kEps * falloff) * t.L[0];
      const double error = std::abs(got[i].L[0] - t.L[0]);
      EXPECT_LE(error, allowed + 1e-9)  // as good as the truth was asked to be
          << "seed " << seed << ", scene " << scene << ", ray " << i << ", " << name(isa)
          << ": " << got[i].L[0] << ", not " << t.L[0];
      if (falloff < 1 && t.L[0] > 1e-3) worst = std::max(worst, error / t.L[0]);
    }
  }
  std::printf(
      "80 soft volumes: largest relative error of L %.1e where falloff is below 1 / m\n",
      worst);
}

TEST(FogVolume, SoftnessIsBetweenHardAndThinAndVanishesAtTheEdge) {
  const auto seen = [](const std::string& shape, double softness, double off) {
    ThroughAir air(eye_at(off, 0, 0));
    air.add("fog_volume", {{"shape", shape},
                           {"center", "0,0,20"},
                           {"half", "5,5,5"},
                           {"softness", text(softness)},
                           {"color", "1"}});
    return double(air.compile()(toward({0, 0, 0}, {0, 0, 1})).L[1]);
  };
  for (const char* shape : {"box", "ellipsoid"}) {
    double before = seen(shape, 0, 0);
    // A fade over 2e-5 of 5 m takes some 1e-4 m x 0.1/m from 1.
    EXPECT_NEAR(seen(shape, 2e-5, 0), before, 1e-5);
    for (const double s : {0.1, 0.3, 0.6, 1.}) {
      const double L = seen(shape, s, 0);
      EXPECT_LT(L, before);
      before = L;
      // A fiftieth of the way in it has faded to u^2 (3 - 2 u) of u = 0.02/s, or less.
      EXPECT_LT(seen(shape, s, 4.9), seen(shape, 0, 4.9) * 0.15);
    }
  }
  // Through the middle of a box half of each fade counts: 10 m (1 - s/2).
  EXPECT_NEAR(seen("box", 0.4, 0), -std::expm1(-0.1 * 10 * 0.8), 1e-6);
}

}  // namespace
}  // namespace fog_volume
