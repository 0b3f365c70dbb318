#include "truth/probe.h"

#include <tbb/parallel_for.h>

#include "pipeline/impl.h"

namespace brume::truth {

std::vector<double> mixes(const PreparedFrame& frame) {
  std::vector<double> weights;
  for (const RunningStage& stage : frame.impl().stages)
    weights.push_back(double(stage.mix));
  return weights;
}

std::vector<Answer> probe(const SceneFile& scene, Registry& registry, double frame,
                          std::span<const ProbeRay> rays, const Options& options) {
  const Session session(without_picture(scene), registry);
  std::vector<Answer> answers(rays.size());
  for (std::size_t begin = 0; begin < rays.size();) {
    std::size_t end = begin + 1;
    while (end < rays.size() && rays[end].origin == rays[begin].origin) ++end;
    const PreparedFrame prepared =
        session.prepare(probe_source(rays[begin].origin, frame));
    const std::vector<double> weights = mixes(prepared);
    Options one = options;
    one.weights = weights;
    one.only_stage = -1;
    const World& world = prepared.impl().world;
    tbb::parallel_for(begin, end, [&](std::size_t i) {
      answers[i] = along(world, rays[i].origin, rays[i].direction, rays[i].distance, one);
    });
    begin = end;
  }
  return answers;
}

}  // namespace brume::truth
