#include "study/sheet.h"

#include <algorithm>

#include "pipeline/proxy.h"
#include "pipeline/rows.h"
#include "stage/registry.h"

namespace brume::study {

const RunningStage* find_stage(const Prepared& p, const std::string& name) {
  const PreparedFrame::Impl& f = p.impl();
  for (std::size_t k = 0; k < f.stages.size(); ++k)
    if (stage_name(f, k) == name) return &f.stages[k];
  return nullptr;
}

namespace {

// The picture that a lens stage is given: everything before it applied.
Image before_lens(const std::string& name, const SceneFile& scene, Registry& registry,
                  const FrameFiles& files) {
  SceneFile less = scene;
  less.stages.clear();
  bool found = false;
  for (const StageEntry& s : scene.stages) {
    found = found || s.name == name;
    if (!found || registry.find(s.type).role != BRUME_LENS) less.stages.push_back(s);
  }
  FrameReport ignored;
  const ApplyOptions whole;
  FrameSource source = files.source(whole);
  source.best_effort = true;
  return render_part(Session(less, registry).prepare(source), files, whole, ignored);
}

}  // namespace

std::optional<Sheet> sheet_of(const Context& c, const RunningStage& stage,
                              const std::string& name, const SceneFile& scene,
                              Registry& registry, const FrameFiles& files,
                              std::string& why_not) {
  const PreparedFrame::Impl& f = c.given.impl();
  const Window data = files.main().header().data_window;
  Sheet s;
  s.x = data.x, s.y = data.y;
  s.resize(data.width, data.height,
           std::max(stage.needs.rows_around, stage.needs.columns_around));
  const auto n = std::size_t(s.size());
  if (c.rays.count != n) {
    why_not = "the frame is too large to study what its pixels do to each other";
    return {};
  }
  std::vector<float> rgb[3], alpha(n, 1.f);
  if (stage.role == BRUME_LENS) {
    const Image image = before_lens(name, scene, registry, files);
    for (std::size_t k = 0; k < 3; ++k) {
      const int at = f.color[k] < 0
                         ? -1
                         : image.header.find(f.inputs[std::size_t(f.color[k])].channel);
      if (at < 0) {
        why_not = "the frame has no colour";
        return {};
      }
      const auto plane = image.plane(at);
      rgb[k].assign(plane.begin(), plane.end());
    }
  } else {
    for (int k = 0; k < 3; ++k)
      rgb[k].assign(c.rays.S[k].begin(), c.rays.S[k].begin() + std::ptrdiff_t(n));
  }
  if (f.alpha >= 0) alpha = files.read_all(f.inputs[std::size_t(f.alpha)], data, false);
  for (int k = 0; k < 3; ++k) s.rgb[k] = s.lay(rgb[k]);
  s.alpha = s.lay(alpha);
  if (stage.role == BRUME_SURFACE) {
    s.t = s.lay(c.rays.t);
    for (int k = 0; k < 3; ++k) s.d[k] = s.lay(c.rays.d[k]), s.o[k] = s.lay(c.rays.o[k]);
  }
  for (const int channel : stage.channels)
    s.channels.push_back(
        channel < 0 ? std::vector<float>()
                    : s.lay(files.read_all(f.inputs[std::size_t(channel)], data, false)));
  return s;
}

}  // namespace brume::study
