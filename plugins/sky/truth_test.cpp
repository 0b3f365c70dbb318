// The sky against what others say: the reference, the oracle; and the tables of a frame
// against the rays that they stand for.

#include <gtest/gtest.h>

#include <cstdio>
#include <utility>

#include "color.h"
#include "map_build.h"
#include "models_test.h"
#include "num/random.h"
#include "oracle.h"
#include "reference.h"
#include "run.h"

namespace {

using namespace brume;
using namespace brume::sky;

void judge_model(const Model& m, const char* name, double most_day, double most_low_sun) {
  const auto rows = reference(name);
  ASSERT_FALSE(rows.empty());
  for (const auto& [key, j] : judge(
           rows, [&](const ReferenceRow&r, double*L, double*T) { m.see(r.ray, L, T); })) {
    std::printf(
        "%-7s %6.0f m, sun %2.0f: RMSE/mean %.3f %% (noise %.3f %%), bias %+.3f %%, T "
        "%.1e\n",
        name, key.first, key.second, 100 * j.rmse_over_mean, 100 * j.noise_over_mean,
        100 * j.bias_over_mean, j.worst_T);
    EXPECT_LE(j.rmse_over_mean, key.second <= 80 ? most_day : most_low_sun)
        << name << " " << key.first << " " << key.second;
    EXPECT_LE(j.worst_T, 1e-4);
  }
}

// The bounds that README.md states; the figures asked for are three to ten times wider.
TEST(Reference, DefaultSky) { judge_model(earth(), "sky", .0015, .002); }
TEST(Reference, DefaultAerialPerspective) {
  judge_model(earth(), "aerial", .0025, .0025);
}
TEST(Reference, DefaultFromSpace) { judge_model(earth(), "space", .0015, .002); }
TEST(Reference, FastSky) { judge_model(fast_earth(), "sky", .005, .01); }
TEST(Reference, FastAerialPerspective) { judge_model(fast_earth(), "aerial", .006, .01); }
TEST(Reference, FastFromSpace) { judge_model(fast_earth(), "space", .005, .01); }

TEST(Reference, NishitaIsSingleScattering) {
  const Model m(preset("earth", kThree), nishita());
  double squares = 0, mean = 0;
  int n = 0;
  for (const auto& r : reference("sky")) {
    if (r.view > 85 || r.sun > 80) continue;
    double L[3], T[3];
    m.see(r.ray, L, T);
    for (int c = 0; c < 3; ++c, ++n)
      squares += std::pow(L[c] - r.single[c], 2), mean += r.single[c];
  }
  // 32 even steps of the midpoint rule, the thinnest layer (1.2 km) two thirds of a step
  // high: (step/H)^2/24 = 10 % of the aerosol's part.
  EXPECT_LE(std::sqrt(squares / n) / (mean / n), .1);
  EXPECT_GE(std::sqrt(squares / n) / (mean / n), 1e-4);
}

// ---- the oracle
// ------------------------------------------------------------------------

TEST(Oracle, AgreesWithTheReference) {
  const Atmosphere a = preset("earth", kThree);
  double chi2 = 0, bias = 0, mean = 0;
  int n = 0;
  for (const char* name : {"sky", "aerial", "space"}) {
    const auto rows = reference(name);
    for (std::size_t i = 0; i < rows.size(); i += 29, ++n) {
      const auto& r = rows[i];
      const int c = n % 3;
      const auto o = oracle::see(a, c, r.ray, 300, 3000, n);
      EXPECT_NEAR(o.T, r.T[c], 1e-5);                // the reference's own quadrature
      EXPECT_NEAR(o.single / r.single[c], 1, 1e-3);  // .06 % is the reference's own claim
      chi2 += std::pow((o.L - r.L[c]) / std::hypot(o.error, r.error[c]), 2);
      bias += o.L - r.L[c], mean += r.L[c];
    }
  }
  std::printf("%d rays: chi^2/n %.2f, bias %+.2f %%\n", n, chi2 / n, 100 * bias / mean);
  EXPECT_LE(chi2 / n, 1.8);  // sigma from 16 batches: Student's t, variance 1.15; of the
                             // mean of 27 values +- .3
  EXPECT_LE(std::abs(bias / mean), .01);  // 27 rays of 1.2 % noise each
}

TEST(Oracle, AgreesWithTheModelWhereNothingWasTuned) {
  struct Case {
    const char* name;
    Atmosphere a;
    double sun, most;
  };
  Atmosphere small = preset("earth", kThree), thick = small;
  small.planet_radius = 1e6, small.atmosphere_height = 100e3;
  small.rayleigh_scale_height = 12e3, small.mie_scale_height = 4e3;
  for (auto* list : {&thick.mie_scattering, &thick.mie_extinction})
    for (double& x : *list) x *= 200;
  // Haze of optical depth .25, dust of .5 and aerosol of 1.07: more forward scattering
  // than ten harmonics hold.
  for (const Case& k :
       {Case{"earth", preset("earth", kThree), 75, .008},
        Case{"hazy", preset("hazy", kThree), 60, .02},
        Case{"mars", preset("mars", kThree), 60, .02},
        Case{"a small planet", small, 60, .01}, Case{"thick aerosol", thick, 60, .04}}) {
    const Atmosphere& a = k.a;
    const Model m(a, Quality{});
    Random random(5);
    double squares = 0, noise = 0, mean = 0;
    constexpr int n = 30;
    for (int i = 0; i < n; ++i) {
      const Ray ray =
          ray_at(300, 90 * std::sqrt(random.uniform()), k.sun, 180 * random.uniform(),
                 i % 2 ? kInf : 2000 * std::exp(3 * random.uniform()));
      const auto o = oracle::see(a, i % 3, ray, 300, 12000, i);
      double L[3], T[3];
      m.see(ray, L, T);
      squares += std::pow(L[i % 3] - o.L, 2), noise += o.error * o.error, mean += o.L;
    }
    const double excess = std::sqrt(std::max(squares - noise, 0.) / n) / (mean / n);
    std::printf("%s: RMSE/mean beyond the oracle's noise (%.2f %%): %.2f %%\n", k.name,
                100 * std::sqrt(noise / n) / (mean / n), 100 * excess);
    EXPECT_LE(excess, k.most + .5 * std::sqrt(noise / n) / (mean / n)) << k.name;
  }
}

// ---- the tables of a frame ------------------------------------------------------------

// A frame's tables, of both grounds, above a planet whose north is up, the sun toward x.
struct Tables {
  MapTables near, deep;
  SkyPlace place;

  Tables(double h, double sun) : place(place_of(earth(), colors_none(3))) {
    const double mu_s = std::cos(sun * M_PI / 180), scale[3] = {1, 1, 1};
    place.up[2] = 1, place.ground[2] = float(h);
    const auto build = [&](double ground, MapTables& t) {
      build_map(earth(), h, ground, mu_s, 1, colors_none(3), scale,
                map_size(earth(), h, ground, mu_s), t);
      t.map.up[2] = 1;
      t.map.sun[0] = float(std::sin(sun * M_PI / 180)), t.map.sun[2] = float(mu_s);
    };
    build(earth().ground(h), near);
    build(earth().deepest_ground(), deep);
  }

  void look(const float d[3], float t, float L[3], float T[3]) const {
    float *const to_L[3] = {L, L + 1, L + 2}, *const to_T[3] = {T, T + 1, T + 2};
    const auto in = [&](const SkyMap& map) {
      BRUME_ISA_SELECT(map_kernels).look(map, place, 1, d, d + 1, d + 2, &t, to_L, to_T);
    };
    in(near.map);
    if (T[0] < 0) in(deep.map);
  }
};

TEST(Map, AgreesWithTheRaysItStandsFor) {
  const Colors none = colors_none(3);
  struct Case {
    double h, sun;
  };
  for (const Case& k : {Case{-250, 40}, Case{0, 75}, Case{2, 30}, Case{50, 85},
                        Case{2000, 60}, Case{10e3, 92}, Case{59.9e3, 60}, Case{61e3, 60},
                        Case{400e3, 60}, Case{630e3, 85}}) {
    const Tables t(k.h, k.sun);
    Random random(11);
    double squares[3] = {}, mean[3] = {}, worst_T = 0;
    int n[3] = {};
    for (int i = 0; i < 1200; ++i) {
      // Whole sphere, the horizon's 10 degrees, the sun's neighbourhood.
      double z = i % 3 == 0 ? random.uniform(-1, 1) : std::sin(random.uniform(-.09, .09));
      // From above: the disc and a little of what is around.
      if (k.h > 50e3) {
        const double dip = std::acos(6360e3 / (6360e3 + k.h));
        z = i % 2 ? -std::sin(dip + random.uniform(-.02, .02))
                  : -1 + random.uniform() * (1 - std::sin(dip));
      }
      const double a = (i % 3 == 2 ? .3 : M_PI) * random.uniform(-1, 1),
                   s = std::sqrt(1 - z * z);
      const int near = random.uniform() < .5;
      const float d[3] = {float(s * std::cos(a)), float(s * std::sin(a)), float(z)};
      const float t1 =
          near ? float((k.h > 60e3 ? k.h : 0) + 5 * std::exp(9.4 * random.uniform()))
               : float(kInf);
      float L[3], T[3];
      t.look(d, t1, L, T);
      const double length =
          std::sqrt(double(d[0]) * d[0] + double(d[1]) * d[1] + double(d[2]) * d[2]);
      double l[3], through[3];
      // Surfaces are seen down to half a scale height of aerosol.
      const double mu = d[2] / length, r0 = 6360e3 + k.h,
                   end = r0 * r0 + double(t1) * (2 * r0 * mu + t1);
      const double depth = std::isfinite(t1) ? std::sqrt(std::max(end, 0.)) - 6360e3 : 0;
      earth().see(
          {k.h, d[2] / length, std::cos(k.sun * M_PI / 180),
           (double(d[0]) * t.near.map.sun[0] + double(d[2]) * t.near.map.sun[2]) / length,
           t1, std::isfinite(t1) || k.h < 0 ? -600. : 0.},
          l, through);
      const int kind = depth < 0 ? 2 : near;
      for (int c = 0; c < 3; ++c, ++n[kind]) {
        squares[kind] += std::pow(L[c] - l[c], 2), mean[kind] += l[c];
        worst_T = std::max(worst_T, std::abs(T[c] - through[c]));
      }
    }
    const auto rms = [&](int q) {
      return std::sqrt(squares[q] / n[q]) / (mean[q] / n[q]);
    };
    std::printf(
        "eye %5.0f m, sun %2.0f: sky %.3f %%, aerial perspective %.3f %%, T %.1e\n", k.h,
        k.sun, 100 * rms(0), 100 * rms(1), worst_T);
    // A tenth of what is asked of the model: sky 1 to 2 %, aerial perspective 1.5 to 6 %.
    EXPECT_LE(rms(0), 1e-3);
    EXPECT_LE(rms(1), 1.5e-3);
    EXPECT_LE(worst_T, 2.5e-5);
    if (n[2] == 0) continue;
    std::printf("  to surfaces below the ground: %.3f %%\n", 100 * rms(2));
    EXPECT_LE(rms(2), 1.5e-3);
  }
}

TEST(Map, DoesNotStepWhereTheSkyDoesNot) {
  // Rays up and down through both horizons, a pixel apart: what the table is off by
  // changes little from one to the next. Of the horizon's brightness 1e-4, a tenth of the
  // tolerance, is what it does nearby; more where surfaces far away set. (From high up in
  // twilight the reference itself steps there, by 4e-3.)
  const Colors none = colors_none(3);
  double worst = 0;
  for (const double h : {-250., -1., 0., 1., 50., 2000., 10e3})
    for (const double sun : {40., 85., 92.}) {
      const double mu_s = std::cos(sun * M_PI / 180), sin_s = std::sin(sun * M_PI / 180);
      const Tables t(h, sun);
      double sky[6], white = 0;  // the brightest that the horizon is
      for (const double azimuth : {0., .4, 2.}) {
        earth().see({h, .01, mu_s, std::cos(azimuth) * sin_s + .01 * mu_s}, sky, sky + 3);
        white = std::max({white, sky[0], sky[1], sky[2]});
      }
      for (const auto& [far, most] :
           {std::pair(200.f, 1e-4), {2e4f, 2.5e-4}, {3e5f, 1.1e-3}}) {
        if (far > 1e5f && h >= 2000 && sun > 90) continue;
        double before[6] = {};
        for (int i = 0; i <= 400; ++i) {
          const double z = -.08 + .12 * i / 400, s = std::sqrt(1 - z * z);
          const float d[3] = {float(s * std::cos(.4)), float(s * std::sin(.4)), float(z)};
          float made[6];
          t.look(d, far, made, made + 3);
          double want[6];
          earth().see(
              {h, z, mu_s, s * std::cos(.4) * sin_s + z * mu_s, double(far), -600}, want,
              want + 3, 4);
          for (int k = 0; k < 6; ++k) {
            const double off = made[k] - want[k];
            const double step = std::abs(off - before[k]) / (k < 3 ? white : 1);
            worst = std::max(worst, i > 0 ? step : 0);
            EXPECT_TRUE(i == 0 || step <= most)
                << step << " at " << h << " m, sun " << sun << ", " << far << " m, z "
                << z << ", " << k;
            before[k] = off;
          }
        }
      }
    }
  std::printf("largest step %.1e of the brightest\n", worst);
}

TEST(Map, IsBuiltOnlyWhereSunOrEyeMoved) {
  const Maps maps;
  const Colors none = colors_none(3);
  const auto one = maps.get(fast_earth(), 50, 0, .2, 1, none, {1, 1, 1}, 1);
  EXPECT_EQ(maps.get(fast_earth(), 50, 0, .2, 1, none, {1, 1, 1}, 1), one);
  const auto other = maps.get(fast_earth(), 50.5, 0, .2, 1, none, {1, 1, 1}, 1);
  EXPECT_NE(other, one);
  EXPECT_NE(maps.get(fast_earth(), 50, 0, .3, 1, none, {1, 1, 1}, 1), one);
  EXPECT_NE(maps.get(fast_earth(), 50, 0, .2, 1, none, {1, 2, 1}, 1), one);
  EXPECT_EQ(maps.get(fast_earth(), 50.5, 0, .2, 1, none, {1, 1, 1}, 1), other);
}

}  // namespace
