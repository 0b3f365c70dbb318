// Facts about the sky's physics: laws, its tables on disk, colours.

#include <gtest/gtest.h>

#include <unistd.h>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <thread>

#include "bind.h"
#include "color.h"
#include "map_build.h"
#include "model.h"
#include "models_test.h"
#include "nishita.h"
#include "num/random.h"
#include "oracle.h"
#include "run.h"
#include "store.h"

namespace {

using namespace brume;
using namespace brume::sky;

template <class S>
Shape<S> shape_of(const Atmosphere& a) {
  return {S(a.planet_radius),    S(a.atmosphere_height), S(a.rayleigh_scale_height),
          S(a.mie_scale_height), S(a.ozone_altitude),    S(a.ozone_half_width)};
}

// ---- columns --------------------------------------------------------------------------

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

// ---- phase functions and harmonics ----------------------------------------------------

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

// ---- laws of the whole ----------------------------------------------------------------

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

// ---- tables on disk -------------------------------------------------------------------

class Store : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = testing::TempDir() + "brume_sky_" + std::to_string(getpid());
    setenv("BRUME_CACHE", folder_.c_str(), 1);
  }
  void TearDown() override {
    std::filesystem::remove_all(folder_);
    setenv("BRUME_CACHE", "off", 1);
  }
  std::vector<std::filesystem::path> files() const {
    std::vector<std::filesystem::path> out;
    if (std::filesystem::exists(folder_))
      for (const auto& f : std::filesystem::directory_iterator(folder_))
        out.push_back(f.path());
    return out;
  }
  // What a small model sees, bit for bit.
  static std::vector<double> look(const Atmosphere& a = preset("earth", kThree)) {
    Quality q = Quality::fast();
    q.resolution.altitudes = 6, q.resolution.suns = 12;
    const Model m(a, q);
    std::vector<double> out;
    for (double view : {10., 88., 95.})
      for (double sun : {20., 80., 93.}) {
        double L[3], T[3];
        m.see(ray_at(500, view, sun, 30), L, T);
        out.insert(out.end(), L, L + 3), out.insert(out.end(), T, T + 3);
      }
    return out;
  }
  std::string folder_;
};

TEST_F(Store, GivesTheBitsThatWereSolved) {
  const auto solved = look();
  ASSERT_EQ(files().size(), 1u);
  const auto written = std::filesystem::last_write_time(files()[0]);
  EXPECT_EQ(look(), solved);
  EXPECT_EQ(std::filesystem::last_write_time(files()[0]), written);
  setenv("BRUME_CACHE", "off", 1);
  EXPECT_EQ(look(), solved);
}

TEST_F(Store, KnowsEveryInput) {
  const auto solved = look();
  Atmosphere a = preset("earth", kThree);
  a.ground_albedo[2] += 1e-12;
  look(a);
  EXPECT_EQ(files().size(), 2u);
  EXPECT_NE(key_of(a, Quality{}), key_of(preset("earth", kThree), Quality{}));
  Quality q;
  ++q.resolution.next.panels;
  EXPECT_NE(key_of(a, q), key_of(a, Quality{}));
}

TEST_F(Store, BuildsAgainWhatIsBroken) {
  const auto solved = look();
  ASSERT_EQ(files().size(), 1u);
  const auto file = files()[0];
  const auto size = std::filesystem::file_size(file);
  std::ifstream in(file, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), {}};
  for (int harm = 0; harm < 6; ++harm) {
    std::string bytes = whole;
    if (harm == 0) bytes.clear();
    if (harm == 1) bytes.resize(size / 2);
    if (harm == 2) bytes[size / 2] ^= 1;        // a bit of a number
    if (harm == 3) bytes[40] ^= 1;              // of the key
    if (harm == 4) bytes += "more";             // longer than it says
    if (harm == 5) bytes.assign(size, '\xff');  // NaN throughout
    std::ofstream(file, std::ios::binary) << bytes;
    EXPECT_EQ(look(), solved) << harm;
    EXPECT_EQ(std::filesystem::file_size(file), size) << harm;
  }
}

TEST_F(Store, WritersAtOnceLeaveAWholeFile) {
  setenv("BRUME_CACHE", "off", 1);
  const auto solved = look();
  setenv("BRUME_CACHE", folder_.c_str(), 1);
  std::vector<std::thread> threads;
  std::atomic<int> wrong = 0;
  for (int i = 0; i < 8; ++i)
    threads.emplace_back([&] {
      if (look() != solved) ++wrong;
    });
  for (auto& t : threads) t.join();
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(files().size(), 1u);  // none left beside
  EXPECT_EQ(look(), solved);
}

TEST_F(Store, DoesWithoutAFolder) {
  setenv("BRUME_CACHE", "/proc/no such folder", 1);
  const auto solved = look();
  setenv("BRUME_CACHE", "off", 1);
  EXPECT_EQ(look(), solved);
  EXPECT_EQ(store_folder(), "");
}

// ---- colour
// ----------------------------------------------------------------------------

constexpr std::array<double, 8> kRec709 = {.64, .33, .3, .6, .15, .06, .3127, .329};

TEST(Color, MatchingFunctionsAreThoseOfTheCie) {
  // CIE 1931, 2 degrees (CIE 15:2004, table T.4); the fit's own claim is 3 % of the
  // maximum.
  const double table[][4] = {{450, .3362, .0380, 1.7721},
                             {500, .0049, .3230, .2720},
                             {550, .4334, .9950, .0087},
                             {600, 1.0622, .6310, .0008},
                             {650, .2835, .1070, 0}};
  for (const auto& row : table) {
    const auto xyz = matching(row[0]);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(xyz[c], row[1 + c], .03 * (c == 2 ? 1.78 : 1.06)) << row[0] << " " << c;
  }
}

TEST(Color, WhiteIsWhiteAndPrimariesArePrimary) {
  const auto M = rgb_from_xyz(kRec709);
  for (int i = 0; i < 4; ++i) {
    const double x = kRec709[2 * i], y = kRec709[2 * i + 1],
                 xyz[3] = {x / y, 1, (1 - x - y) / y};
    double rgb[3];
    for (int c = 0; c < 3; ++c)
      rgb[c] = M[c][0] * xyz[0] + M[c][1] * xyz[1] + M[c][2] * xyz[2];
    for (int c = 0; c < 3; ++c)
      if (c != i) {
        EXPECT_NEAR(rgb[c], i == 3, 1e-12);
      }
  }
}

TEST(Color, EightWavelengthsAreEnough) {
  // Single scattering carries the sky's whole spectral shape, and costs nothing at 40
  // wavelengths.
  const auto color = [](const std::vector<double>& nm, double view, double sun,
                        std::array<double, 3>& rgb) {
    const Model m(preset("earth", nm), nishita());
    const Colors colors = colors_of(nm, kRec709, sun_spectrum);
    std::vector<double> L(nm.size()), T(nm.size());
    m.see(ray_at(1, view, sun, 40), L.data(), T.data());
    rgb = {};
    for (std::size_t i = 0; i < nm.size(); ++i)
      for (int c = 0; c < 3; ++c) rgb[c] += colors.radiance[i][c] * L[i];
  };
  std::vector<double> many;
  for (int nm = 385; nm < 780; nm += 10) many.push_back(nm);
  const std::vector<std::vector<double>> lists = {
      {440, 550, 680},
      {385, 450, 515, 555, 590, 605, 640, 700},
      {390, 410, 430, 450, 470, 490, 510, 530, 550, 570, 590, 610, 630, 650, 680, 710}};
  for (std::size_t k = 0; k < lists.size(); ++k) {
    double worst = 0;
    for (double view : {0., 60., 88.})
      for (double sun : {20., 75., 88., 92.}) {
        std::array<double, 3> truth, rgb;
        color(many, view, sun, truth);
        color(lists[k], view, sun, rgb);
        const double most = std::max({truth[0], truth[1], truth[2]});
        for (int c = 0; c < 3; ++c)
          worst = std::max(worst, std::abs(rgb[c] - truth[c]) / most);
      }
    std::printf("%zu wavelengths: colour error %.2f %% of the brightest channel\n",
                lists[k].size(), 100 * worst);
    if (k > 0) {
      // Eight are placed, sixteen are spread.
      EXPECT_LE(worst, k == 1 ? .004 : .006) << lists[k].size();
    }
  }
}

}  // namespace
