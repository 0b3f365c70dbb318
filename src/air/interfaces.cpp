// A surface in mid-air: the ray is split where it meets the first one, and what that
// reflects is looked up along the mirrored ray, once.

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "air/segment.h"

namespace brume::air {
namespace {

/// n floats of each of several quantities, on the stack.
template <int count>
struct Store {
  alignas(64) float at[count][kBlock];
};

brume_rays c_rays(const Rays& r) {
  return {static_cast<std::size_t>(r.n), r.ox, r.oy, r.oz, r.dx, r.dy, r.dz};
}

/// Where each ray first meets any interface within its length: t (kFar: nowhere), normal,
/// reflectance.
struct Hit {
  float t[kBlock], normal[3][kBlock], R[kBlock];
};

bool first_hit(const Air::Impl& air, const Rays& rays, Hit& hit) {
  Store<5> s;
  const brume_rays r = c_rays(rays);
  std::fill(hit.t, hit.t + rays.n, kFar);
  bool any = false;
  for (const auto& f : air.interfaces) {
    f.hit(f.self, &r, s.at[0], s.at[1], s.at[2], s.at[3], s.at[4]);
    for (int i = 0; i < rays.n; ++i) {
      if (!(s.at[0][i] > 0 && s.at[0][i] < rays.end[i] && s.at[0][i] < hit.t[i]))
        continue;
      hit.t[i] = s.at[0][i];
      for (int c = 0; c < 3; ++c) hit.normal[c][i] = s.at[1 + c][i];
      hit.R[i] = std::clamp(s.at[4][i], 0.f, 1.f);
      any = true;
    }
  }
  return any;
}

/// Radiance along the mirrored rays, from the hits to infinity; 0 where there is no hit.
void reflected(const Air::Impl& air, const Rays& rays, const Hit& hit,
               const std::vector<const float*>& weights, float* const seen[3]) {
  Store<13> s;
  float *const o[3] = {s.at[0], s.at[1], s.at[2]}, *const d[3] = {s.at[3], s.at[4],
                                                                  s.at[5]};
  float* const end = s.at[6];
  Block b;
  for (int c = 0; c < 3; ++c) {
    b.T[c] = s.at[7 + c];
    b.L[c] = s.at[10 + c];
  }
  b.weights = weights;
  const float* const from[3] = {rays.ox, rays.oy, rays.oz};
  const float* const to[3] = {rays.dx, rays.dy, rays.dz};
  for (int i = 0; i < rays.n; ++i) {
    const bool there = hit.t[i] < kFar;
    float across = 0;
    for (int c = 0; c < 3; ++c) across += to[c][i] * hit.normal[c][i];
    for (int c = 0; c < 3; ++c) {
      o[c][i] = there ? (from[c] ? from[c][i] : 0.f) + hit.t[i] * to[c][i] : 0.f;
      d[c][i] = there ? to[c][i] - 2 * across * hit.normal[c][i] : to[c][i];
    }
    end[i] = there ? std::numeric_limits<float>::infinity() : 0.f;
  }
  b.rays = {rays.n, o[0], o[1], o[2], d[0], d[1], d[2], nullptr, end};
  segment_block(air, b.rays, b);
  background_block(air, b.rays, seen);
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < rays.n; ++i) {
      const float beyond = b.T[c][i] > 0 ? b.T[c][i] * seen[c][i] : 0.f;
      seen[c][i] = hit.t[i] < kFar ? b.L[c][i] + beyond : 0.f;
    }
}

}  // namespace

void split_at_interfaces(const Air::Impl& air, const Block& b) {
  const int n = b.rays.n;
  Hit hit;
  if (!first_hit(air, b.rays, hit)) return segment_block(air, b.rays, b);

  // In front of the surface.
  Store<1> middle;
  for (int i = 0; i < n; ++i) middle.at[0][i] = std::min(hit.t[i], b.rays.end[i]);
  Rays front = b.rays, behind = b.rays;
  front.end = behind.begin = middle.at[0];
  segment_block(air, front, b);

  // Behind it, into room of its own.
  std::vector<float> room(std::size_t(kBlock) *
                          (6 + b.stage_L.size() + b.stage_T.size()));
  float* next = room.data();
  const auto plane = [&] { return std::exchange(next, next + kBlock); };
  Block far = b;
  for (int c = 0; c < 3; ++c) {
    far.T[c] = plane();
    far.L[c] = plane();
  }
  for (auto& p : far.stage_L) p = plane();
  for (auto& p : far.stage_T) p = plane();
  segment_block(air, behind, far);

  Store<3> seen;
  float* const sky[3] = {seen.at[0], seen.at[1], seen.at[2]};
  reflected(air, b.rays, hit, b.weights, sky);
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < n; ++i) {
      const float R = hit.t[i] < kFar ? hit.R[i] : 0.f;
      const float before = b.T[c][i], through = before * (1 - R);
      b.L[c][i] += before * R * sky[c][i] + through * far.L[c][i];
      b.T[c][i] = through * far.T[c][i];
      for (std::size_t s = std::size_t(c); s < b.stage_L.size(); s += 3)
        b.stage_L[s][i] += through * far.stage_L[s][i];
      for (std::size_t s = std::size_t(c); s < b.stage_T.size(); s += 3)
        b.stage_T[s][i] *= far.stage_T[s][i];
    }
}

void background_block(const Air::Impl& air, const Rays& rays, float* const B[3]) {
  Store<3> one;
  const brume_rays r = c_rays(rays);
  for (int c = 0; c < 3; ++c) std::fill(B[c], B[c] + rays.n, 0.f);
  for (const auto& from : air.backgrounds) {
    from.radiance(from.self, &r, one.at[0], one.at[1], one.at[2]);
    for (int c = 0; c < 3; ++c)
      for (int i = 0; i < rays.n; ++i) B[c][i] += one.at[c][i];
  }
}

}  // namespace brume::air
