#include "pipeline/rows.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "pipeline/kernels.h"
#include "pipeline/scratch.h"
#include "scene/coverage.h"

namespace brume {
namespace {

using pipeline::kernels;

struct Pointers3 {
  float* p[3];
  explicit Pointers3(Rgb3& planes) : p{planes[0].v, planes[1].v, planes[2].v} {}
};

}  // namespace

RowWorker::RowWorker(const PreparedFrame::Impl& frame, RowFeed& feed)
    : f_(frame),
      feed_(feed),
      world_(world_for_stages(frame)),
      s_(std::make_unique<Scratch>()) {
  const std::size_t n = f_.stages.size();
  s_->weights.assign(n, nullptr);
  if (f_.any_weight || f_.plate) s_->weight_planes.resize(n);
  if (f_.wants_shares) {
    s_->shares.resize(6 * n);
    s_->shares_inf.resize(6 * n);
    for (std::size_t k = 0; k < 3 * n; ++k) {
      s_->share_L.push_back(s_->shares[k].v);
      s_->share_T.push_back(s_->shares[3 * n + k].v);
      s_->share_L_inf.push_back(s_->shares_inf[k].v);
      s_->share_T_inf.push_back(s_->shares_inf[3 * n + k].v);
    }
  }
}

RowWorker::~RowWorker() = default;

bool RowWorker::run(int y, int x0, int x1, std::span<float* const> out) {
  touched_ = false;
  int columns = 0;
  for (int k = 0; k < f_.surface_end; ++k)
    columns = std::max(columns, f_.stages[std::size_t(k)].needs.columns_around);
  around_columns_ = {std::max(x0 - columns, feed_.window.x),
                     std::min(x1 + columns, feed_.window.right())};
  if (f_.sole) return one_pass(y, x0, x1, out);
  const auto met = f_.extent ? f_.extent->row(y, x0, x1) : Extent::Columns{x0, x1};
  leave(y, x0, met.first, 0, out);
  for (int x = met.first; x < met.end; x += kBlock)
    block(y, x, std::min(kBlock, met.end - x), x - x0, out);
  leave(y, met.end, x1, met.end - x0, out);
  return touched_;
}

/// Pixels whose rays meet nothing: what was there stays, and layers say so.
void RowWorker::leave(int y, int x, int end, int offset, std::span<float* const> out) {
  if (x >= end) return;
  const auto n = std::size_t(end - x);
  const auto keep = [&](int from, int to) {
    if (to < 0 || !out[std::size_t(to)]) return;
    const float* before = feed_.row(from, y) + (x - feed_.window.x);
    if (before != out[std::size_t(to)] + offset)
      std::memcpy(out[std::size_t(to)] + offset, before, n * sizeof(float));
  };
  const auto fill = [&](OutputRgb layer, float value) {
    for (int c = 0; layer.wanted() && c < 3; ++c)
      if (float* o = out[std::size_t(layer.first + c)]) std::fill_n(o + offset, n, value);
  };
  for (int c = 0; c < 3; ++c)
    if (f_.color_out.wanted()) keep(f_.color[c], f_.color_out.first + c);
  if (f_.alpha >= 0) keep(f_.alpha, f_.alpha_out);
  fill(f_.T_out, 1);
  fill(f_.L_out, 0);
  for (OutputRgb layer : f_.stage_T_out) fill(layer, 1);
  for (OutputRgb layer : f_.stage_L_out) fill(layer, 0);
  for (OutputRgb layer : f_.idle_T_out) fill(layer, 1);
  for (OutputRgb layer : f_.idle_L_out) fill(layer, 0);
}

/// The whole run at once, but in blocks where covered pixels without depth need their
/// neighbours'.
bool RowWorker::one_pass(int y, int x0, int x1, std::span<float* const> out) {
  pipeline::SoleRun run{};
  run.row = ray_row(*f_.view, y);
  run.depth = f_.sole_depth;
  for (int k = 0; k < 3; ++k) {
    run.fall_at_middle += f_.sole->grad[k] * run.row.at_middle[k];
    run.fall_per_f += f_.sole->grad[k] * run.row.per_f[k];
  }
  const auto input = [&](int k, int x) { return feed_.row(k, y) + (x - feed_.window.x); };
  bool touched = false;
  for (int x = x0; x < x1; x += kBlock) {
    run.x = x;
    run.n = std::min(kBlock, x1 - x);
    run.z = input(f_.depth, x);
    run.a = f_.alpha >= 0 ? input(f_.alpha, x) : nullptr;
    run.distance = nullptr;
    if (run.a && pipeline::kernels_of_one_fog().uncovered(run)) {
      cover_edges(y, x, run.n, s_->distance.v);
      run.distance = s_->distance.v;
    }
    const auto output = [&](int k) {
      return k < 0 || !out[std::size_t(k)] ? nullptr : out[std::size_t(k)] + (x - x0);
    };
    for (int c = 0; c < 3; ++c) {
      run.S[c] = input(f_.color[c], x);
      run.C[c] = output(f_.color_out.first + c);
      if (!run.C[c]) run.C[c] = s_->before[c].v;
    }
    run.a_out = output(f_.alpha_out);
    touched = pipeline::kernels_of_one_fog().apply(*f_.sole, run) || touched;
  }
  return touched;
}

/// Rays into the scratch planes.
void RowWorker::fill_block_rays(int y, int x, int n) {
  Scratch& s = *s_;
  if (f_.view) {
    s.at_eye =
        fill_rays(*f_.view, x, y, n,
                  {s.ox.v, s.oy.v, s.oz.v, s.dx.v, s.dy.v, s.dz.v, s.per_planar.v});
  } else {
    // No camera: every ray looks forward, and depth is taken as distance (the plan says
    // so).
    std::fill_n(s.dx.v, n, 0.f), std::fill_n(s.dy.v, n, 1.f), std::fill_n(s.dz.v, n, 0.f);
    std::fill_n(s.per_planar.v, n, 1.f);
  }
}

/// Rays into the scratch planes, then distances along them.
void RowWorker::distances(int y, int x, int n, float* out) {
  Scratch& s = *s_;
  fill_block_rays(y, x, n);
  const int at = x - feed_.window.x;
  if (f_.position[0] >= 0) {
    const float* alpha = f_.alpha >= 0 ? feed_.row(f_.alpha, y) : nullptr;
    distances_from_position(
        *f_.view, f_.metres, n, feed_.row(f_.position[0], y) + at,
        feed_.row(f_.position[1], y) + at, feed_.row(f_.position[2], y) + at,
        alpha ? alpha + at : nullptr,
        {s.ox.v, s.oy.v, s.oz.v, s.dx.v, s.dy.v, s.dz.v, s.per_planar.v}, out);
  } else if (f_.depth >= 0) {
    distances_from_depth(f_.depth_rule, n, feed_.row(f_.depth, y) + at, s.per_planar.v,
                         out);
  } else {
    std::fill_n(out, n, kInfinity);
  }
}

/// The distances of a whole row, or null outside the frame. Overwrites the block's rays.
const float* RowWorker::distance_row(int y) {
  Scratch& s = *s_;
  if (y < feed_.window.y || y >= feed_.window.bottom()) return nullptr;
  if (s.kept.empty()) s.kept.resize(RowFeed::kRowsKept);
  Scratch::KeptRow& kept = s.kept[std::size_t(
      ((y % RowFeed::kRowsKept) + RowFeed::kRowsKept) % RowFeed::kRowsKept)];
  if (kept.y != y || kept.distance.empty()) {
    kept.distance.resize(std::size_t(feed_.window.width));
    for (int x = 0; x < feed_.window.width; x += kBlock)
      distances(y, feed_.window.x + x, std::min(kBlock, feed_.window.width - x),
                kept.distance.data() + x);
    kept.y = y;
  }
  return kept.distance.data();
}

/// Pixels that are partly covered but have no depth take their nearest neighbour's
/// distance. Rare: silhouettes before the sky.
void RowWorker::cover_edges(int y, int x, int n, float* out) {
  Scratch& s = *s_;
  const Window& w = feed_.window;
  const int left = std::min(kCoverageReach, x - w.x);
  const int right = std::min(kCoverageReach, w.right() - (x + n));
  CoverageBand band;
  band.width = left + n + right;
  band.above = std::min(kCoverageReach, y - w.y);
  band.rows = 1;
  band.below = std::min(kCoverageReach, w.bottom() - 1 - y);
  s.patch.resize(std::size_t(band.width) * std::size_t(band.above + 1 + band.below));
  for (int r = 0; r < band.above + 1 + band.below; ++r)
    std::memcpy(&s.patch[std::size_t(r) * std::size_t(band.width)],
                distance_row(y - band.above + r) + (x - left - w.x),
                sizeof(float) * std::size_t(band.width));
  band.distance = s.patch.data();
  band.distance_stride = band.width;
  band.alpha = feed_.row(f_.alpha, y) + (x - left - w.x);
  fill_uncovered(band);
  fill_block_rays(y, x, n);  // again: the rows around had theirs in between
  std::memcpy(
      out,
      &s.patch[std::size_t(band.above) * std::size_t(band.width) + std::size_t(left)],
      sizeof(float) * std::size_t(n));
}

/// Distances as stages see them: of covered pixels without depth, their neighbours'.
void RowWorker::sample_distances(int y, int x, int n, float* out) {
  distances(y, x, n, out);
  if (!f_.plate && f_.alpha >= 0 &&
      has_uncovered(n, feed_.row(f_.alpha, y) + (x - feed_.window.x), out))
    cover_edges(y, x, n, out);
}

// How much of what lies behind everything the pixels of a block get: as much as of the
// stage that brings it. Null: all.
const float* RowWorker::part_of_background(int n) {
  Scratch& s = *s_;
  if (s.weight_planes.empty()) return nullptr;
  std::fill_n(s.fills.v, n, 0.f);
  for (std::size_t k = 0; k < f_.stages.size(); ++k) {
    if (!f_.stages[k].fills) continue;
    if (!s.weights[k]) return nullptr;
    for (int i = 0; i < n; ++i) s.fills.v[i] = std::max(s.fills.v[i], s.weights[k][i]);
  }
  return s.fills.v;
}

void RowWorker::block(int y, int x, int n, int offset, std::span<float* const> out) {
  Scratch& s = *s_;
  const int at = x - feed_.window.x;
  const auto input = [&](int k) { return feed_.row(k, y) + at; };
  const auto output = [&](int k) { return k < 0 || !out[k] ? nullptr : out[k] + offset; };

  // Layers of stages that are left out at this frame, so that every frame of a shot has
  // the same.
  const auto fill = [&](OutputRgb layer, float value) {
    for (int c = 0; c < 3; ++c)
      if (float* o = layer.wanted() ? output(layer.first + c) : nullptr)
        std::fill_n(o, n, value);
  };
  for (OutputRgb layer : f_.idle_T_out) fill(layer, 1);
  for (OutputRgb layer : f_.idle_L_out) fill(layer, 0);
  if (f_.stages.empty()) {
    fill(f_.T_out, 1);
    fill(f_.L_out, 0);
    return;
  }

  // Where the samples are, and how much of the pixel they cover.
  sample_distances(y, x, n, s.distance.v);
  const float* a = nullptr;
  if (f_.plate) {
    for (int i = 0; i < n; ++i)
      s.infinite.v[i] = s.distance.v[i] == kInfinity ? 1.f : 0.f;
    if (f_.surface_end > 0) {
      std::memcpy(s.surface_distance.v, s.distance.v, sizeof(float) * std::size_t(n));
      std::fill_n(s.alpha.v, n, 1.f);
    }
    for (int i = 0; i < n; ++i)
      if (s.infinite.v[i] != 0) s.distance.v[i] = f_.background_distance;
  } else if (f_.alpha >= 0) {
    a = input(f_.alpha);
  } else {
    for (int i = 0; i < n; ++i) s.alpha.v[i] = s.distance.v[i] < kInfinity ? 1.f : 0.f;
    a = s.alpha.v;
  }

  // How much of each stage this pixel gets.
  if (!s.weight_planes.empty()) {
    for (std::size_t k = 0; k < f_.stages.size(); ++k) {
      const RunningStage& stage = f_.stages[k];
      float* w = s.weight_planes[k].v;
      s.weights[k] = nullptr;
      const bool behind = f_.plate && stage.is_sky;
      if (stage.mask < 0 && stage.mix == 1 && !behind) continue;
      if (stage.mask >= 0)
        kernels().weight(n, input(stage.mask), stage.mix, w);
      else
        std::fill_n(w, n, stage.mix);
      if (behind)
        for (int i = 0; i < n; ++i) w[i] = s.infinite.v[i] != 0 ? 0.f : w[i];
      s.weights[k] = w;
    }
  }

  // Surface: what the ray ends on.
  const float* S[3];
  for (int c = 0; c < 3; ++c) S[c] = input(f_.color[c]);
  if (f_.surface_end > 0) {
    for (int c = 0; c < 3; ++c) {
      std::memcpy(s.S[c].v, S[c], sizeof(float) * std::size_t(n));
      S[c] = s.S[c].v;
    }
    if (a && a != s.alpha.v) {
      std::memcpy(s.alpha.v, a, sizeof(float) * std::size_t(n));
      a = s.alpha.v;
    }
    surface(y, x, n, offset, out);
    for (int c = 0; c < 3; ++c)
      touched_ = touched_ || std::memcmp(S[c], input(f_.color[c]),
                                         sizeof(float) * std::size_t(n)) != 0;
    touched_ = touched_ ||
               (f_.alpha >= 0 && a &&
                std::memcmp(a, input(f_.alpha), sizeof(float) * std::size_t(n)) != 0);
    for (int c = 0; c < 3; ++c)
      if (float* o = f_.S_out.wanted() ? output(f_.S_out.first + c) : nullptr)
        std::memcpy(o, S[c], sizeof(float) * std::size_t(n));
  }

  // Air: up to the sample, and to infinity where something of that is seen.
  RaySpans rays;
  rays.n = n;
  if (!s.at_eye) rays.ox = s.ox.v, rays.oy = s.oy.v, rays.oz = s.oz.v;
  rays.dx = s.dx.v, rays.dy = s.dy.v, rays.dz = s.dz.v;
  rays.t_end = s.distance.v;
  const Pointers3 T(s.T), L(s.L), T_inf(s.T_inf), L_inf(s.L_inf), B(s.B);
  AirOut near{{T.p[0], T.p[1], T.p[2]}, {L.p[0], L.p[1], L.p[2]}, s.share_L, s.share_T};
  std::span<const float* const> weights;  // of thousands of stages none may have one
  if (!s.weight_planes.empty()) weights = s.weights;
  f_.air.integrate(rays, weights, near);
  const bool both = a && kernels().needs_infinity(n, a, s.distance.v);
  if (both) {
    std::fill_n(s.infinite.v, n, kInfinity);
    rays.t_end = s.infinite.v;
    AirOut far{{T_inf.p[0], T_inf.p[1], T_inf.p[2]},
               {L_inf.p[0], L_inf.p[1], L_inf.p[2]},
               s.share_L_inf,
               s.share_T_inf};
    f_.air.integrate(rays, weights, far);
  }
  const bool background = a && f_.own_background;
  const float* fills = nullptr;  // how much of it; null: all
  if (background) {
    f_.air.background(rays, B.p);
    fills = part_of_background(n);
    for (int c = 0; fills && c < 3; ++c)
      for (int i = 0; i < n; ++i) B.p[c][i] = fills[i] > 0 ? fills[i] * B.p[c][i] : 0;
  }

  // Shares of single stages, laid over as the whole is (their own T of the background
  // belongs to no stage but the one that published it). Before that, as the coverage that
  // comes out may stand where the one that came in does.
  for (std::size_t k = 0; f_.wants_shares && k < f_.stages.size(); ++k) {
    for (int c = 0; c < 3; ++c) {
      const std::size_t i = 3 * k + std::size_t(c);
      if (float* o =
              f_.stage_T_out[k].wanted() ? output(f_.stage_T_out[k].first + c) : nullptr)
        std::memcpy(o, s.share_T[i], sizeof(float) * std::size_t(n));
      if (float* o = f_.stage_L_out[k].wanted() ? output(f_.stage_L_out[k].first + c)
                                                : nullptr) {
        const float* beyond = both ? s.share_L_inf[i] : s.share_L[i];
        for (int j = 0; j < n; ++j) {
          const float u = a && a[j] < 1 ? std::max(a[j], 0.f) : 1.f;  // NaN covers
          const float near_L = s.share_L[i][j], far_L = beyond[j];
          o[j] = u == 1 ? near_L : u == 0 ? far_L : u * near_L + (1 - u) * far_L;
        }
      }
    }
  }

  // Together.
  pipeline::CompositeRun run{};
  run.n = n;
  run.a = a;
  run.fills = fills;
  run.a_out = output(f_.alpha_out);
  for (int c = 0; c < 3; ++c) {
    run.S[c] = S[c];
    run.T[c] = T.p[c];
    run.L[c] = L.p[c];
    if (both) run.T_inf[c] = T_inf.p[c], run.L_inf[c] = L_inf.p[c];
    if (background) run.B[c] = B.p[c];
    run.C[c] = f_.color_out.wanted() ? output(f_.color_out.first + c) : nullptr;
    if (!run.C[c]) run.C[c] = s.before[c].v;
    run.L_out[c] = f_.L_out.wanted() ? output(f_.L_out.first + c) : nullptr;
    if (float* o = f_.T_out.wanted() ? output(f_.T_out.first + c) : nullptr)
      std::memcpy(o, T.p[c], sizeof(float) * std::size_t(n));
  }
  touched_ = kernels().composite(run) || touched_;
}

}  // namespace brume
