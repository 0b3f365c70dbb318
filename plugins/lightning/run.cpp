#include "run.h"

#include "num/tail.h"

namespace lightning::inline BRUME_ISA_NS {
namespace {

constexpr int W = Batch::W;

// f(o, d, first ray) for every batch of rays, its answers to `out`.
template <class F>
void each(const brume_rays& rays, float* out, F f) {
  const float* const from[3] = {rays.ox, rays.oy, rays.oz};
  const float* const along[3] = {rays.dx, rays.dy, rays.dz};
  const int n = int(rays.n);
  for (int i = 0; i < n; i += W) {
    Batch o[3], d[3];
    for (int k = 0; k < 3; ++k) {
      o[k] = from[k] ? load_some(from[k], i, n) : Batch(0.f);
      d[k] = load_some(along[k], i, n);
    }
    store_some(out, i, n, f(o, d, i, n));
  }
}

void integrals(const Channel& k, const brume_rays& rays, const float* t0, const float* t1,
               float* D) noexcept {
  each(rays, D, [&](const Batch* o, const Batch* d, int i, int n) {
    return integral(k, o, d, load_some(t0, i, n), min(load_some(t1, i, n), Batch(kNone)));
  });
}

void densities(const Channel& k, const brume_rays& rays, const float* t,
               float* rho) noexcept {
  each(rays, rho, [&](const Batch* o, const Batch* d, int i, int n) {
    return density(k, o, d, min(load_some(t, i, n), Batch(1e12f)));
  });
}

}  // namespace

const Kernels kernels = {integrals, densities};

}  // namespace lightning::inline BRUME_ISA_NS
