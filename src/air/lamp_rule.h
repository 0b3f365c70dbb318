#pragma once
// The rule for a piece of a ray in a lamp's light, in the angle under which the lamp sees
// it (Kulla & Fajardo 2012, "equi-angular"): x = h / tan psi, dx / r^2 = dpsi / h, so
// that the peak of 1/r^2 is flat. psi is taken from the far end on either side of the
// foot, where it is small and keeps its digits.

#include "air/lamp_rays.h"

namespace brume::air::inline BRUME_ISA_NS {

// Gauss 7, Kronrod 15 on [-1, 1] (Kronrod 1965; Piessens et al. 1983, QUADPACK qk15).
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
  Batch per_width;

  BRUME_INLINE Angle(const Light& lamp, const Foot& f)
      : width(max(max(f.h, Batch(0.5f) * sqrt(Batch(lamp.radius2))),
                  Batch(1e-6f) * (abs(f.t) + Batch(1e-3f)))),
        per_width(Batch(1.f) / width) {}
  BRUME_INLINE Batch psi(Batch x) const { return atan2pos(width, abs(x)); }
  BRUME_INLINE Batch x(Batch psi, Batch side) const {
    const auto sc = sincos(psi);
    return min(width * sc.cos / max(sc.sin, Batch(1e-30f)), Batch(1e18f)) * side;
  }
  // No more than floats hold, far away from a lamp that the ray meets.
  BRUME_INLINE Batch dx_dpsi(Batch x) const {
    return min((x * x + width * width) * per_width, Batch(1e36f));
  }
};

/// The light of a piece by both rules; their difference tells the error.
struct Sums {
  Batch kronrod[3], gauss[3];
  Batch first[3], last[3];  // optical depth up to the first node, and to the last
  Batch last_r2;            // and how far that is from the lamp
};

/// A piece [a, b] of the rays, on one side of the foot, and its angles.
struct LampPiece {
  Batch a, b, psi_a, psi_b, side;

  BRUME_INLINE Batch width() const { return abs(psi_b - psi_a); }
  // Seen from the lamp under next to no angle: what differs along it is depth. Its places
  // are then told by the way itself, of which an angle has too few digits.
  BRUME_INLINE Mask narrow() const { return width() <= Batch(1e-3f) * max(psi_a, psi_b); }
};

/// The nodes of a piece: where they are, and how they see the lamp. Step by step for all
/// of them: each is a long chain of operations of which every one waits for the last, and
/// fifteen chains side by side fill the time.
struct Nodes {
  Batch x[kNodes], t[kNodes], light[kNodes];  // light: what arrives times the step in t
  Leg leg[kNodes];
  Mask lit[kNodes];
  int lit_ones[kNodes], n = 0;  // those with a lane that is lit, and the first

  BRUME_INLINE Nodes(const LampRays& g, const Angle& angle, const LampPiece& piece,
                     Mask going) {
    const Batch zero(0.f), half = Batch(0.5f) * (piece.psi_b - piece.psi_a),
                           middle = Batch(0.5f) * (piece.psi_b + piece.psi_a),
                           half_way = Batch(0.5f) * (piece.b - piece.a);
    const auto narrow = piece.narrow();
    for (int i = 0; i < kNodes; ++i)
      x[i] = angle.x(middle + half * Batch(kNode[i]), piece.side);
    for (int i = 0; i < kNodes; ++i) {
      const Batch along = piece.a + half_way * Batch(1.f + kNode[i]);
      const Batch step = abs(half) * angle.dx_dpsi(x[i]);
      t[i] = select(narrow, along, g.f.t + x[i]);
      x[i] = select(narrow, along - g.f.t, x[i]);
      leg[i] = leg_from(g.lamp, g.f, g.ray, x[i]);
      light[i] = leg[i].fall * select(narrow, half_way, step);
      lit[i] = going & (leg[i].fall > zero) & (t[i] >= zero);
      if (i == 0 || any(lit[i])) lit_ones[n++] = i;
    }
  }
  /// Calls work(node) for each that is lit.
  template <class Work>
  BRUME_INLINE void each(const Work& work) const {
    for (int i = 0; i < n; ++i) work(lit_ones[i]);
  }
};

// What dims the lamp on its ways to the nodes.
inline void add_legs(const LampRays& g, const Nodes& at, Batch tau[kNodes][3]) {
  if (!g.lamp.attenuated) return;
  for (const Medium* m : g.world.absorbers) {
    const Lit* open = nullptr;
    for (int j = 0; j < g.k; ++j)
      if (g.on[j].m == m && g.on[j].open) open = &g.on[j];
    at.each([&](int n) {
      open ? g.add_open_leg(*m, open->rho[n], at.leg[n], at.x[n], at.lit[n], tau[n])
           : add_optical_depth(*m, g.along_leg(at.leg[n], at.x[n]), at.leg[n].r, tau[n]);
    });
  }
  if (g.world.shadowers.size > 0)
    at.each([&](int n) {
      add_shadowers(g.world, g.along_leg(at.leg[n], at.x[n]), at.leg[n].r, tau[n]);
    });
}

// Who is `here` is told.
inline Sums rule(const LampRays& g, const Angle& angle, const LampPiece& piece,
                 Mask going) {
  const Batch zero(0.f);
  const Nodes at(g, angle, piece, going);
  Batch tau[kNodes][3], T[kNodes][3];
  at.each([&](int n) { g.node(n, at.t[n], going, tau[n]); });
  Sums s;
  for (int c = 0; c < 3; ++c) {
    s.kronrod[c] = s.gauss[c] = zero;
    s.first[c] = s.last[c] = tau[0][c];
  }
  s.last_r2 = at.leg[0].r * at.leg[0].r;
  at.each([&](int n) {  // a ray's own nodes, not those of all rays
    for (int c = 0; c < 3; ++c) s.last[c] = select(at.lit[n], tau[n][c], s.last[c]);
    s.last_r2 = select(at.lit[n], at.leg[n].r * at.leg[n].r, s.last_r2);
  });
  add_legs(g, at, tau);
  // Both ways together: one exponential, and only one where all is grey.
  at.each([&](int n) {
    Batch through;
    for (int c = 0; c < 3; ++c) {
      if (c == 0 || any(tau[n][c] != tau[n][c - 1])) through = exp(-tau[n][c]);
      T[n][c] = select(at.lit[n], through * at.light[n] * Batch(g.lamp.power[c]), zero);
    }
  });
  for (int j = 0; j < g.k; ++j) {
    Lit& r = g.on[j];
    const Medium& m = *r.m;
    for (Batch& L : r.piece) L = zero;
    if (!m.glows_by_lamp || none(r.here)) continue;
    at.each([&](int n) {
      const Batch mu = -at.x[n] * at.leg[n].per_r;
      const Batch rate = select(
          r.here, min(r.rho[n] * r.weight * phase(m.phase, mu, m.g), Batch(kFar)), zero);
      for (int c = 0; c < 3; ++c) {
        const Batch L =  // 600 pieces of these add up to a float
            min(rate * (Batch(m.sigma[c] * m.albedo[c]) * T[n][c]), Batch(1e34f));
        r.piece[c] += Batch(kKronrod[n]) * L;
        s.gauss[c] += Batch(kGauss[n]) * L;
      }
    });
    for (int c = 0; c < 3; ++c) s.kronrod[c] += r.piece[c];
  }
  return s;
}

}  // namespace brume::air::inline BRUME_ISA_NS
