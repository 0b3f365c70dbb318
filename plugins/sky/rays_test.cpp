// Rays through a frame's sky, as the integrator asks for them, against the truth.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "../../tests/stage/through_air.h"
#include "truth/truth.h"

namespace brume::test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

// An eye h metres up, in a frame of many pixels, the sun so many degrees above level
// toward x.
FrameInfo under_the_sun(double h, double sun) {
  FrameInfo f = eye_at(0, 0, h);
  f.display = {0, 0, 1920, 1080};
  const double e = sun * M_PI / 180;
  f.sun = FrameInfo::Sun{{std::cos(e), 0, std::sin(e)}};
  return f;
}

Ray toward(double z, double azimuth, float t, float weight = 1) {
  const double s = std::sqrt(1 - z * z);
  return {{0, 0, 0},
          {float(s * std::cos(azimuth)), float(s * std::sin(azimuth)), float(z)},
          t,
          weight};
}

truth::Answer truth_of(const ThroughAir& air, const Ray& r) {
  return truth::along(air.world(), air.world().eye, {r.d[0], r.d[1], r.d[2]}, r.t,
                      {.tolerance = 1e-5});
}

TEST(Rays, APartOfASkyIsAsMuchOfItsTruth) {
  // Under a mask or mix every wavelength's air is thinned along the ray, not its
  // colours'. Rays of the frame's own mix are looked up, others asked one by one; in a
  // fog all of them are walked.
  double worst = 0, worst_in_fog = 0;
  for (const char* preset : {"earth", "hazy"})
    for (const double sun : {-2., 2., 40.})
      for (const float mix : {.02f, .3f, .9f})
        for (const bool fog : {false, true}) {
          FrameInfo f = under_the_sun(50, sun);
          f.mix = double(mix);
          ThroughAir air(f);
          air.add("sky", {{"preset", preset}, {"exposure", "0.05"}});
          if (fog)
            air.add("height_fog",
                    {{"density", "0.0005"}, {"falloff", "0.005"}, {"color", "0.3"}});
          air.compile(2e-4);
          std::vector<Ray> rays;
          for (const double z : {-.2, -.02, -.004, .0, .003, .03, .2, .8})
            for (const double azimuth : {.1, 2.})
              for (const float weight : {mix, .5f * mix}) {
                const Ray ray = toward(z, azimuth, z < 0 ? float(49 / -z) : kInf, weight);
                rays.push_back(ray);
                if (z == 0) rays.push_back(ray), rays.back().t = 8000;
              }
          const auto got = air(rays);
          for (std::size_t i = 0; i < rays.size(); ++i) {
            const Ray& r = rays[i];
            const double weights[2] = {double(r.weight), double(r.weight)};
            const auto want =
                truth::along(air.world(), f.eye, {r.d[0], r.d[1], r.d[2]}, r.t,
                             {.tolerance = 1e-5, .weights = {weights, fog ? 2u : 1u}});
            double& largest = fog ? worst_in_fog : worst;
            for (int c = 0; c < 3; ++c) {
              EXPECT_NEAR(got[i].T[c], want.T[c], 1e-4) << sun << ", " << r.weight;
              largest =
                  std::max(largest, std::abs(got[i].L[c] - want.L[c]) / (1 + want.L[c]));
            }
          }
        }
  std::printf("a part of a sky, of white + |L|: %.1e, in a fog %.1e\n", worst,
              worst_in_fog);
  // What the whole promises at this detail (curve.h), and what the walk adds to it.
  EXPECT_LE(worst, 4.3e-4);
  EXPECT_LE(worst_in_fog, 4.3e-4 + 2e-4);
}

TEST(Rays, BelowTheSeaTheAirIsAsTheTruthHasIt) {
  // A plain 1.7 m below an eye that is below sea level itself, or just above it; as a
  // frame of few pixels asks, and as one of many does.
  for (const char* sea : {"0", "1", "1.69", "1.71", "40", "280", "320", "9000"})
    for (const int width : {16, 1920}) {
      FrameInfo f = eye_at(0, 0, 1.7);
      f.display = {0, 0, width, width / 2};
      FrameInfo::Sun sun;
      sun.to = {.6, 0, .8};
      f.sun = sun;
      ThroughAir air(f);
      air.add("sky", {{"sea_level", sea}, {"conversion", "none"}}).compile(1e-4);
      std::vector<Ray> rays;
      for (double t = 20; t < 1e5; t *= 1.5) {
        const double z = -1.7 / t, x = std::sqrt(1 - z * z);
        rays.push_back({{0, 0, 0}, {0, float(x), float(z)}, float(t)});
      }
      // And where there is no plain.
      for (const double z : {-1., -.3, -.05, -.02, -.01, -.002, .002, .05, .7})
        rays.push_back({{0, 0, 0}, {0, float(std::sqrt(1 - z * z)), float(z)}, kInf});
      const auto got = air(rays);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const Ray& r = rays[i];
        const auto want = truth_of(air, r);
        for (int c = 0; c < 3; ++c) {
          EXPECT_NEAR(got[i].T[c], want.T[c], 1e-4) << sea << ", " << r.t;
          EXPECT_NEAR(got[i].L[c], want.L[c], 4e-3 * want.L[c]) << sea << ", " << r.t;
          EXPECT_TRUE(got[i].L[c] > 0) << sea << ", " << r.t << ", " << r.d[2];
        }
      }
    }
}

TEST(Rays, RaysThatBeginOrEndFarInTheGroundAreAsTheTruthHasThem) {
  FrameInfo f = eye_at(0, 0, 0);
  f.display = {0, 0, 1920, 1080};
  FrameInfo::Sun sun;
  sun.to = {.6, 0, .8};
  f.sun = sun;
  ThroughAir air(f);
  air.add("sky", {{"conversion", "none"}}).compile(1e-4);
  std::vector<Ray> rays;
  for (const float z : {-5000.f, -700.f, -500.f, 0.f, 300.f})
    for (const float up : {-.3f, -1e-7f, 0.f, 1e-3f, .05f, .8f})
      for (const float t : {80.f, 4000.f, 9e4f, 2e7f, 2e20f, kInf}) {
        // By the last bit a ray meets the horizon or not.
        if (z == 0 && std::abs(up) < 1e-6f && t == kInf) continue;
        rays.push_back({{z < 0 ? 3000.f : 0, 0, z}, {std::sqrt(1 - up * up), 0, up}, t});
      }
  const auto got = air(rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Ray& r = rays[i];
    const glm::dvec3 o{r.o[0], r.o[1], r.o[2]};
    const auto want = truth::along(air.world(), f.eye + o, {r.d[0], r.d[1], r.d[2]}, r.t,
                                   {.tolerance = 1e-6});
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(got[i].T[c], want.T[c], 1e-4) << o.z << ", " << r.d[2] << ", " << r.t;
      EXPECT_NEAR(got[i].L[c], want.L[c], 4e-4 * (1 + want.L[c]))
          << o.z << ", " << r.d[2] << ", " << r.t;
    }
  }
}

TEST(Rays, TheSunSetsAsInTheTruth) {
  // While its disc crosses the horizon light changes over kilometres of air, and within
  // metres above the ground. From below sea level, from the beach, from the air; in the
  // sky and before surfaces near, far, and past the ground.
  double worst = 0;
  for (const char* preset : {"earth", "hazy"})
    for (const double h : {-25., 2., 500., 10e3})
      for (const double sun : {-2., -.5, -.2, 0., .2, .5, 2.}) {
        const FrameInfo f = under_the_sun(h, sun);
        ThroughAir air(f);
        air.add("sky", {{"preset", preset}}).compile(2e-4);
        std::vector<Ray> rays;
        for (const double z : {-.05, -.0013, 0., .003, .02, .2})
          for (const double azimuth : {.05, 1.5, 3.})
            for (const float t : {900.f, 3e4f, kInf}) {
              if (z <= 0 && t == kInf) continue;
              rays.push_back(toward(z, azimuth, t));
            }
        const auto got = air(rays);
        for (std::size_t i = 0; i < rays.size(); ++i) {
          const Ray& r = rays[i];
          const auto want = truth_of(air, r);
          for (int c = 0; c < 3; ++c) {
            const double off = std::abs(got[i].L[c] - want.L[c]) / (1 + want.L[c]);
            worst = std::max(worst, off);
            // The default tolerance; what `plan` promises of whole frames is half of it.
            EXPECT_LE(off, 1e-3) << preset << ", " << h << " m, sun " << sun << ", z "
                                 << r.d[2] << ", " << r.t;
          }
        }
      }
  std::printf("sunset: %.1e of white + |L|\n", worst);
}

TEST(Rays, EveryModelIsAsItsPointsHaveIt) {
  // What a model leaves out is its own affair; numbers are not.
  double worst = 0;
  for (const char* model : {"scattering", "fast", "nishita93"})
    for (const double sun : {2., 40.}) {
      const FrameInfo f = under_the_sun(50, sun);
      ThroughAir air(f);
      air.add("sky", {{"model", model}, {"exposure", "0.05"}}).compile(2e-4);
      std::vector<Ray> rays;
      for (const double z : {-.2, -.02, .004, .03, .2, .8})
        for (const double azimuth : {.1, 1., 3.})
          rays.push_back(toward(z, azimuth, z < 0 ? float(49 / -z) : kInf));
      const auto got = air(rays);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const Ray& r = rays[i];
        const auto want = truth_of(air, r);
        for (int c = 0; c < 3; ++c) {
          EXPECT_NEAR(got[i].T[c], want.T[c], 1e-4) << model << ", sun " << sun;
          worst = std::max(worst, std::abs(got[i].L[c] - want.L[c]) / (1 + want.L[c]));
        }
      }
    }
  EXPECT_LE(worst, 4.4e-4);
}

}  // namespace
}  // namespace brume::test
