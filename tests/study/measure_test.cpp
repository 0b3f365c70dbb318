// Ways to compute the air, where the answer is known; and how errors are counted.

#include "study/measure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "air/air.h"
#include "num/error.h"
#include "stage/stage.h"

namespace {

using namespace brume;
using namespace brume::study;

// Rays along y of these lengths, before a surface of colour S.
Rays along_y(const std::vector<float>& lengths, float S = 0.5f) {
  Rays r;
  r.count = lengths.size();
  r.t = lengths;
  for (std::size_t c = 0; c < 3; ++c) {
    r.d[c].assign(r.count, c == 1 ? 1.0f : 0.0f);
    r.S[c].assign(r.count, S);
  }
  for (std::size_t i = 0; i < r.count; ++i) r.x.push_back(int(20 * i)), r.y.push_back(0);
  r.weights.resize(2);
  r.pad();
  return r;
}

brume_medium even(double sigma, double color) {
  brume_medium m = new_medium();
  for (int c = 0; c < 3; ++c) m.extinction[c] = sigma, m.color[c] = color;
  return m;
}

// A slab between y = a and y = b, as a wide box.
brume_medium slab(double a, double b, double sigma, double color) {
  brume_medium m = even(sigma, color);
  m.shape = BRUME_BOX;
  const double rows[12] = {1e-6, 0, 0,    0, 0, 2 / (b - a), 0, -(a + b) / (b - a),
                           0,    0, 1e-6, 0};
  std::copy(rows, rows + 12, m.local_from_world);
  return m;
}

World world_of(std::vector<brume_medium> media) {
  World w;
  for (std::size_t k = 0; k < media.size(); ++k)
    w.media.push_back({media[k], int(k), "m" + std::to_string(k)});
  return w;
}

AirOptions two_stages() {
  AirOptions o;
  o.stages = 2;
  return o;
}

std::shared_ptr<const Air> compiled(const World& w) {
  return std::make_shared<const Air>(Air::compile(w, two_stages()));
}

TEST(Marching, OfEvenFogHasTheRightTransmittanceAndTooMuchLight) {
  // T = e^-tau whatever the steps. L by n steps is S tau/n Sum e^(-k tau/n), k = 0..n-1.
  const double sigma = 0.02, d = 100, tau = sigma * d;
  const Rays rays = along_y({float(d)});
  for (const int n : {1, 2, 8, 64}) {
    const Answers a =
        evaluate(marching(compiled(world_of({even(sigma, 3)})), n, 1e6f), rays);
    double sum = 0;
    for (int k = 0; k < n; ++k) sum += std::exp(-k * tau / n);
    EXPECT_NEAR(a.T[0][0], std::exp(-tau), 2e-6) << n;  // n roundings of 6e-8
    EXPECT_NEAR(a.L[2][0], 3 * tau / n * sum, 2e-5) << n;
  }
}

TEST(Marching, ConvergesToTheIntegratorAtFirstOrder) {
  const World w = world_of({even(0.01, 1), slab(20, 70, 0.05, 0.2)});
  const Rays rays = along_y({10, 50, 100, 300});
  const Answers right = evaluate(ours(compiled(w)), rays);
  double before = 0;
  for (const int n : {64, 128, 256, 512}) {
    const Answers a = evaluate(marching(compiled(w), n, 1e6f), rays);
    double worst = 0;
    for (std::size_t i = 0; i < rays.count; ++i)
      worst = std::max(worst, std::abs(double(a.L[0][i]) - double(right.L[0][i])));
    if (before > 0) {
      EXPECT_NEAR(worst / before, 0.5, 0.35) << n;  // edges fall into steps
    }
    before = worst;
  }
  EXPECT_LT(before, 0.01);
}

TEST(Marching, EndsRaysWithoutEndAtFar) {
  const float inf = std::numeric_limits<float>::infinity();
  const Answers a = evaluate(marching(compiled(world_of({even(0.01, 1)})), 4, 50.0f),
                             along_y({inf, 50, 70}));
  EXPECT_EQ(a.T[0][0], a.T[0][1]);
  EXPECT_EQ(a.T[0][2], a.T[0][1]);
}

TEST(Marching, CountsWeights) {
  Rays rays = along_y({100});
  rays.weights[0].assign(16, 0.25f);
  const Answers a =
      evaluate(marching(compiled(world_of({even(0.02, 1)})), 8, 1e6f), rays);
  EXPECT_NEAR(a.T[0][0], std::exp(-0.5), 1e-6);
}

TEST(Marching, RefusesMoreMediaThanItHolds) {
  World w = world_of(std::vector<brume_medium>(65, even(0.1, 1)));
  for (std::size_t k = 0; k < w.media.size(); ++k) {
    w.media[k].stage = 0;
    w.media[k].what.color[0] = double(k);  // so that they are not one
  }
  EXPECT_THROW(marching(compiled(w), 4, 1e3f), Error);
}

TEST(Painting, IsExactWhereVolumesLieApartAndWrongWhereTheyOverlap) {
  const Rays rays = along_y({200});
  const World apart = world_of({slab(10, 60, 0.02, 1), slab(80, 130, 0.05, 0.2)});
  const Answers right = evaluate(ours(compiled(apart)), rays);
  const Answers painted = evaluate(painting(apart, two_stages()), rays);
  EXPECT_NEAR(painted.L[0][0], right.L[0][0], 1e-6);
  EXPECT_NEAR(painted.T[0][0], right.T[0][0], 1e-6);
  // Two that share 50 m: the same T, and an L that is off by -43 or +68 %: painted over
  // the first, or under it (the scene of the design).
  const World shared = world_of({slab(10, 60, 0.02, 1), slab(10, 60, 0.05, 0.2)});
  const Answers true_ = evaluate(ours(compiled(shared)), rays);
  const Answers wrong = evaluate(painting(shared, two_stages()), rays);
  EXPECT_NEAR(wrong.T[0][0], true_.T[0][0], 1e-6);
  EXPECT_GT(std::abs(wrong.L[0][0] / true_.L[0][0] - 1), 0.3);
}

TEST(Deviation, IsRelativeToWhiteAndColourAndOfTheWorstChannel) {
  const Rays rays = along_y({1, 1}, 2.0f);
  Answers a(rays);
  Reference right;
  right.T = {{1, 1, 1}, {0.5, 0.5, 0.5}};
  right.L = {{0, 0, 0}, {3, 3, 3}};
  for (std::size_t c = 0; c < 3; ++c)
    a.T[c] = std::vector<float>(16, 1.0f), a.L[c] = std::vector<float>(16, 0.0f);
  a.T[1][0] = 0.75f;  // C = 2 T: 1.5, not 2
  a.T[0][1] = a.T[1][1] = a.T[2][1] = 0.5f;
  a.L[0][1] = a.L[1][1] = 3, a.L[2][1] = 3.5f;  // C = 4.5, not 4
  const Deviation d = deviation(rays, a, right, 1, 2);
  EXPECT_NEAR(d.color_by_ray[0], 0.5 / 3, 1e-7);
  EXPECT_NEAR(d.color_by_ray[1], 0.5 / 5, 1e-7);
  EXPECT_EQ(d.worst, 0u);
  EXPECT_NEAR(d.T.max, 0.25, 1e-7);
  EXPECT_NEAR(d.L.max, 0.5 / 4, 1e-7);
}

TEST(Deviation, CountsTheHuntedInTheWorstAlone) {
  const Rays rays = along_y({1, 1, 1});
  Answers a(rays);
  Reference right;
  right.T.assign(3, {0, 0, 0});
  right.L.assign(3, {0, 0, 0});
  a.L[0][2] = 1;  // the third is hunted
  const Deviation d = deviation(rays, a, right, 1, 2);
  EXPECT_EQ(d.color.max, 1);
  EXPECT_EQ(d.color.rms, 0);
  EXPECT_EQ(d.worst, 2u);
}

TEST(Deviation, ANaNIsAsWrongAsCanBe) {
  const Rays rays = along_y({1});
  Answers a(rays);
  Reference right;
  right.T.assign(1, {1, 1, 1});
  right.L.assign(1, {0, 0, 0});
  a.T[0][0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(std::isinf(deviation(rays, a, right, 1, 1).color.max));
}

TEST(Hunt, FindsWhereTwoAnswersPartAndOneOfATileOnly) {
  Rays rays = along_y(std::vector<float>(100, 1.0f));
  Answers a(rays), b(rays);
  b.L[1][37] = 0.5f;
  b.L[1][80] = 0.25f;
  EXPECT_EQ(farthest_apart(rays, a, b, 1, 4), (std::vector<std::uint32_t>{37, 80}));
  rays.x[80] = rays.x[37];
  EXPECT_EQ(farthest_apart(rays, a, b, 1, 4), (std::vector<std::uint32_t>{37}));
}

TEST(ErrorOf, IsMaxP99RmsAndMean) {
  std::vector<double> d(200, 1.0);
  d[3] = 5, d[70] = 3;
  const ErrorOf e = error_of(d);
  EXPECT_EQ(e.max, 5);
  EXPECT_EQ(e.p99, 1);  // the 198th of 200
  EXPECT_NEAR(e.mean, 206 / 200., 1e-12);
  EXPECT_NEAR(e.rms, std::sqrt((198 + 25 + 9) / 200.), 1e-12);
}

}  // namespace
