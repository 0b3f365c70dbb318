// Irradiance of a sky light on planes, against closed forms.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include "air/air.h"
#include "num/quadrature.h"
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

// E on planes whose normals lie at gamma from an axis about which a sky is the same all
// round, L(mu). A ring at mu is in front of the plane up to psi from the axis:
//   Int max(a + b cos psi, 0) dpsi = 2 (a psi + b sin psi),  cos psi = -a/b,
// a = mu cos gamma, b = sqrt(1 - mu^2) sin gamma; summed over mu by bisection.
double about_axis(const std::function<double(double)>& L, double gamma,
                  std::vector<double> breaks) {
  breaks.insert(breaks.end(), {std::sin(gamma), -std::sin(gamma)});
  return integrate(
             [&](double mu) {
               const double a = mu * std::cos(gamma),
                            b = std::sqrt(1 - mu * mu) * std::sin(gamma);
               const double psi = a >= b ? M_PI : a <= -b ? 0 : std::acos(-a / b);
               return L(mu) * 2 * (a * psi + b * std::sin(psi));
             },
             -1., 1., 1e-9, 1e-12, breaks)
      .value;
}

TEST(SkyLight, AnEvenDomeIsSeenByItsPart) {
  // E = pi (1 + cos theta)/2: a plane at theta sees that part of the dome. Panels are
  // cut at its jump until that changes 1e-5 of all, 2 pi.
  const auto n = normals();
  const auto E = irradiance([](const auto& d) { return d.z > 0 ? 1. : 0.; }, n);
  for (std::size_t i = 0; i < n.size(); ++i)
    EXPECT_NEAR(E[i], M_PI * (1 + n[i].z) / 2, 1e-5 * 2 * M_PI) << n[i].z;
}

TEST(SkyLight, ASkyThatJumpsAnywhereIsGoodToItsPanels) {
  // Panels end where halving changes less than 1e-5 of all: what a jump in the last one
  // is worth. All the sky sends 4 pi at most, and a plane sees it under a cosine.
  for (const double horizon : {-.9, -.31, -.001, .04, .7}) {
    const auto n = normals();
    const auto E = irradiance([&](const auto& d) { return d.z > horizon ? 1. : .1; }, n);
    for (std::size_t i = 0; i < n.size(); ++i) {
      const double want = about_axis([&](double mu) { return mu > horizon ? 1. : .1; },
                                     std::acos(std::clamp(n[i].z, -1., 1.)), {horizon});
      EXPECT_NEAR(E[i], want, 1e-5 * 4 * M_PI) << horizon << ", " << n[i].z;
    }
  }
}

TEST(SkyLight, ANarrowRimMakesAConeAboutUp) {
  // A rim as narrow as the air is thin, at the horizon and as it is seen from orbit: E
  // bends within its width about the normals that look along it.
  for (const double rim : {0., -.34}) {
    const auto L = [&](double mu) { return .1 + std::exp(-std::abs(mu - rim) / .003); };
    std::vector<glm::dvec3> n = normals();
    const double edge = std::abs(std::asin(rim));
    for (int i = 0; i < 60; ++i)
      for (const double side : {-1., 1.}) {
        const double theta = edge + side * std::pow(10., -4 + i / 20.), phi = 2.4 * i;
        n.push_back({std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                     (i % 2 ? -1 : 1) * std::cos(theta)});
      }
    const auto E = irradiance([&](const auto& d) { return L(d.z); }, n);
    for (std::size_t i = 0; i < n.size(); ++i) {
      const double want = about_axis(L, std::acos(std::clamp(n[i].z, -1., 1.)), {rim});
      // Panels to 1e-5 of the light of all, rows of the map to 2e-5 of it.
      EXPECT_NEAR(E[i], want, 3e-5 * 4 * M_PI * .1) << rim << ", " << n[i].z;
    }
  }
}

TEST(SkyLight, AnOvercastSkyIsBrighterAbove) {
  // L = (1 + 2 sin elevation)/3 (Moon & Spencer 1942): on the ground 7 pi/9, on a wall
  // half the sky's: pi/6 + 4/9. Panels at its jump as above.
  const auto E = irradiance([](const auto& d) { return d.z > 0 ? (1 + 2 * d.z) / 3 : 0; },
                            {{0, 0, 1}, {1, 0, 0}, {0, 0, -1}});
  EXPECT_NEAR(E[0], 7 * M_PI / 9, 1e-5 * 2 * M_PI);
  EXPECT_NEAR(E[1], M_PI / 6 + 4. / 9, 1e-5 * 2 * M_PI);
  EXPECT_NEAR(E[2], 0, 1e-5 * 2 * M_PI);
}

TEST(SkyLight, AGlowInOneDirectionIsSeenWhole) {
  // A lobe of 4 degrees wherever it stands. Its order m in azimuth is e^(-m^2/(2 k cos^2
  // elevation)) of it; from 32 on, .14 and less, 64 samples take it for 64 - m. A plane
  // gets 2/(pi m^2) of an order: Sum_(m >= 32) 2/(pi (64 - m)^2) e^(-m^2/520) =
  // 1.4e-3.
  const double k = 260;  // lobe k/(2 pi) e^(k (mu - 1)), irradiance 1 facing it
  for (const glm::dvec3& toward : {glm::dvec3(1, 2, 1.5), glm::dvec3(1, -1, .1),
                                   glm::dvec3(0, .01, 1), glm::dvec3(0, 1, -1)}) {
    const glm::dvec3 to = glm::normalize(toward);
    const auto n = normals();
    const auto E = irradiance(
        [&](const auto& d) {
          return k / (2 * M_PI) * std::exp(k * (glm::dot(d, to) - 1));
        },
        n);
    double worst = 0;
    for (std::size_t i = 0; i < n.size(); ++i) {
      const double want =
          about_axis([&](double mu) { return k / (2 * M_PI) * std::exp(k * (mu - 1)); },
                     std::acos(std::clamp(glm::dot(n[i], to), -1., 1.)), {1 - 1 / k});
      worst = std::max(worst, std::abs(E[i] - want));
    }
    std::printf("a lobe toward %g %g %g: off by %.1e\n", to.x, to.y, to.z, worst);
    EXPECT_LT(worst, 1.4e-3);
  }
}

}  // namespace
}  // namespace brume
