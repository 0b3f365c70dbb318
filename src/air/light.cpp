#include "air/light.h"

#include "air/lit.h"
#include "num/math_trig.h"

namespace brume::air::inline BRUME_ISA_NS {
namespace {

// E(n) by the map (sky_light.h).
BRUME_INLINE void sky_irradiance(const SkyMap& map, const Batch n[3], Batch E[3]) {
  constexpr int W = Batch::W;
  Batch d[3];
  for (int k = 0; k < 3; ++k)
    d[k] = n[0] * Batch(map.axis[k][0]) + n[1] * Batch(map.axis[k][1]) +
           n[2] * Batch(map.axis[k][2]);

  // Those below the horizontal by their opposite.
  const Mask below = d[2] < Batch(0.f);
  for (Batch& x : d) x = select(below, -x, x);

  // Which row: from where on, and four weights.
  const Batch from_up = atan2pos(sqrt(d[0] * d[0] + d[1] * d[1]), d[2]);
  const Batch past = from_up - Batch(map.edge);
  const Mask in_cap = past < Batch(0.f);
  const Batch v = sqrt(select(in_cap, -past * Batch(map.cap), past * Batch(map.belt)));
  const Batch last =
      select(in_cap, Batch(float(SkyMap::kCap - 3)), float(SkyMap::kBelt - 3));
  const Batch low = clamp(floor(v) - Batch(1.f), Batch(0.f), last), f = v - low;
  const Batch row = low + select(in_cap, Batch(0.f), float(SkyMap::kCap + 1));
  const Batch f1 = f - Batch(1.f), f2 = f - Batch(2.f), f3 = f - Batch(3.f);
  const Batch by_row[4] = {f1 * f2 * f3 * Batch(-1 / 6.f), f * f2 * f3 * Batch(.5f),
                           f * f1 * f3 * Batch(-.5f), f * f1 * f2 * Batch(1 / 6.f)};

  // Which columns.
  const Batch angle = atan2(d[1], d[0]) * Batch(float(SkyMap::kAround / (2 * kPi)));
  const Batch u =
      select(angle < Batch(0.f), angle + Batch(float(SkyMap::kAround)), angle);
  const Batch column = clamp(floor(u), Batch(0.f), Batch(float(SkyMap::kAround - 1)));
  const Batch g = u - column, h = Batch(1.f) - g;
  const Batch sixth(1 / 6.f), two_thirds(2 / 3.f), half(.5f);
  const Batch by_column[4] = {
      sixth * h * h * h, two_thirds - half * g * g * (h + Batch(1.f)),
      two_thirds - half * h * h * (g + Batch(1.f)), sixth * g * g * g};

  // Four rows become one, of four columns.
  alignas(64) float one[W][16], weight[4][W], at[W];
  store(at, row * Batch(float(SkyMap::kRow)) + column * Batch(4.f));
  for (int k = 0; k < 4; ++k) store(weight[k], by_row[k]);
  for (int i = 0; i < W; ++i) {
    const float* const p = map.E.data() + int(at[i]);
    for (int q = 0; q < 16; q += W) {
      Batch sum(0.f);
      for (int k = 0; k < 4; ++k)
        sum += Batch(weight[k][i]) * load<Batch>(p + k * SkyMap::kRow + q);
      store(one[i] + q, sum);
    }
  }
  for (int c = 0; c < 3; ++c) {
    Batch sum(0.f);
    for (int k = 0; k < 4; ++k) {
      alignas(64) float lane[W];
      for (int i = 0; i < W; ++i) lane[i] = one[i][4 * k + c];
      sum += by_column[k] * load<Batch>(lane);
    }
    const float* const F = map.flux[c];
    const Batch less = d[0] * Batch(F[0]) + d[1] * Batch(F[1]) + d[2] * Batch(F[2]);
    E[c] = max(sum - select(below, less, 0.f), Batch(0.f));
  }
}

void irradiance(const Compiled& world, const Light& light, const SkyMap* sky,
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
