#include "stress/shown.h"

#include <cmath>

#include "pipeline/rows.h"
#include "truth/truth.h"

namespace brume::stress {

Shown::Shown(const World& w, const AirOptions& o) {
  frame_.world = w;
  sort_lights(frame_.world);  // as the pipeline does
  frame_.air = Air::compile(frame_.world, o);
  fast_ = truth_ = world_for_stages(frame_);
  truth_.transmittance = [](const brume_world* of, const brume_rays* rays,
                            const float* t1, float* const T[3]) {
    const World& there = static_cast<const PreparedFrame::Impl*>(of->context)->world;
    for (std::size_t i = 0; i < rays->n; ++i) {
      glm::dvec3 from = there.eye;
      if (rays->ox) from += glm::dvec3(rays->ox[i], rays->oy[i], rays->oz[i]);
      const truth::Rgb tau = truth::optical_depth(
          there, from, {rays->dx[i], rays->dy[i], rays->dz[i]}, double(t1[i]));
      for (std::size_t c = 0; c < 3; ++c) T[c][i] = float(std::exp(-tau[c]));
    }
  };
}

}  // namespace brume::stress
