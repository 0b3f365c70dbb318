#include "air/light.h"

#include "air/lit.h"

namespace brume::air::inline BRUME_ISA_NS {
namespace {

void irradiance(const Compiled& world, const Light& light, const Rays& rays,
                float* const E[3]) noexcept {
  for (int i = 0; i < rays.n; i += Batch::W) {
    const auto plane = load_ray(rays, i);
    auto in = incident(light, plane.o);
    Batch facing(static_cast<float>(kPi));
    if (light.kind != BRUME_SKY_LIGHT) {
      attenuate(world, light, plane.o, in);
      facing = max(dot(in.to, plane.d), Batch(0.f));
    }
    for (int c = 0; c < 3; ++c) store(E[c] + i, in.E[c] * facing);
  }
}

}  // namespace

const LightKernels light_kernels = {irradiance};

}  // namespace brume::air::inline BRUME_ISA_NS
