// What a frame is made from: colour, coverage, depth, and what stages read.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "num/error.h"
#include "pipeline/preparation.h"

namespace brume {

void Preparation::choose_inputs() {
  if (f_->stages.empty()) return;
  // Colour: what is changed.
  const ChannelName layer = parse_channel(input_.color);
  const ColorNames color =
      find_color(list_.header(layer.file), layer.channel, list_.where(layer.file));
  const char* const kNames[] = {"colour red", "colour green", "colour blue"};
  for (int c = 0; c < 3; ++c)
    f_->color[c] = list_.add(layer.file, color.rgb[c], kNames[c]);
  decide(fmt::format("colour: {}, {}, {} ({})", color.rgb[0], color.rgb[1], color.rgb[2],
                     color.why));

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
    const std::string& mask = scene_.stages[std::size_t(s.plan)].mask;
    if (!mask.empty()) s.mask = list_.add(mask, "mask of " + plan.name);
    f_->any_weight = f_->any_weight || s.mask >= 0 || s.mix != 1;
    for (const std::string& c : s.needs.channels)
      s.channels.push_back(list_.add(c, "read by " + name_of(s)));
    for (const std::string& c : s.needs.optional)
      s.channels.push_back(list_.add_if_present(c, "read by " + name_of(s)));
    for (int c : s.channels)
      if (c >= 0) plan.reads.push_back(f_->inputs[std::size_t(c)].channel);
  }
}

void Preparation::choose_depth() {
  const bool wanted = std::any_of(f_->stages.begin(), f_->stages.end(),
                                  [](const RunningStage& s) { return s.needs.depth; });
  if (!wanted) return;
  if (!input_.position.empty()) {
    if (!f_->view)
      throw Error(
          source_.name, "a position pass needs the camera to become distances",
          "write one into the file (worldToCamera and worldToNDC), or give [camera]");
    const ChannelName p = parse_channel(input_.position);
    const auto names = find_vector(list_.header(p.file), p.channel, list_.where(p.file));
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

}  // namespace brume
