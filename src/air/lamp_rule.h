#pragma once
// The rule for a piece of a ray in a lamp's light. It goes by the angle psi under which
// the lamp sees the ray (Kulla & Fajardo 2012, "equi-angular"), in which the peak of
// 1/r^2 is flat, through the tangent of its half, w = tan(psi/2), so that no node asks
// for a sine or a root:
//   x = h (1/w - w) / 2,  r = h (1/w + w) / 2,  dx / r^2 = dw / (w r)
// psi is taken from the far end on either side of the foot, where w is small and keeps
// its digits; at the foot it is 1.

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

/// Distance from the foot as w, and back.
struct HalfAngle {
  Batch width;  // h, or what stands for it very near the lamp

  BRUME_INLINE explicit HalfAngle(const Foot& f)
      : width(max(f.h, Batch(1e-6f) * (abs(f.t) + Batch(1e-3f)))) {}
  BRUME_INLINE Batch w(Batch x) const {
    return width / (abs(x) + sqrt(x * x + width * width));
  }
  BRUME_INLINE Batch x(Batch w, Batch side) const {
    const Batch per_w = Batch(1.f) / max(w, Batch(1e-30f));
    return min(Batch(0.5f) * width * (per_w - w), Batch(1e18f)) * side;
  }
};

/// The light of a piece by both rules, whose difference tells the error; and what there
/// may be between the nodes that no node tells of.
struct Sums {
  Batch kronrod[3], gauss[3], unseen[3];
};

/// A piece [a, b] of the rays, on one side of the foot, in w too, and how deep it lies.
struct LampPiece {
  Batch a, b, w_a, w_b, side;
  Batch tau_a[3], tau_b[3];
  Mask within;  // the lamp's own sphere, where its light grows no more

  // What the rule goes by: within the sphere log w, which has places enough near the
  // foot, for the phase function, and far from it.
  BRUME_INLINE Batch to_q(Batch w) const {
    return any(within) ? select(within, log(max(w, Batch(1e-30f))), w) : w;
  }
  BRUME_INLINE Batch to_w(Batch q) const {
    return any(within) ? select(within, exp(q), q) : q;
  }
  // Seen from the lamp under so little that 1/r^2 is all but a parabola: what differs
  // along it is depth. Its places are then told by the way itself, of which an angle has
  // too few digits.
  BRUME_INLINE Mask narrow() const {
    return abs(w_b - w_a) <= Batch(0.05f) * max(w_a, w_b);
  }
  BRUME_INLINE Batch middle(const Foot& f, const HalfAngle& by) const {
    return select(narrow(), a + Batch(0.5f) * (b - a),
                  f.t + by.x(Batch(0.5f) * (w_a + w_b), side));
  }
};

/// The nodes of a piece: where they are, and how they see the lamp. Step by step for all
/// of them: each is a long chain of operations of which every one waits for the last, and
/// fifteen chains side by side fill the time.
struct Nodes {
  Batch x[kNodes], t[kNodes], step[kNodes];  // step: of t, per weight of the rule
  Leg leg[kNodes];
  Mask lit[kNodes];

  BRUME_INLINE Nodes(const LampRays& g, const HalfAngle& by, const LampPiece& piece,
                     Mask going) {
    const Batch half(0.5f), one(1.f), near(1e-30f), half_width = half * by.width,
                                                    half_way = half * (piece.b - piece.a);
    const Batch q_a = piece.to_q(piece.w_a), q_b = piece.to_q(piece.w_b);
    const Batch spread = half * (q_b - q_a), middle = half * (q_b + q_a);
    const auto narrow = piece.narrow();
    for (int i = 0; i < kNodes; ++i) {
      const Batch w = max(piece.to_w(middle + spread * Batch(kNode[i])), near);
      const Batch per_w = one / w, along = piece.a + half_way * Batch(1.f + kNode[i]);
      x[i] = min(half_width * (per_w - w), Batch(1e18f)) * piece.side;
      // dx / dq = r / w, or r; no more than floats hold, far away from a lamp that the
      // ray meets.
      const Batch per_q = abs(spread) * select(piece.within, one, per_w);
      step[i] = min(half_width * (per_w + w) * per_q, Batch(1e36f));
      t[i] = select(narrow, along, g.f.t + x[i]);
      x[i] = select(narrow, along - g.f.t, x[i]);
      step[i] = select(narrow, half_way, step[i]);
    }
    for (int i = 0; i < kNodes; ++i) {
      leg[i] = leg_from(g.lamp, g.f, g.ray, x[i]);
      lit[i] = going & (leg[i].fall > Batch(0.f)) & (t[i] >= Batch(0.f));
    }
  }
};

// What dims the lamp on its ways to the nodes.
inline void add_legs(const LampRays& g, const Nodes& at, Batch tau[kNodes][3]) {
  for (int n = 0; n < kNodes; ++n)
    for (int c = 0; c < 3; ++c) tau[n][c] = Batch(0.f);
  for (const Medium* m : g.world.absorbers) {
    const Lit* open = nullptr;
    for (int j = 0; j < g.k; ++j)
      if (g.on[j].m == m && g.on[j].open) open = &g.on[j];
    for (int n = 0; n < kNodes; ++n)
      open ? g.add_open_leg(*m, open->rho[n], at.leg[n], at.x[n], at.lit[n], tau[n])
           : add_optical_depth(*m, g.along_leg(at.leg[n], at.x[n]), at.leg[n].r, tau[n]);
  }
  if (g.world.shadowers.size > 0)
    for (int n = 0; n < kNodes; ++n)
      add_shadowers(g.world, g.along_leg(at.leg[n], at.x[n]), at.leg[n].r, tau[n]);
}

/// What of the lamp's light reaches the nodes and from there the eye, in one channel.
struct Reaching {
  Batch at[kNodes];       // times the step
  Batch light[kNodes];    // before the way to the eye
  Batch gap[kNodes + 1];  // the most of it before each node and beyond the last, a mean
                          // over optical depth

  BRUME_INLINE void fill(const LampRays& g, const LampPiece& piece, const Nodes& nodes,
                         const Batch eye[kNodes][3], const Batch leg[kNodes][3], int c) {
    const Batch zero(0.f), one(1.f);
    Batch tau = piece.tau_a[c], through = exp(-tau), last = zero;
    for (int n = 0; n < kNodes; ++n) {
      const Batch next = exp(-eye[n][c]);
      Batch there = nodes.leg[n].fall;
      if (g.lamp.attenuated) there = there * exp(-leg[n][c]);
      there = select(nodes.lit[n], there, zero);
      gap[n] = through * max(last, there) / max(eye[n][c] - tau, one);
      at[n] = next * (there * nodes.step[n]);
      light[n] = there;
      tau = eye[n][c], through = next, last = there;
    }
    gap[kNodes] = through * last / max(piece.tau_b[c] - tau, one);
  }
};

/// One medium at the nodes: density times phase function, and that alone.
struct Scattering {
  Batch rate[kNodes], p[kNodes];

  BRUME_INLINE Scattering(const Lit& r, const Nodes& at, const Ray<Batch>& ray) {
    for (int n = 0; n < kNodes; ++n)
      p[n] = phase(r.m->phase, at.leg[n].to, ray.d, r.m->g);
    for (int n = 0; n < kNodes; ++n)
      rate[n] = select(r.here, min(r.rho[n] * r.weight * p[n], Batch(kFar)), Batch(0.f));
  }
};

// The light of one medium from a piece in channel c, per `power`, added to the sums.
//   Between two nodes it is no more than the optical depth there times the more of what
//   reaches either. Of light that goes smoothly the nodes have about as much, however
//   steep: what is more than four times what they have, they do not see.
BRUME_INLINE void add_light(Lit& r, const Scattering& by, const Reaching& light,
                            Batch power, int c, Sums& s) {
  const Batch zero(0.f), most(1e34f);  // 600 pieces of these add up to a float
  Batch D = r.D_a, seen = zero, p = zero, unseen = zero;
  const auto go_on = [&](int n, Batch to_D, Batch to_seen, Batch to_p) {
    const Batch deeper = max(to_D - D - Batch(4e-7f) * to_D, zero);  // no rounding
    const Batch possible = deeper * (light.gap[n] * max(p, to_p) * power);
    unseen += min(max(possible - Batch(4.f) * (seen + to_seen), zero), most);
    D = to_D, seen = to_seen, p = to_p;
  };
  for (int n = 0; n < kNodes; ++n) {
    const Batch L = min(by.rate[n] * (power * light.at[n]), most);
    const Batch share = Batch(kKronrod[n]) * L;
    r.piece[c] += share;
    if (n % 2) s.gauss[c] += Batch(kGauss[n]) * L;
    go_on(n, r.D[n], share, by.p[n]);
  }
  go_on(kNodes, r.D_b, zero, zero);
  s.kronrod[c] += r.piece[c];
  s.unseen[c] += select(r.here, unseen, zero);
}

// The same of a medium with functions of its own, such as noise: its density may have any
// detail between the nodes, but its depth is known there, and what reaches it is smooth.
//   Sum over gaps of Delta D times the mean of e^-tau, exact, times that of the light at
//   both ends; over all gaps and over every second node. The error falls by 4 from these
//   to those, and most of it is taken away (Richardson 1911).
BRUME_INLINE void add_light_by_depth(Lit& r, const Scattering& by, const Reaching& light,
                                     const LampPiece& piece, const Batch eye[kNodes][3],
                                     Batch power, int c, Sums& s) {
  const Batch zero(0.f), most(1e34f);
  const auto sum = [&](int every) {
    Batch all = zero, D = r.D_a, tau = piece.tau_a[c], source(0.f);
    bool first = true;
    const auto go_on = [&](Batch to_D, Batch to_tau, Batch to_source) {
      const auto through = transmit(max(to_tau - tau, zero));
      const Batch depth = max(to_tau - tau, Batch(1e-6f));
      const Batch mean =
          exp(-tau) * select(to_tau - tau > Batch(1e-6f), through.A / depth, Batch(1.f));
      const Batch of_both = first ? to_source : Batch(0.5f) * (source + to_source);
      all += min(max(to_D - D, zero) * (mean * of_both * power), most);
      D = to_D, tau = to_tau, source = to_source, first = false;
    };
    for (int n = every - 1; n < kNodes; n += every)
      go_on(r.D[n], eye[n][c], light.light[n] * by.p[n]);
    go_on(r.D_b, piece.tau_b[c], source);
    return all;
  };
  const Batch fine = sum(1), coarse = sum(2);
  r.piece[c] = select(r.here, max(fine + Batch(1.f / 3) * (fine - coarse), zero), zero);
  s.gauss[c] += select(r.here, fine, zero);
  s.kronrod[c] += r.piece[c];
}

// Who is `here` is told, and D_a and D_b.
inline Sums rule(const LampRays& g, const HalfAngle& by, const LampPiece& piece,
                 Mask going) {
  const Nodes at(g, by, piece, going);
  Batch eye[kNodes][3], leg[kNodes][3];
  for (int n = 0; n < kNodes; ++n) g.node(n, at.t[n], going, eye[n]);
  if (g.lamp.attenuated) add_legs(g, at, leg);
  Reaching light[3];
  for (int c = 0; c < (g.world.grey ? 1 : 3); ++c)
    light[c].fill(g, piece, at, eye, leg, c);
  Sums s = {};
  for (int j = 0; j < g.k; ++j) {
    Lit& r = g.on[j];
    const Medium& m = *r.m;
    for (Batch& L : r.piece) L = Batch(0.f);
    if (!m.glows_by_lamp || none(r.here)) continue;
    const Scattering scattering(r, at, g.ray);
    for (int c = 0; c < 3; ++c) {
      const Reaching& reaching = light[g.world.grey ? 0 : c];
      const Batch power(m.sigma[c] * m.albedo[c] * g.lamp.power[c]);
      if (m.profile == BRUME_CUSTOM)
        add_light_by_depth(r, scattering, reaching, piece, eye, power, c, s);
      else
        add_light(r, scattering, reaching, power, c, s);
    }
  }
  return s;
}

}  // namespace brume::air::inline BRUME_ISA_NS
