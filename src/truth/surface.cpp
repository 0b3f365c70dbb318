#include "truth/surface.h"

#include <algorithm>
#include <cmath>

#include "num/random.h"
#include "pipeline/rows.h"

namespace brume::truth {
namespace {

// What rounding to a float may do, as a part of a number.
constexpr double kLastBit = 0x1p-24;
// An edge is looked for as far as the roundings of a few operations reach. What changes
// by four times as much as if it were even over that is one.
constexpr double kWider = 8, kEdge = 4 * kWider;
// Of optical depths toward lights: far below what a tolerance can ask for.
constexpr double kDepth = 1e-8;

}  // namespace

Surfaces::Surfaces(const FrameInput& in)
    : in_(in), shown_(in.f().world, kDepth), fast_(world_for_stages(in.f())) {}

std::vector<std::string> Surfaces::unproven() const {
  std::vector<std::string> names;
  for (int k = 0; k < in_.f().surface_end; ++k) {
    const RunningStage& stage = in_.f().stages[std::size_t(k)];
    if (!stage.instance->type().table.truth) names.push_back(stage.instance->name());
  }
  return names;
}

// (2 around + 1)^2 of them, row by row; past the frame's edge those of the edge.
std::vector<Surfaces::Place> Surfaces::places(int x, int y, int around) const {
  const Window& w = in_.window;
  std::vector<Place> all;
  for (int dy = -around; dy <= around; ++dy)
    for (int dx = -around; dx <= around; ++dx) {
      const int px = std::clamp(x + dx, w.x, w.right() - 1),
                py = std::clamp(y + dy, w.y, w.bottom() - 1);
      const View::RayAt r = in_.ray(px, py);
      all.push_back({in_.distance(px, py), r.direction, r.origin - in_.f().world.eye});
    }
  return all;
}

// One pixel as the stage is given it, but for its colour.
Sheet Surfaces::sheet(const RunningStage& stage, int x, int y,
                      const std::vector<Place>& places, int around, Moved* moved) const {
  Sheet s;
  s.x = x, s.y = y;
  s.resize(1, 1, std::max(stage.needs.rows_around, stage.needs.columns_around));
  const auto bits = [&](double v) {
    return moved ? v * (1 + moved->by * moved->random.uniform(-1, 1)) : v;
  };
  const bool parallel =
      in_.f().view && in_.f().view->projection == Projection::orthographic;
  const std::size_t n = s.alpha.size();
  s.t.resize(n);
  for (int c = 0; c < 3; ++c) {
    s.d[c].resize(n);
    if (parallel) s.o[c].resize(n);
  }
  for (int dy = -s.around; dy <= s.around; ++dy)
    for (int dx = -s.around; dx <= s.around; ++dx) {
      const std::size_t i = s.at(dx, dy);
      const Place& p =
          places[std::size_t((dy + around) * (2 * around + 1) + dx + around)];
      s.t[i] = float(bits(p.t));
      for (int c = 0; c < 3; ++c) {
        s.d[c][i] = float(bits(p.d[c]));
        if (parallel) s.o[c][i] = float(bits(p.o[c]));
      }
    }
  const Window& w = in_.window;
  for (const int channel : stage.channels) {
    auto& plane = s.channels.emplace_back();
    if (channel < 0) continue;
    plane.resize(n);
    for (int dy = -s.around; dy <= s.around; ++dy)
      for (int dx = -s.around; dx <= s.around; ++dx)
        plane[s.at(dx, dy)] =
            float(in_.value(channel, std::clamp(x + dx, w.x, w.right() - 1),
                            std::clamp(y + dy, w.y, w.bottom() - 1)));
  }
  return s;
}

void Surfaces::apply(const RunningStage& stage, int x, int y,
                     const std::vector<Place>& places, int around, Surface& p) const {
  const Surface before = p;
  const double own_alpha = before.alpha;
  // What the stage makes of the pixel; `moved` null: as it stands.
  const auto ask = [&](Moved* moved, Rgb& out, double* alpha) {
    Sheet s = sheet(stage, x, y, places, around, moved);
    const std::size_t at = s.at(0);
    for (std::size_t c = 0; c < 3; ++c) {
      const double off =
          moved ? (moved->random.uniform() < .5 ? -1 : 1) * before.S_error[c] : 0;
      s.rgb[c][at] = float(before.S[c] + off);
    }
    s.alpha[at] = float(own_alpha);
    const bool has_truth = stage.instance->type().table.truth;
    if (has_truth) {
      const int xy[2] = {0, 0};
      stage.instance->truth(s.tile(&shown_.table()), xy, out.data());
    }
    if (alpha || !has_truth) {
      stage.instance->run(s.tile(&fast_));
      if (alpha) *alpha = double(s.alpha[at]);
      for (std::size_t c = 0; c < 3 && !has_truth; ++c) out[c] = double(s.rgb[c][at]);
    }
  };
  Rgb after;
  ask(nullptr, after, stage.needs.changes_alpha ? &p.alpha : nullptr);
  // How far the answer moves, moved `by` so much of everything.
  const auto change = [&](double by) {
    Rgb most{};
    for (int k = 0; k < kAsked; ++k) {
      // Every second time the other way: what lies on an edge crosses it.
      Moved moved{
          Random(std::uint64_t(y), std::uint64_t(x) * kAsked + std::uint64_t(k / 2)),
          k % 2 ? -by : by};
      Rgb other;
      ask(&moved, other, nullptr);
      for (std::size_t c = 0; c < 3; ++c)
        if (other[c] != after[c])  // inf - inf is no change
          most[c] = std::max(most[c], std::abs(other[c] - after[c]));
    }
    return most;
  };
  Rgb error = change(kLastBit);
  const Rgb around_it = change(kWider * kLastBit);
  for (std::size_t c = 0; c < 3; ++c)
    if (around_it[c] > kEdge * error[c]) error[c] = around_it[c];
  const bool behind = in_.distance(x, y) == kInf;
  const double w = in_.weight(stage, x, y, behind);
  Rgb added{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double b = before.S[c];
    p.S[c] = w == 0 ? b : w == 1 ? after[c] : b + w * (after[c] - b);
    p.S_error[c] = (1 - w) * before.S_error[c] + w * error[c];
    const double more = p.S[c] - b;
    added[c] = std::isfinite(more) ? more : 0;
  }
  p.added.push_back(added);
}

Surface Surfaces::at(int x, int y) const {
  const PreparedFrame::Impl& f = in_.f();
  Surface p;
  for (int c = 0; c < 3; ++c)
    p.S[std::size_t(c)] = f.color[c] < 0 ? 0 : in_.value(f.color[c], x, y);
  p.alpha = in_.alpha(x, y);
  int around = 0;
  for (int k = 0; k < f.surface_end; ++k) {
    const StageNeeds& needs = f.stages[std::size_t(k)].needs;
    around = std::max({around, needs.rows_around, needs.columns_around});
  }
  if (f.surface_end == 0) return p;
  const std::vector<Place> there = places(x, y, around);
  for (int k = 0; k < f.surface_end; ++k)
    apply(f.stages[std::size_t(k)], x, y, there, around, p);
  return p;
}

}  // namespace brume::truth
