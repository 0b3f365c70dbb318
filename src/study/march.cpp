#include "study/march.h"

#include "air/piece.h"
#include "air/steady.h"

namespace brume::study::inline BRUME_ISA_NS {
namespace {

using namespace air::BRUME_ISA_NS;
using air::Compiled;
using air::Light;
using air::Medium;

// Media that a batch of rays meets, and what is constant along each ray.
int gather(const Compiled& world, const float* const* weights, int i,
           const Ray<Batch>& ray, Batch begin, Batch end, Walked* on) {
  int k = 0;
  for (const Medium& m : world.media) {
    Walked& r = on[k];
    const float* w = weights ? weights[m.stage] : nullptr;
    r.m = &m;
    r.weight = w ? load<Batch>(w + i) : Batch(1.f);
    r.p = along(m, ray);
    r.in = inside(m, r.p, ray, r.weight, begin, end);
    if (none(r.in.lo < r.in.hi)) continue;
    for (int c = 0; c < 3; ++c) r.S[c] = Batch(m.S[c]);
    if (m.glows_by_sun) add_steady(m, world, ray, r.S);
    ++k;
  }
  return k;
}

// Light of the lamps at t, answered by the medium.
void add_lamps(const Compiled& world, const Walked& r, const Ray<Batch>& ray, Batch t,
               Batch S[3]) {
  if (!r.m->glows_by_lamp) return;
  Batch x[3];
  point_at(ray, t, x);
  for (const Light& lamp : world.lamps) {
    auto in = incident(lamp, x);
    attenuate(world, lamp, x, in);
    const Batch p = phase(r.m->phase, in.to, ray.d, r.m->g);
    for (int c = 0; c < 3; ++c) S[c] += Batch(r.m->albedo[c]) * p * in.E[c];
  }
}

void march(const Compiled& world, const air::Rays& rays, const float* const* weights,
           int steps, float far, float* const T_out[3], float* const L_out[3]) noexcept {
  const Batch zero(0.f);
  Walked on[kMarchedMedia];
  for (int i = 0; i < rays.n; i += Batch::W) {
    const auto ray = load_ray(rays, i);
    const Batch begin = rays.begin ? load<Batch>(rays.begin + i) : zero;
    const Batch end = min(load<Batch>(rays.end + i), Batch(far));
    const int k = gather(world, weights, i, ray, begin, end, on);
    const Batch ds = max(end - begin, zero) / Batch(float(steps));
    Batch T[3] = {1.f, 1.f, 1.f}, L[3] = {zero, zero, zero};
    for (int step = 0; k > 0 && step < steps; ++step) {
      const Batch t = begin + (Batch(float(step)) + Batch(0.5f)) * ds;
      Batch sigma[3] = {zero, zero, zero}, e[3] = {zero, zero, zero};
      for (int j = 0; j < k; ++j) {
        Walked& r = on[j];
        const Medium& m = *r.m;
        const auto here =
            (r.in.lo <= t) & (t < r.in.hi) & !((r.in.hole0 <= t) & (t < r.in.hole1));
        if (none(here)) continue;
        const Batch rho = select(here, density(m, r.p, ray, t) * r.weight, zero);
        Batch S[3] = {r.S[0], r.S[1], r.S[2]};
        if (!m.closed) source_at(world, r, ray, t, S);
        add_lamps(world, r, ray, t, S);
        for (int c = 0; c < 3; ++c) {
          const Batch k_c = Batch(m.sigma[c]) * rho;
          sigma[c] += k_c;
          e[c] += k_c * S[c] + Batch(m.emission[c]) * rho;
        }
      }
      for (int c = 0; c < 3; ++c) {
        L[c] += T[c] * e[c] * ds;
        T[c] = T[c] * exp(-(sigma[c] * ds));
      }
    }
    for (int c = 0; c < 3; ++c) {
      store(T_out[c] + i, T[c]);
      store(L_out[c] + i, L[c]);
    }
  }
}

}  // namespace

const MarchKernels march_kernels = {march};

}  // namespace brume::study::inline BRUME_ISA_NS
