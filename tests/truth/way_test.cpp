// The depth toward a light along a view ray, kept as polynomials, against the same depth
// asked at each point by itself.

#include "truth/way.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support.h"
#include "truth/physics.h"

namespace brume {
namespace {

using namespace testing_truth;
using truth::along;

TEST(Truth, AWayThatIsKeptIsTheWay) {
  // Small bodies, thin and opaque ones, within each other, about the ray, the light, and
  // neither; their shadows are narrower than any spacing of nodes.
  std::mt19937_64 random(3);
  RecordProperty("seed", 3);
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  double worst = 0;
  for (int scene = 0; scene < 60; ++scene) {
    std::vector<brume_medium> media{fog(0.01)};
    for (int i = 0; i < 4; ++i)
      media.push_back(bounded(fog(std::pow(10, uniform(-3, 2))),
                              i % 2 ? BRUME_BOX : BRUME_ELLIPSOID,
                              {uniform(-9, 9), uniform(-9, 9), uniform(-9, 9)},
                              {uniform(.1, 5), uniform(.1, 5), uniform(.1, 5)}));
    World w;
    for (const brume_medium& m : media) w.media.push_back({m, 0, ""});
    brume_light light{};
    light.kind = scene % 3 ? BRUME_POINT : BRUME_SUN;
    light.attenuated = 1;
    for (double& x : light.position) x = uniform(-9, 9);
    const glm::dvec3 to = glm::normalize(glm::dvec3(uniform(-1, 1), uniform(-1, 1), 1));
    for (int k = 0; k < 3; ++k) light.direction[k] = to[k], light.power[k] = 1;
    const truth::Ray ray{
        {0, 0, 0},
        glm::normalize(glm::dvec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1))),
        30};
    truth::Cost cost;
    const truth::Obstacles obstacles(w);
    const truth::Ways all(w, obstacles, light, ray, cost);
    truth::WaysToLight ways(all);
    for (int i = 0; i < 200; ++i) ways.at(uniform(0, 30), 1e-2);  // coarse ones first
    for (int i = 0; i < 400; ++i) {
      const double t = uniform(0, 30);
      const glm::dvec3 x = ray.at(t);
      const truth::Incident in = truth::light_at(w, light, x);
      truth::Cost own;
      const auto depth = obstacles.depth({x, in.to, in.distance}, 1e-10, own);
      worst = std::max(
          worst, std::abs(std::exp(-ways.at(t, 1e-8)[0]) - std::exp(-depth.tau[0])));
    }
  }
  // As asked for at the places where it was tried; ten times that between them.
  EXPECT_LE(worst, 1e-7);
}

TEST(Truth, LightThroughNoiseNeedNotKnowEveryWay) {
  // Waves of four sizes down to 1/2 m in all directions, lit by a lamp beside the ray and
  // one on it. What a few thousand evaluations make of it against what ten million do:
  // within what is told, and that is far above.
  brume_medium m = fog(.02);
  m.profile = BRUME_CUSTOM;
  for (double& a : m.albedo) a = .9;
  m.point = [](const void*, const double x[3], const double*, double* rho,
               double source[3]) {
    double log_rho = 0, k = 1;
    for (int octave = 0; octave < 4; ++octave, k *= 2)
      log_rho += (std::sin(1.7 * k * x[0] + 5 * octave) + std::sin(2.3 * k * x[1]) +
                  std::sin(1.9 * k * x[2] - octave)) /
                 (3 * k);
    *rho = std::exp(log_rho);
    source[0] = source[1] = source[2] = 0;
  };
  const World w =
      world({m}, {lamp({6, 25, 3}, 3000, true), lamp({0, 40.5, 0}, 20, true)});
  const glm::dvec3 d = glm::normalize(glm::dvec3(.01, 1, .02));
  const auto best =
      along(w, {0, 0, 0}, d, 60, {.tolerance = 1e-7, .evaluations = 20'000'000});
  EXPECT_TRUE(best.converged);
  EXPECT_GT(best.L[0], .1);
  bool enough = false;
  for (const long ways : {3'000L, 8'000L, 100'000L}) {
    const auto a =
        along(w, {0, 0, 0}, d, 60, {.tolerance = 1e-5, .enough = 1e-4, .ways = ways});
    const double off = std::abs(a.L[0] - best.L[0]) / (1 + best.L[0]);
    EXPECT_LE(off, a.L_error[0] / (1 + best.L[0])) << ways;
    if (a.converged) {
      EXPECT_LE(off, 1e-4) << ways;
    }
    EXPECT_EQ(a.converged, a.L_error[0] <= 2e-4 * (1 + best.L[0])) << ways;
    enough = a.converged;
    std::printf("%ld evaluations, %ld for ways: off by %.1e, told %.1e\n", a.evaluations,
                ways, off, a.L_error[0] / (1 + best.L[0]));
  }
  EXPECT_TRUE(enough);
  std::printf("best: %ld evaluations, told %.1e\n", best.evaluations, best.L_error[0]);
}

}  // namespace
}  // namespace brume
