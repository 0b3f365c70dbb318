// What a frame of many pixels looks up instead of asking along every ray. Each table is
// made when a pixel first asks.

#include "frame_sky.h"

namespace brume::sky {

const SkyMap& FrameSky::Table::of(const FrameSky& sky, double ground) const {
  std::call_once(made, [&] {
    const double here[3] = {};
    const Ray eye = sky.ray(here, sky.at_.up.data());
    memory = sky.maps_.get(sky.model_, eye.h, ground, eye.mu_s, sky.weight_,
                           sky.look_.colors, sky.look_.scale, sky.detail_);
    map = memory->map;
    // Up at the eye, from the planet's centre.
    const double R = sky.model_.atmosphere().planet_radius;
    for (int k = 0; k < 3; ++k) {
      map.up[k] = float((sky.centre_[k] + R * sky.at_.up[k]) / (R + eye.h));
      map.sun[k] = float(sky.at_.to_sun[k]);
    }
  });
  return map;
}

void FrameSky::look_up(const brume_rays& rays, const float* t1, float* const L[3],
                       float* const T[3]) const {
  static const MapKernels& kernel = BRUME_ISA_SELECT(map_kernels);
  const double here[3] = {}, deepest = model_.deepest_ground();
  const Ray eye = ray(here, at_.up.data());
  kernel.look(map_.of(*this, eye.ground), place_, static_cast<int>(rays.n), rays.dx,
              rays.dy, rays.dz, t1, L, T);
  // Few, as a rule none, go on beyond the ground.
  if (sun_sets_) {
    for (std::size_t i = 0; i < rays.n; ++i)
      if (T[0][i] < 0) see_into(rays, i, weight_, 0, double(t1[i]), L, T);
    return;
  }
  constexpr int kRun = 64;
  std::size_t of[kRun];
  float in[4][kRun], out[6][kRun];
  float *const to_L[3] = {out[0], out[1], out[2]}, *const to_T[3] = {out[3], out[4],
                                                                     out[5]};
  for (std::size_t i = 0; i < rays.n;) {
    int n = 0;
    for (; i < rays.n && n < kRun; ++i) {
      if (!(T[0][i] < 0)) continue;
      of[n] = i;
      in[0][n] = rays.dx[i], in[1][n] = rays.dy[i], in[2][n] = rays.dz[i];
      in[3][n++] = t1[i];
    }
    if (n == 0) return;
    kernel.look(deep_.of(*this, deepest), place_, n, in[0], in[1], in[2], in[3], to_L,
                to_T);
    for (int k = 0; k < n; ++k)
      for (int c = 0; c < 3; ++c) L[c][of[k]] = to_L[c][k], T[c][of[k]] = to_T[c][k];
  }
}

const NishitaTable& FrameSky::hemisphere() const {
  std::call_once(hemisphere_made_, [this] {
    const double here[3] = {};
    const Ray eye = ray(here, at_.up.data());
    hemisphere_ = std::make_unique<NishitaTable>(model_.atmosphere(), eye.h, eye.mu_s,
                                                 look_.colors, look_.scale);
  });
  return *hemisphere_;
}

}  // namespace brume::sky
