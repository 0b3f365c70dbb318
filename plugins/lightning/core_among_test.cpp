// Facts about a bolt's bright core among other things: geometry, fog, branches, extremes.

#include "core_test.h"

#include <gtest/gtest.h>

#include <random>

#include "truth/truth.h"

namespace {

using namespace lightning::test;

TEST(LightningCore, GeometryInFrontHidesIt) {
  ThroughAir air(frame_of(1e-3));
  air.add("lightning", line({{-3, 0, 20}, {3, 0, 20}}, 0.1)).compile();
  const double whole = air({{0, 0, 0}, {0, 0, 1}, kInf}).L[0];
  EXPECT_EQ(air({{0, 0, 0}, {0, 0, 1}, 19}).L[0], 0);
  EXPECT_NEAR(air({{0, 0, 0}, {0, 0, 1}, 20}).L[0], whole / 2, 1e-5 * whole);
  EXPECT_NEAR(air({{0, 0, 0}, {0, 0, 1}, 21}).L[0], whole, 1e-6 * whole);
}

TEST(LightningCore, ItsFaintestEdgeShinesOnRaysThatReachItOnly) {
  // A thousand million shows e^-16: rays at 4 to 5.65 deviations that end short of it, in
  // it and beyond. A deviation is rounded by 5e-6 here, its square by 32 times that; a
  // quadrature is off by 1e-6 of the whole.
  const double r = 0.2;
  const Point p = {-3, 0, 20}, q = {3, 0, 20};
  for (int set = 0; set <= int(best_isa()); ++set) {
    ThroughAir air(frame_of(0));
    air.add("lightning", line({p, q}, 2 * r, "1e9")).compile(1e-3, Isa(set));
    for (const double off : {4., 5., 5.5, 5.65})
      for (const double beyond : {-7., -5., -3., -1., 0., 1., 3., 7.}) {
        Ray ray = toward({}, {0.1, off * r, 20}, 20);
        ray.t = float((20 + beyond * r) / double(ray.d[2]));
        const double want = 1e9 * light(p, q, r, 0, ray);
        EXPECT_NEAR(air(ray).L[0], want, 1e3 * std::exp(-off * off / 2) + 1e-3 * want)
            << name(Isa(set)) << ", " << off << " off, " << beyond << " beyond";
      }
  }
}

TEST(LightningCore, AStretchPastTheEyeIsSeenByTheTruthToo) {
  // From 4 cm before the eye to a hundred metres: pixels are 40 um and 10 cm wide.
  const Point p = {.031, -.027, 0}, q = {-16, 93, 0};
  ThroughAir air(frame_of(1e-3));
  air.add("lightning", line({p, q}, 1e-4, "1e6")).compile();
  for (int i = 0; i < 40; ++i) {
    const double along = std::pow(10., -4 + i / 10.), s = std::hypot(5e-5, 6.5e-4 * .04);
    const Point at = p + along * (q + -1. * p) + Point{0, 0, (i % 3) * s};
    const Ray ray = toward({}, at, 3 + 40 * along);
    const auto truth =
        truth::along(air.world(), {0, 0, 0}, {ray.d[0], ray.d[1], ray.d[2]}, ray.t,
                     {.tolerance = 1e-6});
    // Farther out it is seen along itself: there a long part of it counts, of which each
    // has a width of its own; the formula has one for all.
    const double want = i < 10 ? 1e6 * light(p, q, 5e-5, 1e-3, ray) : truth.L[0];
    EXPECT_NEAR(truth.L[0], want, 2e-3 * want) << i;
    EXPECT_NEAR(air(ray).L[0], truth.L[0], 1e-4 * truth.L[0]) << i;
    EXPECT_TRUE(truth.converged) << i;
  }
}

TEST(LightningCore, RaysBesideItStayAsTheyWere) {
  ThroughAir with(frame_of(1e-3)), without(frame_of(1e-3));
  Set bolt = {{"form", "bolt"},        {"points", "0,0,30,5,0,60"}, {"intensity", "0"},
              {"core_radiance", "90"}, {"core_radius", "0.1"},      {"branches", "0"},
              {"roughness", "0.05"}};
  const Set fog = {{"density", "0.01"}, {"falloff", "0.02"}};
  with.add("lightning", bolt).add("height_fog", fog).compile();
  without.add("height_fog", fog).compile();
  std::vector<Ray> rays;
  for (int i = 0; i < 64; ++i) rays.push_back(toward({}, {20. + i, 1. * i, 30}, 100 + i));
  EXPECT_TRUE(same_bits(with(rays), without(rays)));
}

TEST(LightningCore, BehindFogItIsDimmedAsTheTruthSays) {
  FrameInfo frame = frame_of(1e-3);
  ThroughAir air(frame);
  air.add("lightning", {{"form", "bolt"},
                        {"points", "-1,2,40,2,-1,12"},
                        {"attenuation", "0.2"},
                        {"lights", "3"},
                        {"branches", "1"},
                        {"roughness", "0.1"},
                        {"core_radiance", "5,6,9"},
                        {"core_radius", "0.2"}})
      .add("height_fog", {{"density", "0.01,0.03,0.1"}, {"falloff", "0.05"}})
      .compile();
  int met = 0;
  double worst = 0;
  for (int i = 0; i < 24; ++i) {
    const double w = (i + .5) / 24;
    const Ray r = toward({}, {-1 + 3 * w + .02 * (i % 3), 2 - 3 * w, 40 - 28 * w}, 60);
    const auto truth = truth::along(air.world(), {0, 0, 0}, {r.d[0], r.d[1], r.d[2]}, r.t,
                                    {.tolerance = 1e-6});
    met += truth.L[0] > 0.3;
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(air(r).L[c], truth.L[c], 1e-3 * (1 + truth.L[c])) << i;
      worst = std::max(worst, std::abs(air(r).L[c] - truth.L[c]) / (1 + truth.L[c]));
    }
  }
  EXPECT_GE(met, 4);  // or it said nothing
  std::printf("%d of 24 rays meet it: largest error %.1e\n", met, worst);
}

TEST(LightningCore, TheTruthDecidesAWholeBolt) {
  // Far off, where a pixel is wider than its stretches are long and a ray meets hundreds,
  // and near; 256 lights beside. What `apply --truth` asks for, in a tenth of its
  // evaluations: 64 x 36 such pixels are seconds.
  for (const double pixel : {1.8e-2, 1e-3}) {
    ThroughAir air(frame_of(pixel));
    air.add("lightning", {{"form", "bolt"},
                          {"points", "-700,1100,2200,-420,650,2300,-480,40,2100"},
                          {"intensity", "1e-4"},
                          {"attenuation", "2e-5"},
                          {"lights", "256"},
                          {"branches", "9"},
                          {"core_radiance", "1600"},
                          {"core_radius", "0.15"},
                          {"seed", "21"}})
        .add("height_fog", {{"density", "0.0007"}, {"falloff", "0.0012"}})
        .compile(1e-4);
    double most = 0, worst = 0;
    long evaluations = 0;
    for (int i = 0; i < 12; ++i) {  // across it, past the one place that is known
      const Ray r = toward({}, {-420 + 20. * (i - 6), 650 - 3. * (i - 6), 2300}, kInf);
      const auto truth = truth::along(air.world(), {0, 0, 0}, {r.d[0], r.d[1], r.d[2]},
                                      r.t, {.tolerance = 1e-5, .evaluations = 100'000});
      EXPECT_TRUE(truth.converged) << i;
      EXPECT_LE(truth.L_error[0], 1e-5 * (1 + truth.L[0])) << i;
      const double off = std::abs(air(r).L[0] - truth.L[0]) / (1 + truth.L[0]);
      EXPECT_LE(off, 1e-3) << i;
      worst = std::max(worst, off);
      most = std::max(most, truth.L[0]);
      evaluations = std::max(evaluations, truth.evaluations);
    }
    EXPECT_GT(most, 0.5);
    std::printf("pixel %g: off by %.1e at most, %ld evaluations\n", pixel, worst,
                evaluations);
  }
}

TEST(LightningCore, IsFiniteAndNeverNegativeWhateverTheCase) {
  // Radii of 0.1 mm to 10 km, stretches of nothing to 1e8 m, the eye on the core, on its
  // line, far away; rays along it, through it, ending in it, from anywhere.
  std::mt19937 random(77);
  const auto log_uniform = [&](double a, double b) {
    return a * std::pow(b / a, std::uniform_real_distribution<double>(0, 1)(random));
  };
  const auto sign = [&] { return random() % 2 ? 1. : -1.; };
  const auto place = [&](double a, double b) {
    return Point{sign() * log_uniform(a, b), sign() * log_uniform(a, b),
                 random() % 3 ? sign() * log_uniform(a, b) : 0};
  };
  for (int scene = 0; scene < 400; ++scene) {
    const Point p = scene % 5 ? place(1e-3, 1e8) : Point{},
                q = scene % 7 ? p + place(1e-6, 1e8) : -1. * p;
    ThroughAir air(frame_of(scene % 2 ? log_uniform(1e-6, .1) : 0));
    air.add("lightning", line({p, q}, log_uniform(1e-4, 1e4), "1e6"))
        .compile(1e-3, Isa(random() % (unsigned(best_isa()) + 1)));
    std::vector<Ray> rays;
    for (int i = 0; i < 32; ++i) {
      const Point from = i % 2 ? place(1e-6, 1e9) : Point{};
      Point to = i % 3 ? p + (i % 4) / 3. * (q + -1. * p) : from + (q + -1. * p);
      if (to == from) to = from + Point{0, 0, 1};
      rays.push_back(toward(from, to, i % 5 ? log_uniform(1e-9, 1e12) : kInf));
    }
    for (const Answer& a : air(rays))
      for (int c = 0; c < 3; ++c) {
        EXPECT_TRUE(std::isfinite(a.L[c]) && a.L[c] >= 0) << scene << ": " << a.L[c];
        EXPECT_EQ(a.T[c], 1) << scene;
      }
  }
}

TEST(LightningCore, BranchesAreThinner) {
  ThroughAir air(frame_of(0));
  air.add("lightning", {{"form", "bolt"},
                        {"points", "0,0,30,5,0,0"},
                        {"intensity", "0"},
                        {"core_radiance", "3"},
                        {"branches", "2"}});
  // The trunk is broken into 64, each branch into 16; all shine alike where they are
  // dense.
  EXPECT_EQ(air.world().media.size(), 64u + 2 * 16u);
  for (const auto& m : air.world().media)
    EXPECT_NEAR(m.what.emission[0], 3 / (kRoot2Pi * 0.025), 1e-9);
}

TEST(LightningCore, APixelIsAsWideEverywhereInAnOrthographicView) {
  FrameInfo frame = frame_of(0.5);
  frame.projection = Projection::orthographic;
  ThroughAir air(frame);
  air.add("lightning", line({{-9, 0, 20}, {9, 0, 20}}, 0.2))
      .add("lightning", line({{-9, 5, 900}, {9, 5, 900}}, 0.2))
      .compile();
  const double L = 0.1 / std::hypot(0.1, 0.65 * 0.5);
  EXPECT_NEAR(air({{0, 0, 0}, {0, 0, 1}, kInf}).L[0], L, 1e-4 * L);
  EXPECT_NEAR(air({{0, 5, 0}, {0, 0, 1}, kInf}).L[0], L, 1e-4 * L);
}

}  // namespace
