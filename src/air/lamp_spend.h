#pragma once
// A piece of a ray on which a lamp's light is one: stiff.

#include "air/lamp_rule.h"

namespace brume::air::inline BRUME_ISA_NS {

// A piece as short as floats allow and still of optical depth, so that no node of a rule
// would be where the light is. What the lamp makes of the medium at t, spent on the whole
// depth:
//   L = S (e^-tau_a - e^-tau_b), S = Sum of media's glow / extinction at t.
[[gnu::noinline]] inline void spend(const LampRays& g, Batch t, const Batch tau_a[3],
                                    const Batch tau_b[3], Mask lanes, Sums& s) {
  const Batch zero(0.f), x = t - g.f.t;
  const Leg leg = leg_from(g.lamp, g.f, g.ray, x);
  Batch tau[3] = {zero, zero, zero}, sigma[3] = {zero, zero, zero};
  g.add_depth_of(leg, x, tau);
  const auto rho_of = [&](const Lit& r) {  // two products of these stay floats
    const Batch rho = clamp(density(*r.m, r.p, g.ray, t) * r.weight, zero, Batch(1e20f));
    return select(r.here, rho, zero);
  };
  for (int j = 0; j < g.k; ++j)
    for (int c = 0; c < 3; ++c) sigma[c] += rho_of(g.on[j]) * Batch(g.on[j].m->sigma[c]);
  for (Batch& sum : s.kronrod) sum = select(lanes, zero, sum);
  for (int j = 0; j < g.k; ++j) {
    Lit& r = g.on[j];
    const Medium& m = *r.m;
    const Batch p = phase(m.phase, leg.to, g.ray.d, m.g);
    for (int c = 0; c < 3; ++c) {
      const Batch part = rho_of(r) * Batch(m.sigma[c]) / max(sigma[c], Batch(1e-30f)) *
                         Batch(m.albedo[c]);
      const Batch depth = min(tau_b[c], Batch(kFar)) - min(tau_a[c], Batch(kFar));
      const Batch spent = exp(-tau_a[c]) * transmit(max(depth, zero)).A;
      const Batch L =
          part * p * (exp(-tau[c]) * leg.fall * Batch(g.lamp.power[c])) * spent;
      r.piece[c] = select(lanes, L, r.piece[c]);
      s.kronrod[c] += select(lanes, L, zero);
    }
  }
}

}  // namespace brume::air::inline BRUME_ISA_NS
