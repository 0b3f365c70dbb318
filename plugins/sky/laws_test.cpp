// What the sky does whatever its numbers, and the same on every instruction set.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "bind.h"
#include "map_build.h"
#include "models_test.h"
#include "num/random.h"
#include "oracle.h"
#include "run.h"

namespace {

using namespace brume;
using namespace brume::sky;

TEST(Sky, TransmittanceMultipliesAndFalls) {
  for (double view : {0., 60., 89., 90., 91.5})
    for (double h : {1., 2000., 12e3}) {
      double L[3], last_T[3] = {1, 1, 1}, last_L[3] = {};
      for (double d = 1; d < 2e6; d *= 1.7) {
        double T[3];
        earth().see(ray_at(h, view, 50, 40, d), L, T);
        for (int c = 0; c < 3; ++c) {
          EXPECT_LE(T[c], last_T[c] + 2e-7);  // float
          EXPECT_GE(L[c],
                    last_L[c] * (1 - 2e-4));  // different panels for each distance: .02 %
          last_T[c] = T[c], last_L[c] = L[c];
        }
      }
    }
}

TEST(Sky, VanishesWithDistance) {
  for (double d : {1e-6, 1e-3, 1.}) {
    double L[3], T[3];
    earth().see(ray_at(1, 90, 60, 0, d), L, T);
    for (int c = 0; c < 3; ++c) {
      // Extinction at the ground is 4e-5/m at most, the source no brighter than 1 W m^-2
      // sr^-1 nm^-1.
      EXPECT_NEAR(T[c], 1, 4e-5 * d + 1e-7);
      EXPECT_GE(L[c], 0);
      EXPECT_LE(L[c], 4e-5 * d);
    }
  }
}

TEST(Sky, IsFiniteAndNeverNegativeAnywhere) {
  for (const Model* m : {&earth(), &fast_earth()})
    for (double h : {-400., 0., 1e-3, 1., 5e3, 59999., 60e3, 60001., 4e5, 4e8})
      for (double sun : {0., 45., 89.9, 90., 91., 96., 108., 150., 180.})
        for (double view :
             {0., 1e-4, 45., 89.99, 90., 90.01, 95., 110., 135., 179.9999, 180.})
          for (double azimuth : {0., 90., 180.})
            for (double d : {0., 1e-30, 10., 1e5, 1e12, kInf}) {
              double L[3], T[3];
              m->see(ray_at(h, view, sun, azimuth, d), L, T);
              for (int c = 0; c < 3; ++c) {
                ASSERT_TRUE(std::isfinite(L[c]) && L[c] >= 0)
                    << h << " " << sun << " " << view << " " << azimuth << " " << d;
                ASSERT_TRUE(T[c] >= 0 && T[c] <= 1)
                    << h << " " << sun << " " << view << " " << d;
              }
            }
}

TEST(Sky, FadesSmoothlyIntoNight) {
  double last[3] = {kInf, kInf, kInf};
  for (double sun = 90; sun <= 130; sun += .25) {
    double L[3], T[3];
    earth().see(ray_at(1, 45, sun, 0), L, T);
    for (int c = 0; c < 3; ++c) {
      EXPECT_LE(L[c], last[c] + 1e-12) << sun;
      last[c] = L[c];
    }
  }
  // At 18 degrees below, astronomical night: the day's sky (.05) times 1e-6 is the
  // faintest a plate could hold.
  double L[3], T[3];
  earth().see(ray_at(1, 45, 108, 0), L, T);
  for (double x : L) EXPECT_LE(x, 5e-8);
}

TEST(Sky, HasNoSeamAtTheHorizonThatTheOracleHasNot) {
  // An eye on the ground: the path above the horizon ends in space, below it at once.
  // Seen from 2 km both are long.
  const Atmosphere a = preset("earth", kThree);
  for (double h : {2000., 10e3}) {
    const double horizon = 90 + std::acos(6360e3 / (6360e3 + h)) * 180 / M_PI;
    for (double sun : {30., 85.}) {
      double above[3], below[3], T[3];
      const Ray up = ray_at(h, horizon - 1e-3, sun, 60),
                down = ray_at(h, horizon + 1e-3, sun, 60);
      earth().see(up, above, T);
      earth().see(down, below, T);
      for (int c = 0; c < 3; ++c) {
        const double truth = oracle::see(a, c, up, 1500, 0, 1).single -
                             oracle::see(a, c, down, 1500, 0, 1).single;
        const double single_share = truth / std::max(above[c], 1e-9);
        // The step of what is scattered again is that of single scattering times their
        // ratio, 1 to 4.
        EXPECT_LE(std::abs(above[c] - below[c]) / above[c],
                  4 * std::abs(single_share) + 2e-3)
            << h << " " << sun << " " << c;
      }
    }
  }
}

TEST(Sky, SunInTheZenithLooksTheSameFromAllSides) {
  double L[3], M[3], T[3];
  for (double view : {10., 60., 90.}) {
    earth().see(ray_at(1, view, 0, 0), L, T);
    earth().see(ray_at(1, view, 0, 137), M, T);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(L[c] / M[c], 1, 1e-5);  // the same numbers but for rounding of nu
  }
}

TEST(Sky, FloatAgreesWithDouble) {
  const Atmosphere a = preset("earth", kThree);
  Resolution r{.altitudes = 8,
               .suns = 16,
               .first = {4, 3, 6, 2},
               .next = {3, 2, 4, 2},
               .orders = 2};
  const auto kd = kernels_of<double, 4, 4>();
  const auto kf = kernels_of<float, 4, 4>();
  Light<double> d;
  Light<float> f;
  solve(a, 0, r, kd, d);
  solve(a, 0, r, kf, f);
  double worst = 0;
  for (double view : {0., 45., 85., 90., 100.})
    for (double sun : {0., 70., 89., 92., 95.})
      for (double azimuth : {0., 120.}) {
        const Ray ray = ray_at(1500, view, sun, azimuth);
        const Trace t = trace(6360e3, 60e3, ray, {.shadow = true});
        Seen<double> sd;
        Seen<float> sf;
        kd.see(d.air, d.forward, d.table, t, ray, 6, sd);
        kf.see(f.air, f.forward, f.table, t, ray, 6, sf);
        for (int c = 0; c < 3; ++c) {
          worst = std::max(worst, std::abs(sf.L[c] / sd.L[c] - 1));
          EXPECT_NEAR(sf.T[c], sd.T[c], 1e-6);
        }
      }
  std::printf("float against double: %.1e\n", worst);
  // Twilight: mu_s of a node is good to 2 eps, a path of 1e6 m turns it into eps r/H of
  // an optical depth of ten.
  EXPECT_LE(worst, 2e-3);
}

TEST(Sky, AllInstructionSetsAgree) {
  const auto& k2 = isa_v2::kernel_table.by[0][3];
  Light<float> light;
  const Resolution small{.altitudes = 8,
                         .suns = 16,
                         .first = {4, 3, 12, 2},
                         .next = {3, 2, 6, 2},
                         .orders = 1};
  solve(preset("earth", kThree), 0, small, k2, light);
  for (const Kernels<float>* k :
       {&isa_v3::kernel_table.by[0][3], &isa_v4::kernel_table.by[0][3]}) {
    if (k == &isa_v4::kernel_table.by[0][3] && best_isa() != Isa::v4) continue;
    for (double view : {10., 88., 91.}) {
      const Ray ray = ray_at(100, view, 75, 20);
      const Trace t = trace(6360e3, 60e3, ray, {.shadow = true});
      Seen<float> a, b;
      k2.see(light.air, light.forward, light.table, t, ray, 6, a);
      k->see(light.air, light.forward, light.table, t, ray, 6, b);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(a.L[c] / b.L[c], 1, 2e-5);  // fused products: a few hundred roundings
    }
  }
}

}  // namespace
