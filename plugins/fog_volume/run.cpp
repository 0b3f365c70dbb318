#include "run.h"

#include "num/tail.h"

namespace fog_volume::inline BRUME_ISA_NS {
namespace {

constexpr int W = Batch::W;

struct RayBatch {
  Batch o[3], d[3];
  const Batch* from;  ///< null: the eye

  RayBatch(const brume_rays& rays, int i, int n) : from(rays.ox ? o : nullptr) {
    const float* const at[3] = {rays.ox, rays.oy, rays.oz};
    const float* const along[3] = {rays.dx, rays.dy, rays.dz};
    for (int k = 0; k < 3; ++k) {
      if (from) o[k] = load_some(at[k], i, n);
      d[k] = load_some(along[k], i, n);
    }
  }
  RayBatch(const RayBatch&) = delete;
};

void integrals(const Soft& v, const brume_rays& rays, const float* t0, const float* t1,
               float* D) noexcept {
  const int n = int(rays.n);
  for (int i = 0; i < n; i += W) {
    const RayBatch r(rays, i, n);
    store_some(D, i, n,
               integral(v, r.from, r.d, load_some(t0, i, n),
                        min(load_some(t1, i, n), Batch(kFar))));
  }
}

void densities(const Soft& v, const brume_rays& rays, const float* t,
               float* rho) noexcept {
  const int n = int(rays.n);
  for (int i = 0; i < n; i += W) {
    const RayBatch r(rays, i, n);
    store_some(rho, i, n, density_at(v, r.from, r.d, load_some(t, i, n)));
  }
}

}  // namespace

const Kernels kernels = {integrals, densities};

}  // namespace fog_volume::inline BRUME_ISA_NS
