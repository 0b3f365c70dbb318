#pragma once
// What Session::prepare leaves behind for the pixels: internal to src/pipeline.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "air/air.h"
#include "pipeline/extent.h"
#include "pipeline/pipeline.h"
#include "scene/depth_run.h"
#include "stage/instance.h"

namespace brume {

/// A stage that runs at this frame.
struct RunningStage {
  std::unique_ptr<StageInstance> instance;
  StageNeeds needs;
  brume_role role = BRUME_AIR;
  brume_surface_step step = BRUME_BACKGROUND_STEP;
  int plan = 0;   ///< index into Plan::stages
  int mask = -1;  ///< index into inputs, or none
  float mix = 1;
  std::vector<int> channels;  ///< inputs for run, -1 where an optional one is missing
  bool is_sky = false;        ///< publishes the sky: not before a plate
  bool fills = false;         ///< brings what lies behind everything: a sky, a background
};

/// Three planes of an AOV in the outputs, -1 where not wanted.
struct OutputRgb {
  int first = -1;
  bool wanted() const { return first >= 0; }
};

struct PreparedFrame::Impl {
  Plan plan;
  std::vector<InputChannel> inputs;
  std::vector<OutputChannel> outputs;

  // Where things are among the inputs.
  int color[3] = {-1, -1, -1};
  int alpha = -1, depth = -1, position[3] = {-1, -1, -1};

  // Where things go among the outputs.
  OutputRgb color_out, T_out, L_out, S_out;
  int alpha_out = -1;
  std::vector<OutputRgb> stage_L_out, stage_T_out;  ///< by stage (index into `stages`)
  std::vector<OutputRgb> stage_added_out;           ///< by stage; not of the air's
  std::vector<OutputRgb> idle_L_out, idle_T_out;    ///< of stages left out: 0 and 1

  std::optional<View> view;
  DepthRule depth_rule;
  double metres = 1;
  bool plate = false;
  float background_distance = 0;

  std::vector<RunningStage>
      stages;  ///< that run; surface first, in light's order, then air, then lens
  int surface_end = 0,
      air_end =
          0;  ///< stages[0, surface_end) surface, [surface_end, air_end) air, then lens
  World world;
  Air air;
  bool own_background = false;  ///< some stage `fills`: pixels end up full
  bool any_weight = false;      ///< some air stage has a mask or mix < 1
  bool wants_shares = false;    ///< some per-stage AOV is asked for

  bool has_lens() const { return air_end < int(stages.size()); }
  int around = 0;

  /// Where the air can matter, where that is not everywhere: other pixels stay as they
  /// are. Only set where all that runs but the lens is air.
  std::optional<Extent> extent;

  /// Set where one fog is all there is to do: pixels then take one pass (sole.h).
  std::optional<SoleMedium> sole;
  DepthConstants sole_depth;
};

}  // namespace brume
