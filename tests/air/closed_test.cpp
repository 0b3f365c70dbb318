// One medium: its closed form against the same formula in long double, or quadrature.

#include <gtest/gtest.h>

#include "support.h"

namespace brume {
namespace {

using namespace testing_air;

constexpr double kEps = 5.97e-8;  // half an ulp of float, relative

// tau of sigma e^(-c (z - z0)) over t from the eye's height, long double.
long double exponential_tau(long double sigma, long double c, long double height_above,
                            long double mu, long double t) {
  const long double x = c * mu * t;
  // The densest end's density times exprel of a positive number.
  const long double densest = -c * height_above + std::max(-x, 0.0L);
  const long double a = std::abs(x);
  const long double exprel = a == 0 ? 1 : -std::expm1(-a) / a;
  return sigma * std::exp(densest) * t * exprel;
}

TEST(Closed, HeightFogAgainstLongDoubleOverTheWholeRange) {
  const unsigned seed = 11;
  RecordProperty("seed", int(seed));
  for (Isa isa : isas()) {
    Random random(seed);
    double worst_T = 0, worst_A = 0;
    for (int scene = 0; scene < 400; ++scene) {
      const double c = random.log(1e-5, 1e2);
      // Eye so high or low that log rho lies in +-1e4 or so; sigma makes tau moderate.
      const double z = (random.integer(2) ? 1 : -1) * random.log(1e-3, 1e4) / c;
      const double sigma = random.log(1e-6, 1e6);
      World w = world_of({height_fog(sigma, c)});
      w.eye = {3, 4, z};
      AirOptions o = options();
      o.isa = isa;
      const Air air = Air::compile(w, o);
      Bundle b;
      for (int i = 0; i < 64; ++i) {
        glm::dvec3 d = random.direction();
        if (i % 8 == 0) d.z = 0;
        if (i % 8 == 1) d = {0, 0, i % 16 == 1 ? 1 : -1};
        if (i % 8 == 2) d.z *= 1e-6;
        b.add(d, i % 8 == 3
                     ? 0
                     : random.log(1e-6, 1e4) / (c * std::max(std::abs(d.z), 1e-3)));
      }
      const Result r = integrate(air, b);
      for (int i = 0; i < b.size(); ++i) {
        const long double mu = b.d[2][i], t = b.end[i];
        const long double tau = exponential_tau(sigma, c, z, mu, t);
        const double T = double(std::exp(-tau)), A = double(-std::expm1(-tau));
        // What one float exponent loses: half an ulp of the two numbers it adds, and of c
        // times the direction.
        const double lost = 2 * kEps * double(std::abs(c * z) + std::abs(c * mu * t));
        const double dT = std::abs(r.T[0][i] - T), dA = std::abs(r.L[0][i] - A);
        const double bound_T = 1e-6 + lost, bound_A = (2e-6 + lost) * A + 1e-37;
        worst_T = std::max(worst_T, dT - lost);
        if (A > 1e-30) worst_A = std::max(worst_A, dA / A - lost);
        ASSERT_LE(dT, bound_T) << "c " << c << " z " << z << " sigma " << sigma << " mu "
                               << double(mu) << " t " << double(t);
        ASSERT_TRUE(A <= 1e-35 || dA <= bound_A)
            << "c " << c << " z " << z << " sigma " << sigma << " mu " << double(mu)
            << " t " << double(t);
      }
    }
    RecordProperty(std::string("T_") + name(isa), std::to_string(worst_T));
    printf("  %s: |dT| %.2g, |dA|/A %.2g beyond the exponent's rounding\n", name(isa),
           worst_T, worst_A);
  }
}

TEST(Closed, ExtremesAreFiniteAndOpaqueOrClearAsTheyShould) {
  // Every combination of awkward numbers: never NaN, T in [0, 1], L <= source (1 - T).
  const double falloffs[] = {0, 1e-30, 1e-6, 1e-2, 1, 1e3};
  const double heights[] = {0, 1e-3, 1e3, -1e3, 1e7, -1e7};
  const double sigmas[] = {1e-40, 1e-20, 1e-3, 1, 1e6, 1e9};
  const double lengths[] = {0, 1e-30, 1e-3, 1, 1e4, 1e10, 1e30, INFINITY};
  for (Isa isa : isas())
    for (double c : falloffs)
      for (double z : heights)
        for (double sigma : sigmas) {
          World w = world_of({height_fog(sigma, c, 0, 1e9)});
          w.eye.z = z;
          AirOptions o = options();
          o.isa = isa;
          const Air air = Air::compile(w, o);
          Bundle b;
          for (double t : lengths)
            for (glm::dvec3 d :
                 {glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 1), glm::dvec3(0, 0, -1),
                  glm::dvec3(1, 0, 1e-7), glm::dvec3(1, 0, -1e-7), glm::dvec3(1, 1, 1)})
              b.add(d, t);
          const Result r = integrate(air, b);
          for (int i = 0; i < b.size(); ++i) {
            const float T = r.T[1][i], L = r.L[1][i];
            ASSERT_TRUE(T >= 0 && T <= 1)
                << c << " " << z << " " << sigma << " " << b.end[i];
            ASSERT_TRUE(L >= 0 && L <= 1e9f * 1.000001f)
                << L << " " << c << " " << z << " " << sigma << " " << b.end[i];
            if (b.end[i] == 0) {
              ASSERT_EQ(T, 1);
              ASSERT_EQ(L, 0);
            }
          }
        }
}

TEST(Closed, EndlessRaysHaveTheirLimits) {
  World w = world_of({height_fog(1e-3, 1e-2, 0, 1)});
  const Air air = Air::compile(w, options());
  Bundle b;
  b.add({0, 0, 1}, kInf);   // tau = sigma / c = 0.1
  b.add({0, 0, -1}, kInf);  // into ever denser fog
  b.add({1, 0, 0}, kInf);   // horizontal
  b.add({1, 0, 1}, kInf);
  const Result r = integrate(air, b);
  EXPECT_NEAR(r.T[0][0], std::exp(-0.1), 1e-6);
  EXPECT_EQ(r.T[0][1], 0);
  EXPECT_EQ(r.T[0][2], 0);
  EXPECT_EQ(r.L[0][2], 1);
  EXPECT_NEAR(r.T[0][3], std::exp(-0.1 * std::sqrt(2.)), 1e-6);
}

TEST(Closed, UniformFogIsBeerLambertInEachChannel) {
  brume_medium m = fog(0, 0);
  const double sigma[3] = {0.01, 0.02, 0}, color[3] = {1, 2, 3};
  for (int c = 0; c < 3; ++c) m.extinction[c] = sigma[c], m.color[c] = color[c];
  const Air air = Air::compile(world_of({m}), options());
  Bundle b;
  for (double t : {0., 1e-6, 1., 50., 1e4}) b.add({1, 2, 3}, t);
  b.add({1, 2, 3}, kInf);
  const Result r = integrate(air, b);
  for (int i = 0; i < b.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      const double tau = sigma[c] > 0 ? sigma[c] * b.end[i] : 0;
      EXPECT_NEAR(r.T[c][i], std::exp(-tau), 2e-7);
      // Two roundings of tau, exp's 2.5 ulp, the product: < 5e-7.
      EXPECT_NEAR(r.L[c][i], color[c] * -std::expm1(-tau),
                  5e-7 * color[c] * -std::expm1(-tau));
    }
}

TEST(Closed, LorentzianGlowAgainstLongDouble) {
  const unsigned seed = 5;
  RecordProperty("seed", int(seed));
  for (Isa isa : isas()) {
    Random random(seed);
    double worst = 0;
    for (int scene = 0; scene < 400; ++scene) {
      brume_medium m = fog(0);
      m.profile = BRUME_LORENTZIAN;
      m.falloff = random.log(1e-6, 1e6);
      const double distance = random.log(1e-2, 1e4);
      const glm::dvec3 at = distance * random.direction();
      for (int c = 0; c < 3; ++c) m.origin[c] = at[c], m.emission[c] = 1;
      AirOptions o = options();
      o.isa = isa;
      const Air air = Air::compile(world_of({m}), o);
      Bundle b;
      for (int i = 0; i < 32; ++i)
        b.add(random.direction() + (i % 2 ? 3. / distance : 0.) * at,
              i == 0 ? INFINITY : distance * random.log(1e-3, 1e3));
      const Result r = integrate(air, b);
      for (int i = 0; i < b.size(); ++i) {
        // In float, as the kernel sees them, the directions and the lamp; then exact.
        long double tc = 0, m2 = 0, d2 = 0;
        for (int c = 0; c < 3; ++c) {
          tc += (long double)b.d[c][i] * float(at[c]);
          m2 += (long double)float(at[c]) * float(at[c]);
          d2 += (long double)b.d[c][i] * b.d[c][i];
        }
        tc /= d2;
        const long double h2 = std::max(m2 - tc * tc * d2, 0.0L), a = float(m.falloff);
        const long double w = 1 + a * h2, k = std::sqrt(a / w);
        const long double x0 = -k * tc, x1 = k * (b.end[i] - tc);
        const long double F =
            (i == 0 ? std::atan2(1.0L, x0) : std::atan2(x1 - x0, 1 + x0 * x1)) / (w * k);
        // The float position of the lamp's foot is off by eps x distance; where the ray
        // passes closer than its core that is noise of the input.
        const double slack = 2e-6 + 4 * kEps * double(distance / std::sqrt(h2 + 1 / a));
        worst = std::max(worst, double(std::abs(r.L[0][i] - F) / F) - slack + 2e-6);
        ASSERT_LE(std::abs(r.L[0][i] - F), slack * F)
            << m.falloff << " " << distance << " " << b.end[i];
        ASSERT_EQ(r.T[0][i], 1);
      }
    }
    printf("  %s: relative error %.2g\n", name(isa), worst);
  }
}

TEST(Closed, MaxOpacityEndsTheMediumPerChannel) {
  brume_medium m = height_fog(0.01, 0.02, 0, 1);
  m.extinction[1] = 0.05;
  m.extinction[2] = 0;
  m.max_opacity = 0.6;
  for (double z : {0., 50., -400., 3000.}) {
    World w = world_of({m});
    w.eye.z = z;
    const Air air = Air::compile(w, options());
    Bundle b;
    for (glm::dvec3 d : {glm::dvec3(1, 0, 0), glm::dvec3(1, 0, 1), glm::dvec3(1, 0, -1),
                         glm::dvec3(1, 0, 1e-6), glm::dvec3(0, 0, -1)})
      for (double t : {1., 30., 300., 1e4}) b.add(d, t);
    const Result r = integrate(air, b);
    for (int i = 0; i < b.size(); ++i)
      for (int c = 0; c < 3; ++c) {
        const double tau =
            double(exponential_tau(m.extinction[c], 0.02, z, b.d[2][i], b.end[i]));
        const double T = std::max(std::exp(-tau), m.extinction[c] > 0 ? 0.4 : 0);
        // c z = 60 at most: exponents to 60 eps; the inverse integral adds as much.
        EXPECT_NEAR(r.T[c][i], T, 2e-5) << z << " " << i << " " << c;
        EXPECT_NEAR(r.L[c][i], 1 - T, 2e-5) << z << " " << i << " " << c;
      }
  }
}

TEST(Closed, StartLeavesOutWhatIsNear) {
  brume_medium m = fog(0.01, 1);
  m.start = 30;
  const Air air = Air::compile(world_of({m}), options());
  Bundle b;
  for (double t : {10., 30., 31., 100.}) b.add({0, 1, 0}, t);
  const Result r = integrate(air, b);
  for (int i = 0; i < b.size(); ++i)
    EXPECT_NEAR(r.T[0][i], std::exp(-0.01 * std::max(0.f, b.end[i] - 30)), 3e-7);
  EXPECT_EQ(r.T[0][0], 1);
  EXPECT_EQ(r.L[0][1], 0);
}

TEST(Closed, BoundsAreWhereTheyAre) {
  // The eye inside, outside, on the surface; rays parallel to a face, grazing, along it.
  const double sigma = 0.1;
  const auto box = shaped(fog(sigma, 1), BRUME_BOX, {0, 0, 10}, {2, 3, 4});
  const auto ball = shaped(fog(sigma, 1), BRUME_ELLIPSOID, {0, 0, 10}, {2, 2, 4});
  const auto below = shaped(fog(sigma, 1), BRUME_HALF_SPACE, {0, 0, -5}, {1, 1, 1});
  struct Case {
    brume_medium m;
    glm::dvec3 eye, direction;
    double end, length;
  };
  const Case cases[] = {
      {box, {0, 0, 0}, {0, 0, 1}, 100, 8},   {box, {0, 0, 0}, {0, 0, 1}, 10, 4},
      {box, {0, 0, 0}, {0, 0, -1}, 100, 0},  {box, {0, 0, 10}, {1, 0, 0}, 100, 2},
      {box, {1, 0, 0}, {0, 0, 1}, 100, 8},   {box, {5, 0, 0}, {0, 0, 1}, 100, 0},
      {box, {0, 0, 6}, {0, 0, 1}, 100, 8},   {box, {0, 0, 14}, {0, 0, 1}, 100, 0},
      {box, {0, 0, 14}, {0, 0, -1}, 100, 8}, {ball, {0, 0, 0}, {0, 0, 1}, 100, 8},
      {ball, {2, 0, 0}, {0, 0, 1}, 100, 0},  {ball, {0, 0, 6}, {0, 0, 1}, 100, 8},
      {ball, {0, 0, 6}, {0, 0, -1}, 100, 0}, {ball, {0, 0, 10}, {1, 0, 0}, 100, 2},
      {below, {0, 0, 0}, {1, 0, 0}, 9, 0},   {below, {0, 0, -5}, {0, 0, 1}, 9, 0},
      {below, {0, 0, -5}, {0, 0, -1}, 9, 9}, {below, {0, 0, -6}, {1, 0, 0}, 9, 9},
      {below, {0, 0, 0}, {0, 0, -1}, 9, 4},
  };
  for (const Case& c : cases) {
    World w = world_of({c.m});
    w.eye = c.eye;
    const Air air = Air::compile(w, options());
    Bundle b;
    b.add(c.direction, c.end);
    const Result r = integrate(air, b);
    EXPECT_NEAR(r.T[0][0], std::exp(-sigma * c.length), 1e-6)
        << "length " << c.length << " of case " << &c - cases;
    if (c.length == 0) {
      EXPECT_EQ(r.T[0][0], 1) << &c - cases;
      EXPECT_EQ(r.L[0][0], 0) << &c - cases;
    }
  }
}

TEST(Closed, SunAndSkyThatNothingDimsAreAConstantSource) {
  brume_medium m = fog(0.02);
  m.source = BRUME_SOURCE_SKY;
  m.g = 0.5;
  brume_light sun = {};
  sun.size = sizeof sun;
  sun.kind = BRUME_SUN;
  sun.direction[0] = 1;
  brume_light sky = sun;
  sky.kind = BRUME_SKY_LIGHT;
  for (int c = 0; c < 3; ++c) sun.power[c] = 3, sky.power[c] = 0.25;
  const Air air = Air::compile(world_of({m}, {sun, sky}), options());
  Bundle b;
  b.add({1, 0, 0}, 100);
  b.add({-1, 0, 0}, 100);
  b.add({0, 1, 0}, 100);
  const Result r = integrate(air, b);
  const double A = -std::expm1(-2.);
  const auto hg = [](double mu) { return 0.75 / (4 * M_PI * std::pow(1.25 - mu, 1.5)); };
  EXPECT_NEAR(r.L[0][0], A * (3 * hg(1) + 0.25), 2e-6);
  EXPECT_NEAR(r.L[0][1], A * (3 * hg(-1) + 0.25), 2e-6);
  EXPECT_NEAR(r.L[0][2], A * (3 * hg(0) + 0.25), 2e-6);
}

}  // namespace
}  // namespace brume
