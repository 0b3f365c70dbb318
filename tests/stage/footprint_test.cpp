// How wide a pixel is at a place, against the rays of its neighbours.

#include "stage/footprint.h"

#include <gtest/gtest.h>

#include <glm/gtc/constants.hpp>
#include <random>

#include "stage/instance.h"
#include "stage/module.h"
#include "stage/stage.h"

namespace {

using namespace brume;
using glm::dvec3;

// What the stage was told last.
brume_frame told;

struct Listener : Stage {
  static constexpr StageAbout about{"listener", "Listens.", BRUME_AIR};
  template <class V>
  void describe(V&) {}
  void publish(const brume_frame& frame, Publisher&) override { told = frame; }
};
const brume_plugin_info* plugin() { return detail::plugin_info<Listener>(""); }

brume_frame frame_of(const View& view) {
  static const std::vector<StageType> types = read_plugin(plugin, "here");
  StageCache cache;
  FrameInfo info;
  info.look(view);
  info.display = view.display;
  World world;
  StageInstance stage(types[0], "listener", {}, cache);
  stage.needs(info);
  stage.publish(info, 0, world);
  return told;
}

struct Dice {
  std::mt19937 random{20261123};
  double operator()(double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  }
  dvec3 direction() {
    for (;;) {
      const dvec3 v((*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1));
      if (glm::length(v) > 0.1 && glm::length(v) < 1) return glm::normalize(v);
    }
  }
};

// A camera that is turned and stands anywhere, its window off the axis, its pixels
// `aspect` times as wide as high.
View view_of(Projection projection, Dice& dice, double aspect) {
  View v;
  v.projection = projection;
  v.eye = 100. * dice.direction();
  v.display = {-7, 3, 320, 200};
  v.forward = dice.direction();
  v.right = glm::normalize(glm::cross(v.forward, dice.direction()));
  v.up = glm::cross(v.right, v.forward);
  if (projection == Projection::latlong) {
    v.corner = {-0.5, 0.25, 0};
    v.across = {1. / 320, 0, 0};
    v.down = {0, -0.5 / 200, 0};
    return v;
  }
  const double size = 0.008;
  v.across = size * aspect * v.right;
  v.down = -size * v.up;
  v.corner = dice(-2, .1) * v.right + dice(-.1, 1.3) * v.up;
  if (projection == Projection::perspective) v.corner += v.forward;
  return v;
}

struct Steps {
  dvec3 place, direction, across, down;  // place relative to the eye
};
// By central differences of half a thousandth of a pixel: 1e-7 of their curvature.
Steps steps(const View& v, double x, double y, double t) {
  const auto at = [&](double i, double j) {
    const View::RayAt r = v.ray(i, j);
    return r.origin - v.eye + t * r.direction;
  };
  const double h = 5e-4;
  return {at(x, y), v.ray(x, y).direction, (at(x + h, y) - at(x - h, y)) / (2 * h),
          (at(x, y + h) - at(x, y - h)) / (2 * h)};
}

std::array<double, 3> array(const dvec3& v) { return {v.x, v.y, v.z}; }

TEST(Footprint, IsHowFarNeighboursRaysPassFromOneAnother) {
  Dice dice;
  double worst = 0;
  for (const Projection p :
       {Projection::perspective, Projection::orthographic, Projection::latlong})
    for (int i = 0; i < 1000; ++i) {
      const View v = view_of(p, dice, dice(0.4, 2.5));
      const Footprint pixel(frame_of(v));
      // To within a tenth of a pixel of a latlong's poles.
      const double x = v.display.x + dice(0, v.display.width), t = std::exp(dice(-3, 9)),
                   y = i % 4 == 0 && p == Projection::latlong
                           ? std::exp(dice(-2.3, 4))
                           : v.display.y + dice(0, v.display.height - 3.1);
      const Steps s = steps(v, x, y, t);
      const dvec3 n = glm::normalize(glm::cross(s.direction, dice.direction()));
      const double want =
          std::pow(glm::dot(n, s.across), 2) + std::pow(glm::dot(n, s.down), 2);
      const double got = pixel.across(array(n))(array(s.place));
      EXPECT_NEAR(got, want, 1e-6 * want + 1e-12 * t * t)
          << int(p) << ", " << x << ", " << y;
      worst = std::max(worst, std::abs(got / want - 1));
    }
  std::printf("3000 places: largest error of a width's square %.1e\n", worst);
}

TEST(Footprint, ItsMeanIsOverAllDirectionsAcrossTheRay) {
  // w(n)^2 = n^T M n has the mean (trace M) / 2: of square pixels, and of any that a
  // latlong has.
  Dice dice;
  for (const Projection p :
       {Projection::perspective, Projection::orthographic, Projection::latlong})
    for (int i = 0; i < 300; ++i) {
      const View v = view_of(p, dice, 1);
      const Steps s = steps(v, v.display.x + dice(0, v.display.width),
                            v.display.y + dice(0, v.display.height - 3.1), dice(1, 500));
      const double want = (glm::dot(s.across, s.across) + glm::dot(s.down, s.down)) / 2;
      const FootprintMean mean = Footprint(frame_of(v)).mean();
      EXPECT_NEAR(mean(array(s.place)), want, 1e-6 * want) << int(p);
      EXPECT_LE(mean.narrowest() * glm::dot(s.place, s.place), want * (1 + 1e-6));
    }
}

TEST(Footprint, InTheMiddleItIsPixelFootprint) {
  Dice dice;
  for (const Projection p :
       {Projection::perspective, Projection::orthographic, Projection::latlong}) {
    View v = view_of(p, dice, 1);
    v.display = {0, 0, 320, p == Projection::latlong ? 160 : 200};
    v.down.y *= p == Projection::latlong ? 1.25 : 1;
    if (p != Projection::latlong)
      v.corner += -glm::dot(v.corner + 160. * v.across, v.right) * v.right -
                  glm::dot(v.corner + 100. * v.down, v.up) * v.up;
    const View::RayAt r = v.ray(160, p == Projection::latlong ? 80 : 100);
    const dvec3 y = r.origin - v.eye + 20. * r.direction;
    const double scale = p == Projection::orthographic ? 1 : 20;
    // The angle between rays a whole pixel apart: (0.02)^2 / 12 from the derivative.
    EXPECT_NEAR(std::sqrt(Footprint(frame_of(v)).mean()(array(y))),
                scale * v.pixel_footprint(), 1e-4 * scale * v.pixel_footprint())
        << int(p);
  }
}

TEST(Footprint, OfHostsThatSayLessIsPixelFootprint) {
  Dice dice;
  brume_frame frame = frame_of(view_of(Projection::latlong, dice, 1));
  frame.pixel_footprint = 0.25;
  const std::array<double, 3> y{0, 3, 4}, n{1, 0, 0};
  brume_frame older = frame;
  older.size = offsetof(brume_frame, projection);
  brume_frame newer = frame;
  newer.projection = 77;
  for (const brume_frame& f : {older, newer}) {
    EXPECT_DOUBLE_EQ(Footprint(f).across(n)(y), 1.25 * 1.25);
    EXPECT_DOUBLE_EQ(Footprint(f).mean()(y), 1.25 * 1.25);
  }
  older.orthographic = 1;
  EXPECT_DOUBLE_EQ(Footprint(older).across(n)(y), 0.25 * 0.25);
  older.size = offsetof(brume_frame, orthographic);  // and older still
  EXPECT_DOUBLE_EQ(Footprint(older).mean()(y), 1.25 * 1.25);
}

}  // namespace
