// Media that overlap, against pointwise double quadrature.

#include <gtest/gtest.h>

#include "support.h"

namespace brume {
namespace {

using namespace testing_air;

TEST(General, TwoFogsThatShareFiftyMetresGiveTheOneRightL) {
  // Both uniform: L = (sa ca + sb cb)/(sa + sb) (1 - e^-(sa + sb) d) exactly.
  const double sa = 0.02, sb = 0.05, d = 50;
  const double S = (sa * 1 + sb * 0.2) / (sa + sb);
  const double exact = S * -std::expm1(-(sa + sb) * d);
  for (Isa isa : isas()) {
    AirOptions o = options();
    o.isa = isa;
    const Air air = Air::compile(world_of({fog(sa, 1), fog(sb, 0.2)}), o);
    Bundle b;
    b.add({0, 0, 1}, d);
    const Result r = integrate(air, b, 2);
    EXPECT_NEAR(r.L[0][0], exact, 1e-6);
    EXPECT_NEAR(r.T[0][0], std::exp(-(sa + sb) * d), 1e-6);
    EXPECT_NEAR(r.stage_L[0][0], sa / (sa * 1 + sb * .2) * exact, 1e-6);
    EXPECT_NEAR(r.stage_L[3][0], sb * .2 / (sa * 1 + sb * .2) * exact, 1e-6);
  }
}

brume_medium random_medium(Random& r) {
  brume_medium m = fog(r.log(1e-4, 1), r.uniform(0, 1));
  if (r.integer(3)) {
    m.profile = BRUME_EXPONENTIAL;
    m.falloff = r.log(1e-4, 0.3);
    const glm::dvec3 d = r.integer(2) ? glm::dvec3(0, 0, 1) : r.direction();
    for (int c = 0; c < 3; ++c) m.direction[c] = d[c], m.origin[c] = r.uniform(-20, 20);
  } else if (r.integer(3) == 0) {
    m.profile = BRUME_LORENTZIAN;
    m.falloff = r.log(1e-4, 1);
    for (int c = 0; c < 3; ++c) m.origin[c] = r.uniform(-50, 50);
  }
  for (int c = 0; c < 3; ++c)
    m.extinction[c] *= r.uniform(0.2, 1), m.color[c] = r.uniform(0, 1);
  const int shape = r.integer(5);
  if (shape == 1)
    m = shaped(m, BRUME_HALF_SPACE, {0, 0, r.uniform(-20, 20)}, {1, 1, 1},
               r.uniform(0, .3));
  if (shape > 1)
    m = shaped(m, shape < 4 ? BRUME_BOX : BRUME_ELLIPSOID,
               {r.uniform(-60, 60), r.uniform(-60, 60), r.uniform(-30, 30)},
               {r.log(2, 80), r.log(2, 80), r.log(2, 80)}, r.uniform(0, 3));
  if (r.integer(6) == 0) m.start = r.uniform(0, 50);
  if (r.integer(6) == 0) m.max_opacity = r.uniform(0.2, 0.95);
  return m;
}

// A ray whose exponential densities stay within what float exponents carry.
bool tame(const World& w, const oracle::Ray& ray) {
  for (const auto& p : w.media) {
    if (p.what.profile != BRUME_EXPONENTIAL) continue;
    double a = 0, b = 0;
    for (int c = 0; c < 3; ++c) {
      a += p.what.falloff * p.what.direction[c] * -p.what.origin[c];
      b += p.what.falloff * p.what.direction[c] * ray.d[c] * ray.end;
    }
    if (std::abs(a) > 40 || std::abs(b) > 200) return false;
  }
  return true;
}

TEST(General, AThousandRandomScenesWithinTheTolerance) {
  const unsigned seed = 2024;
  RecordProperty("seed", int(seed));
  Random random(seed);
  double worst = 0, worst_T = 0, sum = 0;
  int rays = 0;
  for (int scene = 0; scene < 1000; ++scene) {
    std::vector<brume_medium> media;
    const int n = 2 + random.integer(4);
    for (int i = 0; i < n; ++i) media.push_back(random_medium(random));
    const World w = world_of(media);
    double largest = 0;
    for (const auto& m : media)
      for (double x : m.color) largest = std::max(largest, x);
    AirOptions o = options();
    const auto available = isas();
    o.isa = available[std::size_t(scene) % available.size()];
    const Air air = Air::compile(w, o);
    Bundle b;
    for (int i = 0; i < 4; ++i) b.add(random.direction(), random.log(1, 400));
    const Result r = integrate(air, b);
    for (int i = 0; i < b.size(); ++i) {
      if (!tame(w, b.ray(i))) continue;
      const auto truth = oracle::integrate(w, b.ray(i), 1e-6);
      ++rays;
      for (int c = 0; c < 3; ++c) {
        const double error = std::abs(r.L[c][i] - truth.L[c]);
        worst = std::max(worst, error / largest);
        sum += error / largest / 3;
        worst_T = std::max(worst_T, std::abs(r.T[c][i] - truth.T[c]));
        EXPECT_LE(error, 1e-3 * largest) << "scene " << scene << " ray " << i << " L "
                                         << r.L[c][i] << " truth " << truth.L[c];
        // Exponents to 240 rounded at 6e-8, times tau e^-tau <= .37.
        EXPECT_NEAR(r.T[c][i], truth.T[c], 1e-5) << "scene " << scene << " ray " << i;
      }
    }
  }
  printf(
      "  %d rays: largest error of L %.2g of the largest source (mean %.2g), of T %.2g\n",
      rays, worst, sum / rays, worst_T);
  EXPECT_GE(rays, 3000);
}

TEST(General, ErrorFallsWithTheTolerance) {
  const unsigned seed = 12;
  RecordProperty("seed", int(seed));
  double last = 1;
  for (double tolerance : {1e-2, 1e-3, 1e-4}) {
    Random random(seed);
    double worst = 0;
    for (int scene = 0; scene < 60; ++scene) {
      std::vector<brume_medium> media;
      for (int i = 0; i < 3; ++i) media.push_back(random_medium(random));
      const World w = world_of(media);
      const Air air = Air::compile(w, options(16, tolerance));
      Bundle b;
      for (int i = 0; i < 4; ++i) b.add(random.direction(), random.log(1, 400));
      const Result r = integrate(air, b);
      for (int i = 0; i < b.size(); ++i) {
        if (!tame(w, b.ray(i))) continue;
        const auto truth = oracle::integrate(w, b.ray(i), 1e-7);
        for (int c = 0; c < 3; ++c)
          worst = std::max(worst, std::abs(r.L[c][i] - truth.L[c]));
      }
    }
    printf("  tolerance %g: largest error %.2g\n", tolerance, worst);
    // 2e-5 is what float leaves of many pieces and long exponents.
    EXPECT_LE(worst, tolerance + 2e-5);
    EXPECT_LE(worst, last);
    last = worst;
  }
}

TEST(General, EmissionInsideAnAbsorberIsDimmed) {
  // A glowing core (no extinction) in black fog.
  brume_medium glow = fog(0);
  glow.profile = BRUME_LORENTZIAN;
  glow.falloff = 0.5;
  glow.origin[2] = 20;
  for (double& e : glow.emission) e = 0.3;
  const World w = world_of({glow, fog(0.03)});
  const Air air = Air::compile(w, options());
  Bundle b;
  for (double x : {0., .01, .1, 1.}) b.add({x, 0, 1}, 60);
  const Result r = integrate(air, b);
  for (int i = 0; i < b.size(); ++i)
    EXPECT_NEAR(r.L[0][i], oracle::integrate(w, b.ray(i)).L[0], 1e-3);
}

TEST(General, StiffMediaAreExactInTAndBoundedInL) {
  // sigma ds from 1e-9 to 1e9 under a second fog; the nearer surface shows.
  for (double sigma : {1e-9, 1e-3, 1., 1e3, 1e6, 1e9}) {
    const World w = world_of({height_fog(sigma, 0.1, 0, 0.7), fog(1e-2, 0.1)});
    const Air air = Air::compile(w, options());
    Bundle b;
    b.add({0, 0, 1}, 1);
    b.add({0, 0, -1}, 1);
    b.add({1, 0, 0}, kInf);
    b.add({0, 0, -1}, kInf);
    b.add({0, 0, 1}, kInf);
    const Result r = integrate(air, b);
    for (int i = 0; i < b.size(); ++i) {
      ASSERT_TRUE(std::isfinite(r.L[0][i])) << sigma << " " << i;
      ASSERT_TRUE(r.L[0][i] >= 0 && r.L[0][i] <= 0.7001 * (1 - r.T[0][i]) + 1e-6)
          << sigma << " " << i << " " << r.L[0][i];
    }
    if (sigma >= 1e6) {
      EXPECT_NEAR(r.L[0][1], 0.7, 1e-3);
    }
    const double exact = (sigma * .7 + 1e-2 * .1) / (sigma + 1e-2);
    EXPECT_NEAR(r.L[0][2], exact, 1e-3) << sigma;
  }
}

TEST(General, AThinDenseBankIsNotSteppedOver) {
  // One millimetre of tau = 3 in a kilometre of haze.
  const World w = world_of(
      {fog(1e-3, 1), shaped(fog(3000, 0.1), BRUME_BOX, {0, 0, 700.3}, {500, 500, 5e-4})});
  const Air air = Air::compile(w, options());
  Bundle b;
  b.add({0, 0, 1}, 1000);
  const Result r = integrate(air, b);
  const auto truth = oracle::integrate(w, b.ray(0));
  // The bank's faces are at float(700.2995) .. : 3e-5 of 1e-3 m.
  EXPECT_NEAR(r.L[0][0], truth.L[0], 0.03);
  EXPECT_NEAR(r.T[0][0], truth.T[0], 0.01);
}

}  // namespace
}  // namespace brume
