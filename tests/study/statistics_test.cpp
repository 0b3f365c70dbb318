// Medians, frontiers, and the choice of settings by time and by error.

#include "study/statistics.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "study/prepared.h"
#include "study/report.h"

namespace {

using namespace brume::study;

TEST(Spread, IsTheMedianAndTheQuartilesWhateverTheOrder) {
  const Spread s = spread({5, 1, 4, 2, 3});
  EXPECT_EQ(s.low, 2);
  EXPECT_EQ(s.median, 3);
  EXPECT_EQ(s.high, 4);
}

TEST(Spread, InterpolatesBetweenTwoInTheMiddle) {
  const Spread s = spread({1, 2, 3, 10});
  EXPECT_EQ(s.low, 1.75);
  EXPECT_EQ(s.median, 2.5);
  EXPECT_EQ(s.high, 4.75);
}

TEST(Spread, OneIsItselfAndNoneIsZero) {
  EXPECT_EQ(spread({7}).low, 7);
  EXPECT_EQ(spread({7}).high, 7);
  EXPECT_EQ(spread({}).median, 0);
}

TEST(Spread, AnOutlierDoesNotMoveTheMedian) {
  EXPECT_EQ(spread({1, 1, 1, 1, 1e9}).median, 1);
}

using Indices = std::vector<std::size_t>;

TEST(Frontier, IsWhatNothingBeatsInBoth) {
  const std::vector<Cost> c = {{1, 10}, {2, 5}, {3, 7}, {4, 1}, {5, 1}};
  EXPECT_EQ(frontier(c), (Indices{0, 1, 3}));  // 2 is beaten by 1, 4 by 3
}

TEST(Frontier, OfEqualsKeepsTheFirstAndOfOneTimeTheBest) {
  const std::vector<Cost> c = {{1, 5}, {1, 5}, {1, 3}};
  EXPECT_EQ(frontier(c), (Indices{2}));
  EXPECT_EQ(frontier(std::vector<Cost>{{1, 5}, {1, 5}}), (Indices{0}));
}

TEST(Frontier, WhatIsNoNumberIsNotOnIt) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(frontier(std::vector<Cost>{{nan, 0}, {1, nan}, {2, 2}}), (Indices{2}));
}

TEST(Frontier, NoPointOnItIsBeatenByAny) {
  std::mt19937 random(1896);
  std::uniform_real_distribution<double> u(0, 1);
  for (int round = 0; round < 200; ++round) {
    std::vector<Cost> c(1 + random() % 20);
    for (Cost& one : c) one = {u(random), u(random)};
    const Indices best = frontier(c);
    ASSERT_FALSE(best.empty());
    for (const std::size_t i : best)
      for (const Cost& other : c)
        EXPECT_FALSE(other.seconds < c[i].seconds && other.error < c[i].error);
    // And what is not on it is beaten by some.
    for (std::size_t i = 0; i < c.size(); ++i) {
      if (std::find(best.begin(), best.end(), i) != best.end()) continue;
      EXPECT_TRUE(std::any_of(best.begin(), best.end(), [&](std::size_t b) {
        return c[b].seconds <= c[i].seconds && c[b].error <= c[i].error;
      }));
    }
  }
}

TEST(Choice, ByTimeIsTheLeastErrorThatFits) {
  const std::vector<Cost> c = {{1, 10}, {2, 5}, {3, 7}, {4, 1}};
  EXPECT_EQ(least_error_within(c, 3.5), 1u);  // not the slowest that fits
  EXPECT_EQ(least_error_within(c, 4), 3u);
  EXPECT_EQ(least_error_within(c, 0.5), std::nullopt);
}

TEST(Choice, ByErrorIsTheFastestThatIsGoodEnough) {
  const std::vector<Cost> c = {{1, 10}, {2, 5}, {3, 7}, {4, 1}};
  EXPECT_EQ(least_time_for(c, 7), 1u);
  EXPECT_EQ(least_time_for(c, 1), 3u);
  EXPECT_EQ(least_time_for(c, 0.5), std::nullopt);
}

// A study whose whole scene has these points, ours over two knobs.
Study study_of(const std::vector<Cost>& costs) {
  Study s;
  s.subjects.emplace_back();
  for (const Cost& c : costs) {
    Method m{MethodKind::ours, "brume", {}};
    m.points.emplace_back();
    m.points[0].seconds = c.seconds;
    m.points[0].color.max = c.error;
    m.points[0].setting = std::to_string(int(c.seconds));
    s.subjects[0].methods.push_back(m);
  }
  // A baseline is no setting, however good.
  Method other{MethodKind::marching, "even steps", {}};
  other.points.emplace_back();
  other.points[0].seconds = 1e-9;
  s.subjects[0].methods.push_back(other);
  return s;
}

TEST(Choice, IsAmongOursAndNamesTheNearestWhereThereIsNone) {
  const Study s = study_of({{1, 10}, {2, 5}, {4, 1}});
  EXPECT_EQ(choose_by_time(s, 2.5).point->setting, "2");
  EXPECT_EQ(choose_by_time(s, 0.1).point, nullptr);
  EXPECT_EQ(choose_by_time(s, 0.1).nearest->setting, "1");
  EXPECT_EQ(choose_by_error(s, 6).point->setting, "2");
  EXPECT_EQ(choose_by_error(s, 0.1).point, nullptr);
  EXPECT_EQ(choose_by_error(s, 0.1).nearest->setting, "4");
}

TEST(Knob, ValuesGoFromEndToEnd) {
  brume::ParamSpec whole{.name = "n", .kind = brume::Kind::integer};
  whole.minimum = 2, whole.maximum = 10;
  EXPECT_EQ(values_along(whole), (std::vector<double>{2, 4, 8, 10}));
  brume::ParamSpec real{.name = "x"};
  real.minimum = 1e-3, real.maximum = 1;
  const auto v = values_along(real);
  ASSERT_EQ(v.size(), 4u);
  EXPECT_NEAR(v.front(), 1e-3, 1e-15);
  EXPECT_EQ(v.back(), 1);
  EXPECT_TRUE(values_along(brume::ParamSpec{.name = "free"}).empty());
}

}  // namespace
