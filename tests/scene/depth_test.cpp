// What depth values mean, and which channel is taken for depth.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "camera_scenes.h"
#include "num/isa.h"
#include "scene/depth_run.h"

namespace brume {
namespace {

using namespace test;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

// One value through a run of 19, so that whole batches and the rest are both asked.
float distance(const DepthRule& rule, float depth, float per_planar) {
  std::vector<float> z(19, depth), p(19, per_planar), d(19, -1.f);
  distances_from_depth(rule, 19, z.data(), p.data(), d.data());
  for (const float x : d) EXPECT_EQ(x, d[0]);
  return d[0];
}

TEST(Depth, PlanarDepthIsStretchedAlongTheRay) {
  EXPECT_FLOAT_EQ(distance({}, 100, 1.25f), 125);
  EXPECT_FLOAT_EQ(distance({.metres = 0.01}, 100, 1.25f), 1.25f);
}
TEST(Depth, DistanceIsTakenAsItIs) {
  EXPECT_FLOAT_EQ(distance({.kind = DepthKind::distance, .metres = 2}, 100, 1.25f), 200);
}
TEST(Depth, InverseDepthIsOneOverPlanar) {
  EXPECT_FLOAT_EQ(distance({.kind = DepthKind::inverse}, 0.01f, 1.25f), 125);
  EXPECT_FLOAT_EQ(distance({.kind = DepthKind::inverse, .metres = 10}, 0.01f, 1), 1000);
  EXPECT_EQ(distance({.kind = DepthKind::inverse}, 0, 1), kInfinity);
  EXPECT_EQ(distance({.kind = DepthKind::inverse}, 1e-45f, 1), kInfinity);
}
TEST(Depth, NormalisedDepthRunsFromNearToFarAndFarIsBackground) {
  const DepthRule r{.kind = DepthKind::normalised, .near = 10, .far = 110};
  EXPECT_FLOAT_EQ(distance(r, 0, 1.5f), 15);
  EXPECT_FLOAT_EQ(distance(r, 0.5f, 1.5f), 90);
  EXPECT_FLOAT_EQ(distance(r, -0.25f, 1.5f), 15);  // clamped by its writer
  EXPECT_EQ(distance(r, 1, 1), kInfinity);
  EXPECT_EQ(distance(r, 2, 1), kInfinity);
  DepthRule white = r;
  white.white_near = true;
  EXPECT_FLOAT_EQ(distance(white, 1, 1.5f), 15);
  EXPECT_FLOAT_EQ(distance(white, 0.5f, 1.5f), 90);
  EXPECT_EQ(distance(white, 0, 1), kInfinity);
  for (const float bad : {kInfinity, -kInfinity, kNaN}) {
    EXPECT_EQ(distance(r, bad, 1), kInfinity);
    EXPECT_EQ(distance(white, bad, 1), kInfinity);
  }
}
TEST(Depth, WhatNoSurfaceHasIsBackgroundInEveryKind) {
  for (const DepthKind kind :
       {DepthKind::planar, DepthKind::distance, DepthKind::inverse})
    for (const float bad : {0.f, -0.f, -5.f, kInfinity, -kInfinity, kNaN})
      EXPECT_EQ(distance({.kind = kind}, bad, 1.1f), kInfinity) << bad;
  for (const DepthKind kind : {DepthKind::planar, DepthKind::distance})
    for (const float far : {1e9f, 1e10f, 1e12f, 3e38f})
      EXPECT_EQ(distance({.kind = kind, .metres = 0.01}, far, 1), kInfinity) << far;
}
TEST(Depth, TheBackgroundThresholdIsExactAndInTheChannelsUnits) {
  // 0.1 is no float: the float below it is a surface, the one above background.
  const DepthRule r{.metres = 7, .background_from = 0.1};
  EXPECT_LT(distance(r, std::nextafter(0.1f, 0.f), 1), kInfinity);
  EXPECT_EQ(distance(r, 0.1f, 1), kInfinity);  // 0.1f > 0.1
  // And of 0.7 the float is below it: still a surface; the next one is not.
  const DepthRule below{.background_from = 0.7};
  EXPECT_EQ(distance(below, 0.7f, 1), 0.7f);  // 0.7f < 0.7
  EXPECT_EQ(distance(below, std::nextafter(0.7f, 1.f), 1), kInfinity);
  const DepthRule none{.background_from = std::numeric_limits<double>::infinity()};
  EXPECT_EQ(distance(none, 1e10f, 1), 1e10f);
  EXPECT_EQ(distance(none, kInfinity, 1), kInfinity);
}
TEST(Depth, MayBeDoneInPlace) {
  std::vector<float> z{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}, p(11, 2.f);
  distances_from_depth({}, 11, z.data(), p.data(), z.data());
  for (int i = 0; i < 11; ++i) EXPECT_EQ(z[std::size_t(i)], 2.f * float(i + 1));
}
TEST(Depth, ANormalisedDepthWithoutItsEndsIsAnError) {
  InputSection in;
  in.depth_kind = "normalised";
  EXPECT_THROW(depth_rule(in), Error);
  in.depth_far = 100;
  EXPECT_EQ(depth_rule(in).far, 100);
}

// ---- position pass

float from_position(const glm::dvec3& eye, const glm::dvec3& p, double metres = 1,
                    const float* alpha = nullptr) {
  View v;
  v.eye = eye;
  v.display = {0, 0, 2, 2};
  v.corner = v.forward - v.right + v.up;
  v.across = v.right;
  v.down = -v.up;
  Rays rays(1);
  fill_rays(v, 0, 0, 1, rays.span());
  const float x = float(p.x), y = float(p.y), z = float(p.z);
  float d = -1;
  distances_from_position(v, metres, 1, &x, &y, &z, alpha, rays.span(), &d);
  return d;
}

TEST(Position, DistanceIsTheProjectionOnTheRay) {
  // The ray of pixel (0, 0) goes along (-1/2, 1, 1/2).
  const glm::dvec3 eye{1, 2, 3}, d = glm::normalize(glm::dvec3(-0.5, 1, 0.5));
  EXPECT_NEAR(from_position(eye, eye + 100. * d), 100, 3e-5);  // 3 floats near 100
  const glm::dvec3 aside = glm::cross(d, glm::dvec3(0, 0, 1));
  EXPECT_NEAR(from_position(eye, eye + 100. * d + aside), 100, 3e-5);
  EXPECT_EQ(from_position(eye, eye - 5. * d), 0);
  EXPECT_NEAR(from_position(eye, (eye + 100. * d) / 0.01, 0.01), 100, 3e-5);
}
TEST(Position, TheEyeIsTakenOffWithoutCancellation) {
  // Positions that are floats, an eye that is not: 0.3 m from a multiple of half a metre.
  const glm::dvec3 eye{6.4e6 + 0.3, -6.4e6 + 0.3, 0.1};
  const glm::dvec3 p{6.4e6 - 50, -6.4e6 + 100, 50};
  const glm::dvec3 d = glm::normalize(glm::dvec3(-0.5, 1, 0.5));
  EXPECT_NEAR(from_position(eye, p), glm::dot(p - eye, d), 2e-5);  // 2^-24 of 100 m, x 3
}
TEST(Position, NothingIsThereWithoutCoverageAtTheOriginOrBeyondNumbers) {
  const glm::dvec3 eye{0, -5, 0}, p{0, 5, 0};
  const float none = 0, some = 0.5f, nan = kNaN;
  EXPECT_LT(from_position(eye, p), kInfinity);
  EXPECT_LT(from_position(eye, p, 1, &some), kInfinity);
  EXPECT_EQ(from_position(eye, p, 1, &none), kInfinity);
  EXPECT_EQ(from_position(eye, p, 1, &nan), kInfinity);
  EXPECT_EQ(from_position(eye, {0, 0, 0}), kInfinity);
  EXPECT_EQ(from_position(eye, {0, 0, 0}, 1, &some), kInfinity);
  EXPECT_EQ(from_position(eye, {1, kInfinity, 0}), kInfinity);
  EXPECT_EQ(from_position(eye, {kNaN, 1, 0}), kInfinity);
}
TEST(Position, ARunGivesWhatItsPixelsGiveAlone) {
  const int n = 37;
  View v;
  v.display = {0, 0, n, 1};
  v.corner = v.forward;
  v.across = 0.01 * v.right;
  v.down = -v.up;
  Rays rays(n);
  fill_rays(v, 0, 0, n, rays.span());
  std::vector<float> x(n), y(n), z(n), a(n), d(n);
  for (int i = 0; i < n; ++i) {
    x[std::size_t(i)] = 0.1f * float(i);
    y[std::size_t(i)] = 10;
    z[std::size_t(i)] = -1;
    a[std::size_t(i)] = i % 3 ? 1.f : 0.f;
  }
  distances_from_position(v, 1, n, x.data(), y.data(), z.data(), a.data(), rays.span(),
                          d.data());
  for (int i = 0; i < n; ++i) {
    float alone;
    const auto k = std::size_t(i);
    distances_from_position(v, 1, 1, &x[k], &y[k], &z[k], &a[k], rays.span(i), &alone);
    EXPECT_EQ(alone, d[k]);
    EXPECT_EQ(i % 3 == 0, d[k] == kInfinity);
  }
}

// ---- which channel

DepthChoice choose(std::initializer_list<const char*> names) {
  ImageHeader h = header(1, 1);
  for (const char* name : names) h.channels.push_back({name});
  return find_depth(h);
}
TEST(FindDepth, TakesTheMostCertainNameFirst) {
  EXPECT_EQ(choose({"A", "B", "G", "R"}).channel, -1);
  EXPECT_EQ(choose({"A", "Z", "depth.Z", "z"}).channel, 1);
  EXPECT_EQ(choose({"A", "depth.Z", "z"}).channel, 1);
  EXPECT_EQ(choose({"ViewLayer.Depth.V", "ViewLayer.Depth.Z"}).channel, 1);
  EXPECT_EQ(choose({"FinalImageMovieRenderQueue_WorldDepth.R", "depth.V"}).channel, 1);
  EXPECT_EQ(choose({"FinalImageMovieRenderQueue_WorldDepth.R", "VRayZDepth.R"}).channel,
            0);
  EXPECT_EQ(choose({"VRayZDepth.R", "z"}).channel, 0);
  EXPECT_EQ(choose({"A", "Pz"}).channel, 1);
  EXPECT_EQ(choose({"A", "z"}).channel, 1);
}
TEST(FindDepth, IsNotMisledByChannelsThatOnlyEndAlike) {
  EXPECT_EQ(choose({"N.Z", "P.Z", "Position.Z", "soft_depth_Z"}).channel, -1);
  EXPECT_EQ(choose({"mydepth.Z"}).channel, -1);
}
TEST(FindDepth, SaysWhyAndHowManyMore) {
  EXPECT_NE(choose({"Z"}).why.find("EXR"), std::string::npos);
  const auto two = choose({"Far.Depth.Z", "Near.Depth.Z"});
  EXPECT_EQ(two.channel, 0);
  EXPECT_NE(two.why.find("first of 2"), std::string::npos) << two.why;
}

}  // namespace
}  // namespace brume
