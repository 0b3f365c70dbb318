#include "air/light.h"

#include "air/lit.h"

namespace brume::air::inline BRUME_ISA_NS {
namespace {

// E(n) = Sum C cos(m phi) + S sin(m phi) times Legendre's polynomials (sky_light.h), with
// (x + i y)^m in place of sin^m(theta) e^(i m phi).
BRUME_INLINE void sky_irradiance(const SkyHarmonics& sky, const Batch n[3], Batch E[3]) {
  for (int c = 0; c < 3; ++c) E[c] = Batch(0.f);
  Batch re(1.f), im(0.f);
  int i = 0;
  for (int m = 0; m <= SkyHarmonics::kDegree; ++m) {
    Batch before(0.f), here(1.f);
    for (int l = m; l <= SkyHarmonics::kDegree; ++l, ++i) {
      if (l > m) {
        const Batch next = Batch(sky.rise[i]) * n[2] * here - Batch(sky.fall[i]) * before;
        before = here;
        here = next;
      }
      if (l > 1 && l % 2 == 1) continue;  // a clamped cosine has none of these
      for (int c = 0; c < 3; ++c)
        E[c] += here * (re * Batch(sky.C[c][i]) + im * Batch(sky.S[c][i]));
    }
    const Batch turned = re * n[0] - im * n[1];
    im = re * n[1] + im * n[0];
    re = turned;
  }
  for (int c = 0; c < 3; ++c) E[c] = max(E[c], Batch(0.f));
}

void irradiance(const Compiled& world, const Light& light, const SkyHarmonics* sky,
                const Rays& rays, float* const E[3]) noexcept {
  for (int i = 0; i < rays.n; i += Batch::W) {
    const auto plane = load_ray(rays, i);
    if (light.kind == BRUME_SKY_LIGHT) {
      Batch from_sky[3] = {light.power[0], light.power[1], light.power[2]};
      for (Batch& e : from_sky) e *= Batch(static_cast<float>(kPi));
      if (sky) sky_irradiance(*sky, plane.d, from_sky);
      for (int c = 0; c < 3; ++c) store(E[c] + i, from_sky[c]);
      continue;
    }
    auto in = incident(light, plane.o);
    // At the lamp itself more than a float holds, which times 0 would be no number.
    for (Batch& e : in.E) e = min(e, Batch(kFar));
    attenuate(world, light, plane.o, in);
    const Batch facing = max(dot(in.to, plane.d), Batch(0.f));
    for (int c = 0; c < 3; ++c) store(E[c] + i, in.E[c] * facing);
  }
}

}  // namespace

const LightKernels light_kernels = {irradiance};

}  // namespace brume::air::inline BRUME_ISA_NS
