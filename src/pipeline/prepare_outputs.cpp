// What a frame becomes: the picture, its coverage, layers; and what the plan says at the
// end.

#include <algorithm>

#include "num/error.h"
#include "pipeline/preparation.h"
#include "scene/coverage.h"

namespace brume {

int Preparation::add_output(const std::string& name, PixelType type) {
  f_->outputs.push_back({Channel{name, type}, source_.header.find(name) >= 0});
  return int(f_->outputs.size()) - 1;
}
OutputRgb Preparation::add_layer(const std::string& name) {
  const PixelType type =
      output_.aov_type == "half" ? PixelType::half : PixelType::float32;
  const int r = add_output(name + ".R", type);
  add_output(name + ".G", type);
  add_output(name + ".B", type);
  return {r};
}

void Preparation::choose_outputs() {
  f_->stage_L_out.resize(f_->stages.size());
  f_->stage_T_out.resize(f_->stages.size());
  f_->stage_added_out.resize(f_->stages.size());
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

void Preparation::add_aov(const std::string& aov) {
  std::vector<std::string> known{"T", "L", "S"};
  for (const StageEntry& e : scene_.stages)
    for (const char* part : {"", ".T", ".L"}) known.push_back(e.name + part);
  if (std::find(known.begin(), known.end(), aov) == known.end()) {
    const std::string near = nearest_name(aov, known);
    throw Error(scene_.path.empty() ? "scene" : scene_.path.string(),
                "output.aovs: no layer " + aov,
                near.empty() ? "there are T, L, S, for each stage of the air NAME.T and "
                               "NAME.L, and for one of surface or lens NAME"
                             : "did you mean " + near + "?");
  }
  if (aov == "T") return void(f_->T_out = add_layer(aov));
  if (aov == "L") return void(f_->L_out = add_layer(aov));
  if (aov == "S") return void(f_->S_out = add_layer(aov));
  const std::size_t dot = aov.rfind('.');
  const std::string stage = aov.substr(0, dot);
  const bool whole = dot == std::string::npos;  // all that a stage adds
  const bool is_T = aov.back() == 'T' && !whole;
  for (std::size_t k = 0; k < f_->stages.size(); ++k) {
    if (name_of(f_->stages[k]) != stage) continue;
    if (whole == (f_->stages[k].role == BRUME_AIR))
      throw Error(scene_.path.empty() ? "scene" : scene_.path.string(),
                  "output.aovs: " + stage + " is " +
                      (whole ? "in the air" : "no stage of the air"),
                  "write " + stage + (whole ? ".T or " + stage + ".L" : ""));
    f_->wants_shares = f_->wants_shares || !whole;
    (whole  ? f_->stage_added_out
     : is_T ? f_->stage_T_out
            : f_->stage_L_out)[k] = add_layer(aov);
    return;
  }
  // The stage is left out at this frame: its share is T = 1, L = 0, so that every frame
  // of a shot has the same layers.
  (is_T ? f_->idle_T_out : f_->idle_L_out).push_back(add_layer(aov));
}

/// One fog over a perspective picture with planar depth, and no layers: one pass does
/// it.
void Preparation::choose_one_pass() {
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

// Which rays can meet media at all. A picture of the background, or stages on surfaces,
// need every pixel.
void Preparation::find_extent() {
  if (!f_->view || f_->air_end == 0 || f_->surface_end > 0 || f_->own_background ||
      !f_->world.interfaces.empty())
    return;
  Extent extent(source_.header.data_window);
  std::vector<Window> of_stage(f_->stages.size());
  for (const auto& m : f_->world.media) {
    const auto w = extent.add(m.what, *f_->view);
    if (!w) return;
    Window& all = of_stage[std::size_t(m.stage)];
    all = unite(all, *w);
  }
  for (int k = 0; k < f_->air_end; ++k) {
    StagePlan& p = f_->plan.stages[std::size_t(f_->stages[std::size_t(k)].plan)];
    if (p.screen.empty()) p.screen = of_stage[std::size_t(k)];
  }
  f_->extent = std::move(extent);
}

/// What the compression of an EXR would make of the channels that are packed anew.
void Preparation::note_losses() {
  const Compression compression = output_.compression.empty()
                                      ? source_.header.compression
                                      : *compression_from(output_.compression);
  std::vector<Channel> packed;
  if (!f_->outputs.empty()) packed = source_.header.channels;
  for (const OutputChannel& out : f_->outputs)
    if (!out.changed) packed.push_back(out.channel);
  std::string names;
  for (const Channel& c : packed) {
    if (!is_lossy(compression, c)) continue;
    names += (names.empty() ? "" : ", ") + c.name;
    if (source_.header.find(c.name) < 0) f_->plan.lossy_layers.push_back(c.name);
  }
  if (names.empty()) return;
  decide(std::string("compression: ") + name(compression) + " (" +
         (output_.compression.empty() ? "the file's" : "[output]") +
         ") loses a little of " + names +
         " where a pixel changes; output.compression = \"zip\" loses nothing");
}

void Preparation::summarise() {
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
    f_->around += kCoverageReach;  // each pixel that is looked at looks for its own
  plan.changes_nothing = !f_->color_out.wanted();
  for (const InputChannel& in : f_->inputs)
    plan.channels_read.push_back((in.file.empty() ? "" : in.file + ":") + in.channel);
  for (const OutputChannel& out : f_->outputs)
    plan.channels_written.push_back(out.channel.name);
  for (const Channel& c : source_.header.channels) {
    const bool read = std::any_of(
        f_->inputs.begin(), f_->inputs.end(),
        [&](const InputChannel& in) { return in.file.empty() && in.channel == c.name; });
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
  if (f_->extent && !f_->has_lens()) plan.active = f_->extent->bounds();
}

}  // namespace brume
