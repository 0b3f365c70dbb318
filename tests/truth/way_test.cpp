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
    truth::WaysToLight ways(w, obstacles, light, ray, cost);
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

}  // namespace
}  // namespace brume
