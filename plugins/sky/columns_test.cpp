// How much air lies on a ray, and how scattered light is spread over directions.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "bind.h"
#include "map_build.h"
#include "models_test.h"
#include "num/random.h"
#include "oracle.h"

namespace {

using namespace brume;
using namespace brume::sky;

template <class S>
Shape<S> shape_of(const Atmosphere& a) {
  return {S(a.planet_radius),    S(a.atmosphere_height), S(a.rayleigh_scale_height),
          S(a.mie_scale_height), S(a.ozone_altitude),    S(a.ozone_half_width)};
}

TEST(Columns, VerticalOneIsTheScaleHeightLessWhatLiesAboveTheTop) {
  const Atmosphere a = preset("earth", kThree);
  const auto c = columns_to_space(shape_of<double>(a), 0., 1.);
  // (H/r)^2 = 2e-6 is what the expansion leaves out.
  EXPECT_NEAR(c.R / (8000 * -std::expm1(-60e3 / 8000)), 1, 2e-6);
  EXPECT_NEAR(c.M / 1200, 1, 2e-6);
  EXPECT_NEAR(c.O / 15000, 1, 1e-9);
}

TEST(Columns, AgreeWithQuadratureInEveryDirection) {
  Random random(1);
  double worst = 0, worst_float = 0;
  for (const char* name : {"earth", "hazy", "mars"}) {
    const Atmosphere a = preset(name, kThree);
    for (int i = 0; i < 300; ++i) {
      const double u = random.uniform(), h = a.atmosphere_height * u * u;
      const double horizon =
          -std::sqrt(h * (2 * a.planet_radius + h)) / (a.planet_radius + h);
      const double v = random.uniform(),
                   mu = float(horizon + 1e-6 + (1 - horizon - 1e-6) * v * v);
      const double truth = oracle::to_space(a, i % 3, h, mu);
      const auto T = [&](auto c) {
        return std::exp(-(a.rayleigh_scattering[i % 3] * c.R +
                          a.mie_extinction[i % 3] * c.M +
                          a.ozone_absorption[i % 3] * c.O));
      };
      worst = std::max(worst,
                       std::abs(T(columns_to_space(shape_of<double>(a), h, mu)) - truth));
      worst_float = std::max(
          worst_float,
          std::abs(T(columns_to_space(shape_of<float>(a), float(h), float(mu))) - truth));
    }
  }
  std::printf("T error: double %.1e, float %.1e\n", worst, worst_float);
  EXPECT_LE(worst, 4e-6);        // tau e^-tau (H/r)^2, mars: 1e-5/e
  EXPECT_LE(worst_float, 2e-5);  // grazing: tau changes by r/H eps = 3e-5 of itself per
                                 // eps of mu, times tau e^-tau
}

TEST(Columns, AddUpAlongARay) {
  const auto shape = shape_of<float>(preset("earth", kThree));
  const double R = 6360e3;
  for (double mu : {1., .3, 0., -.02, -.2})
    for (double h : {10., 3000., 25e3}) {
      const Trace path = trace(R, 60e3, {h, mu, 0, 0}, {});
      const double half = .4 * path.t_end, b = (R + h) * mu;
      const double c = h * (2 * R + h) + half * (2 * b + half),
                   h1 = c / (R + std::sqrt(R * R + c));
      const float mu1 = float((b + half) / (R + h1));
      const auto whole = columns_between(shape, float(h), float(mu), float(path.t_end));
      const auto first = columns_between(shape, float(h), float(mu), float(half));
      const auto rest = columns_between(shape, float(h1), mu1, float(path.t_end - half));
      // Each is a difference of columns; rounding of positions, eps r / H = 1e-4 of a
      // density, lies at the cut only.
      EXPECT_NEAR(first.R + rest.R, whole.R, 1e-5 * whole.R + 1) << mu << " " << h;
      EXPECT_NEAR(first.M + rest.M, whole.M, 1e-5 * whole.M + 1) << mu << " " << h;
      EXPECT_NEAR(first.O + rest.O, whole.O, 1e-5 * whole.O + 1) << mu << " " << h;
    }
}

TEST(Phase, EigenvaluesAreItsLegendreMoments) {
  for (double g : {.2, .65, .8, .95})
    for (int l = 0; l <= kMaxL; ++l) {
      double mie = 0, rayleigh = 0;
      constexpr int n = 400000;
      for (int i = 0; i < n; ++i) {
        const double c = -1 + 2 * (i + .5) / n, w = 2 * M_PI * 2 / n;
        mie += w * phase_mie(c, g) * std::legendre(l, c);
        rayleigh += w * phase_rayleigh(c) * std::legendre(l, c);
      }
      // Midpoint rule: h^2/24 2 pi p'(1), and p' = 7e4 for g = .95: 5e-7.
      EXPECT_NEAR(mie, mie_eigenvalue(l, g), 2e-6) << g << " " << l;
      EXPECT_NEAR(rayleigh, rayleigh_eigenvalue(l), 1e-8) << l;
    }
}

TEST(Harmonics, AreOrthonormal) {
  constexpr int L = 6, n = harmonics_count(L), steps = 200;
  double gram[n][n] = {};
  for (int i = 0; i < steps; ++i)
    for (int j = 0; j < 2 * L + 2; ++j) {
      const double z = -1 + 2 * (i + .5) / steps, phi = 2 * M_PI * (j + .5) / (2 * L + 2),
                   s = std::sqrt(1 - z * z);
      double polar[n], azimuth[L + 1];
      polar_part<L>(z, polar);
      azimuth_part<L>(s * std::cos(phi), z, azimuth);
      const double w = 2. / steps * 2 * M_PI / (2 * L + 2);
      for (int l = 0; l <= L; ++l)
        for (int m = 0; m <= l; ++m)
          for (int k = 0; k <= L; ++k)
            for (int o = 0; o <= k; ++o)
              gram[harmonic(l, m)][harmonic(k, o)] += w * polar[harmonic(l, m)] *
                                                      azimuth[m] * polar[harmonic(k, o)] *
                                                      azimuth[o];
    }
  // Midpoint rule on polynomials of degree 12: l^4/(24 steps^2) (2/steps..).
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) EXPECT_NEAR(gram[i][j], i == j, 5e-3) << i << " " << j;
}

}  // namespace
