// Height fog against its truth (oracle.cpp), over stiff and over random cases.

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "fog_air_test.h"
#include "oracle.h"

namespace height_fog {
namespace {

// As long as a ray can be (README.md, "Limits"): the visible universe is 9e26 m wide.
constexpr double kForever = 1e30;

TEST(HeightFogOracle, AgreesWithTheClosedFormsThatExist) {
  const Fog uniform{.density = 0.5L};
  EXPECT_NEAR(double(optical_depth(uniform, 7, 0.3L, 2, 12) / 5), 1, 1e-14);
  const Fog fog{.density = 2, .height = 3, .falloff = 0.25L};
  // Straight up from its reference height to infinity: sigma / c. A level ray: sigma t.
  EXPECT_NEAR(double(optical_depth(fog, 3, 1, 0, kInf) / 8), 1, 1e-14);
  EXPECT_NEAR(double(optical_depth(fog, 3, 0, 0, 1e6L) / 2e6L), 1, 1e-14);
  EXPECT_EQ(optical_depth(fog, 3, -1, 0, kInf), HUGE_VALL);
  EXPECT_EQ(optical_depth(fog, 3, 0, 0, kInf), HUGE_VALL);
  // c dz = 1e4 both ways: only the thick end counts.
  const Fog steep{.density = 1, .falloff = 10};
  EXPECT_NEAR(double(optical_depth(steep, 0, 1, 0, 1000) * 10), 1, 1e-14);
  EXPECT_NEAR(double(optical_depth(steep, 1000, -1, 0, 1000) * 10), 1, 1e-14);
}

double length(const Ray& r) { return std::min<double>(r.t, kForever); }

// The largest excess over what the roundings below explain.
struct Worst {
  double T = 0, opacity = 0;
};

// Holds an answer of fog with colour 1, whose L is its opacity, against the truth.
void expect_near_truth(const Answer& got, double density, double tau, double c,
                       const Ray& ray, const std::string& where, Worst& worst) {
  const double T = std::exp(-tau), opacity = -std::expm1(-tau);
  // A float exponent. (Where the fog is so stiff that it says nothing, T is still in [0,
  // 1].)
  const double slack = kEps * std::min(1e7, std::abs(c * ray.d[2] * length(ray)));
  // A density that is below the normal floats everywhere on the ray has lost its digits.
  const double underflow = density * length(ray) * std::numeric_limits<float>::min();
  for (int k = 0; k < 3; ++k) {
    const double got_T = got.T[k], got_L = got.L[k];
    ASSERT_TRUE(got_T >= 0 && got_T <= 1 && got_L >= 0 && got_L <= 1)
        << where << ": T " << got_T << ", L " << got_L;
    if (slack >= 1) continue;  // c dz is beyond 1e7: a float says nothing of it
    const double error_T = std::abs(got_T - T) - slack / std::exp(1) - underflow;
    EXPECT_LE(error_T, kErrorT) << where << ": T " << got_T << ", not " << T;
    worst.T = std::max(worst.T, error_T);
    const double error = std::abs(got_L - opacity) - slack * opacity - underflow -
                         std::numeric_limits<float>::min();
    EXPECT_LE(error, kErrorOpacity * opacity)
        << where << ": opacity " << got_L << ", not " << opacity;
    if (error > 0) worst.opacity = std::max(worst.opacity, error / opacity);
  }
}

TEST(HeightFog, AgreesWithQuadratureOverTheStiffGrid) {
  const double falloffs[] = {0, 1e-9, 1e-5, 1e-3, 0.1, 10, 1e3};
  const double eyes[] = {-1e7, -300, -1, 0, 1.7, 1e3, 1e7};
  const double slopes[] = {-1,   -0.5, -0.01,  -1e-4,  -1e-9, 0,
                           1e-9, 1e-4, 0.0099, 0.0101, 0.5,   1};
  const double depths[] = {0, 1e-6, 0.1, 10, 1e3, 1e5, 1e9, kInf};
  const double densities[] = {0, 1e-6, 2e-3, 1, 1e6};
  std::vector<Ray> rays;
  for (const double mu : slopes)
    for (const double d : depths) rays.push_back(climbing(mu, d));
  Worst worst[3];
  for (const double c : falloffs)
    for (const double z : eyes) {
      std::vector<long double> tau;  // at density 1
      for (const Ray& r : rays)
        tau.push_back(
            optical_depth({.density = 1, .falloff = c}, z, r.d[2], 0, length(r)));
      for (const double density : densities)
        for (const Isa isa : {Isa::v2, Isa::v3, Isa::v4}) {
          if (isa > best_isa()) continue;
          const auto answers = FogAir({{"falloff", text(c)}, {"density", text(density)}},
                                      at(z), false, isa)(rays);
          for (std::size_t i = 0; i < rays.size(); ++i) {
            const Ray& r = rays[i];
            const std::string where = "falloff " + text(c) + ", eye " + text(z) +
                                      ", slope " + text(r.d[2]) + ", depth " + text(r.t) +
                                      ", density " + text(density) + ", " + name(isa);
            const double t = density == 0 ? 0 : double(density * tau[i]);
            expect_near_truth(answers[i], density, t, c, r, where, worst[int(isa)]);
            ASSERT_FALSE(HasFatalFailure()) << where;
          }
        }
    }
  for (const Isa isa : {Isa::v2, Isa::v3, Isa::v4})
    std::printf("%s: beyond the exponent's rounding |dT| <= %.1e, of 1-T <= %.1e\n",
                name(isa), worst[int(isa)].T, worst[int(isa)].opacity);
}

TEST(HeightFog, AgreesWithQuadratureWhereItIsNeitherClearNorOpaque) {
  // A grid seldom hits the optical depths that show an error. Here everything is random,
  // and the density such that the ray's optical depth is between 1e-3 and 10.
  const unsigned seed = 20061101;
  std::mt19937 random(seed);
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  const auto log_uniform = [&](double a, double b) {
    return std::exp(uniform(std::log(a), std::log(b)));
  };
  Worst worst;
  int asked = 0;
  for (int i = 0; i < 3000; ++i) {
    const double c = log_uniform(1e-6, 1e3);
    const double z =
        uniform(-60, 60) / c;  // density at the eye e^-60 to e^60 of that at 0
    if (std::abs(z) > 1e7) continue;
    const double mu = uniform(0, 1) < 0.2 ? uniform(-1e-6, 1e-6) : uniform(-1, 1);
    const Ray ray = climbing(mu, log_uniform(1e-3, 1e7));
    const double unit =
        double(optical_depth({.density = 1, .falloff = c}, z, ray.d[2], 0, ray.t));
    const double density = log_uniform(1e-3, 10) / unit;
    if (!(density > 0 && density <= 1e6) || std::abs(c * ray.d[2] * ray.t) > 1e4)
      continue;
    const Answer got =
        FogAir({{"falloff", text(c)}, {"density", text(density)}}, at(z))(ray);
    expect_near_truth(got, density, density * unit, c, ray,
                      "seed " + std::to_string(seed) + ", case " + std::to_string(i) +
                          ", falloff " + text(c) + ", eye " + text(z) + ", slope " +
                          text(ray.d[2]) + ", depth " + text(ray.t),
                      worst);
    ++asked;
  }
  EXPECT_GT(asked, 500);
  std::printf(
      "%d cases, seed %u: beyond the exponent's rounding |dT| <= %.1e, of 1-T <= %.1e\n",
      asked, seed, worst.T, worst.opacity);
}

}  // namespace
}  // namespace height_fog
