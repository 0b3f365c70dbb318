// Sunlight dimmed on its way by other stages' media, against pointwise double quadrature.

#include <gtest/gtest.h>

#include "support.h"

namespace brume {
namespace {

using namespace testing_air;

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

}  // namespace
}  // namespace brume
