// Surface stages on a block, with what lies around it.

#include <algorithm>
#include <cstring>
#include <iterator>

#include "pipeline/kernels.h"
#include "pipeline/scratch.h"

namespace brume {

using pipeline::kernels;

namespace {

const PreparedFrame::Impl& frame_of(const brume_world* w) {
  return *static_cast<const PreparedFrame::Impl*>(w->context);
}

RaySpans spans(const brume_rays* r, const float* t_end) {
  return {int(r->n), r->ox, r->oy, r->oz, r->dx, r->dy, r->dz, t_end};
}

}  // namespace

/// What surface stages may ask while they run: everything that all stages published.
brume_world world_for_stages(const PreparedFrame::Impl& frame) {
  brume_world w{};
  w.size = sizeof w;
  w.context = &frame;
  w.light_count = frame.world.lights.size();
  w.transmittance = [](const brume_world* world, const brume_rays* rays, const float* t1,
                       float* const T[3]) {
    frame_of(world).air.transmittance(spans(rays, t1), {}, T);
  };
  w.irradiance = [](const brume_world* world, std::size_t light, const brume_rays* rays,
                    float* const E[3]) {
    if (light < world->light_count)
      return frame_of(world).air.irradiance(int(light), spans(rays, nullptr), E);
    for (int c = 0; c < 3; ++c) std::fill_n(E[c], rays->n, 0.f);
  };
  w.light = [](const brume_world* world, std::size_t k) -> const brume_light* {
    return k < world->light_count ? &frame_of(world).world.lights[k].what : nullptr;
  };
  return w;
}

/// Row y of the run's columns, and what may be asked for left and right of them: the
/// planes of kRayPlanes, one after the other. Overwrites the block's rays.
const float* RowWorker::around_row(int y) {
  Scratch& s = *s_;
  s.around.resize(RowFeed::kRowsKept);
  Scratch::AroundRow& row = s.around[std::size_t(y - feed_.window.y) % s.around.size()];
  if (row.y == y && row.columns == around_columns_) return row.planes.data();
  row.y = y, row.columns = around_columns_;
  const auto [from, to] = row.columns;
  const std::size_t size = std::size_t(to - from);
  row.planes.resize(kRayPlanes * size);
  for (int x = from; x < to; x += kBlock) {
    const int n = std::min(kBlock, to - x);
    Plane d;
    sample_distances(y, x, n, d.v);
    const float* const planes[] = {d.v, s.dx.v, s.dy.v, s.dz.v, s.ox.v, s.oy.v, s.oz.v};
    static_assert(std::size(planes) == kRayPlanes);
    for (std::size_t p = 0; p < (s.at_eye ? 4 : kRayPlanes); ++p)
      std::memcpy(&row.planes[p * size + std::size_t(x - from)], planes[p],
                  sizeof(float) * std::size_t(n));
  }
  return row.planes.data();
}

/// The block with what lies around it, for a stage that asked for rows or columns around:
/// rows of n + 2 columns, replicated at the frame's edges. Returns where the block's own
/// first pixel is in each plane (those of kRayPlanes, then the channels); rows are
/// `stride` apart.
const std::vector<float*>& RowWorker::halo(const RunningStage& stage, int y, int x, int n,
                                           int& stride) {
  Scratch& s = *s_;
  const int rows = stage.needs.rows_around, columns = stage.needs.columns_around;
  const std::size_t ray_planes = s.at_eye ? 4 : kRayPlanes,
                    planes = kRayPlanes + stage.channels.size();
  stride = n + 2 * columns;
  const std::size_t size = std::size_t(stride) * std::size_t(2 * rows + 1);
  s.halo.resize(planes * size);
  const Window& w = feed_.window;
  // Columns that the frame has; those left and right of it are replicated.
  const int from = std::max(x - columns, w.x), to = std::min(x + n + columns, w.right());
  const auto lay = [&](const float* row, std::size_t plane, int r) {
    float* out = &s.halo[plane * size + std::size_t(r) * std::size_t(stride)];
    const int left = from - (x - columns), inside = to - from;
    std::fill_n(out, left, row[0]);
    std::memcpy(out + left, row, sizeof(float) * std::size_t(inside));
    std::fill(out + left + inside, out + stride, row[inside - 1]);
  };
  for (int r = 0; r < 2 * rows + 1; ++r) {
    const int yy = std::clamp(y - rows + r, w.y, w.bottom() - 1);
    const float* rays = around_row(yy);
    const auto width = std::size_t(around_columns_.second - around_columns_.first);
    for (std::size_t p = 0; p < ray_planes; ++p)
      lay(rays + p * width + (from - around_columns_.first), p, r);
    for (std::size_t p = 0; p < stage.channels.size(); ++p)
      if (stage.channels[p] >= 0)
        lay(feed_.row(stage.channels[p], yy) + (from - w.x), kRayPlanes + p, r);
  }
  s.halo_at.clear();
  for (std::size_t p = 0; p < planes; ++p)
    s.halo_at.push_back(s.halo.data() + p * size +
                        std::size_t(rows) * std::size_t(stride) + std::size_t(columns));
  return s.halo_at;
}

void RowWorker::surface(int y, int x, int n, int offset, std::span<float* const> out) {
  Scratch& s = *s_;
  const bool at_eye = s.at_eye;
  bool rays_kept = true;
  for (int k = 0; k < f_.surface_end; ++k) {
    const RunningStage& stage = f_.stages[std::size_t(k)];
    const float* w = s.weights[std::size_t(k)];
    const OutputRgb added = f_.stage_added_out[std::size_t(k)];
    if (w || added.wanted())
      for (int c = 0; c < 3; ++c)
        std::memcpy(s.before[c].v, s.S[c].v, sizeof(float) * std::size_t(n));

    brume_tile tile{};
    tile.size = sizeof tile;
    tile.x = x, tile.y = y, tile.width = n, tile.height = 1;
    tile.row_stride = kBlock;
    tile.r = s.S[0].v, tile.g = s.S[1].v, tile.b = s.S[2].v, tile.a = s.alpha.v;
    tile.world = &world_;
    std::vector<const float*> channels;
    const auto set_rays = [&tile, at_eye](const auto& at) {
      tile.distance = at[0];
      tile.dx = at[1], tile.dy = at[2], tile.dz = at[3];
      if (!at_eye) tile.ox = at[4], tile.oy = at[5], tile.oz = at[6];
    };
    if (stage.needs.rows_around > 0 || stage.needs.columns_around > 0) {
      int stride = 0;
      const std::vector<float*>& at = halo(stage, y, x, n, stride);
      rays_kept = false;
      tile.row_stride = stride;
      set_rays(at);
      for (std::size_t p = 0; p < stage.channels.size(); ++p)
        channels.push_back(stage.channels[p] < 0 ? nullptr : at[kRayPlanes + p]);
    } else {
      if (!rays_kept) fill_block_rays(y, x, n);
      rays_kept = true;
      // Of a plate, what is at infinity is no surface wherever the air takes it to be.
      const float* const at[] = {f_.plate ? s.surface_distance.v : s.distance.v,
                                 s.dx.v,
                                 s.dy.v,
                                 s.dz.v,
                                 s.ox.v,
                                 s.oy.v,
                                 s.oz.v};
      set_rays(at);
      for (int c : stage.channels)
        channels.push_back(c < 0 ? nullptr : feed_.row(c, y) + (x - feed_.window.x));
    }
    tile.channels = channels.data();
    stage.instance->run(tile);

    if (w)
      for (int c = 0; c < 3; ++c)
        kernels().blend(n, s.before[c].v, s.S[c].v, w, s.S[c].v);
    for (int c = 0; added.wanted() && c < 3; ++c)
      if (float* const to = out[std::size_t(added.first + c)])
        kernels().difference(n, s.S[c].v, s.before[c].v, to + offset);
  }
  if (!rays_kept) fill_block_rays(y, x, n);
}

}  // namespace brume
