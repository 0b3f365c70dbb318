// The scene's tolerance shared out among knobs. The sums are worked out by hand beside
// each case.

#include "pipeline/knobs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "num/error.h"

namespace brume {
namespace {

// Air that reaches 1e-6 in steps of ten.
constexpr double kAir[] = {1e-2, 1e-2, 1e-3, 1e-3, 1e-4, 1e-4, 1e-5, 1e-5, 1e-6, 1e-6};

StageEntry stage(const std::string& name, std::vector<double> curve,
                 std::optional<double> given = {}) {
  StageEntry s;
  s.name = s.type = name;
  ParamSpec spec{.name = "steps", .kind = Kind::integer, .default_numbers = {10}};
  spec.knob = true;
  spec.curve = std::move(curve);
  s.params = Settings::defaults({spec});
  if (given) {
    s.params.values[0].keys = {{0, Value{.numbers = {*given}}}};
    s.params.values[0].is_default = false;
  }
  return s;
}
double steps(const Knobs& k, std::size_t i) {
  return k.stages[i].params.values[0].at(1).numbers[0];
}
SceneFile scene(double tolerance) {
  SceneFile s;
  s.tolerance = tolerance;
  return s;
}

const std::vector<double> kSteps{4, 3e-2, 8, 4e-3, 16, 5e-4, 32, 6e-5};

TEST(Knobs, WithoutKnobsTheAirHasTheWholeTolerance) {
  const Knobs k = set_knobs(scene(1e-3), {stage("fog", {})}, false, kAir);
  EXPECT_EQ(k.air, 1e-3);
  EXPECT_EQ(k.promised, 1e-3);
  ASSERT_EQ(k.plans.size(), 1u);
  EXPECT_EQ(k.plans[0].name, "air");
}

TEST(Knobs, OneKnobTakesTheCheapestValueOfHalfTheTolerance) {
  // 1e-3 / 2 = 5e-4: 16 steps. 5e-4 is left: the air's 1e-4.
  const Knobs k = set_knobs(scene(1e-3), {stage("clouds", kSteps)}, false, kAir);
  EXPECT_EQ(steps(k, 0), 16);
  EXPECT_EQ(k.air, 1e-4);
  EXPECT_NEAR(k.promised, 6e-4, 1e-18);
}

TEST(Knobs, TwoShareThatHalf) {
  // 1e-2 / 4 = 2.5e-3 each: 16 steps, 5e-4. 9e-3 is left: 1e-3.
  const Knobs k =
      set_knobs(scene(1e-2), {stage("a", kSteps), stage("b", kSteps)}, false, kAir);
  EXPECT_EQ(steps(k, 0), 16);
  EXPECT_EQ(steps(k, 1), 16);
  EXPECT_EQ(k.air, 1e-3);
  EXPECT_NEAR(k.promised, 2e-3, 1e-18);
}

TEST(Knobs, TheBestMayTakeMoreThanItsShare) {
  // 1e-4 / 2 = 5e-5 is less than the best, 6e-5; but 4e-5 is left and the air does 1e-5.
  const Knobs k = set_knobs(scene(1e-4), {stage("clouds", kSteps)}, false, kAir);
  EXPECT_EQ(steps(k, 0), 32);
  EXPECT_EQ(k.air, 1e-5);
}

TEST(Knobs, WhatCannotBeReachedNamesTheBest) {
  try {
    set_knobs(scene(6e-5), {stage("clouds", kSteps)}, false, kAir);
    FAIL() << "no error";
  } catch (const Error& e) {
    const std::string text = e.what();
    EXPECT_NE(text.find("tolerance = 6e-05 cannot be reached"), text.npos) << text;
    EXPECT_NE(text.find("6.1e-05 (clouds.steps 6e-05, air 1e-06)"), text.npos) << text;
  }
  EXPECT_THROW(set_knobs(scene(1e-7), {}, false, kAir), Error);
  EXPECT_EQ(set_knobs(scene(1e-7), {}, true, kAir).air, 1e-6);
}

TEST(Knobs, AGivenKnobKeepsItsValueAndPromisesWhatItCan) {
  // 12 steps promise what 8 do; half of the tolerance is left for the air.
  const Knobs k = set_knobs(scene(1e-3), {stage("clouds", kSteps, 12)}, false, kAir);
  EXPECT_EQ(steps(k, 0), 12);
  EXPECT_EQ(k.plans[0].promised, 4e-3);
  EXPECT_TRUE(k.plans[0].given);
  EXPECT_EQ(k.air, 1e-4);
  EXPECT_NEAR(k.promised, 4.1e-3, 1e-18);
  // Fewer than the least that was measured promise nothing.
  EXPECT_TRUE(std::isinf(set_knobs(scene(1e-3), {stage("clouds", kSteps, 2)}, false, kAir)
                             .plans[0]
                             .promised));
}

TEST(Knobs, WhatAStageWithoutAKnobPromisesIsLeftToIt) {
  // 6e-4 is left, half of it for the knob: 32 steps, 6e-5; 5.4e-4 for the air: 1e-4.
  const KnobPlan lit{"lit", 0, 4e-4, false, true};
  const Knobs k = set_knobs(scene(1e-3), {stage("clouds", kSteps)}, false, kAir, {lit});
  EXPECT_EQ(k.plans[0].name, "lit");
  EXPECT_EQ(steps(k, 0), 32);
  EXPECT_EQ(k.air, 1e-4);
  EXPECT_NEAR(k.promised, 5.6e-4, 1e-18);
  // More than the tolerance: nobody can help it, and half is left for the others.
  const KnobPlan bad{"lit", 0, 5e-3, false, true};
  EXPECT_NEAR(
      set_knobs(scene(1e-3), {stage("clouds", kSteps)}, false, kAir, {bad}).promised,
      5.16e-3, 1e-18);
}

}  // namespace
}  // namespace brume
