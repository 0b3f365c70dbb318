#include "study/sheet.h"

#include <algorithm>

#include "pipeline/proxy.h"
#include "pipeline/rows.h"
#include "stage/registry.h"

namespace brume::study {

std::vector<float> Sheet::lay(const std::vector<float>& plane) const {
  std::vector<float> out;
  if (plane.empty()) return out;
  out.resize(std::size_t(stride * (height + 2 * around)));
  for (int y = -around; y < height + around; ++y)
    for (int x = -around; x < width + around; ++x)
      out[at(x, y)] =
          plane[std::size_t(std::clamp(y, 0, height - 1)) * std::size_t(width) +
                std::size_t(std::clamp(x, 0, width - 1))];
  return out;
}

brume_tile Sheet::tile(const brume_world* world) {
  const std::size_t first = at(0, 0);
  const auto plane = [&](std::vector<float>& v) {
    return v.empty() ? nullptr : v.data() + first;
  };
  channels_at.clear();
  for (auto& c : channels) channels_at.push_back(plane(c));
  brume_tile tile{};
  tile.size = sizeof tile;
  tile.width = width, tile.height = height;
  tile.row_stride = stride;
  tile.r = plane(rgb[0]), tile.g = plane(rgb[1]), tile.b = plane(rgb[2]);
  tile.a = plane(alpha);
  tile.distance = plane(t);
  tile.dx = plane(d[0]), tile.dy = plane(d[1]), tile.dz = plane(d[2]);
  tile.ox = plane(o[0]), tile.oy = plane(o[1]), tile.oz = plane(o[2]);
  tile.channels = channels_at.data();
  tile.world = world;
  return tile;
}

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
  s.width = data.width, s.height = data.height;
  s.around = std::max(stage.needs.rows_around, stage.needs.columns_around);
  s.stride = s.width + 2 * s.around;
  const std::size_t n = s.pixels();
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
