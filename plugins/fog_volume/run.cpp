#include "run.h"

namespace fog_volume::inline BRUME_ISA_NS {
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

Local<Batch> ray_at(const Soft& v, const brume_rays& rays, int i, int n) {
  const float* const from[3] = {rays.ox, rays.oy, rays.oz};
  const float* const along[3] = {rays.dx, rays.dy, rays.dz};
  Batch o[3], d[3];
  for (int k = 0; k < 3; ++k) {
    o[k] = from[k] ? some(from[k], i, n) : Batch(0.f);
    d[k] = some(along[k], i, n);
  }
  return local(v, o, d);
}

void integrals(const Soft& v, const brume_rays& rays, const float* t0, const float* t1,
               float* D) noexcept {
  const int n = int(rays.n);
  for (int i = 0; i < n; i += W)
    put(D, i, n,
        integral(v, ray_at(v, rays, i, n), some(t0, i, n),
                 min(some(t1, i, n), Batch(kFar))));
}

void densities(const Soft& v, const brume_rays& rays, const float* t,
               float* rho) noexcept {
  const int n = int(rays.n);
  for (int i = 0; i < n; i += W)
    put(rho, i, n, density(v, ray_at(v, rays, i, n), min(some(t, i, n), Batch(1e30f))));
}

}  // namespace

const Kernels kernels = {integrals, densities};

}  // namespace fog_volume::inline BRUME_ISA_NS
