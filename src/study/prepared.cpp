#include "study/prepared.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipeline/probe.h"
#include "stage/registry.h"

namespace brume::study {

namespace {

constexpr double kTolerances[] = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5};
constexpr double kFinest = 1e-6;

SceneFile with(const SceneFile& scene, Registry& registry,
               const std::vector<std::string>& set) {
  SceneFile out = scene;
  for (const std::string& s : set)
    brume::set(out, s, [&](const std::string& type, const Location& where) {
      return registry.specs(type, where);
    });
  return out;
}

// Knobs that the user set follow the tolerance again.
SceneFile finest_of(const SceneFile& scene, Registry& registry) {
  SceneFile out = with(scene, registry, {fmt::format("tolerance={:g}", kFinest)});
  for (StageEntry& stage : out.stages)
    for (std::size_t i = 0; i < stage.params.specs.size(); ++i)
      if (stage.params.specs[i].knob)
        stage.params.values[i] =
            brume::Settings::defaults({stage.params.specs[i]}).values.front();
  return out;
}

// What the frame's integrator is held to: less than the scene's tolerance, of which it
// makes but a part (air/curve.h). The finest goes beyond the curve.
double integrator_tolerance(const SceneFile& scene, const PreparedFrame& made) {
  double least = scene.tolerance;
  for (const KnobPlan& knob : made.plan().knobs)
    if (knob.name == "air") least = std::min(least, knob.value);
  return least;
}

}  // namespace

std::vector<double> values_along(const ParamSpec& spec) {
  std::vector<double> out;
  const double lo = spec.minimum, hi = spec.maximum;
  if (!std::isfinite(lo) || !std::isfinite(hi) || !(lo < hi)) return out;
  if (spec.kind == Kind::integer) {
    for (double v = std::max(lo, 1.); v < hi; v *= 2) out.push_back(std::round(v));
    out.push_back(hi);
  } else if (spec.kind == Kind::number) {
    const double from = std::max(lo, hi * 1e-7);
    for (double v = hi; v >= from * 0.999 && out.size() < 8; v /= 10) out.push_back(v);
    std::reverse(out.begin(), out.end());
  }
  return out;
}

Preparer::Preparer(const SceneFile& scene, Registry& registry, const FrameFiles& files)
    : scene_(scene), registry_(registry), files_(files) {}

Prepared Preparer::prepare(std::vector<std::string> set, std::string setting) const {
  Prepared p = prepare(with(scene_, registry_, set));
  p.setting = std::move(setting);
  p.set = std::move(set);
  return p;
}

Prepared Preparer::prepare(const SceneFile& scene) const {
  Prepared p;
  const auto session = std::make_shared<const Session>(scene, registry_);
  p.session = session;
  FrameSource source = files_.source({});
  source.best_effort = true;  // curves end where accuracy does
  const double begin = process_seconds();
  p.made = std::make_shared<const PreparedFrame>(session->prepare(source));
  const double first = process_seconds() - begin;
  p.tolerance = integrator_tolerance(scene, *p.made);
  // Again: what is left is what every frame of a sequence takes.
  const double again = process_seconds();
  (void)session->prepare(source);
  p.frame = process_seconds() - again;
  p.once = std::max(first - p.frame, 0.);
  return p;
}

std::vector<Prepared> Preparer::along_knobs() const {
  std::vector<Prepared> all;
  for (const double t : kTolerances)
    all.push_back(
        prepare({fmt::format("tolerance={:g}", t)}, fmt::format("tolerance {:g}", t)));
  for (const StageEntry& stage : scene_.stages) {
    if (!stage.enabled) continue;
    for (const ParamSpec& spec : stage.params.specs) {
      if (!spec.knob) continue;
      for (const double v : values_along(spec)) {
        all.push_back(prepare({fmt::format("{}.{}={:g}", stage.name, spec.name, v)},
                              fmt::format("{} {:g}", spec.name, v)));
        all.back().knob = stage.name + "." + spec.name;
      }
    }
  }
  return all;
}

Prepared Preparer::finest() const { return prepare(finest_of(scene_, registry_)); }

Prepared Preparer::finest_by_ray(const PreparedFrame& like, double frame) const {
  Prepared p;
  const SceneFile scene = without_picture(finest_of(scene_, registry_));
  const auto session = std::make_shared<const Session>(scene, registry_);
  FrameSource source = probe_source(like.impl().world.eye, frame);
  if (like.impl().view) source.view = like.impl().view;          // pixels as wide as its
  source.header.attributes = files_.main().header().attributes;  // its primaries
  source.best_effort = true;
  p.tolerance = kFinest;
  p.session = session;
  p.made = std::make_shared<const PreparedFrame>(session->prepare(source));
  return p;
}

}  // namespace brume::study
