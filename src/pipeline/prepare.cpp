// Session::prepare: everything that is decided before a pixel is touched.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "num/error.h"
#include "pipeline/impl.h"
#include "pipeline/inputs.h"
#include "scene/coverage.h"
#include "scene/sun.h"
#include "stage/registry.h"

namespace brume {

struct Session::Impl {
  SceneFile scene;
  Registry* registry;
  mutable StageCache cache;
};

namespace {

/// One prepare: the steps share these.
class Preparation {
 public:
  Preparation(const SceneFile& scene, Registry& registry, StageCache& cache,
              const FrameSource& source)
      : scene_(scene),
        registry_(registry),
        cache_(cache),
        source_(source),
        f_(std::make_unique<PreparedFrame::Impl>()),
        list_(source, f_->inputs),
        input_(SceneFile::section<InputSection>(scene.input, source.frame)),
        output_(SceneFile::section<OutputSection>(scene.output, source.frame)) {
    f_->plan.frame = source.frame;
  }

  std::unique_ptr<PreparedFrame::Impl> run() {
    find_camera();
    describe_frame();
    create_stages();
    order_stages();
    choose_inputs();
    publish();
    choose_outputs();
    choose_one_pass();
    summarise();
    return std::move(f_);
  }

 private:
  void decide(std::string text) { f_->plan.decisions.push_back(std::move(text)); }

  void find_camera() {
    f_->view = source_.view
                   ? source_.view
                   : find_view(source_.header, scene_, source_.frame, source_.name);
    if (!f_->view) return decide("camera: none");
    decide("camera: " + f_->view->source);
    if (source_.scale_x != 1 || source_.scale_y != 1)
      f_->view = f_->view->scaled(source_.scale_x, source_.scale_y);
  }

  void describe_frame() {
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
    if (f_->view) {
      i.has_camera = true;
      i.eye = f_->view->eye;
      i.forward = f_->view->forward;
      i.pixel_footprint = f_->view->pixel_footprint();
    }
    i.display = source_.header.display_window;
    i.tolerance = scene_.tolerance;
    i.white = output_.white;
    if (const Attribute* c = attribute("chromaticities"))
      if (const auto xy = c->numbers(); xy && xy->size() == 8)
        std::copy(xy->begin(), xy->end(), i.chromaticities.begin());
    if (scene_.has_sun)
      i.sun = FrameInfo::Sun{direction_to_sun(sun, i.up),
                             {sun.irradiance.r, sun.irradiance.g, sun.irradiance.b}};
    f_->depth_rule = depth_rule(input_);
    f_->metres = input_.metres;
    f_->plate = input_.background == "plate";
    f_->background_distance = float(input_.background_distance);
  }

  /// Creates the stages and asks for their needs; what has nothing to do is left out
  /// here, with the reason.
  void create_stages() {
    for (const StageEntry& entry : scene_.stages) {
      StagePlan plan;
      plan.name = entry.name;
      plan.type = entry.type;
      const double mix = entry.mix.at(source_.frame).numbers[0];
      if (!entry.enabled)
        plan.reason = "enabled = false";
      else if (source_.frame < entry.first_frame || source_.frame > entry.last_frame)
        plan.reason = fmt::format("frame {} is outside frames {} to {}", source_.frame,
                                  entry.first_frame, entry.last_frame);
      else if (mix == 0)
        plan.reason = "mix is 0";
      if (plan.reason.empty()) {
        const StageType& type = registry_.find(entry.type, entry.where);
        plan.role = type.role;
        RunningStage stage;
        stage.instance =
            std::make_unique<StageInstance>(type, entry, source_.frame, cache_);
        stage.needs = stage.instance->needs(info_);
        stage.role = type.role;
        stage.step = type.step;
        stage.mix = float(mix);
        stage.plan = int(f_->plan.stages.size());
        plan.reason = stage.needs.idle;
        if (plan.reason.empty()) {
          plan.runs = true;
          plan.nearest = stage.needs.nearest, plan.farthest = stage.needs.farthest;
          const auto& s = stage.needs.screen;
          plan.screen = s[2] > 0 ? Window{s[0], s[1], s[2], s[3]} : Window{};
          if (!entry.mask.empty())
            stage.mask = list_.add(entry.mask, "mask of " + entry.name);
          f_->any_weight = f_->any_weight || stage.mask >= 0 || stage.mix != 1;
          f_->stages.push_back(std::move(stage));
        }
      }
      f_->plan.stages.push_back(std::move(plan));
    }
  }

  /// The scene file lists stages, light orders them.
  void order_stages() {
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

  const std::string& name_of(const RunningStage& s) const {
    return f_->plan.stages[std::size_t(s.plan)].name;
  }

  void choose_inputs() {
    if (f_->stages.empty()) return;
    // Colour: what is changed.
    const ChannelName layer = parse_channel(input_.color);
    const ColorNames color =
        find_color(list_.header(layer.file), layer.channel, list_.where(layer.file));
    const char* const kNames[] = {"colour red", "colour green", "colour blue"};
    for (int c = 0; c < 3; ++c)
      f_->color[c] = list_.add(layer.file, color.rgb[c], kNames[c]);
    decide(fmt::format("colour: {}, {}, {} ({})", color.rgb[0], color.rgb[1],
                       color.rgb[2], color.why));

    // Coverage.
    if (!f_->plate) {
      if (!input_.alpha.empty())
        f_->alpha = list_.add(input_.alpha, "coverage");
      else if (!color.alpha.empty())
        f_->alpha = list_.add(layer.file, color.alpha, "coverage");
      decide(f_->alpha >= 0 ? "coverage: " + f_->inputs[std::size_t(f_->alpha)].channel
                            : "coverage: no alpha; pixels with a depth are covered");
    } else {
      decide("background: a plate; its pixels at infinity are placed at " +
             (std::isinf(input_.background_distance)
                  ? std::string("infinity")
                  : fmt::format("{} m", input_.background_distance)));
    }

    choose_depth();
    for (RunningStage& s : f_->stages) {
      StagePlan& plan = f_->plan.stages[std::size_t(s.plan)];
      if (s.needs.camera && !f_->view)
        throw Error(
            source_.name,
            "no camera, and " + name_of(s) +
                " needs to know where in the world a pixel is",
            "write one into the file (worldToCamera and worldToNDC), or give [camera]");
      for (const std::string& c : s.needs.channels)
        s.channels.push_back(list_.add(c, "read by " + name_of(s)));
      for (const std::string& c : s.needs.optional)
        s.channels.push_back(list_.add_if_present(c, "read by " + name_of(s)));
      for (int c : s.channels)
        if (c >= 0) plan.reads.push_back(f_->inputs[std::size_t(c)].channel);
    }
  }

  void choose_depth() {
    const bool wanted = std::any_of(f_->stages.begin(), f_->stages.end(),
                                    [](const RunningStage& s) { return s.needs.depth; });
    if (!wanted) return;
    if (!input_.position.empty()) {
      if (!f_->view)
        throw Error(
            source_.name, "a position pass needs the camera to become distances",
            "write one into the file (worldToCamera and worldToNDC), or give [camera]");
      const ChannelName p = parse_channel(input_.position);
      const auto names =
          find_vector(list_.header(p.file), p.channel, list_.where(p.file));
      for (int c = 0; c < 3; ++c)
        f_->position[c] = list_.add(p.file, names[std::size_t(c)], "position");
      return decide("depth: from the positions " + names[0] + ", " + names[1] + ", " +
                    names[2]);
    }
    const std::string kind =
        fmt::format("{}, {} m per unit", input_.depth_kind, input_.metres);
    if (!input_.depth.empty()) {
      f_->depth = list_.add(input_.depth, "depth");
      decide("depth: " + input_.depth + " (" + kind + "): named in the scene");
    } else {
      const DepthChoice choice = find_depth(source_.header);
      if (choice.channel < 0) {
        std::string has;
        for (const Channel& c : source_.header.channels)
          has += (has.empty() ? "" : ", ") + c.name;
        throw Error(source_.name, "no depth channel",
                    "it has " + has +
                        "; name one with [input] depth = \"CHANNEL\" or "
                        "\"FILE:CHANNEL\"");
      }
      const std::string& name = source_.header.channels[std::size_t(choice.channel)].name;
      f_->depth = list_.add("", name, "depth");
      decide("depth: " + name + " (" + kind + "): " + choice.why);
    }
    if (!f_->view && input_.depth_kind != "distance")
      decide("depth: without a camera it is taken as the distance from the eye");
  }

  void publish() {
    f_->world.eye = info_.eye;
    f_->world.up = info_.up;
    for (std::size_t k = 0; k < f_->stages.size(); ++k) {
      RunningStage& s = f_->stages[k];
      const std::size_t before = f_->world.media.size();
      s.instance->publish(info_, int(k), f_->world);
      for (std::size_t m = before; m < f_->world.media.size(); ++m)
        s.is_sky = s.is_sky || f_->world.media[m].what.is_sky;
    }
    AirOptions options;
    options.tolerance = scene_.tolerance;
    options.white = output_.white;
    options.stages = int(f_->stages.size());
    f_->air = Air::compile(f_->world, options);
    f_->plan.air = f_->air.describe();
  }

  int add_output(const std::string& name, PixelType type) {
    f_->outputs.push_back({Channel{name, type}, source_.header.find(name) >= 0});
    return int(f_->outputs.size()) - 1;
  }
  OutputRgb add_layer(const std::string& name) {
    const PixelType type =
        output_.aov_type == "half" ? PixelType::half : PixelType::float32;
    const int r = add_output(name + ".R", type);
    add_output(name + ".G", type);
    add_output(name + ".B", type);
    return {r};
  }

  void choose_outputs() {
    f_->stage_L_out.resize(f_->stages.size());
    f_->stage_T_out.resize(f_->stages.size());
    const bool air = !f_->air.empty() || f_->air.has_background();
    const bool changes = air || f_->surface_end > 0 || f_->has_lens();
    if (changes) {
      // The picture is written where it was read, or as R, G, B where it came from
      // another file.
      const char* const kRgb[] = {"R", "G", "B"};
      for (int c = 0; c < 3; ++c) {
        const InputChannel& in = f_->inputs[std::size_t(f_->color[c])];
        const int k = source_.header.find(in.file.empty() ? in.channel : kRgb[c]);
        const int at = k >= 0 ? add_output(source_.header.channels[std::size_t(k)].name,
                                           source_.header.channels[std::size_t(k)].type)
                              : add_output(kRgb[c], PixelType::half);
        if (c == 0) f_->color_out.first = at;
      }
      const bool lens_alpha =
          std::any_of(f_->stages.begin(), f_->stages.end(),
                      [](const RunningStage& s) { return s.needs.changes_alpha; });
      if (f_->alpha >= 0 && output_.alpha == "over" && (air || lens_alpha)) {
        const InputChannel& in = f_->inputs[std::size_t(f_->alpha)];
        const int k = in.file.empty() ? source_.header.find(in.channel) : -1;
        f_->alpha_out = add_output(
            in.file.empty() ? in.channel : "A",
            k >= 0 ? source_.header.channels[std::size_t(k)].type : PixelType::half);
      }
    }
    for (const std::string& aov : output_.aovs) add_aov(aov);
    if (f_->surface_end > 0 && (f_->T_out.wanted() || f_->L_out.wanted()) &&
        !f_->S_out.wanted())
      f_->S_out = add_layer("S");
    if (output_.alpha == "keep") decide("alpha: kept");
  }

  void add_aov(const std::string& aov) {
    std::vector<std::string> known{"T", "L", "S"};
    for (const StageEntry& e : scene_.stages)
      for (const char* part : {".T", ".L"}) known.push_back(e.name + part);
    if (std::find(known.begin(), known.end(), aov) == known.end()) {
      const std::string near = nearest_name(aov, known);
      throw Error(scene_.path.empty() ? "scene" : scene_.path.string(),
                  "output.aovs: no layer " + aov,
                  near.empty() ? "there are T, L, S and for each stage NAME.T and NAME.L"
                               : "did you mean " + near + "?");
    }
    if (aov == "T") return void(f_->T_out = add_layer(aov));
    if (aov == "L") return void(f_->L_out = add_layer(aov));
    if (aov == "S") return void(f_->S_out = add_layer(aov));
    const std::string stage = aov.substr(0, aov.size() - 2);
    for (std::size_t k = 0; k < f_->stages.size(); ++k) {
      if (name_of(f_->stages[k]) != stage) continue;
      (aov.back() == 'T' ? f_->stage_T_out : f_->stage_L_out)[k] = add_layer(aov);
      f_->wants_shares = true;
      return;
    }
    // The stage is left out at this frame: its share is T = 1, L = 0, so that every frame
    // of a shot has the same layers.
    (aov.back() == 'T' ? f_->idle_T_out : f_->idle_L_out).push_back(add_layer(aov));
  }

  /// One fog over a perspective picture with planar depth, and no layers: one pass does
  /// it.
  void choose_one_pass() {
    const bool picture_only =
        f_->outputs.size() == (f_->alpha_out >= 0 ? 4u : 3u) && f_->color_out.wanted();
    if (f_->stages.size() != 1 || f_->air_end != 1 || f_->surface_end != 0 ||
        f_->any_weight || f_->plate || f_->depth < 0 || !picture_only || !f_->view ||
        f_->view->projection != Projection::perspective ||
        f_->depth_rule.kind != DepthKind::planar)
      return;
    f_->sole = f_->air.sole();
    f_->sole_depth = depth_constants(f_->depth_rule);
  }

  void summarise() {
    Plan& plan = f_->plan;
    for (RunningStage& s : f_->stages) {
      StagePlan& p = plan.stages[std::size_t(s.plan)];
      p.reason = s.role == BRUME_AIR    ? "in the air"
                 : s.role == BRUME_LENS ? "on the whole frame"
                                        : "on the surface";
      f_->around =
          s.role == BRUME_LENS ? -1
          : f_->around < 0
              ? -1
              : std::max({f_->around, s.needs.rows_around, s.needs.columns_around});
    }
    plan.whole_frame = f_->has_lens();
    if (f_->around >= 0 && f_->alpha >= 0 && (f_->depth >= 0 || f_->position[0] >= 0))
      f_->around = std::max(f_->around, kCoverageReach);
    plan.changes_nothing = !f_->color_out.wanted();
    for (const InputChannel& in : f_->inputs)
      plan.channels_read.push_back((in.file.empty() ? "" : in.file + ":") + in.channel);
    for (const OutputChannel& out : f_->outputs)
      plan.channels_written.push_back(out.channel.name);
    for (const Channel& c : source_.header.channels) {
      const bool read =
          std::any_of(f_->inputs.begin(), f_->inputs.end(), [&](const InputChannel& in) {
            return in.file.empty() && in.channel == c.name;
          });
      if (!read) plan.channels_left.push_back(c.name);
    }
    // Where something can change: the union of what the stages said.
    bool everywhere = !f_->outputs.empty() && f_->stages.empty();
    for (const RunningStage& s : f_->stages) {
      const Window& w = plan.stages[std::size_t(s.plan)].screen;
      everywhere = everywhere || w.empty();
      plan.active = plan.active.empty() ? w : unite(plan.active, w);
    }
    if (everywhere) plan.active = Window{};
  }

  const SceneFile& scene_;
  Registry& registry_;
  StageCache& cache_;
  const FrameSource& source_;
  std::unique_ptr<PreparedFrame::Impl> f_;
  InputList list_;
  InputSection input_;
  OutputSection output_;
  FrameInfo info_;
};

}  // namespace

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
