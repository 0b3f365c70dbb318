#include "air/lamps.h"

#include "air/lamp_by_angle.h"
#include "air/lamp_closed.h"

// One lamp at a time: in closed form where there is one, else by quadrature.

namespace brume::air::inline BRUME_ISA_NS {
namespace {

void add_lamp(const LampRays& g, Batch L[3]) {
  const Mask closed = g.lamp.closed ? add_closed(g, L) : Mask(false);
  if (!all(closed)) ByAngle(g, !closed, L).add();
}

unsigned long scratch_bytes(int k) { return sizeof(Lit) * static_cast<unsigned>(k) + 64; }

void add(const Compiled& world, int k, const Medium* const* media,
         const float* const* weights, const Rays& rays, float* const L[3],
         const Stretch* share, void* scratch) noexcept {
  Lit* on = static_cast<Lit*>(scratch);
  for (int i = 0; i < rays.n; i += Batch::W) {
    const auto ray = load_ray(rays, i);
    const int n = meet(k, media, weights, rays, i, ray, on);
    bool glows = false;
    for (int j = 0; j < n; ++j) {
      glows = glows || on[j].m->glows_by_lamp;
      const Inside& in = on[j].in;
      on[j].open = is_open(*on[j].m, ray);
      on[j].from_eye = (in.lo == Batch(0.f)) | (in.lo >= in.hi);
    }
    if (!glows) continue;
    Batch sum[3] = {0.f, 0.f, 0.f};
    for (const Light& lamp : world.lamps)
      add_lamp({world, lamp, on, n, ray, foot_of(lamp, ray)}, sum);
    for (int c = 0; c < 3; ++c) store(L[c] + i, load<Batch>(L[c] + i) + sum[c]);
    if (share) put_shares(on, n, k, media, share, i, true);
  }
}

}  // namespace

const LampKernels lamp_kernels = {add, scratch_bytes};

}  // namespace brume::air::inline BRUME_ISA_NS
