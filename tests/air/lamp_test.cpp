// Lamps in fog, against pointwise double quadrature.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "support.h"

namespace brume {
namespace {

using namespace testing_air;

TEST(Lamps, OneStagesLampGlowsInAnotherStagesFog) {
  // 600 m of thin fog, the lamp 20 m away and 3 m off the ray.
  const World w = world_of(
      {white_fog(0.01), shaped(fog(0.03, .3), BRUME_BOX, {0, 0, 60}, {10, 10, 20})},
      {lamp({0, 3, 20}, 100)});
  const Air air = Air::compile(w, options());
  Bundle b;
  for (double t : {5., 20., 50., 100., 600.}) b.add({0, 0, 1}, t);
  const Result r = integrate(air, b, 2);
  for (int i = 0; i < b.size(); ++i) {
    const auto truth = oracle::integrate(w, b.ray(i), 1e-8);
    EXPECT_NEAR(r.L[0][i], truth.L[0], 1e-3 * (1 + truth.L[0])) << b.end[i];
    EXPECT_NEAR(r.stage_L[0][i] + r.stage_L[3][i], r.L[0][i], 1e-5 * r.L[0][i]);
  }
}

TEST(Lamps, RandomLampsInRandomFog) {
  const unsigned seed = 21;
  RecordProperty("seed", int(seed));
  Random random(seed);
  double worst = 0, sum = 0;
  int n = 0;
  for (int scene = 0; scene < 36; ++scene) {
    brume_medium m = random.integer(2)
                         ? height_fog(random.log(1e-4, .1), random.log(1e-3, .05), 0, 0)
                         : fog(random.log(1e-4, .1));
    for (double& a : m.albedo) a = random.uniform(0.1, 1);
    m.g = random.uniform(-.8, .8);
    m.phase = brume_phase(random.integer(3));
    if (random.integer(3) == 0)
      m = shaped(m, random.integer(2) ? BRUME_BOX : BRUME_ELLIPSOID, {0, 0, 20},
                 {30, 40, 15});
    std::vector<brume_medium> media = {m};
    if (random.integer(2))
      media.push_back(shaped(fog(0.05, 0.5), BRUME_BOX, {0, 5, 25}, {20, 20, 20}));
    brume_light l =
        lamp({random.uniform(-20, 20), random.uniform(-20, 20), random.uniform(-10, 50)},
             random.log(1, 1e3), random.integer(2) ? BRUME_SPOT : BRUME_POINT);
    const glm::dvec3 axis = random.direction();
    for (int c = 0; c < 3; ++c) l.direction[c] = axis[c];
    l.cone = random.uniform(0.05, 1.5);
    l.cone_soft = random.uniform(0.2, 1) * l.cone;
    l.cone_falloff = random.integer(3) == 0;
    l.radius = random.integer(2) ? 0.1 : 0;
    const World w = world_of(media, {l});
    const auto available = isas();
    AirOptions o = options();
    o.isa = available[std::size_t(scene) % available.size()];
    const Air air = Air::compile(w, o);
    Bundle b;
    for (int i = 0; i < 3; ++i) {
      const glm::dvec3 near(l.position[0] + random.uniform(-5, 5),
                            l.position[1] + random.uniform(-5, 5), l.position[2]);
      b.add(i == 0 ? random.direction() : near, random.log(10, 200));
    }
    const Result r = integrate(air, b);
    for (int i = 0; i < b.size(); ++i) {
      const auto truth = oracle::integrate(w, b.ray(i), 1e-6);
      const double error = std::abs(r.L[0][i] - truth.L[0]) / (1 + truth.L[0]);
      worst = std::max(worst, error);
      sum += error;
      ++n;
      EXPECT_LE(error, 1e-3) << "scene " << scene << " ray " << i << " L " << r.L[0][i]
                             << " truth " << truth.L[0];
    }
  }
  printf("  %d rays: largest error %.2g of (1 + L), mean %.2g\n", n, worst, sum / n);
}

TEST(Lamps, FogWithoutBoundsIsTheSameFogInBoundsThatNothingReaches) {
  // The first has a shorter way (LampRays::node), the second the general one. Falloffs
  // of up to 1200 folds on a ray, lanes where the stage's weight is 0, and both sorts in
  // one batch. The same rule at the same nodes: they part by rounding, of exponents of up
  // to 80 (eps 80 = 1e-5).
  const unsigned seed = 22;
  RecordProperty("seed", int(seed));
  Random random(seed);
  double worst = 0;
  for (int scene = 0; scene < 200; ++scene) {
    auto m = scene % 5 == 0 ? white_fog(random.log(1e-4, 1))
                            : height_fog(random.log(1e-4, 1), random.log(1e-4, 3),
                                         random.uniform(-30, 30), 0);
    for (double& a : m.albedo) a = .9;
    m.g = scene % 2 ? random.uniform(-.9, .9) : 0;
    const auto l = lamp({random.uniform(-40, 40), random.uniform(-40, 40), 30},
                        random.log(1, 1e4), scene % 3 ? BRUME_POINT : BRUME_SPOT);
    const auto bounded = shaped(m, BRUME_BOX, {0, 0, 0}, {1e5, 1e5, 1e5});
    Bundle b;
    std::vector<float> weight;
    for (int i = 0; i < 32; ++i) {
      b.add(random.direction(), random.log(1, 400));
      weight.push_back(i % 7 == 3 ? 0 : i % 3 ? 1 : float(random.uniform(0, 1)));
    }
    const float* const weights[] = {weight.data()};
    const Air air = Air::compile(world_of({m}, {l}), options());
    const Result open = integrate(air, b, 1, weights);
    const Result closed =
        integrate(Air::compile(world_of({bounded}, {l}), options()), b, 1, weights);
    for (int i = 0; i < b.size(); ++i)
      worst = std::max(worst, std::abs(double(open.L[0][i]) - closed.L[0][i]) /
                                  (1e-3 + closed.L[0][i]));
    // Which way a ray takes is its own affair: alone it has the same bits.
    for (int i = 0; i < b.size(); i += 5) {
      Bundle one;
      one.add({b.d[0][i], b.d[1][i], b.d[2][i]}, b.end[i]);
      for (int c = 0; c < 3; ++c) one.d[c][0] = b.d[c][i];
      const float* const its[] = {&weight[std::size_t(i)]};
      ASSERT_EQ(integrate(air, one, 1, its).L[0][0], open.L[0][i]) << scene << " " << i;
    }
  }
  printf("  part by %.2g at most\n", worst);
  EXPECT_LE(worst, 2e-5);
}

TEST(Lamps, HardPlacesAreFinite) {
  // The lamp on the ray, at the eye, behind it; opaque and clear fog; endless rays.
  for (double sigma : {1e-6, 1e-2, 1., 1e3, 1e6})
    for (glm::dvec3 at :
         {glm::dvec3(0, 0, 10), glm::dvec3(0, 0, 0), glm::dvec3(0, 0, -10),
          glm::dvec3(1e-4, 0, 10), glm::dvec3(1e4, 0, 1e4)})
      for (double radius : {0., 0.1}) {
        brume_light l = lamp(at, 1e6);
        l.radius = radius;
        const World w = world_of({white_fog(sigma, 0.9)}, {l});
        const Air air = Air::compile(w, options());
        Bundle b;
        for (double t : {0., 1e-3, 5., 10., 100., double(INFINITY)}) b.add({0, 0, 1}, t);
        const Result r = integrate(air, b);
        for (int i = 0; i < b.size(); ++i) {
          ASSERT_TRUE(std::isfinite(r.L[0][i]) && r.L[0][i] >= 0)
              << sigma << " " << at.x << " " << at.z << " " << radius << " " << b.end[i]
              << " " << r.L[0][i];
        }
        EXPECT_EQ(r.L[0][0], 0);
      }
}

TEST(Lamps, ThickFogAroundALampShowsLittleOfIt) {
  // sigma h = 20 and 200: the glow is what oracle and a bound of e^-sigma h say.
  for (double sigma : {2., 20.}) {
    const World w = world_of({white_fog(sigma)}, {lamp({0, 10, 10}, 1e9)});
    const Air air = Air::compile(w, options());
    Bundle b;
    b.add({0, 0, 1}, 40);
    const Result r = integrate(air, b);
    const auto truth = oracle::integrate(w, b.ray(0), 1e-12);
    EXPECT_NEAR(r.L[0][0], truth.L[0], 1e-3 * (1 + truth.L[0]));
  }
}

TEST(Lamps, LightScatteredNearTheEyeIsSeenThoughTheLampIsFarAndDeep) {
  // tau to the lamp's foot is 20: all that shows is scattered in the first metres, where
  // the lamp's angle hardly changes.
  for (double sigma : {0.005, 0.02, 0.1}) {
    World w = world_of({white_fog(sigma)}, {lamp({0, 5, 1000}, 1e9)});
    w.lights[0].what.attenuated = 0;
    const Air air = Air::compile(w, options());
    Bundle b;
    b.add({0, 0, 1}, 2000);
    b.add({0, 0, 1}, 990);
    const Result r = integrate(air, b);
    for (int i = 0; i < 2; ++i) {
      const auto truth = oracle::integrate(w, b.ray(i), 1e-9);
      EXPECT_NEAR(r.L[0][i], truth.L[0], 1e-3 * (1 + truth.L[0])) << sigma;
    }
  }
}

TEST(Lamps, IrradianceOnAPlane) {
  World w = world_of({fog(0.1)}, {lamp({0, 0, 5}, 50)});
  brume_light sky = {};
  sky.size = sizeof sky;
  sky.kind = BRUME_SKY_LIGHT;
  for (double& x : sky.power) x = 0.5;
  w.lights.push_back({sky, 0, ""});
  const Air air = Air::compile(w, options());
  const float o[3] = {0, 0, 0}, n[2] = {1, 0.6f}, side[2] = {0, 0.8f}, zero[2] = {0, 0};
  float E[3][2];
  float* const out[3] = {E[0], E[1], E[2]};
  const RaySpans points{2, o, o, o, side, zero, n, zero};
  air.irradiance(0, points, out);
  EXPECT_NEAR(E[0][0], 50 / 25. * std::exp(-.5), 1e-6);
  EXPECT_NEAR(E[0][1], 50 / 25. * std::exp(-.5) * .6, 1e-6);
  air.irradiance(1, points, out);
  EXPECT_NEAR(E[0][0], M_PI * .5, 1e-6);
}

// Opaque bodies between lamp and ray throw shadows with sharp edges, narrower than any
// spacing of nodes. Single scattering in thin fog with these bodies, in double: the ray
// in 200000 even pieces, the way to the lamp blocked where it meets a body, which is
// asked for as the quadratic or the slabs say. Fog between lamp and ray is thin enough to
// leave out (tau <= 2e-4), and so is what it does before.
struct Body {
  glm::dvec3 center, half;
  bool box;

  // Whether the way from x along u, to x + u, meets it.
  bool blocks(const glm::dvec3& x, const glm::dvec3& u) const {
    const glm::dvec3 p = (x - center) / half, q = u / half;
    if (!box) {
      const double near = std::clamp(-glm::dot(p, q) / glm::dot(q, q), 0., 1.);
      return glm::length(p + near * q) < 1;
    }
    double lo = 0, hi = 1;
    for (int c = 0; c < 3; ++c) {
      const double t0 = (-1 - p[c]) / q[c], t1 = (1 - p[c]) / q[c];
      lo = std::max(lo, std::min(t0, t1)), hi = std::min(hi, std::max(t0, t1));
    }
    return lo < hi;
  }
};
constexpr double kThin = 1e-6, kStrong = 1e9, kRay = 60;  // fog, lamp, length
struct Shaded {
  double lit = 0, all = 0;
  int edges = 0;
};
Shaded shaded(const std::vector<Body>& bodies, const glm::dvec3& at) {
  constexpr int kPieces = 200'000;
  Shaded s;
  bool before = false;
  for (int i = 0; i < kPieces; ++i) {
    const glm::dvec3 x(0, 0, (i + .5) * kRay / kPieces), u = at - x;
    const bool blocked =
        std::ranges::any_of(bodies, [&](const Body& b) { return b.blocks(x, u); });
    const double glow = kThin * kStrong / (4 * M_PI * glm::dot(u, u)) * kRay / kPieces;
    s.all += glow;
    if (!blocked) s.lit += glow;
    s.edges += blocked != before;
    before = blocked;
  }
  return s;
}
double through_air(const std::vector<Body>& bodies, const glm::dvec3& at, unsigned isa) {
  std::vector<brume_medium> media = {white_fog(kThin)};
  for (const Body& b : bodies)
    media.push_back(
        shaped(fog(1e5), b.box ? BRUME_BOX : BRUME_ELLIPSOID, b.center, b.half));
  AirOptions o = options();
  const auto available = isas();
  o.isa = available[isa % available.size()];
  Bundle b;
  b.add({0, 0, 1}, kRay);
  return integrate(Air::compile(world_of(media, {lamp(at, kStrong)}), o), b,
                   int(media.size()))
      .L[0][0];
}

TEST(Lamps, ABodysShadowFallsBetweenNoNodes) {
  const unsigned seed = 8;
  RecordProperty("seed", int(seed));
  Random random(seed);
  double worst = 0;
  int shadows = 0;
  for (int scene = 0; scene < 60; ++scene) {
    const glm::dvec3 half(random.log(.05, 2), random.log(.05, 2), random.log(.05, 2));
    const glm::dvec3 at(random.uniform(-5, 5), random.uniform(10, 14),
                        random.uniform(5, 55));
    const glm::dvec3 behind(0, 0, random.uniform(2, 58));
    const std::vector<Body> body = {
        {behind + random.uniform(.2, .8) * (at - behind), half, scene % 2 == 1}};
    const Shaded s = shaded(body, at);
    shadows += s.lit < 0.999 * s.all;
    worst = std::max(
        worst, std::abs(through_air(body, at, unsigned(scene)) - s.lit) / (1 + s.lit));
  }
  EXPECT_GT(shadows, 50);
  std::printf("%d shadows, largest error %.1e of 1 + L\n", shadows, worst);
  EXPECT_LE(worst, 1e-3);  // the tolerance; the oracle's edges are good to 1e-5 of L
}

TEST(Lamps, NoneOfManyBodiesShadowsIsLost) {
  // Fences of slats and rows of balls between ray and lamp.
  const unsigned seed = 9;
  RecordProperty("seed", int(seed));
  Random random(seed);
  double worst = 0;
  int most = 0;
  for (int scene = 0; scene < 12; ++scene) {
    const glm::dvec3 at(random.uniform(-5, 5), random.uniform(10, 14),
                        random.uniform(20, 40));
    std::vector<Body> bodies;
    for (int i = 0; i < 40; ++i) {
      const glm::dvec3 behind(0, 0, 2 + 1.4 * i + random.uniform(-.5, .5));
      bodies.push_back({behind + random.uniform(.3, .6) * (at - behind),
                        glm::dvec3(random.log(.03, .4)), i % 2 == 1});
    }
    const Shaded s = shaded(bodies, at);
    most = std::max(most, s.edges);
    worst = std::max(
        worst, std::abs(through_air(bodies, at, unsigned(scene)) - s.lit) / (1 + s.lit));
  }
  EXPECT_GT(most, 50);
  std::printf("up to %d edges, largest error %.1e of 1 + L\n", most, worst);
  EXPECT_LE(worst, 1e-3);  // the tolerance; 60 edges are good to 1e-4 of L
}

// A medium of a third party's functions whose density goes up and down 1300 times on 200
// m: 1 + 0.9 sin(40 z). It counts how often it is asked for its depth.
struct Ripples {
  static constexpr double kWaves = 40, kPart = 0.9;
  static double depth(double z, double dz, double t0, double t1) {
    const double b = kWaves * dz;
    const double s =
        std::abs(b) < 1e-9
            ? std::sin(kWaves * z) * (t1 - t0)
            : (std::cos(kWaves * z + b * t0) - std::cos(kWaves * z + b * t1)) / b;
    return t1 - t0 + kPart * s;
  }
  static void integral(const void* asked, const brume_rays* r, const float* t0,
                       const float* t1, float* D) {
    *static_cast<long*>(const_cast<void*>(asked)) += long(r->n);
    for (size_t i = 0; i < r->n; ++i)
      D[i] = float(depth(double(r->oz ? r->oz[i] : 0), double(r->dz[i]), double(t0[i]),
                         double(t1[i])));
  }
  static void density(const void*, const brume_rays* r, const float* t, float* rho) {
    for (size_t i = 0; i < r->n; ++i)
      rho[i] = float(1 + kPart * std::sin(kWaves * (double(r->oz ? r->oz[i] : 0) +
                                                    double(r->dz[i]) * double(t[i]))));
  }
};

TEST(Lamps, FogOfFineDetailIsSeenByItsDepth) {
  const double sigma = 0.01, g = 0.3, power = 500, end = 200;
  const glm::dvec3 at(5, 0, 60), d = glm::normalize(glm::dvec3(0.05, 0.02, 1));
  const auto p = [&](double mu) {
    return (1 - g * g) / (4 * M_PI * std::pow(1 + g * g - 2 * g * mu, 1.5));
  };
  for (const bool dimmed : {false, true}) {
    long asked = 0;
    brume_medium m = fog(sigma);
    m.profile = BRUME_CUSTOM;
    m.self = &asked;
    m.integral = Ripples::integral, m.density = Ripples::density;
    m.g = g;
    for (double& a : m.albedo) a = 1;
    brume_light l = lamp(at, power);
    l.attenuated = dimmed;
    // The midpoint rule, 50 points to a wave.
    double want = 0, tau = 0;
    const int n = 400'000;
    for (int i = 0; i < n; ++i) {
      const double t = (i + .5) * end / n, z = d.z * t;
      const glm::dvec3 way = at - t * d;
      const double r = glm::length(way);
      const double rho = 1 + Ripples::kPart * std::sin(Ripples::kWaves * z);
      tau = sigma * Ripples::depth(0, d.z, 0, t);
      if (dimmed) tau += sigma * Ripples::depth(z, way.z / r, 0, r);
      want += sigma * rho * std::exp(-tau) * power / (r * r) * p(glm::dot(way, d) / r) *
              end / n;
    }
    for (const Isa isa : isas()) {
      AirOptions o = options();
      o.isa = isa;
      Bundle b;
      b.add(d, end);
      asked = 0;
      const Air air = Air::compile(world_of({m}, {l}), o);
      // Dimmed, its own ripples part a way that goes across z from its neighbours.
      EXPECT_NEAR(integrate(air, b).L[0][0], want, (dimmed ? 1e-3 : 2e-4) * (1 + want))
          << name(isa) << " " << dimmed;
      EXPECT_LT(asked, 1000 * 16) << "of 16 rays, on both ways";  // 90 000 by points
    }
  }
}

}  // namespace
}  // namespace brume
