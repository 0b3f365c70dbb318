// An integrator with mistakes about lamps, by worlds that are not quite those it was
// given: each must break a law. And the sound one, which must not.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "broken_print.h"
#include "stage/stage.h"
#include "stress/stress.h"

namespace brume::stress {
namespace {

using Blunder = void (*)(World&);

// A spotlight near the eye, in what fog stress puts around it.
Report stress_of(Blunder blunder, bool in_the_eye = false) {
  const Maker maker = [=](Random& r, const FrameInfo& f) -> std::optional<Subject> {
    Subject s;
    s.world.eye = f.eye;
    s.world.up = f.up;
    brume_light l = new_light();
    l.kind = BRUME_SPOT;
    const double away = std::pow(10., r.uniform(-1, 2));
    for (int i = 0; i < 3; ++i) {
      l.position[i] = f.eye[i] + away * r.uniform(-1, 1);
      l.direction[i] = i == int(3 * r.uniform());
      l.power[i] = away * away * 100;
    }
    if (l.direction[0] + l.direction[1] + l.direction[2] != 1)
      l.direction[0] = 0, l.direction[1] = 0, l.direction[2] = 1;
    l.radius = 0.1 * away;
    l.cone = 1, l.cone_soft = 0.2;
    if (in_the_eye) {
      for (int i = 0; i < 3; ++i) l.position[i] = f.eye[i] + 1e-6 * r.uniform(-1, 1);
      for (double& x : l.power) x = 1e20;  // no more from 1e-5 m on
      l.radius = 0;
    }
    s.world.lights.push_back({l, 0, "lamp"});
    s.compile = [blunder](const World& w, const AirOptions& o) {
      World seen = w;
      if (blunder) blunder(seen);
      return Air::compile(seen, o);
    };
    return s;
  };
  return run("test", maker, {.cases = 5120, .seed = 11, .seconds = 60});
}

void expect_broken(Law law, Blunder blunder) {
  const Report r = stress_of(blunder);
  print(r);
  EXPECT_GT(r.of(law).broken, 0u) << name(law);
}

TEST(StressLights, ASoundLampBreaksNoLaw) {
  const Report r = stress_of(nullptr);
  print(r);
  EXPECT_TRUE(r.ok());
  EXPECT_GT(r.truths, 50u);
  for (const Law law : {Law::additive, Law::dark, Law::order, Law::scale, Law::truth_L})
    EXPECT_GT(r.of(law).checked, 100u) << name(law);
}

TEST(StressLights, ALampInTheEyeAsBrightAsFloatsAllowBreaksNoLaw) {
  const Report r = stress_of(nullptr, true);
  print(r);
  EXPECT_TRUE(r.ok());
  EXPECT_GT(r.of(Law::jump).checked, 50u);
}

TEST(StressLights, FindsThatLampsMakeEachOtherBrighter) {
  expect_broken(Law::additive, [](World& w) {
    for (auto& l : w.lights)
      for (double& x : l.what.power) x *= double(w.lights.size());
  });
}

TEST(StressLights, FindsALampThatThinsTheFog) {
  expect_broken(Law::dark, [](World& w) {
    if (w.lights.empty()) return;
    for (auto& m : w.media)
      for (double& x : m.what.extinction) x *= 0.99;
  });
}

TEST(StressLights, FindsThatTheFirstOfTheListCounts) {
  expect_broken(Law::order, [](World& w) {
    if (w.lights.size() > 1)
      for (double& x : w.lights[0].what.power) x *= 2;
  });
}

TEST(StressLights, FindsARadiusInOtherUnits) {
  expect_broken(Law::scale, [](World& w) {
    for (auto& l : w.lights) l.what.radius = std::max(l.what.radius, 1.);
  });
}

TEST(StressLights, FindsAConeThatShinesBackward) {
  expect_broken(Law::truth_L, [](World& w) {
    for (auto& l : w.lights)
      for (double& x : l.what.direction) x = -x;
  });
}

TEST(StressLights, FindsALampThatTakesLight) {
  expect_broken(Law::positive, [](World& w) {
    for (auto& l : w.lights)
      for (double& x : l.what.power) x = -x;
  });
}

TEST(StressLights, FindsALampThatIsNoNumber) {
  expect_broken(Law::finite, [](World& w) {
    for (auto& l : w.lights)
      if (l.what.kind == BRUME_SUN || l.what.kind == BRUME_SPOT)
        for (double& x : l.what.power) x = x > 0 ? 1e300 : 0;  // no float holds it
  });
}

}  // namespace
}  // namespace brume::stress
