// Where media can be seen: no ray that meets one lies outside, and not much more does.

#include "pipeline/extent.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace brume::test {
namespace {

constexpr int kWidth = 160, kHeight = 90;

View view_at(const glm::dvec3& eye, const glm::dvec3& forward, bool perspective) {
  View v;
  v.projection = perspective ? Projection::perspective : Projection::orthographic;
  v.eye = eye;
  v.forward = glm::normalize(forward);
  v.right = glm::normalize(glm::cross(v.forward, glm::dvec3(0, 0, 1)));
  v.up = glm::cross(v.right, v.forward);
  const double size = perspective ? 1. / kWidth : 100. / kWidth;
  v.across = size * v.right;
  v.down = -size * v.up;
  v.corner = -0.5 * kWidth * v.across - 0.5 * kHeight * v.down;
  if (perspective) v.corner += v.forward;
  v.display = {0, 0, kWidth, kHeight};
  return v;
}

struct Box {
  glm::dvec3 center, half;
  brume_medium medium() const {
    brume_medium m = {};
    m.shape = BRUME_BOX;
    for (int i = 0; i < 3; ++i) {
      m.local_from_world[5 * i] = 1 / half[i];
      m.local_from_world[4 * i + 3] = -center[i] / half[i];
    }
    return m;
  }
  bool met(const View::RayAt& ray) const {
    double lo = 0, hi = 1e30;
    for (int i = 0; i < 3; ++i) {
      const double a = (center[i] - half[i] - ray.origin[i]) / ray.direction[i],
                   b = (center[i] + half[i] - ray.origin[i]) / ray.direction[i];
      lo = std::max(lo, std::min(a, b));
      hi = std::min(hi, std::max(a, b));
    }
    return lo < hi;
  }
};

TEST(Extent, HoldsEveryRayThatMeetsAMedium) {
  std::mt19937 random(3);
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  int met = 0, held = 0, known = 0;
  for (int scene = 0; scene < 200; ++scene) {
    const View view = view_at({uniform(-5, 5), uniform(-5, 5), uniform(-5, 5)},
                              {uniform(-1, 1), 1, uniform(-.4, .4)}, scene % 4 != 0);
    Extent extent({0, 0, kWidth, kHeight});
    std::vector<Box> boxes;
    for (int k = 0; k < 1 + scene % 3; ++k) {
      const double size = std::pow(10, uniform(-1, 1));
      boxes.push_back({{uniform(-40, 40), uniform(-20, 90), uniform(-20, 20)},
                       {size, size * uniform(.3, 3), size}});
      extent.add(boxes.back().medium(), view);
    }
    known += !extent.everywhere();
    const Window all = extent.bounds();
    for (int y = 0; y < kHeight; ++y) {
      const Extent::Columns row = extent.row(y, 0, kWidth);
      for (int x = 0; x < kWidth; ++x) {
        const auto ray = view.ray(x + .5, y + .5);
        const bool in = x >= row.first && x < row.end;
        held += in;
        if (std::none_of(boxes.begin(), boxes.end(),
                         [&](const Box& b) { return b.met(ray); }))
          continue;
        ++met;
        ASSERT_TRUE(in) << "scene " << scene << ", pixel " << x << ", " << y;
        ASSERT_TRUE(y >= all.y && y < all.bottom() && x >= all.x && x < all.right());
      }
    }
  }
  EXPECT_GE(known, 100);
  EXPECT_GE(met, 10000);  // or it said nothing
  EXPECT_LE(held, 200 * kWidth * kHeight / 2);
}

TEST(Extent, IsLittleMoreThanThePictureOfABox) {
  // 10 m wide and high at 100 m: 16 pixels; and one and a half, rounded out, on each
  // side.
  const View view = view_at({0, 0, 0}, {0, 1, 0}, true);
  Extent extent({0, 0, kWidth, kHeight});
  const auto w = extent.add(Box{{0, 100, 0}, {5, 1e-3, 5}}.medium(), view);
  ASSERT_TRUE(w.has_value());
  EXPECT_LE(w->width, 20);
  EXPECT_LE(w->height, 20);
  EXPECT_EQ(extent.row(2, 0, kWidth).first, extent.row(2, 0, kWidth).end);
}

TEST(Extent, AMediumWithoutBoundsOrAroundTheEyeIsEverywhere) {
  const View view = view_at({0, 0, 0}, {0, 1, 0}, true);
  brume_medium open = {};
  open.shape = BRUME_EVERYWHERE;
  const brume_medium around = Box{{0, 0, 0}, {5, 5, 5}}.medium();
  for (const brume_medium& m : {open, around}) {
    Extent extent({0, 0, kWidth, kHeight});
    EXPECT_FALSE(extent.add(m, view).has_value());
    EXPECT_TRUE(extent.everywhere());
    EXPECT_EQ(extent.row(7, 3, 90).first, 3);
    EXPECT_EQ(extent.row(7, 3, 90).end, 90);
  }
}

TEST(Extent, WhatIsBesideThePictureIsOnePixelAtMost) {
  const View view = view_at({0, 0, 0}, {0, 1, 0}, true);
  Extent extent({0, 0, kWidth, kHeight});
  EXPECT_TRUE(extent.add(Box{{500, 100, 0}, {5, 5, 5}}.medium(), view)->empty());
  EXPECT_EQ(extent.bounds().pixels(), 1);
}

}  // namespace
}  // namespace brume::test
