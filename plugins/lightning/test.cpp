// Facts about lightning, asked of the product's own path.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "../../tests/stage/generated.h"
#include "../../tests/stage/through_air.h"
#include "baseline.h"
#include "num/error.h"
#include "truth/truth.h"

namespace {

using namespace brume;
using namespace brume::test;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr double kEps = std::numeric_limits<float>::epsilon();
constexpr double kError = 1e-5;  // of L, relative

// Int dt / (1 + a |o + t d - p|^2) over [0, t1], o the eye at 0: the antiderivative in
// long double, with |d| as it is. Atan differences on one side of the foot are taken from
// the far end, where they keep their digits.
long double truth_of(const Ray& r, const long double p[3], long double a) {
  long double dd = 0, dp = 0;
  for (int i = 0; i < 3; ++i) dd += (long double)r.d[i] * r.d[i], dp += p[i] * r.d[i];
  long double cross = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const long double x = p[j] * r.d[k] - p[k] * r.d[j];
    cross += x * x;
  }
  const long double n = std::sqrt(dd), h2 = cross / dd, tc = dp / n;
  const long double k = std::sqrt(a / (1 + a * h2));
  const long double x0 = -k * tc, x1 = r.t == kInf ? INFINITY : k * (r.t * n - tc);
  long double angle;
  if (x0 > 0)
    angle = std::atan(1 / x0) - (std::isinf(x1) ? 0 : std::atan(1 / x1));
  else
    angle = std::atan(x1) - std::atan(x0);
  return angle * k / a;
}

TEST(Lightning, ItsBaselineIsTheAntiderivativeThatCancels) {
  // Near the light it is right; where both ends of a short stretch lie far beyond it the
  // two arcs are the same float.
  const float a = 0.01f, d[3] = {0, 0, 1}, near[3] = {3, 0, -5};
  const long double p_near[3] = {-3, 0, 5};
  EXPECT_NEAR(lightning::baseline::glow(near, d, 20, a),
              double(truth_of({{0, 0, 0}, {0, 0, 1}, 20}, p_near, a)), 1e-5);
  const float far[3] = {0.01f, 0, 5000};
  const long double p_far[3] = {-0.01L, 0, -5000};
  const double right = double(truth_of({{0, 0, 0}, {0, 0, 1}, 1}, p_far, a));
  EXPECT_GT(std::abs(lightning::baseline::glow(far, d, 1, a) / right - 1), 1e-3);
}

TEST(Lightning, AgreesWithItsAntiderivativeInLongDouble) {
  const unsigned seed = 20060730;
  std::mt19937 random(seed);
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  double worst = 0;
  int asked = 0;
  for (const double a : {1e-6, 1e-4, 1e-2, 1., 1e2, 1e4})
    for (const double h : {1e-3, 1e-1, 1., 10., 1e3, 1e6})
      for (const double tc : {-1e3, -1., 0., 1e-2, 3., 100., 1e5}) {
        ThroughAir air;
        air.add("lightning", {{"position", text(h, 0, tc)},
                              {"intensity", "1,2,0.5"},
                              {"attenuation", text(a)}})
            .compile(1e-3, Isa(random() % (unsigned(best_isa()) + 1)));
        std::vector<Ray> rays;
        for (const float t : {1e-2f, 1.f, 50.f, 1e3f, 1e6f, kInf}) {
          rays.push_back({{0, 0, 0}, {0, 0, 1}, t});
          const double s = uniform(-1e-3, 1e-3);
          rays.push_back({{0, 0, 0}, {float(s), 0, float(std::sqrt(1 - s * s))}, t});
        }
        const auto got = air(rays);
        for (std::size_t i = 0; i < rays.size(); ++i) {
          const auto at = [&](double dx, double dz) {
            const long double p[3] = {h * (1 + dx), 0, tc * (1 + dz)};
            return double(truth_of(rays[i], p, a));
          };
          const double L = at(0, 0);
          // The light's place and the foot are floats: eps of position and direction.
          const double far = std::abs(tc) * std::abs(rays[i].d[0]) / h;
          double slack = 0;
          for (const int sign : {-1, 1})
            slack += std::abs(at(sign * kEps * (1 + 2 * far), 0) - L) +
                     std::abs(at(0, sign * kEps) - L);
          const double error = std::max(0., std::abs(got[i].L[0] - L) - slack) / L;
          worst = std::max(worst, error);
          ++asked;
          EXPECT_LE(error, kError)
              << "a " << a << ", h " << h << ", tc " << tc << ", t " << rays[i].t << ": "
              << got[i].L[0] << ", not " << L << " +- " << slack;
          EXPECT_EQ(got[i].T[0], 1);
        }
      }
  std::printf("%d rays, seed %u: largest error %.1e beside the rounding of places\n",
              asked, seed, worst);
}

TEST(Lightning, InFogItIsDimmedAsTheTruthSays) {
  ThroughAir air;
  air.add("lightning", {{"points", "2,1,30,-3,0,12"}, {"attenuation", "0.2"}})
      .add("height_fog", {{"density", "0.01,0.03,0.1"}, {"falloff", "0.05"}})
      .compile();
  for (const float t : {10.f, 25.f, 200.f}) {
    const Ray r{{0, 0, 0}, {0, 0, 1}, t};
    const auto truth = truth::along(air.world(), {0, 0, 0}, {0, 0, 1}, t);
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(air(r).L[c], truth.L[c], 1e-3 * (1 + truth.L[c])) << t;
  }
}

TEST(Lightning, ManyLightsAddUp) {
  const Ray r{{0, 0, 0}, {0, 0, 1}, 40};
  ThroughAir a, b, both;
  a.add("lightning", {{"position", "1,2,10"}}).compile();
  b.add("lightning", {{"position", "-3,0,20"}}).compile();
  both.add("lightning", {{"points", "1,2,10,-3,0,20"}}).compile();
  const double sum = double(a(r).L[0]) + b(r).L[0];
  EXPECT_NEAR(both(r).L[0], sum, 4 * kEps * sum);  // three roundings of the sum
}

TEST(Lightning, ALineAndABoltHaveTheLightThatIsAskedFor) {
  for (const char* form : {"line", "bolt"}) {
    ThroughAir air;
    air.add("lightning",
            {{"form", form}, {"points", "0,0,30,5,0,0"}, {"intensity", "3"}});
    double sum = 0;
    for (const auto& m : air.world().media) sum += m.what.emission[0];
    EXPECT_NEAR(sum, 3, 1e-12) << form;
    EXPECT_GE(air.world().media.size(), 24u - 5) << form;
  }
}

TEST(Lightning, ABoltIsItsSeeds) {
  const auto first = [](const char* seed) {
    ThroughAir air;
    air.add("lightning", {{"form", "bolt"}, {"points", "0,0,30,5,0,0"}, {"seed", seed}});
    return air.world().media[3].what.origin[0];
  };
  EXPECT_EQ(first("7"), first("7"));
  EXPECT_NE(first("7"), first("8"));
}

TEST(Lightning, TheOrderOfStagesChangesNoBit) {
  const Set one = {{"position", "1,2,10"}}, two = {{"position", "-3,0,20"}};
  ThroughAir ab, ba;
  ab.add("lightning", one).add("lightning", two).compile();
  ba.add("lightning", two).add("lightning", one).compile();
  const std::vector<Ray> rays = {{{0, 0, 0}, {0, 0, 1}, 40}, {{0, 0, 0}, {0, 1, 0}, 9}};
  EXPECT_TRUE(same_bits(ab(rays), ba(rays)));
}

TEST(Lightning, WrongPointsAreAnError) {
  EXPECT_THROW(ThroughAir().add("lightning", {{"points", "1,2"}}), Error);
  EXPECT_THROW(ThroughAir().add("lightning", {{"form", "line"}}), Error);
}

TEST(Lightning, ItsExampleIsAScene) {
  const SceneFile scene = example_of("lightning");
  EXPECT_EQ(scene.stages.size(), 1u);
}

TEST(Lightning, ItsReadmeIsFresh) {
  expect_generated("plugins/lightning/README.md", "parameters",
                   markdown_table(ThroughAir::registry().specs("lightning")));
}

}  // namespace
