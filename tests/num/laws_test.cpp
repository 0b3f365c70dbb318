// Exact laws that the functions of num/math.h keep among themselves.

#include <gtest/gtest.h>

#include <cmath>

#include "num/math.h"
#include "num/random.h"

namespace brume {
namespace {

constexpr std::uint64_t kSeed = 7;
constexpr double eps = 0x1p-53, feps = 0x1p-24;

TEST(Transmit, WhatIsNotLetThroughIsHeldBack) {
  for (float tau = 1e-30f; tau < 1e30f; tau *= 1.37f) {
    const auto [t, a] = transmit(tau);
    EXPECT_NEAR(t + a, 1.0f, 2 * feps) << tau;  // each is rounded once to within 1 eps
    EXPECT_GE(t, 0.0f);
    EXPECT_LE(t, 1.0f);
    EXPECT_LE(a, 1.0f);
  }
}

TEST(Transmit, FallsWithDepth) {
  // Over neighbouring floats it may waver by its error, 1.5 ulp <= 3 feps; over 4 times
  // that distance in the exponent it must fall.
  float before = 1;
  for (float tau = 0; tau < 100; tau += 8 * feps * std::max(1.0f, tau)) {
    const float t = transmit(tau).T;
    ASSERT_LE(t, before * (1 + 3 * feps)) << tau;
    before = t;
    if (tau > 1) tau *= 1.01f;
  }
}

TEST(Transmit, TwoStretchesAreTheirProduct) {
  Random random(kSeed);
  for (int i = 0; i < 10000; ++i) {
    const double a = random.uniform(0, 20), b = random.uniform(0, 20);
    const double whole = transmit(a + b).T, parts = transmit(a).T * transmit(b).T;
    // The sum a + b is rounded: 40 eps in the exponent; three results of 1.5 ulp each.
    EXPECT_NEAR(parts / whole, 1, (40 + 3 * 3 + 1) * eps) << a << " " << b;
  }
}

TEST(SourceWeights, ConstantSourceGivesItsOpacity) {
  for (float d = 1e-20f; d < 1e20f; d *= 1.5f) {
    const auto w = source_weights(d);
    EXPECT_EQ(w.E0, transmit(d).A) << d;
    // Weights fall with the power of u in [0, 1] that they integrate.
    EXPECT_LE(w.E1, w.E0 * (1 + 8 * feps)) << d;
    EXPECT_LE(w.E2, w.E1 * (1 + 16 * feps)) << d;
    EXPECT_GE(w.E2, 0.0f) << d;
  }
}

TEST(SourceWeights, StretchCutInTwoGivesTheLightOfTheWhole) {
  Random random(kSeed);
  for (int i = 0; i < 10000; ++i) {
    const double d = std::pow(10, random.uniform(-6, 3)), cut = random.uniform();
    const double a = random.uniform(), b = random.uniform(), c = random.uniform();
    const auto light = [](double depth, double s0, double s1, double s2) {
      const auto w = source_weights(depth);
      return w.E0 * s0 + w.E1 * s1 + w.E2 * s2;
    };
    // On the far part u = cut + (1 - cut) v, seen through the near part.
    const double rest = 1 - cut;
    const double near = light(d * cut, a, b * cut, c * cut * cut);
    const double far = light(d * rest, a + b * cut + c * cut * cut,
                             (b + 2 * c * cut) * rest, c * rest * rest);
    const double whole = light(d, a, b, c);
    // Sums of positive terms with 5 ulp each; the depth of the near part, rounded, enters
    // the exponent: d cut eps, but where that is large the far part no longer counts.
    EXPECT_NEAR((near + transmit(d * cut).T * far) / whole, 1, 60 * eps)
        << d << " " << cut;
  }
}

TEST(Exprel, IsTheMeanTransmittanceOfAStretch) {
  Random random(kSeed);
  for (int i = 0; i < 10000; ++i) {
    // exprel(x) x = 1 - e^-x, and exprel(-x) = e^x exprel(x).
    const double x = std::pow(10, random.uniform(-12, 2));
    EXPECT_NEAR(exprel(x) * x / transmit(x).A, 1, 8 * eps) << x;
    EXPECT_NEAR(exprel(-x) / (exp(x) * exprel(x)), 1, 10 * eps) << x;
    // 1 - x exprel2(x) = exprel(x), where the difference does not cancel.
    if (x < 1) {
      EXPECT_NEAR((1 - x * exprel2(x)) / exprel(x), 1, 6 * eps) << x;
    }
  }
}

TEST(SinCos, LieOnTheUnitCircle) {
  Random random(kSeed);
  for (int i = 0; i < 100000; ++i) {
    const auto [s, c] = sincos(static_cast<float>(random.uniform(-8192, 8192)));
    EXPECT_NEAR(double(s) * s + double(c) * c, 1, 4 * 2.5 * feps);  // 2.5 ulp of each
  }
}

TEST(SinCos, StayFiniteBeyondTheirDomain) {
  for (const float x : {1e4f, -1e4f, 1e30f, -INFINITY, INFINITY}) {
    EXPECT_LE(std::abs(sin(x)), 1.0f);
    EXPECT_LE(std::abs(cos(x)), 1.0f);
  }
}

TEST(Atan2, TurnsWithItsArguments) {
  Random random(kSeed);
  for (int i = 0; i < 10000; ++i) {
    const double phi = random.uniform(-3.14, 3.14),
                 r = std::pow(10, random.uniform(-9, 9));
    const auto [s, c] = sincos(phi);
    // 2 ulp of sine and cosine turn the angle by 4 eps; its own 2.5 ulp at pi are 10 eps.
    EXPECT_NEAR(atan2(r * s, r * c), phi, 16 * eps);
  }
}

TEST(AtanDifference, KeepsTheDigitsThatThePlainDifferenceLoses) {
  // Lightning far away: two nearly equal arctangents (METHODS A12).
  const double a = 1e6, b = 1e6 + 1e-3;
  const double exact = (b - a) / (1 + a * b);  // atan of so small a number is itself
  EXPECT_NEAR(atan_difference(a, b) / exact, 1, 8 * eps);
  EXPECT_GT(std::abs((std::atan(b) - std::atan(a)) / exact - 1), 1e-4);
}

TEST(AtanDifference, RunsFromEndToEnd) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  EXPECT_NEAR(atan_difference(-inf, inf), M_PI, 4 * eps);
  EXPECT_NEAR(atan_difference(0.0, inf), M_PI / 2, 2 * eps);
  EXPECT_NEAR(atan_difference(inf, 0.0), -M_PI / 2, 2 * eps);
}

TEST(ErfDifference, AddsUp) {
  Random random(kSeed);
  for (int i = 0; i < 10000; ++i) {
    const double a = random.uniform(-6, 6), b = random.uniform(-6, 6);
    const double c = random.uniform(-6, 6);
    const double sum = erf_difference(a, b) + erf_difference(b, c);
    EXPECT_NEAR(sum, erf_difference(a, c),
                3 * 5 * 2 * 2 * eps);  // 5 ulp of at most 2 each
  }
}

TEST(Quadratic, RealRootsAreKnownForCertain) {
  // A ray that grazes a planet: the discriminant's sign is the hit. Coefficients are
  // whole numbers, so that it is known exactly.
  Random random(kSeed);
  for (int i = 0; i < 20000; ++i) {
    const auto whole = [&] { return std::floor(random.uniform(1, 4095)); };
    const double a = whole(), b = whole(), off = std::floor(random.uniform(-2, 3));
    const double c = std::floor(b * b / a) + off;  // up to 2^24: exact in float too
    const bool hits = b * b - a * c >= 0;
    EXPECT_EQ(quadratic(a, b, c).real, hits) << a << " " << b << " " << c;
    if (c < 0x1p24) {
      EXPECT_EQ(quadratic(float(a), float(b), float(c)).real, hits);
    }
  }
}

TEST(Quadratic, DegenerateCases) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  const auto expect = [](auto r, bool real, double lo, double hi) {
    EXPECT_EQ(r.real, real);
    EXPECT_EQ(r.lo, lo);
    EXPECT_EQ(r.hi, hi);
  };
  expect(quadratic(1.0, -1.5, 2.0), true, 1, 2);
  expect(quadratic(0.0, 1.0, -4.0), true, 2, inf);  // 2 x - 4 = 0
  expect(quadratic(0.0, -1.0, -4.0), true, -2, inf);
  expect(quadratic(1.0, 0.0, 0.0), true, 0, 0);
  expect(quadratic(1.0, 0.0, -4.0), true, -2, 2);
  expect(quadratic(2.0, -6.0, 100.0), false, 3, 3);  // none: the vertex
  EXPECT_FALSE(quadratic(0.0, 0.0, 1.0).real);
  EXPECT_FALSE(quadratic(0.0, 0.0, 0.0).real);
}

TEST(LogMean, LiesBetweenGeometricAndArithmeticMean) {
  Random random(kSeed);
  for (int i = 0; i < 10000; ++i) {
    const double a = std::pow(10, random.uniform(-9, 9));
    const double b = a * std::pow(10, random.uniform(-9, 9) * random.uniform());
    const double mean = log_mean(a, b);
    EXPECT_GE(mean, std::sqrt(a) * std::sqrt(b) * (1 - 6 * eps));
    EXPECT_LE(mean, (a + b) / 2 * (1 + 6 * eps));
    EXPECT_EQ(mean, log_mean(b, a));
  }
}

TEST(Saturate, HoldsTheEndsAndKeepsNaN) {
  EXPECT_EQ(saturate(-1.0f), 0.0f);
  EXPECT_EQ(saturate(0.25f), 0.25f);
  EXPECT_EQ(saturate(INFINITY), 1.0f);
  EXPECT_TRUE(std::isnan(saturate(NAN)));
}

}  // namespace
}  // namespace brume
