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

// Haze that light scatters in, and a sun above it.
brume_medium lit_haze(Random& random) {
  brume_medium haze = height_fog(random.log(1e-3, 3e-2), random.log(1e-2, 1e-1), 0, 0);
  for (double& a : haze.albedo) a = 0.9;
  haze.g = random.uniform(-.5, .8);
  return haze;
}
brume_light sun_above(Random& random) {
  brume_light sun = {};
  sun.size = sizeof sun;
  sun.kind = BRUME_SUN;
  sun.attenuated = 1;
  glm::dvec3 to = random.direction();
  to.z = std::abs(to.z) + 0.2;
  to = glm::normalize(to);
  for (int c = 0; c < 3; ++c) sun.direction[c] = to[c], sun.power[c] = 5;
  return sun;
}
// Rays that go up, or down a little, at least so far.
Bundle four_rays(Random& random, double nearest) {
  Bundle b;
  for (int i = 0; i < 4; ++i) {
    glm::dvec3 d = random.direction();
    d.z = std::max(d.z, -0.1);
    b.add(d, random.log(nearest, 300));
  }
  return b;
}

TEST(General, SunlightDimmedOnItsWayThroughAnotherStagesFog) {
  const unsigned seed = 77;
  RecordProperty("seed", int(seed));
  Random random(seed);
  double worst = 0;
  for (int scene = 0; scene < 40; ++scene) {
    const brume_medium haze = lit_haze(random);
    brume_medium other =
        height_fog(random.log(1e-3, 3e-2), random.log(1e-2, 1e-1), 10, .2);
    const World w = world_of({haze, other}, {sun_above(random)});
    const Air air = Air::compile(w, options());
    const Bundle b = four_rays(random, 1);
    const Result r = integrate(air, b, 2);
    for (int i = 0; i < b.size(); ++i) {
      const auto truth = oracle::integrate(w, b.ray(i), 1e-6);
      worst = std::max(worst, std::abs(r.L[0][i] - truth.L[0]) / (1 + truth.L[0]));
      EXPECT_NEAR(r.L[0][i], truth.L[0], 1e-3 * (1 + truth.L[0])) << scene << " " << i;
      EXPECT_NEAR(r.stage_L[0][i] + r.stage_L[3][i], r.L[0][i], 1e-5 * (1 + r.L[0][i]));
    }
  }
  printf("  largest error %.2g\n", worst);
}

TEST(General, ASunOnTheHorizonShinesHighAboveTheFogThatHidesIt) {
  // Straight up from the ground. With y = e^-fz and c the fog's depth toward the sun,
  //   L = E p s Int_0^1 e^{-s (1 - y) - c y} dy,  s = sigma / f, c = s / sin(elevation),
  // all of it where a thousandth of a thousandth of the fog is left.
  const double sigma = 7e-5, f = 9e-4, elevation = 1e-7, E = 1e6;
  brume_medium m = height_fog(sigma, f, 0, 0);
  for (double& a : m.albedo) a = 1;
  brume_light sun = lamp({}, E, BRUME_SUN);
  sun.direction[0] = std::cos(elevation), sun.direction[2] = std::sin(elevation);
  const double s = sigma / f, c = s / std::sin(elevation);
  const double want = E / (4 * M_PI) * s * std::exp(-s) * -std::expm1(-(c - s)) / (c - s);
  for (Isa isa : isas())
    for (const double t : {5e4, 1e6, 1e12, double(INFINITY)}) {
      AirOptions o = options();
      o.isa = isa;
      Bundle b;
      b.add({0, 0, 1}, t);
      const Result r = integrate(Air::compile(world_of({m}, {sun}), o), b);
      EXPECT_NEAR(r.L[0][0], want, 1e-3 * (1 + want)) << name(isa) << " " << t;
    }
}

TEST(General, AShadowThrownByAnotherStagesVolumeIsNotMissed) {
  // Boxes and ellipsoids, some of them small, between the sun and lit haze.
  const unsigned seed = 5;
  RecordProperty("seed", int(seed));
  Random random(seed);
  double worst = 0;
  for (int scene = 0; scene < 40; ++scene) {
    const brume_medium haze = lit_haze(random);
    const brume_medium volume = shaped(
        fog(random.log(1e-2, 1), .2), random.integer(2) ? BRUME_BOX : BRUME_ELLIPSOID,
        {random.uniform(-30, 30), random.uniform(-30, 30), random.uniform(10, 40)},
        {random.log(1, 20), random.log(1, 20), random.log(1, 10)}, random.uniform(0, 3));
    const World w = world_of({haze, volume}, {sun_above(random)});
    const Air air = Air::compile(w, options());
    const Bundle b = four_rays(random, 10);
    const Result r = integrate(air, b);
    for (int i = 0; i < b.size(); ++i) {
      // The oracle knows of no shadow: it looks at 64 panels whatever it finds.
      const auto truth = oracle::integrate(w, b.ray(i), 1e-6);
      worst = std::max(worst, std::abs(r.L[0][i] - truth.L[0]) / (1 + truth.L[0]));
      EXPECT_NEAR(r.L[0][i], truth.L[0], 1e-3 * (1 + truth.L[0])) << scene << " " << i;
    }
  }
  printf("  largest error %.2g\n", worst);
}

// A third party's medium: density 1 + sin(z/5)/2, its own integral and source.
struct Wave {
  static void integral(const void*, const brume_rays* r, const float* t0, const float* t1,
                       float* D) {
    for (size_t i = 0; i < r->n; ++i) {
      const double b = r->dz[i] / 5, a = (r->oz ? r->oz[i] : 0) / 5;
      const double s = std::abs(b) < 1e-9
                           ? std::sin(a) * (t1[i] - t0[i])
                           : (std::cos(a + b * t0[i]) - std::cos(a + b * t1[i])) / b;
      D[i] = float(t1[i] - t0[i] + s / 2);
    }
  }
  static void density(const void*, const brume_rays* r, const float* t, float* rho) {
    for (size_t i = 0; i < r->n; ++i)
      rho[i] = float(1 + std::sin(((r->oz ? r->oz[i] : 0) + r->dz[i] * t[i]) / 5.) / 2);
  }
  static void source(const void*, const brume_rays* r, const float* t, float* x, float* y,
                     float* z) {
    for (size_t i = 0; i < r->n; ++i) x[i] = y[i] = z[i] = float(std::exp(-t[i] * 0.02));
  }
  static void point(const void*, const double p[3], const double*, double* rho,
                    double S[3]) {
    *rho = 1 + std::sin(p[2] / 5) / 2;
    const double t = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    for (int c = 0; c < 3; ++c) S[c] = std::exp(-t * 0.02);
  }
};

TEST(General, AMediumWithItsOwnFunctions) {
  brume_medium m = fog(0.03);
  m.profile = BRUME_CUSTOM;
  m.source = BRUME_SOURCE_CUSTOM;
  m.integral = Wave::integral;
  m.density = Wave::density;
  m.source_at = Wave::source;
  m.point = Wave::point;
  m = shaped(m, BRUME_BOX, {0, 0, 40}, {50, 50, 30});
  for (const World& w : {world_of({m}), world_of({m, height_fog(0.02, 0.05, 0, .5)})}) {
    const Air air = Air::compile(w, options());
    Bundle b;
    for (int i = 0; i < 20; ++i) b.add({0.1 * i, 0.02 * i, 1}, 100);
    const Result r = integrate(air, b);
    for (int i = 0; i < b.size(); ++i) {
      const auto truth = oracle::integrate(w, b.ray(i), 1e-7);
      EXPECT_NEAR(r.L[0][i], truth.L[0], 1e-3) << i;
      EXPECT_NEAR(r.T[0][i], truth.T[0], 2e-6) << i;
    }
  }
}

TEST(General, PiecesThatNeverAgreeLoseNoLight) {
  // A medium that is a fifth off, another way for every stretch it is asked for, in fog
  // of another colour: no piece is ever good, and after thousands of short ones there is
  // still most of the ray to go.
  brume_medium m = fog(0.003, 2);
  m.profile = BRUME_CUSTOM;
  m.integral = [](const void*, const brume_rays* r, const float* t0, const float* t1,
                  float* D) {
    for (std::size_t i = 0; i < r->n; ++i) {
      const double mixed = std::sin(1e4 * double(t0[i])) + std::sin(1e4 * double(t1[i]));
      D[i] = float((double(t1[i]) - double(t0[i])) * (1 + 0.1 * mixed));
    }
  };
  m.density = [](const void*, const brume_rays* r, const float*, float* rho) {
    for (std::size_t i = 0; i < r->n; ++i) rho[i] = 1;
  };
  const Air air = Air::compile(world_of({m, fog(0.001, 10)}), options(16, 1e-5));
  Bundle b;
  for (const double t : {30., 300., 3000., 3e5}) b.add({0, 0.6, 0.8}, t);
  const Result r = integrate(air, b);
  for (int i = 0; i < b.size(); ++i) {
    const double L = (2 * 0.003 + 10 * 0.001) / 0.004 * -std::expm1(-0.004 * b.end[i]);
    EXPECT_NEAR(r.L[0][i], L, 0.2 * L) << b.end[i];
  }
}

TEST(General, AMirrorInMidAirSplitsTheRay) {
  // A plane at z = -10 reflecting a quarter; uniform fog everywhere, black sky.
  brume_interface plane = {};
  plane.size = sizeof plane;
  plane.hit = [](const void*, const brume_rays* r, float* t, float* nx, float* ny,
                 float* nz, float* R) {
    for (size_t i = 0; i < r->n; ++i) {
      t[i] = r->dz[i] < 0 ? -10 / r->dz[i] : kInf;
      nx[i] = ny[i] = 0;
      nz[i] = 1;
      R[i] = 0.25f;
    }
  };
  brume_background sky = {};
  sky.size = sizeof sky;
  sky.radiance = [](const void*, const brume_rays* r, float* x, float* y, float* z) {
    for (size_t i = 0; i < r->n; ++i) x[i] = y[i] = z[i] = 8;
  };
  World w = world_of({shaped(fog(0.1, 1), BRUME_BOX, {0, 0, 0}, {1e3, 1e3, 50})});
  w.interfaces.push_back({plane, 0, ""});
  w.backgrounds.push_back({sky, 0, ""});
  const Air air = Air::compile(w, options());
  Bundle b;
  b.add({0, 0, -1}, 30);  // through the mirror
  b.add({0, 0, -1}, 5);   // ends before it
  b.add({0, 0, 1}, 30);   // away from it
  const Result r = integrate(air, b);
  const double T10 = std::exp(-1.), T20 = std::exp(-2.), T60 = std::exp(-6.);
  EXPECT_NEAR(r.T[0][0], T10 * 0.75 * T20, 1e-6);
  EXPECT_NEAR(r.L[0][0],
              (1 - T10) + T10 * 0.25 * ((1 - T60) + T60 * 8) + T10 * 0.75 * (1 - T20),
              1e-5);
  EXPECT_NEAR(r.T[0][1], std::exp(-.5), 1e-6);
  EXPECT_NEAR(r.T[0][2], std::exp(-3.), 1e-6);
}

}  // namespace
}  // namespace brume
