// What height fog does whatever its numbers: at infinity and at nothing, cut in two,
// scaled, turned, ended; and where the 2007 listing fails.

#include <gtest/gtest.h>

#include <random>

#include "baseline.h"
#include "fog_air_test.h"
#include "num/error.h"
#include "oracle.h"

namespace height_fog {
namespace {

TEST(HeightFog, AHorizontalRaySeesConstantDensity) {
  // Eye 50 m over the reference height, c = 0.02: density there is sigma / e, exactly
  // level.
  const FogAir fog({{"density", "0.01"}, {"falloff", "0.02"}}, at(50));
  for (const double d : {1.0, 100.0, 1000.0}) {
    const double tau = 0.01 * std::exp(-1.0) * d;
    EXPECT_NEAR(fog(climbing(0, d)).T[0], std::exp(-tau), kErrorT) << d;
  }
}

TEST(HeightFog, HasItsDensityAtItsHeight) {
  const Set set = {{"density", "0.01"}, {"falloff", "0.02"}, {"height", "120"}};
  const double tau = 0.01 * 70;  // along a level ray of 70 m
  EXPECT_NEAR(FogAir(set, at(120))(climbing(0, 70)).T[0], std::exp(-tau), kErrorT);
  EXPECT_NEAR(FogAir(set, at(170))(climbing(0, 70)).T[0], std::exp(-tau / std::exp(1)),
              kErrorT);  // 1 / falloff higher: e times thinner
}

TEST(HeightFog, LookingUpThroughAllOfItSeesWhatIsAboveTheEye) {
  // tau = sigma(eye) / (c mu) to infinity.
  const FogAir fog({{"density", "0.004"}, {"falloff", "0.01"}}, at(0));
  for (const double mu : {1.0, 0.5, 0.1, 0.01})
    EXPECT_NEAR(fog(climbing(mu, kInf)).T[0], std::exp(-0.4 / float(mu)), kErrorT) << mu;
}

TEST(HeightFog, LookingDownOrAlongForeverSeesNothing) {
  const FogAir fog({{"density", "1e-6"}, {"falloff", "1e-6"}, {"color", "0.25,0.5,1"}},
                   at(1e3));
  for (const double mu : {-1.0, -1e-3, 0.0}) {
    const Answer a = fog(climbing(mu, kInf));
    EXPECT_EQ(a.T[0], 0) << mu;
    EXPECT_EQ(a.L[0], 0.25f) << mu;
    EXPECT_EQ(a.L[2], 1) << mu;
  }
}

TEST(HeightFog, NoDistanceIsNoFog) {
  const FogAir fog({{"density", "1e6"}, {"falloff", "1000"}}, at(-1e7));
  for (const double mu : {-1.0, 0.0, 1.0}) {
    const Answer a = fog(climbing(mu, 0));
    EXPECT_EQ(a.T[1], 1) << mu;
    EXPECT_EQ(a.L[1], 0) << mu;
  }
}

TEST(HeightFog, ThereIsNoThresholdOfSlope) {
  // Rays to points 1 km away, from 30 m below to 30 m above the eye in steps of 1 mm of
  // height: the transmittance must fall like its own derivative, never by a step. The
  // 2007 listing has one at dz = 0.01 m.
  const double b = 0.02, c = 10, d = 1000;
  const FogAir fog({{"density", text(b)}, {"falloff", text(c)}}, at(0.5));
  const double step = 1e-3;
  std::vector<Ray> rays;
  std::vector<double> theirs;
  for (double dz = -0.05; dz < 0.05; dz += step) {
    rays.push_back(climbing(dz / d, d));
    theirs.push_back(
        baseline::transmittance(float(d), 0, float(dz), 0.5f, float(b), float(c)));
  }
  const auto ours = fog(rays);
  double our_step = 0, their_step = 0, true_step = 0;
  const Fog truth{.density = b, .falloff = c};
  for (std::size_t i = 2; i < rays.size(); ++i) {
    const auto T = [&](std::size_t k) {
      return double(std::exp(-optical_depth(truth, 0.5L, rays[k].d[2], 0, rays[k].t)));
    };
    // Second differences: 0 for a straight line, the step itself for a step.
    const auto bend = [](double x, double y, double z) {
      return std::abs(x - 2 * y + z);
    };
    our_step = std::max(our_step, bend(ours[i].T[0], ours[i - 1].T[0], ours[i - 2].T[0]));
    their_step = std::max(their_step, bend(theirs[i], theirs[i - 1], theirs[i - 2]));
    true_step = std::max(true_step, bend(T(i), T(i - 1), T(i - 2)));
  }
  EXPECT_LE(our_step, true_step + 4 * kErrorT);  // three values, the middle one twice
  // tau = b e^-5 d = 0.135; the limit is off by c dz / 2 = 5 % of it: T by 0.0059.
  EXPECT_GT(their_step, 0.004);
}

TEST(HeightFog, ItsBaselineIsTheListing) {
  const StageType& type = FogAir::registry().find("height_fog");
  EXPECT_NE(type.baseline, "");
  StageCache cache;
  Settings s = Settings::defaults(type.specs);
  for (const auto& [name, value] :
       {std::pair{"density", "0.1,0.2,0.4"}, {"height", "2"}, {"falloff", "0.5"}})
    s.set(name, value, {}, "height_fog");
  const auto ask = [&](float mu, float t, Answer& a) {
    StageInstance fog(type, "height_fog", s.at(0), cache);
    World world;
    fog.publish(at(3), 0, world);
    const float dx = std::sqrt(1 - mu * mu), none = 0;
    float* const L[3] = {&a.L[0], &a.L[1], &a.L[2]};
    float* const T[3] = {&a.T[0], &a.T[1], &a.T[2]};
    fog.baseline({1, nullptr, nullptr, nullptr, &dx, &none, &mu}, &t, L, T);
  };
  Answer a;
  ask(0.6f, 10, a);
  EXPECT_NEAR(a.T[1], baseline::transmittance(8, 0, 6, 1, 0.2f, 0.5f), 1e-6);
  EXPECT_NEAR(a.L[1], 0.6 * (1 - a.T[1]), 1e-6);  // the default colour's green
  s.set("color", "sky", {}, "height_fog");
  EXPECT_THROW(ask(0.6f, 10, a), Error);
}

TEST(HeightFog, AThinFalloffKeepsItsDigits) {
  // c = 1e-5 1/m, a point 0.02 m above the eye: phi = 1 - 1e-7. The 2007 listing takes
  // 1 - exp(-2e-7) in float, where neighbouring numbers below 1 are 6e-8 apart.
  const double b = 0.001, c = 1e-5, d = 1000;
  const FogAir fog({{"density", text(b)}, {"falloff", text(c)}}, at(0));
  const double T = std::exp(-b * d);
  EXPECT_NEAR(fog(climbing(0.02 / d, d)).T[0], T, kErrorT);
  const double theirs =
      baseline::transmittance(float(d), 0, 0.02f, 0, float(b), float(c));
  EXPECT_GT(std::abs(-std::log(theirs) / (b * d) - 1), 0.1);
}

TEST(HeightFog, TransmittanceOfAPathIsTheProductOfItsParts) {
  const FogAir fog({{"density", "0.01,0.02,0.04"}, {"falloff", "0.05"}}, at(20));
  std::mt19937 random(20070305);  // seed
  std::uniform_real_distribution<double> slope(-1, 1), length(0, 100);
  for (int i = 0; i < 500; ++i) {
    const Ray whole = climbing(slope(random), length(random));
    const float b = float(length(random) / 100) * whole.t;
    Ray first = whole, second = whole;
    first.t = b;
    second.t = whole.t - b;
    second.o[0] = b * whole.d[0];
    second.o[2] = b * whole.d[2];
    const Answer w = fog(whole), f = fog(first), s = fog(second);
    for (int k = 0; k < 3;
         ++k)  // three errors of T, each at most kErrorT, and two exponents
      EXPECT_NEAR(f.T[k] * s.T[k], w.T[k], 3 * kErrorT + 2 * kEps * 5) << i;
  }
}

TEST(HeightFog, WithFalloffTowardsZeroItBecomesUniform) {
  const FogAir uniform({{"density", "0.003"}, {"falloff", "0"}}, at(10));
  const FogAir nearly({{"density", "0.003"}, {"falloff", "1e-12"}}, at(10));
  EXPECT_EQ(uniform.world().media[0].what.profile, BRUME_UNIFORM);
  for (const double mu : {-1.0, 0.0, 0.7})
    for (const double d : {1.0, 300.0, 1e5})
      EXPECT_NEAR(uniform(climbing(mu, d)).T[0], nearly(climbing(mu, d)).T[0],
                  2 * kErrorT);
}

TEST(HeightFog, LIsItsColourTimesItsOpacity) {
  const FogAir fog({{"density", "0.01,0.02,0.04"}, {"color", "0.2,0.5,4"}}, at(5));
  const double color[3] = {0.2, 0.5, 4};
  for (const double d : {0.5, 20.0, 1e4}) {
    const Answer a = fog(climbing(0.2, d));
    for (int k = 0; k < 3; ++k)  // 1 - T of a T that is itself rounded: kErrorT each
      EXPECT_NEAR(a.L[k], color[k] * (1 - a.T[k]), 2 * kErrorT * color[k]);
  }
}

TEST(HeightFog, EndsWhereItHidesMaxOpacityInEveryChannel) {
  const double m = 0.7;
  const FogAir full({{"density", "0.001,0.01,0.1"}}, at(5));
  const FogAir ends({{"density", "0.001,0.01,0.1"}, {"max_opacity", text(m)}}, at(5));
  for (const double mu : {-0.1, 0.0, 0.3})
    for (const double d : {0.0, 1.0, 30.0, 1e3, 1e5, kInf}) {
      const Answer f = full(climbing(mu, d)), e = ends(climbing(mu, d));
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(e.T[k], std::max<double>(f.T[k], 1 - m), 2 * kErrorT)
            << mu << " " << d;
        EXPECT_NEAR(e.L[k], std::min<double>(f.L[k], m), 2 * kErrorT) << mu << " " << d;
      }
    }
}

TEST(HeightFog, StartIsABoundaryNotAFade) {
  const FogAir fog({{"density", "0.02"}, {"falloff", "0.01"}, {"start", "50"}}, at(5));
  const Fog truth{.density = 0.02L, .falloff = 0.01L, .start = 50};
  for (const double mu : {-0.5, 0.0, 0.5})
    for (const double d : {10.0, 50.0, 50.5, 200.0, 1e4}) {
      const Ray r = climbing(mu, d);
      const Answer a = fog(r);
      EXPECT_NEAR(a.T[0], double(std::exp(-seen(truth, 5, r.d[2], r.t))), kErrorT);
      if (d <= 50) {
        EXPECT_EQ(a.T[0], 1);
        EXPECT_EQ(a.L[0], 0);
      }
    }
}

TEST(HeightFog, ScalesWithTheWorld) {
  // Lengths times 2^k, everything per metre divided by it: the same bits.
  const FogAir small({{"density", "0.5"}, {"falloff", "0.25"}, {"height", "2"}}, at(3));
  const FogAir large({{"density", text(0.5 / 1024)},
                      {"falloff", text(0.25 / 1024)},
                      {"height", text(2 * 1024)}},
                     at(3 * 1024));
  for (const double mu : {-1.0, -0.01, 0.0, 0.3})
    for (const double d : {0.125, 1.0, 13.0}) {
      const Ray r = climbing(mu, d);
      Ray far = r;
      far.t *= 1024;
      EXPECT_EQ(small(r).T[0], large(far).T[0]) << mu << " " << d;
      EXPECT_EQ(small(r).L[0], large(far).L[0]) << mu << " " << d;
    }
}

TEST(HeightFog, FollowsTheWorldsUp) {
  FrameInfo y_up = at(0);
  y_up.up = {0, 1, 0};
  y_up.eye = {0, 12, 0};
  const FogAir z({{"falloff", "0.1"}, {"density", "0.05"}, {"height", "4"}}, at(12));
  const FogAir y({{"falloff", "0.1"}, {"density", "0.05"}, {"height", "4"}}, y_up);
  for (const double mu : {-0.9, -0.1, 0.0, 0.6}) {
    const Ray r = climbing(mu, 40);
    Ray turned = r;
    std::swap(turned.d[1], turned.d[2]);
    EXPECT_NEAR(z(r).T[0], y(turned).T[0], 2 * kErrorT) << mu;
  }
}

TEST(HeightFog, EyeTenThousandKilometresAwaySeesTheSameLayer) {
  // Straight down from 1e7 m onto the ground at 0 through all of it: sigma / c. The depth
  // is a float and says where the ground is to +- 0.5 m; c = 1e-3 keeps what that does
  // small.
  const FogAir fog({{"density", "0.001"}, {"falloff", "0.001"}}, at(1e7));
  const double c_dz = 1e4;
  EXPECT_NEAR(fog(climbing(-1, 1e7)).T[0], std::exp(-1.0),
              kErrorT + kEps * c_dz / std::exp(1));
}

}  // namespace
}  // namespace height_fog
