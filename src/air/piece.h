#pragma once
// A piece of a ray, in two halves: what each medium does on it, and L by the rule.

#include "air/lit.h"
#include "air/on_ray.h"
#include "air/rule.h"

namespace brume::air::inline BRUME_ISA_NS {

using B = Batch;

constexpr float kMostDepth = 1e20f;  ///< optical depth of a piece: more is the same
constexpr float kMostRate = 1e20f;   ///< likewise of extinction; its light is a float
constexpr float kFarthest =
    1e18f;  ///< of a place that is asked about [m]: its square is a float

/// One medium on the way of the walk.
struct Walked : OnRay {
  Batch S[3];    // constant part of the source
  Batch now[3];  // its source where the lanes stand (media whose source varies)
  // this piece, in two halves
  Batch D1, D2, rho_a, rho_m, rho_b;
  Batch Sa[3], Sm[3], Sb[3], J1[3], J2[3];
  // A medium that is told, not asked at points: what it answers up to t and up to the
  // piece's end; its depths and its extinction at three places, by channel.
  bool told;
  Batch L_t[3], T_t[3], L_b[3], T_b[3];
  Batch d1[3], d2[3], ka[3], km[3], kb[3];
};

// What a channel of a piece, or of half of it, needs for the rule.
struct Piece {
  Batch d, ea, ka, eb, kb, J, least, most;
};

BRUME_INLINE Batch ratio(Batch e, Batch k, Batch mean, Batch least, Batch most) {
  const Batch s = e / k;
  return clamp(select(abs(s) < B(3e38f), s, mean), least, most);
}

/// The source's end values of a piece and the weights that make L of them.
struct Ruled {
  Batch Sa, Sb, L;
  Batch plain;  // L with the mean alone: a rule of second order
  PieceWeights<Batch> w;
};
BRUME_INLINE Ruled ruled(const Piece& x, const SourceWeights<Batch>& E) {
  const Batch mean = x.J / max(x.d, B(1e-30f));
  Ruled r;
  r.Sa = ratio(x.ea, x.ka, mean, x.least, x.most);
  r.Sb = ratio(x.eb, x.kb, mean, x.least, x.most);
  r.w = piece_weights(x.d, r.Sa, r.Sb, x.J, x.least, x.most, E);
  // Rounding alone does not make light negative.
  const Batch L = r.w.a * r.Sa + r.w.b * r.Sb + r.w.j * x.J;
  r.L = select(x.least >= B(0.f), max(L, B(0.f)), L);
  r.plain = select(x.d < B(1e-7f), x.J, mean * E.E0);
  return r;
}

// Source of a medium whose source varies, at t.
inline void source_at(const Compiled& world, const Walked& r, const Ray<Batch>& ray,
                      Batch t, Batch S[3]) {
  const Medium& m = *r.m;
  for (int c = 0; c < 3; ++c) S[c] = r.S[c];
  const Batch at = min(t, B(kFarthest));
  if (m.source_at) {
    const Spans s(ray);
    float x[Batch::W], rgb[3][Batch::W];
    store(x, at);
    m.source_at(m.self, &s.rays, x, rgb[0], rgb[1], rgb[2]);
    for (int c = 0; c < 3; ++c) S[c] += load<Batch>(rgb[c]);
  }
  if (!m.glows_by_sun) return;
  Batch x[3];
  point_at(ray, at, x);
  for (const Light& sun : world.suns) {
    auto in = incident(sun, x);
    attenuate(world, sun, x, in);
    const Batch p = phase(m.phase, in.to, ray.d, m.g);
    for (int c = 0; c < 3; ++c) S[c] += B(m.sky_albedo[c]) * p * in.E[c];
  }
}

// Fills in a medium's part of the piece [t, mid, b]: exact depths of both halves, density
// at three places, and the light added, exact for a constant source. Whole: the light
// added over the piece as its three places alone would have it.
inline void measure(const Compiled& world, Walked& r, const Ray<Batch>& ray, Batch t,
                    Batch mid, Batch b, Batch whole[3]) {
  const Medium& m = *r.m;
  const Batch zero(0.f);
  const auto D = [&](Batch x, Batch y) {
    return select(r.here, integral(m, r.p, ray, x, y) * r.weight, zero);
  };
  const auto rho = [&](Batch x) {
    return select(r.here, density(m, r.p, ray, x) * r.weight, zero);
  };
  r.rho_a = rho(t);
  r.rho_m = rho(mid);
  r.rho_b = rho(b);
  r.D1 = D(t, mid);
  r.D2 = D(mid, b);
  if (m.cap > 0) {  // its last piece takes all that is left of it
    r.D1 = min(r.D1, r.in.left);
    const Batch left = r.in.left - r.D1;
    r.D2 = select(r.here & r.in.capped() & (b >= r.in.hi), left, min(r.D2, left));
  }
  if (m.closed) {
    for (int c = 0; c < 3; ++c) {
      r.Sa[c] = r.Sm[c] = r.Sb[c] = r.S[c];
      r.J1[c] = r.S[c] * min(B(m.sigma[c]) * r.D1, B(kMostDepth));
      r.J2[c] = r.S[c] * min(B(m.sigma[c]) * r.D2, B(kMostDepth));
      whole[c] = r.J1[c] + r.J2[c];
    }
    return;
  }
  // Where the quarters are in optical depth of this medium.
  const Batch q1 = t + B(0.5f) * (mid - t);
  const Batch q3 = mid + B(0.5f) * (min(b, B(kMaxLength)) - mid);
  // What a cap leaves of a half may be less than its quarter has.
  const auto part = [&](Batch x, Batch y) {
    return select(y > zero, min(x / y, B(1.f)), B(0.5f));
  };
  const Batch v1 = part(D(t, q1), r.D1), v3 = part(D(mid, q3), r.D2);
  const Batch v = part(r.D1, r.D1 + r.D2);
  Batch S1[3], S3[3];
  for (int c = 0; c < 3; ++c) r.Sa[c] = r.now[c];
  source_at(world, r, ray, q1, S1);
  source_at(world, r, ray, mid, r.Sm);
  source_at(world, r, ray, q3, S3);
  source_at(world, r, ray, b, r.Sb);
  for (int c = 0; c < 3; ++c) {
    const Batch d1 = min(B(m.sigma[c]) * r.D1, B(kMostDepth));
    const Batch d2 = min(B(m.sigma[c]) * r.D2, B(kMostDepth));
    r.J1[c] = d1 * mean_of_three(r.Sa[c], S1[c], r.Sm[c], v1);
    r.J2[c] = d2 * mean_of_three(r.Sm[c], S3[c], r.Sb[c], v3);
    whole[c] = (d1 + d2) * mean_of_three(r.Sa[c], r.Sm[c], r.Sb[c], v);
  }
}

// What a medium answers for itself over [from, to] of each ray.
inline void tell(const Walked& r, const Ray<Batch>& ray, Batch from, Batch to, Batch L[3],
                 Batch T[3]) {
  const Medium& m = *r.m;
  const Spans s(ray);
  float weights[Batch::W], t0[Batch::W], t1[Batch::W], answer[6][Batch::W];
  store(weights, r.weight);
  store(t0, min(from, to));
  store(t1, forever(to));
  float* const to_L[3] = {answer[0], answer[1], answer[2]};
  float* const to_T[3] = {answer[3], answer[4], answer[5]};
  m.alone(m.self, &s.rays, weights, t0, t1, to_L, to_T);
  for (int c = 0; c < 3; ++c) {
    L[c] = load<Batch>(answer[c]);
    T[c] = clamp(load<Batch>(answer[3 + c]), Batch(1e-36f), Batch(1.f));
  }
}

// `measure` for a medium whose answer over a stretch is known: depths and light of both
// halves are differences of that along the one ray; its source is taken as linear in
// optical depth, with their means.
inline void measure_told(Walked& r, const Ray<Batch>& ray, Batch t, Batch mid, Batch b,
                         Batch whole[3]) {
  const Batch zero(0.f);
  Batch L_m[3], T_m[3];
  tell(r, ray, r.in.lo, mid, L_m, T_m);
  tell(r, ray, r.in.lo, b, r.L_b, r.T_b);
  r.D1 = r.D2 = r.rho_a = r.rho_m = r.rho_b = zero;
  for (int c = 0; c < 3; ++c) {
    // Depth and light of a half, and its mean source.
    const auto half = [&](Batch L0, Batch T0, Batch L1, Batch T1, Batch& d, Batch& J) {
      const Batch depth = max(log(T0) - log(T1), zero), added = max(L1 - L0, zero) / T0,
                  A = transmit(depth).A;
      // Before any of it is lost on the way to the half's begin.
      J = select(depth > Batch(1e-6f), added * depth / max(A, Batch(1e-30f)), added);
      d = select(r.here, depth, zero);
      J = select(r.here, J, zero);
      return select(d > Batch(1e-12f), J / max(d, Batch(1e-12f)), zero);
    };
    const Batch S1 = half(r.L_t[c], r.T_t[c], L_m[c], T_m[c], r.d1[c], r.J1[c]);
    const Batch S2 = half(L_m[c], T_m[c], r.L_b[c], r.T_b[c], r.d2[c], r.J2[c]);
    const Batch d = r.d1[c] + r.d2[c], v = r.d1[c] / max(d, Batch(1e-30f));
    r.Sm[c] = select(d > zero, S1 + v * (S2 - S1), S1);
    r.Sa[c] = max(S1 + S1 - r.Sm[c], zero);
    r.Sb[c] = max(S2 + S2 - r.Sm[c], zero);
    const Batch k1 = r.d1[c] / max(mid - t, Batch(1e-30f)),
                k2 = r.d2[c] / max(b - mid, Batch(1e-30f));
    r.km[c] = select(b >= Batch(kMaxLength), k1, Batch(0.5f) * (k1 + k2));
    r.ka[c] = max(k1 + k1 - r.km[c], zero);
    r.kb[c] = max(k2 + k2 - r.km[c], zero);
    whole[c] = r.J1[c] + r.J2[c];
    const Batch inv(1 / r.m->densest);
    r.D1 = max(r.D1, r.d1[c] * inv);
    r.D2 = max(r.D2, r.d2[c] * inv);
  }
}

// Adds to every medium's share of channel c what it did on a piece that is taken: its
// part of each of the three numbers that the rule is made of, on either half.
inline void add_shares(Walked* on, int k, int c, const Piece& one, const Ruled& r1,
                       const Piece& two, const Ruled& r2, Batch e1, Batch T,
                       Mask accept) {
  for (int j = 0; j < k; ++j) {
    Walked& r = on[j];
    if (none(r.here)) continue;
    const Batch sigma(r.m->sigma[c]), em(r.m->emission[c]);
    const auto part = [&](const Piece& x, const Ruled& u, Batch rho0, Batch S0,
                          Batch rho1, Batch S1, Batch J) {
      const Batch of_J = J / select(x.J == B(0.f), B(1.f), x.J);
      const auto of = [&](Batch mine, Batch all) {
        const Batch f = mine / all;
        return select(abs(f) < B(1e6f), f, of_J);
      };
      return u.w.a * u.Sa * of((sigma * S0 + em) * rho0, x.ea) +
             u.w.b * u.Sb * of((sigma * S1 + em) * rho1, x.eb) + u.w.j * J;
    };
    // Of one that is told extinction is known by channel: per sigma it is a density.
    const Batch per = r.told ? B(1.f) / sigma : B(0.f);
    const Batch rho_a = r.told ? r.ka[c] * per : r.rho_a,
                rho_m = r.told ? r.km[c] * per : r.rho_m,
                rho_b = r.told ? r.kb[c] * per : r.rho_b;
    const Batch mine = part(one, r1, rho_a, r.Sa[c], rho_m, r.Sm[c], r.J1[c]) +
                       e1 * part(two, r2, rho_m, r.Sm[c], rho_b, r.Sb[c], r.J2[c]);
    r.share[c] += select(accept & r.here, T * mine, B(0.f));
  }
}

}  // namespace brume::air::inline BRUME_ISA_NS
