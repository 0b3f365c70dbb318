#include "run.h"

namespace lightning::inline BRUME_ISA_NS {
namespace {

constexpr int W = Batch::W;

// Values i .. i + W - 1; beyond the last, the last again.
Batch some(const float* p, int i, int n) {
  if (i + W <= n) return load<Batch>(p + i);
  float copy[W];
  for (int k = 0; k < W; ++k) copy[k] = p[i + k < n ? i + k : n - 1];
  return load<Batch>(copy);
}
void put(float* p, int i, int n, Batch x) {
  if (i + W <= n) return store(p + i, x);
  float copy[W];
  store(copy, x);
  for (int k = 0; i + k < n; ++k) p[i + k] = copy[k];
}

// f(o, d, first ray) for every batch of rays, its answers to `out`.
template <class F>
void each(const brume_rays& rays, float* out, F f) {
  const float* const from[3] = {rays.ox, rays.oy, rays.oz};
  const float* const along[3] = {rays.dx, rays.dy, rays.dz};
  const int n = int(rays.n);
  for (int i = 0; i < n; i += W) {
    Batch o[3], d[3];
    for (int k = 0; k < 3; ++k) {
      o[k] = from[k] ? some(from[k], i, n) : Batch(0.f);
      d[k] = some(along[k], i, n);
    }
    put(out, i, n, f(o, d, i, n));
  }
}

void integrals(const Channel& k, const brume_rays& rays, const float* t0, const float* t1,
               float* D) noexcept {
  each(rays, D, [&](const Batch* o, const Batch* d, int i, int n) {
    return integral(k, o, d, some(t0, i, n), min(some(t1, i, n), Batch(kNone)));
  });
}

void densities(const Channel& k, const brume_rays& rays, const float* t,
               float* rho) noexcept {
  each(rays, rho, [&](const Batch* o, const Batch* d, int i, int n) {
    return density(k, o, d, min(some(t, i, n), Batch(1e12f)));
  });
}

}  // namespace

const Kernels kernels = {integrals, densities};

}  // namespace lightning::inline BRUME_ISA_NS
