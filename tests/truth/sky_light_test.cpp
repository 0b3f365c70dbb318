// Irradiance from skies whose integral is known.

#include "truth/sky_light.h"

#include <gtest/gtest.h>

#include <cmath>

#include "num/random.h"

namespace brume {
namespace {

template <class F>
truth::SkyLight sky_of(const F& radiance, const glm::dvec3& up) {
  brume_light light{};
  light.self = &radiance;
  light.radiance = [](const void* self, const brume_rays* rays, float* r, float* g,
                      float* b) {
    for (std::size_t i = 0; i < rays->n; ++i) {
      const double L = (*static_cast<const F*>(self))(
          glm::dvec3(rays->dx[i], rays->dy[i], rays->dz[i]));
      r[i] = float(L), g[i] = float(2 * L), b[i] = 0;
    }
  };
  return truth::SkyLight(light, up);
}

glm::dvec3 direction(Random& r) {
  const double z = r.uniform(-1, 1), phi = r.uniform(0, 2 * M_PI),
               s = std::sqrt(1 - z * z);
  return {s * std::cos(phi), s * std::sin(phi), z};
}

TEST(SkyLight, AnEvenSkySendsPiTimesItsRadiance) {
  const auto even = [](const glm::dvec3&) { return 3.; };
  const truth::SkyLight sky = sky_of(even, {0, 0, 1});
  Random r(1);
  for (int k = 0; k < 50; ++k) {
    const truth::Rgb E = sky.irradiance(direction(r));
    EXPECT_NEAR(E[0], 3 * M_PI, 5e-5 * 3 * M_PI);
    EXPECT_NEAR(E[1], 2 * E[0], 1e-6 * E[1]);
    EXPECT_EQ(E[2], 0);
  }
}

TEST(SkyLight, ASkyOverABlackGroundSendsAsMuchAsThePlaneLeansTowardIt) {
  // L = 1 above the plane z = 0, 0 below: E = pi (1 + n.up) / 2. The jump lies at any
  // height about `up`, which need not be an axis.
  Random r(2);
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 up = direction(r);
    const auto half = [&](const glm::dvec3& d) { return double(glm::dot(d, up) > 0); };
    const truth::SkyLight sky = sky_of(half, up);
    for (int j = 0; j < 30; ++j) {
      const glm::dvec3 n = direction(r);
      EXPECT_NEAR(sky.irradiance(n)[0], M_PI * (1 + glm::dot(n, up)) / 2, 5e-5 * M_PI);
    }
  }
}

TEST(SkyLight, AHorizonALittleBelowTheEyeIsSeen) {
  // L = 1 above the height z = -h, 0 below: facing up pi, all that is above; facing down
  // the rest, pi h^2 of a ring about the horizon; a wall sees half of each ring, 2 s of
  // its height: Int_-h^1 2 sqrt(1 - z^2) dz = pi/2 + asin h + h sqrt(1 - h^2).
  for (const double h : {1e-2, 1e-3, 4e-4, 1e-4}) {
    const auto dome = [&](const glm::dvec3& d) { return double(d.z > -h); };
    const truth::SkyLight sky = sky_of(dome, {0, 0, 1});
    EXPECT_NEAR(sky.irradiance({0, 0, 1})[0], M_PI, 5e-5 * M_PI) << h;
    EXPECT_NEAR(sky.irradiance({0, 0, -1})[0], M_PI * h * h, 5e-5 * M_PI) << h;
    EXPECT_NEAR(sky.irradiance({1, 0, 0})[0],
                M_PI / 2 + std::asin(h) + h * std::sqrt(1 - h * h), 5e-5 * M_PI)
        << h;
  }
}

TEST(SkyLight, AGlowOfOneDegreeIsItsPowerTimesTheCosine) {
  // L = exp(-a (1 - d.s)) with a = 2/0.01^2: the lobe is 0.01 rad wide, and
  // Int L d.n dd = n.s 2 pi (1/a - 1/a^2) where all of it is in front (the mean of d over
  // the lobe lies along s, 1 - 1/a long).
  const glm::dvec3 s = glm::normalize(glm::dvec3(.3, -.8, .2));
  const double a = 2e4;
  const auto glow = [&](const glm::dvec3& d) {
    return std::exp(-a * (1 - glm::dot(d, s) / glm::length(d)));
  };
  const truth::SkyLight sky = sky_of(glow, {0, 0, 1});
  Random r(3);
  const double most = 2 * M_PI / a * (1 - 1 / a);
  for (int j = 0; j < 50; ++j) {
    const glm::dvec3 n = direction(r);
    if (std::abs(glm::dot(n, s)) < .1) continue;
    // Directions are floats: 1 - d.s is off by 6e-8, times a 1e-3 at a place; of both
    // signs, so that the sum is good to a tenth of that.
    EXPECT_NEAR(sky.irradiance(n)[0], most * std::max(glm::dot(n, s), 0.), 1e-4 * most);
  }
}

}  // namespace
}  // namespace brume
