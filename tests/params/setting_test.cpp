// Values over frames.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "params/params.h"

namespace brume {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kInf = std::numeric_limits<double>::infinity();

Setting through(const std::vector<std::pair<double, double>>& keys, Interpolation way) {
  Setting s;
  for (const auto& [frame, value] : keys) s.keys.push_back({frame, {.numbers = {value}}});
  s.interpolation = way;
  return s;
}

double at(const Setting& s, double frame) { return s.at(frame).numbers[0]; }

// Keys at random distances with random values, some equal, some far apart.
Setting random_keys(std::mt19937& rng, Interpolation way) {
  std::uniform_real_distribution<double> u(0, 1);
  Setting s;
  double frame = -100 + 50 * u(rng), value = 0;
  const int n = 2 + int(10 * u(rng));
  for (int i = 0; i < n; ++i) {
    s.keys.push_back({frame, {.numbers = {value}}});
    frame += std::exp(6 * u(rng) - 3);
    if (u(rng) > 0.2) value += (u(rng) - 0.5) * std::exp(20 * u(rng) - 10);
  }
  s.interpolation = way;
  return s;
}

const Interpolation kWays[] = {Interpolation::linear, Interpolation::smooth,
                               Interpolation::step};

TEST(Setting, AtAKeyTheKeysValueComesBackBitForBit) {
  std::mt19937 rng(1);
  for (int i = 0; i < 300; ++i) {
    const Setting s = random_keys(rng, kWays[i % 3]);
    for (const Setting::Key& k : s.keys)
      EXPECT_EQ(at(s, k.frame), k.value.numbers[0]) << "seed 1, case " << i;
  }
}

TEST(Setting, AKeyKeepsTheSignOfItsZero) {
  for (const Interpolation way : kWays) {
    const Setting s = through({{0, -0.0}, {1, 1}}, way);
    EXPECT_TRUE(std::signbit(at(s, 0)));
  }
}

TEST(Setting, OutsideTheKeysTheNearestHolds) {
  for (const Interpolation way : kWays) {
    const Setting s = through({{1, 3}, {2, 5}}, way);
    EXPECT_EQ(at(s, -1e9), 3);
    EXPECT_EQ(at(s, 1e9), 5);
    EXPECT_EQ(at(s, -kInf), 3);
    EXPECT_EQ(at(s, kInf), 5);
  }
}

TEST(Setting, AConstantIsTheSameAtEveryFrame) {
  const Setting s = through({{0, 7}}, Interpolation::linear);
  EXPECT_EQ(at(s, -5), 7);
  EXPECT_EQ(at(s, 0), 7);
  EXPECT_EQ(at(s, 5), 7);
  EXPECT_FALSE(s.animated());
}

TEST(Setting, LinearGoesStraight) {
  const Setting s = through({{10, 1}, {14, 3}, {15, -1}}, Interpolation::linear);
  EXPECT_EQ(at(s, 11), 1.5);
  EXPECT_EQ(at(s, 12), 2);
  EXPECT_EQ(at(s, 14.5), 1);
}

TEST(Setting, StepHoldsUntilTheNextKey) {
  const Setting s = through({{10, 1}, {14, 3}}, Interpolation::step);
  EXPECT_EQ(at(s, std::nextafter(14.0, 0.0)), 1);
  EXPECT_EQ(at(s, 14), 3);
}

TEST(Setting, NothingBetweenTwoKeysLeavesTheirInterval) {
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> u(0, 1);
  for (int i = 0; i < 2000; ++i) {
    const Setting s = random_keys(rng, kWays[i % 2]);
    for (std::size_t k = 0; k + 1 < s.keys.size(); ++k) {
      const double a = s.keys[k].value.numbers[0], b = s.keys[k + 1].value.numbers[0];
      const double f = s.keys[k].frame, g = s.keys[k + 1].frame;
      const double y = at(s, f + (g - f) * u(rng));
      EXPECT_LE(std::min(a, b), y) << "seed 2, case " << i;
      EXPECT_GE(std::max(a, b), y) << "seed 2, case " << i;
    }
  }
}

// Where rounding alone could leave: neighbouring doubles.
TEST(Setting, BetweenNeighbouringDoublesThereIsNothingElse) {
  std::mt19937 rng(6);
  std::uniform_real_distribution<double> u(0, 1);
  for (int i = 0; i < 2000; ++i) {
    const double a = u(rng), b = std::nextafter(a, 2.0);
    const double y = at(through({{0, a}, {1, b}}, kWays[i % 2]), u(rng));
    EXPECT_TRUE(y == a || y == b) << "seed 6, case " << i;
  }
}

TEST(Setting, SmoothIsMonotoneBetweenKeys) {
  std::mt19937 rng(3);
  for (int i = 0; i < 300; ++i) {
    const Setting s = random_keys(rng, Interpolation::smooth);
    for (std::size_t k = 0; k + 1 < s.keys.size(); ++k) {
      const double a = s.keys[k].value.numbers[0], b = s.keys[k + 1].value.numbers[0];
      const double f = s.keys[k].frame, g = s.keys[k + 1].frame;
      // A dozen roundings of terms up to 3 |b - a| beside |a| and |b|.
      const double slack =
          12 * kEps * (std::fabs(a) + std::fabs(b) + 3 * std::fabs(b - a));
      double before = a;
      for (int j = 1; j <= 100; ++j) {
        const double y = at(s, f + (g - f) * j / 100);
        EXPECT_GE((y - before) * (b > a ? 1 : -1), -slack) << "seed 3, case " << i;
        before = y;
      }
    }
  }
}

// The data of Fritsch and Carlson 1980, table 1 (RPN 14): a steep rise after a flat foot,
// where a spline swings below 0 and above 1.
TEST(Setting, SmoothKeepsTheRiseOfRpn14) {
  const Setting s = through({{7.99, 0},
                             {8.09, 2.76429e-5},
                             {8.19, 4.37498e-2},
                             {8.7, 0.169183},
                             {9.2, 0.469428},
                             {10, 0.943740},
                             {12, 0.998636},
                             {15, 0.999919},
                             {20, 0.999994}},
                            Interpolation::smooth);
  double before = 0;
  for (int i = 0; i <= 2000; ++i) {
    const double y = at(s, 7.99 + 12.01 * i / 2000);
    EXPECT_GE(y, before - 4 * kEps);  // rounding of values up to 1
    EXPECT_LE(y, 1);
    before = y;
  }
}

TEST(Setting, SmoothThroughALineIsTheLine) {
  const Setting s =
      through({{0, 1}, {1, 3}, {4, 9}, {9, 19}, {10, 21}}, Interpolation::smooth);
  for (double f = 0; f <= 10; f += 0.125)
    EXPECT_NEAR(at(s, f), 1 + 2 * f, 8 * kEps * 21);  // a few roundings of values <= 21
}

TEST(Setting, SmoothHasNoKinkAtAKey) {
  const Setting s =
      through({{0, 0}, {1, 1}, {3, 2}, {4, 5}, {6, 6}}, Interpolation::smooth);
  const double h = 1e-5;
  for (const double key : {1.0, 3.0, 4.0}) {
    const double left = (at(s, key) - at(s, key - h)) / h;
    const double right = (at(s, key + h) - at(s, key)) / h;
    EXPECT_NEAR(left, right, 60 * h);  // one-sided differences: h/2 |y''|, |y''| <= 60
    EXPECT_GT(left, 0.1);              // and it does not rest there
  }
  // Linear does have one: the test sees kinks.
  Setting kinked = s;
  kinked.interpolation = Interpolation::linear;
  EXPECT_GT(at(kinked, 1) - at(kinked, 1 - h), 1.5 * (at(kinked, 1 + h) - at(kinked, 1)));
}

TEST(Setting, SmoothConvergesWithTheThirdPower) {
  const auto error = [](int n) {
    Setting s;
    for (int i = 0; i <= n; ++i)
      s.keys.push_back({4.0 * i / n, {.numbers = {std::exp(4.0 * i / n)}}});
    s.interpolation = Interpolation::smooth;
    double worst = 0;
    for (double x = 1; x < 3; x += 0.001)
      worst = std::max(worst, std::fabs(at(s, x) - std::exp(x)));
    return worst;
  };
  // Slopes are second order away from the ends, so halving the step divides by 8.
  EXPECT_GT(error(20) / error(40), 7);
  EXPECT_LT(error(20) / error(40), 9);
}

TEST(Setting, InfinityAndHugeValuesGiveNoNan) {
  for (const Interpolation way : kWays) {
    const Setting far = through({{0, 1}, {1, kInf}, {2, kInf}}, way);
    EXPECT_EQ(at(far, 0.5), 1);
    EXPECT_EQ(at(far, 1.5), kInf);
    const Setting huge = through({{0, -1.7e308}, {1, 1.7e308}, {2, -1.7e308}}, way);
    EXPECT_TRUE(std::isfinite(at(huge, 0.3)));
    EXPECT_TRUE(std::isfinite(at(huge, 1.3)));
  }
}

TEST(Setting, ColoursGoPerComponentAndWordsStep) {
  Setting s;
  s.keys = {{0, {.numbers = {0, 1, 2}}}, {2, {.numbers = {2, 1, 0}}}};
  EXPECT_EQ(s.at(1).numbers, (std::vector<double>{1, 1, 1}));
  Setting words;
  words.keys = {{0, {.text = "sky"}}, {2, {.text = "sun"}}};
  words.interpolation = Interpolation::step;
  EXPECT_EQ(words.at(1.9).text, "sky");
  EXPECT_EQ(words.at(2).text, "sun");
}

}  // namespace
}  // namespace brume
