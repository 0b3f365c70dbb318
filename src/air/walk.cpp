#include "air/walk.h"

#include "air/piece.h"
#include "air/shadows.h"
#include "air/steady.h"

namespace brume::air::inline BRUME_ISA_NS {
namespace {

constexpr float kBlack = 40;  // e^-40: no light of this world comes through
constexpr float kThick = 12;  // a piece with different sources is not thicker than this
constexpr int kSteps = 4000;  // the last pieces are taken as they are, each twice as long
constexpr int kLast = 400;    // as the one before: 2^400 of the least are any way
constexpr float kPlainPart = 0.05f;
constexpr float kUnseenPart = 0.2f;
constexpr float kSteep = 8;       // e-folds by which densities may part on one piece
constexpr float kFew = 1.f / 64;  // less of a piece in one half, and it checks nothing
constexpr float kTail = 0.1f;     // part of the tolerance that an endless tail may take

// Where a lane may go in one piece: the next boundary of any medium, if a step of H does
// not end before. Also who is here.
BRUME_INLINE Batch next_boundary(Walked* on, int k, const Batch* cuts, int cut_count,
                                 Batch t, Batch end, Mask& anyone) {
  Next next(t, end);
  anyone = Mask(false);
  for (int j = 0; j < k; ++j) {
    next.consider(on[j].in);
    on[j].here = on[j].at(t);
    anyone = anyone | on[j].here;
  }
  for (int j = 0; j < cut_count; ++j) next.consider(cuts[j]);
  return next.next;
}

// A length over which something changes at t, for cutting an endless piece.
Batch natural_length(const Walked* on, int k, const Ray<Batch>& ray, Batch t) {
  Batch rate(1e-30f);
  for (int j = 0; j < k; ++j) {
    const Walked& r = on[j];
    const Medium& m = *r.m;
    Batch own = r.weight * density(m, r.p, ray, min(t, B(kFarthest))) * B(m.densest);
    if (m.profile == BRUME_EXPONENTIAL) own = max(own, abs(r.p.p1));
    if (m.profile == BRUME_LORENTZIAN)
      own = max(own, r.p.p1 / max(r.p.p1 * abs(t - r.p.p0), B(1.f)));
    rate = max(rate, select(r.here, own, B(0.f)));
  }
  return B(1.f) / rate;
}

void walk_batch(const Compiled& world, Walked* on, int k, Batch* cuts,
                const Ray<Batch>& ray, bool shares, Batch L[3]) {
  const Batch zero(0.f), far(kFar);
  Batch t = far, end = zero;
  for (int j = 0; j < k; ++j) {
    t = min(t, on[j].in.lo);
    end = max(end, select(on[j].in.lo < on[j].in.hi, on[j].in.hi, zero));
    for (int c = 0; c < 3; ++c) on[j].L_t[c] = zero, on[j].T_t[c] = B(1.f);
    if (!on[j].m->closed && !on[j].told)
      source_at(world, on[j], ray, on[j].in.lo, on[j].now);
  }
  Mask sunlit(false);
  for (int j = 0; j < k; ++j)
    if (on[j].m->glows_by_sun && !on[j].m->closed)
      sunlit = sunlit | (on[j].in.lo < on[j].in.hi);
  const int cut_count = any(sunlit) ? shadow_cuts(world, ray, sunlit, cuts) : 0;
  Batch tau[3] = {zero, zero, zero}, H = far, grown = zero;
  for (int c = 0; c < 3; ++c) L[c] = zero;

  for (int step = 0; step < kSteps; ++step) {
    const auto going = (t < end) & (min(tau[0], min(tau[1], tau[2])) < B(kBlack));
    if (none(going)) return;

    // The piece [t, b] and its middle.
    Mask anyone;
    const Batch next = next_boundary(on, k, cuts, cut_count, t, end, anyone);
    H = max(H, B(4e-7f) * t);
    Batch b = select(anyone, min(next, t + H), next);
    b = select(going, b, t);
    const auto endless = b >= B(kMaxLength);
    Batch mid = t + B(0.5f) * (b - t);
    if (any(endless)) mid = select(endless, t + natural_length(on, k, ray, t), mid);
    const Batch length = select(endless, B(2.f) * (mid - t), b - t);

    // What all media do on it.
    Piece whole[3], one[3], two[3];
    for (int c = 0; c < 3; ++c) {
      whole[c] = one[c] = two[c] = {zero, zero, zero, zero, zero, zero, far, -far};
    }
    Batch falls_least = far, falls_most = -far;  // rates at which densities fall
    Batch unseen = zero;  // optical depth that three places do not tell of
    for (int j = 0; j < k; ++j) {
      Walked& r = on[j];
      r.here = r.here & going;
      if (none(r.here)) continue;
      Batch J[3];
      if (r.told)
        measure_told(r, ray, t, mid, b, J);
      else
        measure(world, r, ray, t, mid, b, J);
      const Medium& m = *r.m;
      const auto counts =
          r.here & (B(m.densest) * (r.D1 + r.D2) > B(1e-2f * world.tolerance));
      const Batch falls = m.profile == BRUME_EXPONENTIAL ? r.p.p1 : zero;
      if (m.profile == BRUME_CUSTOM && !r.told) {
        const Batch told = length * (r.rho_a + B(4.f) * r.rho_m + r.rho_b) / B(6.f);
        unseen += select(counts & !endless, abs(r.D1 + r.D2 - told) * B(m.densest), zero);
      }
      falls_least = select(counts, min(falls_least, falls), falls_least);
      falls_most = select(counts, max(falls_most, falls), falls_most);
      for (int c = 0; c < 3; ++c) {
        const Batch sigma(m.sigma[c]), em(m.emission[c]);
        const Batch glow1 = min(em * r.D1, B(1e37f)), glow2 = min(em * r.D2, B(1e37f));
        r.J1[c] += glow1;
        r.J2[c] += glow2;
        one[c].d += r.told ? r.d1[c] : min(sigma * r.D1, B(kMostDepth));
        two[c].d += r.told ? r.d2[c] : min(sigma * r.D2, B(kMostDepth));
        one[c].J += r.J1[c];
        two[c].J += r.J2[c];
        whole[c].J += J[c] + glow1 + glow2;
        const Batch ka = r.told ? r.ka[c] : min(sigma * r.rho_a, B(kMostRate)),
                    km = r.told ? r.km[c] : min(sigma * r.rho_m, B(kMostRate)),
                    kb = r.told ? r.kb[c] : min(sigma * r.rho_b, B(kMostRate));
        one[c].ka += ka;
        two[c].ka += km;
        two[c].kb += kb;
        one[c].ea += ka * r.Sa[c] + em * r.rho_a;
        two[c].ea += km * r.Sm[c] + em * r.rho_m;
        two[c].eb += kb * r.Sb[c] + em * r.rho_b;
        if (m.sigma[c] > 0) {
          const Batch lo = min(r.Sa[c], min(r.Sm[c], r.Sb[c]));
          const Batch hi = max(r.Sa[c], max(r.Sm[c], r.Sb[c]));
          whole[c].least = select(r.here, min(whole[c].least, lo), whole[c].least);
          whole[c].most = select(r.here, max(whole[c].most, hi), whole[c].most);
        }
        if (m.emission[c] != 0) {
          whole[c].least = select(r.here, zero, whole[c].least);
          whole[c].most = select(r.here, far, whole[c].most);
        }
      }
    }

    // The rule on the whole and on both halves; their difference is the error's bound.
    Batch Lh[3], e1[3], depth[3], worst(1e-30f);
    Ruled r1[3], r2[3];
    Mask thick(false), blind(false), tail(true), any_differ(false);
    SourceWeights<Batch> E, E1, E2;
    for (int c = 0; c < 3; ++c) {
      Piece &w = whole[c], &x = one[c], &y = two[c];
      x.kb = y.ka;
      x.eb = y.ea;
      w.ka = x.ka, w.ea = x.ea, w.kb = y.kb, w.eb = y.eb;
      w.least = x.least = y.least = min(w.least, w.most);
      x.most = y.most = w.most;
      w.d = x.d + y.d;
      const bool same = c > 0 && all(x.d == one[c - 1].d) && all(y.d == two[c - 1].d);
      if (!same) {
        E = source_weights(w.d);
        E1 = source_weights(x.d);
        E2 = source_weights(y.d);
      }
      const Ruled rw = ruled(w, E);
      r1[c] = ruled(x, E1);
      r2[c] = ruled(y, E2);
      e1[c] = E1.T;
      Lh[c] = r1[c].L + E1.T * r2[c].L;
      depth[c] = w.d;
      // Two estimates, that no accident makes vanish together: the whole against its
      // halves, and a small part of what the parabola changes at all.
      const Batch plain = r1[c].plain + E1.T * r2[c].plain;
      Batch error = max(abs(Lh[c] - rw.L), B(kPlainPart) * abs(Lh[c] - plain));
      // What is finer than the places looked at may be anywhere between its sources.
      const Batch range = select(w.most > w.least, w.most - w.least, zero);
      error = max(error, B(kUnseenPart) * min(unseen, B(1.f)) * min(range, abs(w.most)) *
                             E.E0 / max(w.d, B(1.f)));
      const Batch T = exp(-tau[c]);
      const Batch allowed =
          B(0.5f * world.tolerance) *
          max(B(world.scale) * E.E0 + abs(Lh[c]), B(1e-3f * world.scale) / T);
      const auto lit = tau[c] < B(kBlack);
      worst = max(worst, select(lit, error / max(allowed, B(1e-30f)), zero));
      const auto differ = w.most - w.least > B(1e-6f) * max(abs(w.most), abs(w.least));
      thick = thick | (lit & differ & (w.d > B(kThick)));
      any_differ = any_differ | (lit & differ);
      // No rule is off by more than this: an endless piece is taken when it is little. Of
      // sources at a few places J says nothing; of what glows by itself it is exact.
      const Batch range_or_J = select(w.most < far, w.most - w.least, abs(w.J));
      const Batch unknown = range_or_J * E.E0;
      tail = tail & ((!lit) | (!differ) |
                     (unknown * T <= B(kTail * world.tolerance * world.scale)));
      // Where one half holds nearly all, whole and halves are wrong alike.
      const auto one_sided = (min(x.d, y.d) < B(kFew) * w.d) |
                             (min(abs(x.J), abs(y.J)) < B(kFew) * abs(w.J));
      blind = blind | (lit & differ & one_sided & (unknown > allowed));
    }

    // Where densities part by many e-folds, both rules may be wrong alike.
    const Batch parting = max(falls_most - falls_least, zero);
    const auto steep = any_differ & (parting * length > B(kSteep));

    // Taken, or tried again shorter. The rule is of fourth order: H ~ error^(1/5).
    // Where densities leave the floats no step is short enough.
    const auto least_step = length <= max(B(1e-6f) * t, B(1e-15f));
    const auto good =
        (endless & tail) | ((!endless) & (worst <= B(1.f)) & !(thick | steep | blind));
    const bool last = step > kSteps - kLast;
    const auto accept = going & (good | least_step | Mask(last));
    const Batch factor =
        clamp(B(0.9f) * exp(B(-0.2f) * log(worst)), B(last ? 2.f : 0.1f), B(5.f));
    for (int c = 0; c < 3; ++c) {
      const Batch T = exp(-tau[c]);
      L[c] += select(accept, T * Lh[c], zero);
      if (shares) add_shares(on, k, c, one[c], r1[c], two[c], r2[c], e1[c], T, accept);
      tau[c] = select(accept, tau[c] + depth[c], tau[c]);
    }
    for (int j = 0; j < k; ++j) {
      Walked& r = on[j];
      const auto done = accept & r.here;
      if (none(done)) continue;
      if (r.m->cap > 0) r.in.left = select(done, r.in.left - (r.D1 + r.D2), r.in.left);
      if (r.m->closed) continue;
      for (int c = 0; c < 3; ++c) {
        r.now[c] = select(done, r.Sb[c], r.now[c]);
        if (!r.told) continue;
        r.L_t[c] = select(done, r.L_b[c], r.L_t[c]);
        r.T_t[c] = select(done, r.T_b[c], r.T_t[c]);
      }
    }
    const Batch densest = max(one[0].ka, max(one[1].ka, one[2].ka));
    Batch shorter = min(B(0.5f) * length,
                        select(thick, B(8.f) / max(densest, B(1e-30f)), factor * length));
    shorter =
        min(shorter, select(steep, B(0.75f * kSteep) / max(parting, B(1e-30f)), far));
    shorter = select(blind, min(shorter, B(0.25f) * length), shorter);
    // After an endless attempt: as far as steps had grown; and after a good step on a
    // stretch without end, where its light is spent, such an attempt.
    shorter = select(endless, max(grown, B(0.5f) * length), shorter);
    const Batch longer = select(b < next, factor * length, max(H, factor * length));
    const auto spent = (next >= B(kMaxLength)) & (worst < B(0.01f));
    grown = select(accept, factor * length, grown);
    H = select(accept, select(spent, far, longer), shorter);
    t = select(accept, b, t);
  }
}

unsigned long scratch_bytes(const Compiled& world, int k) {
  return sizeof(Walked) * static_cast<unsigned>(k) +
         sizeof(Batch) * static_cast<unsigned>(most_shadow_cuts(world)) + 64;
}

void walk(const Compiled& world, int k, const Medium* const* media,
          const float* const* weights, const Rays& rays, float* const L[3],
          const Stretch* share, void* scratch) noexcept {
  Walked* on = static_cast<Walked*>(scratch);
  Batch* cuts = reinterpret_cast<Batch*>(on + k);
  for (int i = 0; i < rays.n; i += Batch::W) {
    const auto ray = load_ray(rays, i);
    const int n = meet(k, media, weights, rays, i, ray, on);
    for (int j = 0; j < n; ++j) {
      Walked& r = on[j];
      r.told = r.m->alone && !r.m->closed;
      for (int c = 0; c < 3; ++c) r.S[c] = Batch(r.m->S[c]);
      if (r.m->glows_by_sun) add_steady(*r.m, world, ray, r.S);
    }
    Batch sum[3];
    walk_batch(world, on, n, cuts, ray, share != nullptr, sum);
    for (int c = 0; c < 3; ++c) store(L[c] + i, sum[c]);
    if (share) put_shares(on, n, k, media, share, i, false);
  }
}

}  // namespace

const WalkKernels walk_kernels = {scratch_bytes, walk};

}  // namespace brume::air::inline BRUME_ISA_NS
