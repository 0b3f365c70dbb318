// Integrals come out, and say how far they may be off.

#include "num/quadrature.h"

#include <gtest/gtest.h>

#include <numbers>

namespace brume {
namespace {

TEST(GaussLegendre, IsExactForPolynomialsUpToTwiceItsSize) {
  for (const int n : {1, 2, 3, 5, 8, 16, 40, 100}) {
    const RuleOfSize rule = gauss_legendre(n);
    ASSERT_EQ(rule.x.size(), static_cast<std::size_t>(n));
    for (int power = 0; power < 2 * n; ++power) {
      double sum = 0;
      for (int k = 0; k < n; ++k)
        sum += rule.w[std::size_t(k)] * std::pow(rule.x[std::size_t(k)], power);
      // n terms whose sizes add up to at most 2, each with the errors of x^power.
      EXPECT_NEAR(sum, power % 2 ? 0 : 2.0 / (power + 1), (2.0 * power + 8) * 0x1p-53)
          << n << " nodes, x^" << power;
    }
    EXPECT_TRUE(std::is_sorted(rule.x.begin(), rule.x.end()));
  }
}

TEST(GaussLegendre, KnownNodes) {
  constexpr auto rule = gauss_legendre<3>();
  EXPECT_NEAR(double(rule.x[2]), std::sqrt(0.6), 0x1p-53);
  EXPECT_NEAR(double(rule.x[1]), 0, 1e-19);
  EXPECT_NEAR(double(rule.w[1]), 8 / 9.0, 0x1p-53);
}

// The answer is within the error that was asked for, and the error stated bounds it.
template <class R, class F>
void expect_integral(F f, R a, R b, R exact, R relative, std::vector<R> breaks = {}) {
  const auto result = integrate<R>(f, a, b, relative, R(0), breaks);
  EXPECT_TRUE(result.converged);
  EXPECT_LE(std::abs(result.value - exact), relative * std::abs(exact));
  EXPECT_LE(result.error, relative * std::abs(result.value));
}

TEST(Integrate, KnownIntegrals) {
  const double inf = std::numeric_limits<double>::infinity();
  expect_integral<double>([](double x) { return std::exp(x); }, 0, 1, std::numbers::e - 1,
                          1e-14);
  expect_integral<double>([](double x) { return std::exp(-x * x); }, 0, inf,
                          std::sqrt(std::numbers::pi) / 2, 1e-13);
  expect_integral<double>([](double x) { return 1 / std::sqrt(x); }, 0, 1, 2, 1e-9);
  expect_integral<double>([](double x) { return std::cos(50 * x); }, 0, 1,
                          std::sin(50.0) / 50, 1e-12);
  expect_integral<double>([](double x) { return x; }, 2, 0, -2, 1e-14);
  expect_integral<long double>([](long double x) { return 1 / (1 + x * x); }, 0, inf,
                               std::numbers::pi_v<long double> / 2, 1e-17L);
}

TEST(Integrate, FindsAStepAndUsesABreak) {
  const auto step = [](double x) { return x < 1 / 3.0 ? 0.0 : 1.0; };
  expect_integral<double>(step, 0, 1, 2 / 3.0, 1e-10);
  const auto told = integrate<double>(step, 0, 1, 1e-14, 0, {1 / 3.0});
  EXPECT_NEAR(told.value, 2 / 3.0, 1e-15);
  EXPECT_LE(told.evaluations, 90);
}

TEST(Integrate, SaysWhenItDidNotConverge) {
  const auto result = integrate<double>([](double x) { return 1 / x; }, 0, 1, 1e-6);
  EXPECT_FALSE(result.converged);
}

}  // namespace
}  // namespace brume
