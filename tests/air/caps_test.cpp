// Where media begin and end by what a ray has gone through: `start`, `max_opacity`. In
// dense media these ends are finer than the floats that say where they are.

#include <gtest/gtest.h>

#include "support.h"

namespace brume {
namespace {

using namespace testing_air;

// A float T near 1 is off by half of 6e-8, and by the rounding of -log1p(-max_opacity).
constexpr double kRounding = 2e-7;

TEST(Caps, OpacityIsExactWhereAStepOfAFloatIsManyOpticalDepths) {
  brume_medium far_down = height_fog(0.002, 759, 0, 7e5);  // met at e^5000 of its density
  brume_medium deep = height_fog(0.002, 0.0845, 1e7, 2);   // the eye at e^845000
  brume_medium dense = fog(1e12, 2), started = fog(1e3, 2);
  started.start = 1e7;
  for (const brume_medium& given : {far_down, deep, dense, started})
    for (double opacity : {1e-19, 1.9e-8, 0.3, 0.999}) {
      brume_medium m = given;
      m.max_opacity = opacity;
      m.extinction[1] *= 1e8;
      m.extinction[2] = 0;
      World w = world_of({m});
      if (m.falloff > 1) w.eye.z = 6.4e6;
      const Air air = Air::compile(w, options());
      Bundle b;
      b.add({0.59, 0.807, -1.0163886e-5}, 6.3e11);
      b.add({0, 0, -1}, 1e9);
      const Result r = integrate(air, b);
      for (int i = 0; i < b.size(); ++i)
        for (int c = 0; c < 3; ++c) {
          const double A = c == 2 ? 0 : opacity;
          EXPECT_NEAR(r.T[c][i], 1 - A, kRounding) << m.falloff << " " << opacity;
          EXPECT_NEAR(r.L[c][i], m.color[c] * A, m.color[c] * A * 1e-6)
              << m.falloff << " " << opacity << " ray " << i << " channel " << c;
        }
    }
}

TEST(Caps, FogThatIsFarBelowIsNeverFull) {
  // The eye where e^-100, e^-100000 of it are left: along level rays and up no depth
  // comes together however far they go, and so no light.
  for (const double height : {1e4, 1e7}) {
    brume_medium m = height_fog(1e6, 0.01, 0, 5e5);
    m.max_opacity = 0.126;
    m.extinction[0] = 0.002;
    m.albedo[0] = 1e-9;
    World w = world_of({m}, {lamp({0, 0, height + 1}), lamp({0, 0, 0}, 1, BRUME_SUN)});
    w.eye.z = height;
    const Air air = Air::compile(w, options());
    Bundle b;
    for (const double t : {1e3, 5e29, 1e30})
      for (const double up : {0., 1e-3, 1.}) b.add({0, std::sqrt(1 - up * up), up}, t);
    const Result r = integrate(air, b);
    for (int i = 0; i < b.size(); ++i) {
      // Of e^-100 there are 4e-8 of optical depth on the longest.
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(r.T[c][i], 1, kRounding) << height << " " << i;
        EXPECT_NEAR(r.L[c][i], 0, m.color[c] * 1e-7) << height << " " << i;
      }
    }
  }
}

TEST(Caps, ADenseCappedFogWithinAThinOne) {
  // thin fog, then at 100 m a veil without depth, then thin fog again.
  const double opacity = 0.3;
  for (double sigma : {1e2, 1e6, 1e12}) {
    brume_medium veil = fog(sigma, 1);
    veil.start = 100;
    veil.max_opacity = opacity;
    const Air air = Air::compile(world_of({fog(0.01, 0.2), veil}), options());
    Bundle b;
    for (double t : {50., 150., 1e4}) b.add({0, 1, 0.3}, t);
    const Result r = integrate(air, b, 2);
    for (int i = 0; i < b.size(); ++i) {
      const double t = b.end[i], thin = std::exp(-0.01 * t), at = std::exp(-1.);
      const double T = t < 100 ? thin : (1 - opacity) * thin;
      const double L =
          t < 100 ? 0.2 * (1 - thin)
                  : 0.2 * (1 - at) + at * opacity + (1 - opacity) * 0.2 * (at - thin);
      EXPECT_NEAR(r.T[0][i], T, 1e-6) << sigma << " " << t;
      // The tolerance, and what the thin fog adds within the veil of 0.36/sigma m.
      EXPECT_NEAR(r.L[0][i], L, 1e-3) << sigma << " " << t;
      EXPECT_NEAR(r.stage_L[0][i] + r.stage_L[3][i], r.L[0][i], 1e-6);
    }
  }
}

// e^(-z/100), as a source of its own that counts the integrals it is asked for.
struct Counted {
  int integrals = 0;
  static double up_to(double falls, double t) {
    return falls == 0 ? t : -std::expm1(-falls * t) / falls;
  }
  brume_medium medium(double sigma) {
    brume_medium m = height_fog(sigma, 0.01);
    m.profile = BRUME_CUSTOM;
    m.self = this;
    m.integral = [](const void* self, const brume_rays* r, const float* t0,
                    const float* t1, float* D) {
      const_cast<Counted*>(static_cast<const Counted*>(self))->integrals += int(r->n);
      for (std::size_t i = 0; i < r->n; ++i) {
        const double falls = 0.01 * r->dz[i];
        D[i] = float(std::min(up_to(falls, t1[i]) - up_to(falls, t0[i]), 3e38));
      }
    };
    m.density = [](const void*, const brume_rays* r, const float* t, float* rho) {
      for (std::size_t i = 0; i < r->n; ++i)
        rho[i] = float(std::min(std::exp(-0.01 * r->dz[i] * t[i]), 3e38));
    };
    return m;
  }
};

TEST(Caps, WhereASourceOfItsOwnEndsIsSoughtOnlyWhereItMattersAndInFewSteps) {
  Bundle b;
  for (double up : {-1., -0.1, 0., 0.05, 0.3, 1.})
    for (double t : {1e-3, 1., 40., 300., 1e4, double(kInf)})
      b.add({std::sqrt(1 - up * up), 0, up}, t);
  const int lanes = (b.size() + 15) / 16 * 16;
  for (double opacity : {1e-6, 0.2, 0.9}) {
    Counted counted;
    brume_medium own = counted.medium(0.02), closed = height_fog(0.02, 0.01);
    for (brume_medium* m : {&own, &closed}) {
      m->max_opacity = opacity;
      m->extinction[1] *= 3, m->extinction[2] *= 0.1;
      m->color[0] = 0.3;
    }
    // Alone each of three channels is one integral; with a fog of another colour it
    // matters where each ends.
    const World alone[2] = {world_of({own}), world_of({closed})},
                both[2] = {world_of({own, fog(0.03, 4)}),
                           world_of({closed, fog(0.03, 4)})};
    const Result a = integrate(Air::compile(alone[0], options()), b),
                 a0 = integrate(Air::compile(alone[1], options()), b);
    EXPECT_LE(counted.integrals, 3 * lanes);
    const Result c = integrate(Air::compile(both[0], options(16, 1e-5)), b),
                 c0 = integrate(Air::compile(both[1], options(16, 1e-5)), b);
    // At a tolerance that needs few pieces: by the bits alone, twice 32 a channel.
    counted.integrals = 0;
    integrate(Air::compile(both[0], options(16, 0.5)), b);
    EXPECT_LE(counted.integrals, 3 * 32 * lanes);
    for (int i = 0; i < b.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(a.T[k][i], a0.T[k][i], 1e-6) << opacity << " " << i;
        EXPECT_NEAR(a.L[k][i], a0.L[k][i], 1e-6) << opacity << " " << i;
        EXPECT_NEAR(c.T[k][i], c0.T[k][i], 1e-6) << opacity << " " << i;
        EXPECT_NEAR(c.L[k][i], c0.L[k][i], 2e-5 * 5) << opacity << " " << i;
      }
  }
}

TEST(Starts, ABallAroundTheEyeIsLeftOutOfRaysFromAnywhere) {
  Random random(3);
  for (double start : {1e-30, 1e-22, 1e-3, 30., 1e7}) {
    const double sigma = 0.3 / start;
    brume_medium m = fog(std::min(sigma, 1e20), 1);
    m.start = start;
    const Air air = Air::compile(world_of({m}), options());
    Bundle b;
    for (int i = 0; i < 200; ++i)
      b.add(random.direction() * start * random.log(1e-3, 10), random.direction(),
            start * random.log(0.1, 30));
    const Result r = integrate(air, b);
    for (int i = 0; i < b.size(); ++i) {
      const oracle::Ray ray = b.ray(i);
      const long double t = ray.end;
      long double oo = 0, od = 0, dd = 0;
      for (int c = 0; c < 3; ++c) {
        oo += (long double)ray.o[c] * ray.o[c];
        od += (long double)ray.o[c] * ray.d[c];
        dd += (long double)ray.d[c] * ray.d[c];
      }
      const long double disc = od * od - dd * (oo - (long double)start * start);
      long double chord = 0;
      if (disc > 0) {
        const auto clip = [&](long double x) { return std::clamp(x, 0.0L, t); };
        chord = clip((-od + sqrtl(disc)) / dd) - clip((-od - sqrtl(disc)) / dd);
      }
      // The root of a rounded discriminant: eps |o|^2 of it, so sqrt(eps) at the rim.
      const double off = 4e-7 * double(oo + start * start) /
                         std::max(std::sqrt(std::abs(double(disc))),
                                  3e-4 * std::sqrt(double(oo + start * start)));
      const double tau = m.extinction[0] * double(t - chord);
      EXPECT_NEAR(r.T[0][i], std::exp(-tau),
                  3e-7 + m.extinction[0] * (off + 2e-7 * double(t)) * std::exp(-tau))
          << start << " " << i;
    }
  }
}

TEST(Starts, ACapCountsFromBehindTheBall) {
  brume_medium m = fog(0.01, 1);
  m.start = 1000;
  m.max_opacity = 0.7;
  const Air air = Air::compile(world_of({m}), options());
  Bundle b;
  b.add({0, 3, 0}, {0, 1, 0}, 1e6);       // within the ball
  b.add({0, 3, 0}, {0, 1, 0}, 1000);      // 3 m beyond it
  b.add({0, -1030, 0}, {0, 1, 0}, 1e6);   // 30 m before, then behind
  b.add({0, -1030, 0}, {0, 1, 0}, 2035);  // 5 m behind
  b.add({0, -1300, 0}, {0, 1, 0}, 1e6);   // spent before the ball
  const double tau[] = {-std::log(0.3), 0.03, -std::log(0.3), 0.35, -std::log(0.3)};
  const Result r = integrate(air, b);
  for (int i = 0; i < b.size(); ++i)
    // Distances of 1000 m: eps x 1000 m x 0.01/m.
    EXPECT_NEAR(r.T[0][i], std::exp(-tau[i]), 2e-6) << i;
}

TEST(Starts, ALampInFogThatIsOpaqueAtOnce) {
  // Below the eye, from 588 m on, e^720 times as dense: only its surface is lit.
  brume_medium m = height_fog(43561.8, 1.73165, 0, 0.5);
  m.albedo[1] = 0.3;
  m.g = -0.99;
  m.start = 588.17;
  brume_light lamp = {};
  lamp.size = sizeof lamp;
  lamp.kind = BRUME_POINT;
  lamp.position[0] = 20;
  for (double& x : lamp.power) x = 100;
  const Air air = Air::compile(world_of({m}, {lamp}), options());
  Bundle b;
  for (double t : {600., 3.4e5, double(kInf)}) b.add({-0.55, 0.444, -0.7075}, t);
  const Result r = integrate(air, b);
  for (int i = 0; i < b.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(r.T[c][i], 0);
      // E = 100/588^2, p <= 1600: to the tolerance it is all 0.5 and the lamp's part.
      EXPECT_GE(r.L[c][i], 0.5 - 1e-6);
      EXPECT_LE(r.L[c][i], 0.5 + 0.3 * 100 / (560. * 560) * 1600);
    }
}

}  // namespace
}  // namespace brume
