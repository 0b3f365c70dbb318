#include "study/rays.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace brume::study {

namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

// Rays and distances of one row, as RowWorker has them.
void read_row(const PreparedFrame::Impl& f, const Window& w, int y,
              std::span<const std::vector<float>> in, Rays& rays, std::size_t at) {
  const int n = w.width;
  std::vector<float> origin[3], per_planar(std::size_t(n), 1.0f);
  for (auto& plane : origin) plane.assign(std::size_t(n), 0.0f);
  float* const d[3] = {&rays.d[0][at], &rays.d[1][at], &rays.d[2][at]};
  const RaySpan span{
      origin[0].data(), origin[1].data(), origin[2].data(), d[0], d[1], d[2],
      per_planar.data()};
  if (f.view) {
    if (!fill_rays(*f.view, w.x, y, n, span))
      for (int c = 0; c < 3; ++c)
        std::copy(origin[c].begin(), origin[c].end(), &rays.o[c][at]);
  } else {
    std::fill_n(d[0], n, 0.0f), std::fill_n(d[1], n, 1.0f), std::fill_n(d[2], n, 0.0f);
  }
  float* const t = &rays.t[at];
  const auto input = [&](int k) { return in[std::size_t(k)].data(); };
  if (f.position[0] >= 0)
    distances_from_position(*f.view, f.metres, n, input(f.position[0]),
                            input(f.position[1]), input(f.position[2]),
                            f.alpha >= 0 ? input(f.alpha) : nullptr, span, t);
  else if (f.depth >= 0)
    distances_from_depth(f.depth_rule, n, input(f.depth), per_planar.data(), t);
  else
    std::fill_n(t, n, kInf);
  for (std::size_t k = 0; k < f.stages.size(); ++k) {
    if (rays.weights[k].empty()) continue;
    const RunningStage& stage = f.stages[k];
    for (int i = 0; i < n; ++i) {
      const float m = stage.mask >= 0 ? input(stage.mask)[i] : 1;
      const bool behind = f.plate && stage.is_sky && t[i] == kInf;
      rays.weights[k][at + std::size_t(i)] =
          behind ? 0 : std::clamp(std::isnan(m) ? 0 : m, 0.0f, 1.0f) * stage.mix;
    }
  }
  if (f.plate)
    for (int i = 0; i < n; ++i)
      if (t[i] == kInf) t[i] = f.background_distance;
  for (std::size_t c = 0; c < 3; ++c)
    if (f.color[c] >= 0) std::copy_n(input(f.color[c]), n, &rays.S[c][at]);
  for (int i = 0; i < n; ++i) {
    rays.x[at + std::size_t(i)] = w.x + i;
    rays.y[at + std::size_t(i)] = y;
  }
}

}  // namespace

Rays Rays::pick(std::span<const std::uint32_t> indices) const {
  const auto chosen = [&](const auto& from) {
    std::decay_t<decltype(from)> out;
    if (from.empty()) return out;
    out.reserve(indices.size() + 16);
    for (const std::uint32_t i : indices) out.push_back(from[i]);
    return out;
  };
  Rays r;
  r.count = indices.size();
  for (std::size_t c = 0; c < 3; ++c) {
    r.o[c] = chosen(o[c]);
    r.d[c] = chosen(d[c]);
    r.S[c] = chosen(S[c]);
  }
  r.t = chosen(t);
  r.x = chosen(x);
  r.y = chosen(y);
  for (const auto& w : weights) r.weights.push_back(chosen(w));
  r.pad();
  return r;
}

void Rays::pad() {
  const auto grow = [&](auto& plane) {
    if (!plane.empty()) plane.resize((count + 15) / 16 * 16, plane[count - 1]);
  };
  for (std::size_t c = 0; c < 3; ++c) grow(o[c]), grow(d[c]), grow(S[c]);
  grow(t), grow(x), grow(y);
  for (auto& w : weights) grow(w);
}

RaySpans Rays::spans(std::size_t begin, std::size_t n,
                     std::vector<const float*>& w) const {
  RaySpans s;
  s.n = int(n);
  if (!o[0].empty()) s.ox = &o[0][begin], s.oy = &o[1][begin], s.oz = &o[2][begin];
  s.dx = &d[0][begin], s.dy = &d[1][begin], s.dz = &d[2][begin];
  s.t_end = &t[begin];
  w.clear();
  for (const auto& plane : weights)
    w.push_back(plane.empty() ? nullptr : plane.data() + begin);
  return s;
}

Rays read_rays(const PreparedFrame::Impl& f, const FrameFiles& files, int step) {
  const Window data = files.main().header().data_window;
  const int rows = (data.height + step - 1) / step;
  const std::size_t n = std::size_t(rows) * std::size_t(data.width);
  Rays rays;
  rays.count = n;
  for (std::size_t c = 0; c < 3; ++c) {
    if (f.view && f.view->projection == Projection::orthographic) rays.o[c].resize(n);
    rays.d[c].resize(n);
    rays.S[c].resize(n);
  }
  rays.t.resize(n);
  rays.x.resize(n);
  rays.y.resize(n);
  rays.weights.resize(f.stages.size());
  for (std::size_t k = 0; k < f.stages.size(); ++k)
    if (f.stages[k].mask >= 0 || f.stages[k].mix != 1 || (f.plate && f.stages[k].is_sky))
      rays.weights[k].resize(n);

  std::vector<FrameFiles::Rows> held(f.inputs.size());
  std::vector<std::vector<float>> in(f.inputs.size());
  for (int r = 0; r < rows; ++r) {
    const int y = data.y + r * step;
    for (std::size_t k = 0; k < in.size(); ++k) {
      FrameFiles::Rows& h = held[k];
      if (h.rows == 0 || y < h.y || y >= h.y + h.rows)
        h = files.read(f.inputs[k], y, int(k) == f.depth);
      const auto* row = h.values.data() + std::ptrdiff_t(y - h.y) * data.width;
      in[k].assign(row, row + data.width);
    }
    read_row(f, data, y, in, rays, std::size_t(r) * std::size_t(data.width));
  }
  rays.pad();
  return rays;
}

}  // namespace brume::study
