#include "air/air.h"

#include <algorithm>

#include "air/blocks.h"
#include "air/impl.h"
#include "air/segment.h"

namespace brume {

namespace air {

Kernels kernels_of(Isa which) {
  return {
      of_isa(which, isa_v2::closed_kernels, isa_v3::closed_kernels,
             isa_v4::closed_kernels),
      of_isa(which, isa_v2::compose_kernels, isa_v3::compose_kernels,
             isa_v4::compose_kernels),
      of_isa(which, isa_v2::cone_kernels, isa_v3::cone_kernels, isa_v4::cone_kernels),
      of_isa(which, isa_v2::walk_kernels, isa_v3::walk_kernels, isa_v4::walk_kernels),
      of_isa(which, isa_v2::lamp_kernels, isa_v3::lamp_kernels, isa_v4::lamp_kernels),
      of_isa(which, isa_v2::light_kernels, isa_v3::light_kernels, isa_v4::light_kernels)};
}

namespace {

void register_rays(Planes& planes, Rays& r, const RaySpans& from) {
  planes.start();
  r = {0, from.ox, from.oy, from.oz, from.dx, from.dy, from.dz, nullptr, from.t_end};
  for (const float** p : {&r.ox, &r.oy, &r.oz, &r.dx, &r.dy, &r.dz, &r.end}) planes.in(p);
}

// The shortest way, for the commonest world: one medium without bounds, in closed form,
// and rays in whole batches.
bool only_closed(const Air::Impl& air, const RaySpans& r,
                 std::span<const float* const> weights, const AirOut& out) {
  if (air.media.size() != 1 || !air.interfaces.empty() || !out.stage_L.empty() ||
      !out.stage_T.empty() || r.n % 16 != 0)
    return false;
  const Medium& m = air.media[0];
  if (!m.closed || m.glows_by_lamp || m.alone || air.bounded) return false;
  const auto stage = static_cast<std::size_t>(m.stage);
  const Stretch to = {
      nullptr, nullptr, {out.T[0], out.T[1], out.T[2]}, {out.L[0], out.L[1], out.L[2]}};
  air.kernels.closed.one(m, air.world,
                         {r.n, r.ox, r.oy, r.oz, r.dx, r.dy, r.dz, nullptr, r.t_end},
                         stage < weights.size() ? weights[stage] : nullptr, to, false);
  return true;
}

}  // namespace
}  // namespace air

Air::Air() : impl_(std::make_unique<Impl>()) {}
Air::~Air() = default;
Air::Air(Air&&) noexcept = default;
Air& Air::operator=(Air&&) noexcept = default;

bool Air::empty() const { return impl_->media.empty() && impl_->interfaces.empty(); }

void Air::integrate(const RaySpans& rays, std::span<const float* const> weights,
                    const AirOut& out) const noexcept {
  if (air::only_closed(*impl_, rays, weights, out)) return;
  static thread_local air::Planes planes;
  static thread_local air::Block b;
  air::register_rays(planes, b.rays, rays);
  b.weights.assign(weights.begin(), weights.end());
  b.stage_L.assign(out.stage_L.begin(), out.stage_L.end());
  b.stage_T.assign(out.stage_T.begin(), out.stage_T.end());
  for (auto& w : b.weights)
    if (w) planes.in(&w);
  for (int c = 0; c < 3; ++c) {
    b.T[c] = out.T[c];
    b.L[c] = out.L[c];
    planes.out(&b.T[c]);
    planes.out(&b.L[c]);
  }
  for (auto& p : b.stage_L) planes.out(&p);
  for (auto& p : b.stage_T) planes.out(&p);
  planes.each_block(rays.n, [&](int, int n) {
    b.rays.n = n;
    air::integrate_block(*impl_, b);
  });
}

void Air::transmittance(const RaySpans& rays, std::span<const float* const> weights,
                        float* const T[3]) const noexcept {
  static thread_local air::Planes planes;
  static thread_local air::Block b;
  air::register_rays(planes, b.rays, rays);
  b.weights.assign(weights.begin(), weights.end());
  for (auto& w : b.weights)
    if (w) planes.in(&w);
  for (int c = 0; c < 3; ++c) {
    b.T[c] = T[c];
    planes.out(&b.T[c]);
  }
  planes.each_block(rays.n, [&](int, int n) {
    b.rays.n = n;
    air::transmittance_block(*impl_, b);
  });
}

void Air::irradiance(int light, const RaySpans& points,
                     float* const E[3]) const noexcept {
  static thread_local air::Planes planes;
  air::Rays r;
  air::register_rays(planes, r, points);
  float* e[3] = {E[0], E[1], E[2]};
  for (auto& p : e) planes.out(&p);
  const auto& l = impl_->lights[static_cast<std::size_t>(light)];
  const auto& sky = impl_->skies[static_cast<std::size_t>(light)];
  const air::SkyMap* map = sky ? &sky->map() : nullptr;
  planes.each_block(points.n, [&](int, int n) {
    r.n = n;
    impl_->kernels.light.irradiance(impl_->world, l, map, r, e);
  });
}

void Air::background(const RaySpans& rays, float* const B[3]) const noexcept {
  static thread_local air::Planes planes;
  air::Rays r;
  air::register_rays(planes, r, rays);
  float* out[3] = {B[0], B[1], B[2]};
  for (auto& p : out) planes.out(&p);
  planes.each_block(rays.n, [&](int, int n) {
    r.n = n;
    air::background_block(*impl_, r, out);
  });
}

bool Air::has_background() const { return !impl_->backgrounds.empty(); }

}  // namespace brume
