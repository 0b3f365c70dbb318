#include "run.h"

#include "num/tail.h"

namespace fog_volume::inline BRUME_ISA_NS {
namespace {

constexpr int W = Batch::W;

Local<Batch> ray_at(const Soft& v, const brume_rays& rays, int i, int n) {
  const float* const from[3] = {rays.ox, rays.oy, rays.oz};
  const float* const along[3] = {rays.dx, rays.dy, rays.dz};
  Batch o[3], d[3];
  for (int k = 0; k < 3; ++k) {
    o[k] = from[k] ? load_some(from[k], i, n) : Batch(0.f);
    d[k] = load_some(along[k], i, n);
  }
  return local(v, o, d);
}

void integrals(const Soft& v, const brume_rays& rays, const float* t0, const float* t1,
               float* D) noexcept {
  const int n = int(rays.n);
  for (int i = 0; i < n; i += W)
    store_some(D, i, n,
               integral(v, ray_at(v, rays, i, n), load_some(t0, i, n),
                        min(load_some(t1, i, n), Batch(kFar))));
}

void densities(const Soft& v, const brume_rays& rays, const float* t,
               float* rho) noexcept {
  const int n = int(rays.n);
  for (int i = 0; i < n; i += W)
    store_some(rho, i, n,
               density(v, ray_at(v, rays, i, n), min(load_some(t, i, n), Batch(1e30f))));
}

}  // namespace

const Kernels kernels = {integrals, densities};

}  // namespace fog_volume::inline BRUME_ISA_NS
