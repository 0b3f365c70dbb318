// Partly covered pixels without a depth take the nearest neighbour's.

#include "scene/coverage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace brume {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Frame {
  int width, height;
  std::vector<float> alpha, distance;
  Frame(int w, int h)
      : width(w),
        height(h),
        alpha(std::size_t(w) * std::size_t(h)),
        distance(alpha.size(), kInfinity) {}
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
};

Frame random_frame(unsigned seed, double covered, double deep) {
  Frame f(97, 61);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u;
  for (std::size_t i = 0; i < f.alpha.size(); ++i) {
    f.alpha[i] = u(random) < covered ? 0.5f : 0.f;
    // Few different values, so that ties happen.
    if (u(random) < deep) f.distance[i] = static_cast<float>(int(u(random) * 8));
  }
  return f;
}

// The definition, read aloud.
std::vector<float> truth(const Frame& f) {
  std::vector<float> out = f.distance;
  for (int y = 0; y < f.height; ++y)
    for (int x = 0; x < f.width; ++x) {
      if (!(f.alpha[f.at(x, y)] > 0) || f.distance[f.at(x, y)] != kInfinity) continue;
      constexpr int kTooFar = kCoverageReach * kCoverageReach + 1;
      std::pair<int, float> best{kTooFar, -1.f};
      for (int v = 0; v < f.height; ++v)
        for (int u = 0; u < f.width; ++u)
          if (f.distance[f.at(u, v)] < kInfinity)
            best = std::min(
                best, {(u - x) * (u - x) + (v - y) * (v - y), f.distance[f.at(u, v)]});
      if (best.first < kTooFar) out[f.at(x, y)] = best.second;
    }
  return out;
}

// Fills a frame in bands, each with the rows around it that it asks for.
std::vector<float> in_bands(const Frame& f, int rows) {
  std::vector<float> out = f.distance;
  for (int y = 0; y < f.height; y += rows) {
    const int n = std::min(rows, f.height - y);
    const int first = std::max(0, y - kCoverageReach);
    const int last = std::min(f.height, y + n + kCoverageReach);
    std::vector<float> around(f.distance.begin() + std::ptrdiff_t(f.at(0, first)),
                              f.distance.begin() + std::ptrdiff_t(f.at(0, last)));
    fill_uncovered({f.width, y - first, n, last - y - n, &f.alpha[f.at(0, y)], f.width,
                    around.data(), f.width});
    std::copy_n(around.begin() + std::ptrdiff_t(f.at(0, y - first)), n * f.width,
                out.begin() + std::ptrdiff_t(f.at(0, y)));
  }
  return out;
}

TEST(Coverage, TheNearestPixelWithADepthIsTakenAndOfEquallyNearOnesTheNearerToTheEye) {
  unsigned seed = 7;
  for (const double covered : {0.02, 0.5, 1.0})
    for (const double deep : {0.0, 0.0005, 0.01, 0.3, 1.0}) {
      const Frame f = random_frame(++seed, covered, deep);
      EXPECT_EQ(in_bands(f, f.height), truth(f)) << "seed " << seed;
    }
}
TEST(Coverage, TheResultDoesNotDependOnHowTheFrameIsCut) {
  for (unsigned seed = 1; seed < 5; ++seed) {
    const Frame f = random_frame(seed, 0.6, 0.004);
    const auto whole = in_bands(f, f.height);
    for (const int rows : {1, 3, 16, 60}) EXPECT_EQ(in_bands(f, rows), whole) << rows;
  }
}
TEST(Coverage, RowsAroundTheBandAreOnlyRead) {
  const Frame f = random_frame(3, 1, 0.05);
  std::vector<float> d = f.distance;
  fill_uncovered({f.width, 8, 5, 8, &f.alpha[f.at(0, 8)], f.width, d.data(), f.width});
  for (std::size_t i = 0; i < d.size(); ++i)
    if (i < f.at(0, 8) || i >= f.at(0, 13)) {
      ASSERT_EQ(d[i], f.distance[i]);
    }
}
TEST(Coverage, SkyWithoutAlphaStaysSkyAndNaNAlphaCountsAsNone) {
  Frame f(20, 1);
  f.distance[10] = 5;
  f.alpha.assign(20, 0);
  f.alpha[9] = std::nanf("");
  EXPECT_FALSE(has_uncovered(20, f.alpha.data(), f.distance.data()));
  EXPECT_EQ(in_bands(f, 1), f.distance);
}
TEST(Coverage, BeyondTheReachAPixelStaysBackground) {
  Frame f(40, 1);
  f.alpha.assign(40, 1);
  f.distance[0] = 5;
  const auto out = in_bands(f, 1);
  EXPECT_EQ(out[kCoverageReach], 5);
  EXPECT_EQ(out[kCoverageReach + 1], kInfinity);
}
TEST(Coverage, OneUncoveredPixelIsFoundWhereverItStands) {
  for (int n = 1; n < 40; ++n)
    for (int k = 0; k < n; ++k) {
      std::vector<float> alpha(std::size_t(n), 1.f), distance(std::size_t(n), 3.f);
      EXPECT_FALSE(has_uncovered(n, alpha.data(), distance.data()));
      distance[std::size_t(k)] = kInfinity;
      EXPECT_TRUE(has_uncovered(n, alpha.data(), distance.data()));
      alpha[std::size_t(k)] = 0;
      EXPECT_FALSE(has_uncovered(n, alpha.data(), distance.data()));
    }
}

}  // namespace
}  // namespace brume
