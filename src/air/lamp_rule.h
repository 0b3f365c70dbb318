#pragma once
// The rule for a piece of a ray in a lamp's light, in the angle under which the lamp sees
// it (Kulla & Fajardo 2012, "equi-angular"): x = h / tan psi, dx / r^2 = dpsi / h, so
// that the peak of 1/r^2 is flat. psi is taken from the far end on either side of the
// foot, where it is small and keeps its digits.

#include "air/lamp_rays.h"

namespace brume::air::inline BRUME_ISA_NS {

// Gauss 7, Kronrod 15 on [-1, 1] (Kronrod 1965; Piessens et al. 1983, QUADPACK qk15).
constexpr int kNodes = 15;
constexpr float kNode[kNodes] = {
    -9.914553711e-01f, -9.491079123e-01f, -8.648644234e-01f, -7.415311856e-01f,
    -5.860872355e-01f, -4.058451514e-01f, -2.077849550e-01f, 0.f,
    2.077849550e-01f,  4.058451514e-01f,  5.860872355e-01f,  7.415311856e-01f,
    8.648644234e-01f,  9.491079123e-01f,  9.914553711e-01f};
constexpr float kKronrod[kNodes] = {2.293532201e-02f, 6.309209263e-02f, 1.047900103e-01f,
                                    1.406532597e-01f, 1.690047266e-01f, 1.903505781e-01f,
                                    2.044329401e-01f, 2.094821411e-01f, 2.044329401e-01f,
                                    1.903505781e-01f, 1.690047266e-01f, 1.406532597e-01f,
                                    1.047900103e-01f, 6.309209263e-02f, 2.293532201e-02f};
constexpr float kGauss[kNodes] = {0.f, 1.294849662e-01f, 0.f, 2.797053915e-01f,
                                  0.f, 3.818300505e-01f, 0.f, 4.179591837e-01f,
                                  0.f, 3.818300505e-01f, 0.f, 2.797053915e-01f,
                                  0.f, 1.294849662e-01f, 0.f};

/// Distance from the foot as an angle, and back.
struct Angle {
  Batch width;  // h, or what stands for it very near the lamp

  BRUME_INLINE Angle(const Light& lamp, const Foot& f)
      : width(max(max(f.h, Batch(0.5f) * sqrt(Batch(lamp.radius2))),
                  Batch(1e-6f) * (abs(f.t) + Batch(1e-3f)))) {}
  BRUME_INLINE Batch psi(Batch x) const { return atan2pos(width, abs(x)); }
  BRUME_INLINE Batch x(Batch psi, Batch side) const {
    const auto sc = sincos(psi);
    return min(width * sc.cos / max(sc.sin, Batch(1e-30f)), Batch(1e18f)) * side;
  }
  BRUME_INLINE Batch dx_dpsi(Batch x) const { return (x * x + width * width) / width; }
};

/// The light of a piece by both rules; their difference tells the error.
struct Sums {
  Batch kronrod[3], gauss[3];
  Batch first[3];  // optical depth up to the first node
};

// On the piece between psi_a and psi_b on one side of the foot; who is `here` is told.
inline Sums rule(const LampRays& g, const Angle& angle, Batch side, Batch psi_a,
                 Batch psi_b, Mask going) {
  const Batch zero(0.f);
  Sums s;
  for (int c = 0; c < 3; ++c) s.kronrod[c] = s.gauss[c] = zero;
  for (int j = 0; j < g.k; ++j)
    for (Batch& x : g.on[j].piece) x = zero;
  const Batch half = Batch(0.5f) * (psi_b - psi_a),
              middle = Batch(0.5f) * (psi_b + psi_a);
  for (int n = 0; n < kNodes; ++n) {
    const Batch x = angle.x(middle + half * Batch(kNode[n]), side);
    const Batch t = g.f.t + x, dt = abs(half) * angle.dx_dpsi(x);
    const Leg leg = leg_from(g.lamp, g.f, g.ray, x);
    const auto lit = going & (leg.fall > zero) & (t >= zero);
    if (n > 0 && none(lit)) continue;
    // Both legs together: one exponential, and only one where all is grey.
    Batch tau[3], T[3], through;
    g.depth_before(t, tau);
    if (n == 0)
      for (int c = 0; c < 3; ++c) s.first[c] = tau[c];
    g.add_depth_of(leg, x, tau);
    for (int c = 0; c < 3; ++c) {
      if (c == 0 || any(tau[c] != tau[c - 1])) through = exp(-tau[c]);
      T[c] = select(lit, through * (leg.fall * dt) * Batch(g.lamp.power[c]), zero);
    }
    const Batch mu = -x / leg.r;
    for (int j = 0; j < g.k; ++j) {
      Lit& r = g.on[j];
      const Medium& m = *r.m;
      if (!m.glows_by_lamp || none(r.here)) continue;
      const Batch rho = density(m, r.p, g.ray, t) * r.weight;
      const Batch rate =
          select(r.here, min(rho * phase(m.phase, mu, m.g), Batch(kFar)), zero);
      for (int c = 0; c < 3; ++c) {
        const Batch L = rate * (Batch(m.sigma[c] * m.albedo[c]) * T[c]);
        r.piece[c] += Batch(kKronrod[n]) * L;
        s.kronrod[c] += Batch(kKronrod[n]) * L;
        s.gauss[c] += Batch(kGauss[n]) * L;
      }
    }
  }
  return s;
}

}  // namespace brume::air::inline BRUME_ISA_NS
