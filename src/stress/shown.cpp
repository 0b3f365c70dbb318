#include "stress/shown.h"

#include "pipeline/rows.h"

namespace brume::stress {
namespace {

PreparedFrame::Impl frame_of(const World& w, const AirOptions& o) {
  PreparedFrame::Impl f;
  f.world = w;
  sort_lights(f.world);  // as the pipeline does
  f.air = Air::compile(f.world, o);
  return f;
}

}  // namespace

Shown::Shown(const World& w, const AirOptions& o)
    : frame_(frame_of(w, o)), fast_(world_for_stages(frame_)), truth_(frame_.world) {}

}  // namespace brume::stress
