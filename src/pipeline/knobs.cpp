#include "pipeline/knobs.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "air/curve.h"
#include "num/error.h"

namespace brume {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

struct Point {
  double value, error;
};

// The cheapest of a curve that is good enough, else the best.
Point choose(std::span<const double> curve, double enough) {
  for (std::size_t i = 0; i + 2 < curve.size(); i += 2)
    if (curve[i + 1] <= enough) return {curve[i], curve[i + 1]};
  return {curve[curve.size() - 2], curve[curve.size() - 1]};
}

// What the curve promises at a value that somebody chose: that of the next cheaper point.
double promise_at(std::span<const double> curve, double value) {
  const bool rises = curve.size() > 2 && curve[2] > curve[0];
  double error = kInf;
  for (std::size_t i = 0; i < curve.size(); i += 2)
    if (rises ? curve[i] <= value : curve[i] >= value) error = curve[i + 1];
  return error;
}

struct OpenKnob {
  StageEntry* stage;
  std::size_t param;
};

std::string best_text(const std::vector<KnobPlan>& plans) {
  std::string out;
  for (const KnobPlan& k : plans)
    out += fmt::format("{}{} {:.2g}", out.empty() ? "" : ", ", k.name, k.promised);
  return out;
}

}  // namespace

std::span<const double> air_curve() { return kAirCurve; }

Knobs set_knobs(const SceneFile& scene, std::vector<StageEntry> stages, bool best_effort,
                std::span<const double> air, std::vector<KnobPlan> fixed) {
  Knobs out;
  out.stages = std::move(stages);
  const auto add = [&](KnobPlan plan) {
    out.promised += plan.promised;
    out.plans.push_back(std::move(plan));
  };
  for (KnobPlan& plan : fixed) add(std::move(plan));
  std::vector<OpenKnob> open;
  for (StageEntry& stage : out.stages)
    for (std::size_t i = 0; i < stage.params.specs.size(); ++i) {
      const ParamSpec& spec = stage.params.specs[i];
      const Setting& setting = stage.params.values[i];
      if (!spec.knob || spec.curve.empty()) continue;
      if (setting.is_default) {
        open.push_back({&stage, i});
        continue;
      }
      KnobPlan given{stage.name + "." + spec.name, 0, 0, true};
      for (const Setting::Key& key : setting.keys) {  // the worst of its frames
        const double value = key.value.numbers[0];
        const double error = promise_at(spec.curve, value);
        if (error > given.promised) given.value = value, given.promised = error;
      }
      add(std::move(given));
    }
  const double room = std::max(scene.tolerance - out.promised, scene.tolerance / 2);
  double taken = 0;
  for (const OpenKnob& knob : open) {
    const ParamSpec& spec = knob.stage->params.specs[knob.param];
    const Point p = choose(spec.curve, room / 2 / double(open.size()));
    knob.stage->params.values[knob.param].keys = {{0, Value{.numbers = {p.value}}}};
    add({knob.stage->name + "." + spec.name, p.value, p.error, false});
    taken += p.error;
  }
  const Point p = choose(air, room - taken);
  add({"air", p.value, p.error, false});
  out.air = p.value;
  if (taken + p.error > room && !best_effort)
    throw Error(
        scene.path.empty() ? "scene" : scene.path.string(),
        fmt::format("tolerance = {:g} cannot be reached", scene.tolerance),
        fmt::format("the best here is {:.2g} ({})", out.promised, best_text(out.plans)));
  return out;
}

}  // namespace brume
