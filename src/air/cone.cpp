#include "air/cone.h"

#include "num/batch.h"

namespace brume::air::inline BRUME_ISA_NS {
namespace {

void axis(const Rays& r, float total[3], float* farthest) noexcept {
  Batch x(0.f), y(0.f), z(0.f), far(0.f);
  for (int i = 0; i < r.n; i += Batch::W) {
    x += load<Batch>(r.dx + i);
    y += load<Batch>(r.dy + i);
    z += load<Batch>(r.dz + i);
    far = max(far, load<Batch>(r.end + i));
  }
  total[0] = sum(x);
  total[1] = sum(y);
  total[2] = sum(z);
  *farthest = highest(far);
}

void narrowest(const Rays& r, const float axis[3], float* cosine) noexcept {
  Batch least(1.f);
  for (int i = 0; i < r.n; i += Batch::W)
    least = min(least, load<Batch>(r.dx + i) * axis[0] + load<Batch>(r.dy + i) * axis[1] +
                           load<Batch>(r.dz + i) * axis[2]);
  *cosine = lowest(least);
}

}  // namespace

const ConeKernels cone_kernels = {axis, narrowest};

}  // namespace brume::air::inline BRUME_ISA_NS
