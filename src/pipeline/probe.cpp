#include "pipeline/probe.h"

#include <algorithm>
#include <numbers>

#include "pipeline/impl.h"

namespace brume {

SceneFile without_picture(SceneFile scene) {
  for (const char* name : {"color", "depth", "alpha", "position", "normal", "albedo"})
    if (const int i = scene.input.find(name); i >= 0)
      scene.input.values[std::size_t(i)] =
          Settings::defaults({scene.input.specs[std::size_t(i)]}).values.front();
  if (const int i = scene.output.find("aovs"); i >= 0)
    scene.output.values[std::size_t(i)] =
        Settings::defaults({scene.output.specs[std::size_t(i)]}).values.front();
  for (StageEntry& stage : scene.stages) stage.mask.clear();
  return scene;
}

FrameSource probe_source(const glm::dvec3& eye, double frame) {
  FrameSource source;
  source.frame = frame;
  source.name = "probe";
  source.header.data_window = source.header.display_window = {0, 0, 1, 1};
  for (const char* name : {"A", "B", "G", "N.X", "N.Y", "N.Z", "R", "Z"})
    source.header.channels.push_back({.name = name, .type = PixelType::float32});
  View view;
  view.projection = Projection::latlong;
  view.eye = eye;
  const double turn = kProbePixel / (2 * std::numbers::pi);
  view.corner = {-0.5 * turn, 0.5 * turn, 0};
  view.across = {turn, 0, 0};
  view.down = {0, -turn, 0};
  view.display = source.header.display_window;
  view.source = "the origin of a ray";
  source.view = view;
  return source;
}

namespace {

// Rays [from, to) of one origin.
void integrate(const PreparedFrame::Impl& f, std::span<const ProbeRay> rays,
               std::span<ProbeAnswer> out) {
  constexpr std::size_t kRun = 256;
  std::vector<std::vector<float>> mixes;
  std::vector<const float*> weights;
  if (f.any_weight)
    for (const RunningStage& stage : f.stages) {
      mixes.emplace_back(kRun, stage.mix);
      weights.push_back(mixes.back().data());
    }
  std::vector<float> plane(10 * kRun);
  float* const at = plane.data();
  const auto column = [&](std::size_t k) { return at + k * kRun; };
  for (std::size_t begin = 0; begin < rays.size(); begin += kRun) {
    const std::size_t n = std::min(kRun, rays.size() - begin);
    for (std::size_t i = 0; i < n; ++i) {
      const ProbeRay& ray = rays[begin + i];
      // Scaled first: the square of a direction's length may be beyond double.
      const glm::dvec3 a = glm::abs(ray.direction);
      const glm::dvec3 d = glm::normalize(ray.direction / std::max({a.x, a.y, a.z}));
      column(0)[i] = float(d.x);
      column(1)[i] = float(d.y);
      column(2)[i] = float(d.z);
      column(3)[i] = float(ray.distance);
    }
    RaySpans spans;
    spans.n = int(n);
    spans.dx = column(0);
    spans.dy = column(1);
    spans.dz = column(2);
    spans.t_end = column(3);
    f.air.integrate(
        spans, weights,
        {{column(4), column(5), column(6)}, {column(7), column(8), column(9)}, {}, {}});
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t c = 0; c < 3; ++c) {
        out[begin + i].T[c] = column(4 + c)[i];
        out[begin + i].L[c] = column(7 + c)[i];
      }
  }
}

}  // namespace

std::vector<ProbeAnswer> probe_rays(const SceneFile& scene, Registry& registry,
                                    double frame, std::span<const ProbeRay> rays) {
  const Session session(without_picture(scene), registry);
  std::vector<ProbeAnswer> answers(rays.size());
  const std::span<ProbeAnswer> out(answers);
  for (std::size_t begin = 0; begin < rays.size();) {
    std::size_t end = begin + 1;
    while (end < rays.size() && rays[end].origin == rays[begin].origin) ++end;
    const PreparedFrame prepared =
        session.prepare(probe_source(rays[begin].origin, frame));
    if (!prepared.impl().air.empty())
      integrate(prepared.impl(), rays.subspan(begin, end - begin),
                out.subspan(begin, end - begin));
    begin = end;
  }
  return answers;
}

}  // namespace brume
