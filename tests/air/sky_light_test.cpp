// Irradiance of a sky light on planes, against closed forms.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "air/air.h"
#include "support.h"

namespace brume {
namespace {

using Sky = std::function<double(const glm::dvec3&)>;

// E of a world with this sky alone, on planes with these normals.
std::vector<double> irradiance(const Sky& sky, const std::vector<glm::dvec3>& normals) {
  World w;
  brume_light l{};
  l.size = sizeof l;
  l.name = "";
  l.kind = BRUME_SKY_LIGHT;
  l.self = &sky;
  l.radiance = [](const void* self, const brume_rays* rays, float* r, float* g,
                  float* b) {
    for (std::size_t i = 0; i < rays->n; ++i) {
      r[i] = float(
          (*static_cast<const Sky*>(self))({rays->dx[i], rays->dy[i], rays->dz[i]}));
      g[i] = 2 * r[i];
      b[i] = std::nanf("");
    }
  };
  w.lights.push_back({l, 0, ""});
  const Air air = Air::compile(w, {});
  std::vector<float> zero(normals.size()), d[3], E[3];
  for (int k = 0; k < 3; ++k) {
    for (const auto& n : normals) d[k].push_back(float(n[k]));
    E[k].resize(normals.size());
  }
  float* const out[3] = {E[0].data(), E[1].data(), E[2].data()};
  air.irradiance(0,
                 {int(normals.size()), zero.data(), zero.data(), zero.data(), d[0].data(),
                  d[1].data(), d[2].data()},
                 out);
  std::vector<double> values;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    EXPECT_NEAR(E[1][i], 2 * E[0][i], 1e-6 * (1 + E[1][i]));
    EXPECT_EQ(E[2][i], 0);  // what is no number is no light
    values.push_back(E[0][i]);
  }
  return values;
}

std::vector<glm::dvec3> normals() {
  std::vector<glm::dvec3> n = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}};
  for (int i = 0; i < 40; ++i) {
    const double z = -1 + (i + .5) / 20, phi = 2.4 * i;
    n.push_back(
        {std::sqrt(1 - z * z) * std::cos(phi), std::sqrt(1 - z * z) * std::sin(phi), z});
  }
  return n;
}

TEST(SkyLight, TheSameFromEverywhereIsPiTimesIt) {
  for (const double E : irradiance([](const auto&) { return 1.; }, normals()))
    EXPECT_NEAR(E, M_PI, 2e-6);
}

TEST(SkyLight, AnEvenDomeIsSeenByItsPart) {
  // E = pi (1 + cos theta)/2: a plane at theta sees that part of the dome.
  const auto n = normals();
  const auto E = irradiance([](const auto& d) { return d.z > 0 ? 1. : 0.; }, n);
  for (std::size_t i = 0; i < n.size(); ++i)
    EXPECT_NEAR(E[i], M_PI * (1 + n[i].z) / 2, 2e-5) << n[i].z;
}

TEST(SkyLight, AnOvercastSkyIsBrighterAbove) {
  // L = (1 + 2 sin elevation)/3 (Moon & Spencer 1942): on the ground 7 pi/9, on a wall
  // half the sky's: pi/6 + 4/9.
  const auto E = irradiance([](const auto& d) { return d.z > 0 ? (1 + 2 * d.z) / 3 : 0; },
                            {{0, 0, 1}, {1, 0, 0}, {0, 0, -1}});
  EXPECT_NEAR(E[0], 7 * M_PI / 9, 2e-4 * E[0]);
  EXPECT_NEAR(E[1], M_PI / 6 + 4. / 9, 1e-3 * E[0]);
  EXPECT_NEAR(E[2], 0, 1e-3 * E[0]);
}

TEST(SkyLight, FromOneDirectionItIsNearlyACosine) {
  // The worst that may be: all light from a lobe of 4 degrees. Degrees beyond 20 are
  // missing, 1.5 % of it at most: max |x^+ - Sum (2 l + 1)/(4 pi) A_l P_l(x)|; and the
  // lobe is wider than one direction, 1/sqrt(2 pi k) at the terminator.
  const glm::dvec3 to = glm::normalize(glm::dvec3(1, 2, 1.5));
  const double k = 260;  // lobe k/(2 pi) e^(k (mu - 1)), irradiance 1 facing it
  const auto n = normals();
  const auto E = irradiance(
      [&](const auto& d) { return k / (2 * M_PI) * std::exp(k * (glm::dot(d, to) - 1)); },
      n);
  for (std::size_t i = 0; i < n.size(); ++i)
    EXPECT_NEAR(E[i], std::max(glm::dot(n[i], to), 0.),
                0.015 + 1 / std::sqrt(2 * M_PI * k))
        << glm::dot(n[i], to);
}

}  // namespace
}  // namespace brume
