// Session::prepare: everything that is decided before a pixel is touched.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "num/error.h"
#include "pipeline/preparation.h"
#include "scene/sun.h"

namespace brume {

struct Session::Impl {
  SceneFile scene;
  Registry* registry;
  mutable StageCache cache;
};

void Preparation::find_camera() {
  f_->view = source_.view
                 ? source_.view
                 : find_view(source_.header, scene_, source_.frame, source_.name);
  if (!f_->view) return decide("camera: none");
  decide("camera: " + f_->view->source);
  if (source_.scale_x != 1 || source_.scale_y != 1)
    f_->view = f_->view->scaled(source_.scale_x, source_.scale_y);
}

void Preparation::describe_frame() {
  const auto sun = SceneFile::section<SunSection>(scene_.sun, source_.frame);
  const auto time = SceneFile::section<TimeSection>(scene_.time, source_.frame);
  const auto attribute = [&](const char* name) {
    const auto it = source_.header.attributes.find(name);
    return it == source_.header.attributes.end() ? nullptr : &it->second;
  };
  FrameInfo& i = info_;
  i.frame = source_.frame;
  const Attribute* fps = attribute("framesPerSecond");
  i.fps = time.fps > 0                           ? time.fps
          : fps && fps->number().value_or(0) > 0 ? *fps->number()
                                                 : 24;
  i.time = (i.frame - time.origin) / i.fps;
  i.up = world_up(input_);
  if (f_->view) i.look(*f_->view);
  i.display = source_.header.display_window;
  i.tolerance = scene_.tolerance;
  i.white = output_.white;
  if (const Attribute* c = attribute("chromaticities"))
    if (const auto xy = c->numbers(); xy && xy->size() == 8)
      std::copy(xy->begin(), xy->end(), i.chromaticities.begin());
  if (scene_.has_sun)
    i.sun = FrameInfo::Sun{
        direction_to_sun(sun, i.up),
        to_frame(scene_.colorspace, i.chromaticities,
                 glm::dvec3(sun.irradiance.r, sun.irradiance.g, sun.irradiance.b))};
  for (const Channel& c : source_.header.channels) i.channels.push_back(c.name);
  f_->depth_rule = depth_rule(input_);
  f_->metres = input_.metres;
  f_->plate = input_.background == "plate";
  f_->background_distance = float(input_.background_distance);
}

/// Why a stage has nothing to do at this frame, whatever it is; or "".
std::string Preparation::left_out(const StageEntry& entry) const {
  if (!entry.enabled) return "enabled = false";
  if (source_.frame < entry.first_frame || source_.frame > entry.last_frame)
    return fmt::format("frame {} is outside frames {} to {}", source_.frame,
                       entry.first_frame, entry.last_frame);
  return entry.mix.at(source_.frame).numbers[0] == 0 ? "mix is 0" : "";
}

/// What a stage is told.
FrameInfo Preparation::told(const RunningStage& stage) const {
  FrameInfo info = info_;
  info.mix = stage.mix;
  return info;
}

/// A stage at its values of this frame, and what it needs.
RunningStage Preparation::make(const StageEntry& entry) {
  const StageType& type = registry_.find(entry.type, entry.where);
  RunningStage stage;
  std::vector<Value> values = entry.params.at(source_.frame);
  to_frame(scene_.colorspace, info_.chromaticities, entry.params.specs, values);
  stage.instance =
      std::make_unique<StageInstance>(type, entry.name, values, cache_, entry.where);
  stage.mix = float(entry.mix.at(source_.frame).numbers[0]);
  stage.needs = stage.instance->needs(told(stage));
  stage.role = type.role;
  stage.step = type.step;
  return stage;
}

/// Creates the stages and asks for their needs; what has nothing to do is left out
/// here, with the reason. Those without a knob first: what they promise the others must
/// leave them.
void Preparation::create_stages() {
  std::vector<StageEntry> in_play;
  std::vector<std::optional<RunningStage>> made;
  std::vector<KnobPlan> fixed;
  for (const StageEntry& entry : scene_.stages) {
    if (!left_out(entry).empty()) continue;
    in_play.push_back(entry);
    auto& stage = made.emplace_back();
    if (std::ranges::any_of(entry.params.specs, &ParamSpec::knob)) continue;
    stage = make(entry);
    if (stage->needs.idle.empty() && stage->needs.promise > 0)
      fixed.push_back({entry.name, 0, stage->needs.promise, false, true});
  }
  knobs_ = set_knobs(scene_, std::move(in_play), source_.best_effort, air_curve(),
                     std::move(fixed));
  std::size_t next = 0;
  for (const StageEntry& given : scene_.stages) {
    StagePlan plan;
    plan.name = given.name;
    plan.type = given.type;
    plan.reason = left_out(given);
    if (plan.reason.empty()) {
      const std::size_t k = next++;
      RunningStage stage = made[k] ? std::move(*made[k]) : make(knobs_.stages[k]);
      plan.role = stage.role;
      stage.plan = int(f_->plan.stages.size());
      plan.reason = stage.needs.idle;
      if (plan.reason.empty()) {
        plan.runs = true;
        plan.nearest = stage.needs.nearest, plan.farthest = stage.needs.farthest;
        const auto& s = stage.needs.screen;
        plan.screen = s[2] > 0 ? Window{s[0], s[1], s[2], s[3]} : Window{};
        if (stage.needs.camera && !f_->view)
          throw Error(source_.name,
                      "no camera, and " + plan.name +
                          " needs to know where in the world a pixel is",
                      "write one into the file (worldToCamera and worldToNDC), or give "
                      "[camera]");
        f_->stages.push_back(std::move(stage));
      }
    }
    f_->plan.stages.push_back(std::move(plan));
  }
}

/// The scene file lists stages, light orders them.
void Preparation::order_stages() {
  std::stable_sort(f_->stages.begin(), f_->stages.end(),
                   [](const RunningStage& a, const RunningStage& b) {
                     if (a.role != b.role) return a.role < b.role;
                     return a.role == BRUME_SURFACE && a.step < b.step;
                   });
  const auto count = [&](brume_role r) {
    return int(std::count_if(f_->stages.begin(), f_->stages.end(),
                             [&](const RunningStage& s) { return s.role <= r; }));
  };
  f_->surface_end = count(BRUME_SURFACE);
  f_->air_end = count(BRUME_AIR);
}

namespace {

// "lamp or sun", of the kinds in `bits`.
std::string names_of_lights(std::uint32_t bits) {
  std::string out;
  const auto add = [&](std::uint32_t of, const char* name) {
    if (bits & of) out += (out.empty() ? "" : " or ") + std::string(name);
  };
  add(BRUME_LIGHT_BIT(BRUME_POINT) | BRUME_LIGHT_BIT(BRUME_SPOT), "lamp");
  add(BRUME_LIGHT_BIT(BRUME_SUN), "sun");
  add(BRUME_LIGHT_BIT(BRUME_SKY_LIGHT), "sky light");
  return out.empty() ? "light of that kind" : out;
}

}  // namespace

void Preparation::publish() {
  f_->world.eye = info_.eye;
  f_->world.up = info_.up;
  for (std::size_t k = 0; k < f_->stages.size(); ++k) {
    RunningStage& s = f_->stages[k];
    const std::size_t before = f_->world.media.size(),
                      backgrounds = f_->world.backgrounds.size();
    s.instance->publish(told(s), int(k), f_->world);
    for (std::size_t m = before; m < f_->world.media.size(); ++m)
      s.is_sky = s.is_sky || f_->world.media[m].what.is_sky;
    s.fills = s.is_sky || f_->world.backgrounds.size() > backgrounds;
    f_->own_background = f_->own_background || s.fills;
  }
  sort_lights(f_->world);
}

/// Surface stages that answer to lights which nobody published have nothing to do. What
/// is left takes their numbers.
void Preparation::leave_out_unlit() {
  World& w = f_->world;
  const auto published_by = [](int k) {
    return [k](const auto& p) { return p.stage == k; };
  };
  const auto any_by = [&](int k) {
    const auto by = published_by(k);
    return std::ranges::any_of(w.media, by) || std::ranges::any_of(w.lights, by) ||
           std::ranges::any_of(w.shadowers, by) ||
           std::ranges::any_of(w.interfaces, by) ||
           std::ranges::any_of(w.backgrounds, by);
  };
  for (int k = f_->surface_end - 1; k >= 0; --k) {
    const RunningStage& s = f_->stages[std::size_t(k)];
    const bool lit = std::ranges::any_of(w.lights, [&](const auto& l) {
      return (s.needs.lights & BRUME_LIGHT_BIT(l.what.kind)) != 0;
    });
    if (s.needs.lights == 0 || lit || any_by(k)) continue;
    StagePlan& plan = f_->plan.stages[std::size_t(s.plan)];
    plan.runs = false;
    plan.reason = "no lights: the scene has no " + names_of_lights(s.needs.lights);
    f_->stages.erase(f_->stages.begin() + k);
    --f_->surface_end, --f_->air_end;
    const auto renumber = [k](auto& list) {
      for (auto& p : list) p.stage -= p.stage > k;
    };
    renumber(w.media), renumber(w.lights), renumber(w.shadowers);
    renumber(w.interfaces), renumber(w.backgrounds);
  }
}

void Preparation::compile_air() {
  const auto& lights = f_->world.lights;
  const bool sky = std::any_of(lights.begin(), lights.end(), [](const auto& l) {
    return l.what.kind == BRUME_SUN || l.what.kind == BRUME_SKY_LIGHT;
  });
  for (const auto& m : f_->world.media)
    if (m.what.source == BRUME_SOURCE_SKY && !sky) {
      const RunningStage& s = f_->stages[std::size_t(m.stage)];
      throw Error(scene_.stages[std::size_t(s.plan)].where.text(),
                  m.name + " takes its colour from the sky, and no stage makes one here",
                  "add a [[stage]] of type \"sky\", or give it a color");
    }
  AirOptions options;
  options.tolerance = knobs_.air;
  options.white = output_.white;
  options.stages = int(f_->stages.size());
  f_->air = Air::compile(f_->world, options);
  f_->plan.air = f_->air.describe();
  report_knobs();
}

// Of the stages that run, and of the integrator where there is air.
void Preparation::report_knobs() {
  Plan& plan = f_->plan;
  plan.tolerance = scene_.tolerance;
  for (const KnobPlan& k : knobs_.plans) {
    const auto turns_it = [&](const StagePlan& s) {
      return s.runs && (k.none ? k.name == s.name : k.name.starts_with(s.name + "."));
    };
    const bool counts = k.name == "air" && !k.none
                            ? !f_->air.empty()
                            : std::ranges::any_of(plan.stages, turns_it);
    if (!counts) continue;
    plan.promised += k.promised;
    plan.knobs.push_back(k);
  }
}

Session::Session(SceneFile scene, Registry& registry) : impl_(std::make_unique<Impl>()) {
  impl_->scene = std::move(scene);
  impl_->registry = &registry;
}
Session::~Session() = default;

const SceneFile& Session::scene() const { return impl_->scene; }
Registry& Session::registry() const { return *impl_->registry; }

PreparedFrame Session::prepare(const FrameSource& source) const {
  return PreparedFrame(
      Preparation(impl_->scene, *impl_->registry, impl_->cache, source).run());
}

PreparedFrame::PreparedFrame(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PreparedFrame::PreparedFrame(PreparedFrame&&) noexcept = default;
PreparedFrame& PreparedFrame::operator=(PreparedFrame&&) noexcept = default;
PreparedFrame::~PreparedFrame() = default;

const Plan& PreparedFrame::plan() const { return impl_->plan; }
std::span<const InputChannel> PreparedFrame::inputs() const { return impl_->inputs; }
std::span<const OutputChannel> PreparedFrame::outputs() const { return impl_->outputs; }
int PreparedFrame::around() const { return impl_->around; }

}  // namespace brume
