#pragma once
// Integrals of the density along rays, in steps that follow what can be seen (README,
// "Steps"). The steps of a ray depend on the ray alone, not on the stretch that is asked
// for, so that stretches add up; and they are kept, so that the next stretch costs
// little.
//
//   node      a place t_j where rho was looked at, from one step before the first
//   interval [ta, te]  where the noise counts; elsewhere it is at its mean, in closed
//   form D         integral of rho over the interval from node j to j + 1, by the cubic
//   through
//             nodes j - 1 .. j + 2: all inner weights are 1, so that waves average out
//             though no step resolves them exactly

#include "kernel.h"

namespace noise_fog {

constexpr int kMostNodes = 4096;  ///< kept of a ray, the last
constexpr int kMostTurns = 32;    ///< times that many are made at all
constexpr int kCarried = 8;       ///< kept when room runs out, as the cubic needs them
constexpr int kMostLanes = 16;

/// A batch of rays and what is known of it. Plain memory: kernels never allocate.
struct Track {
  std::uint64_t id = 0;  ///< of the fog; 0: empty
  int nodes = 0;
  int turns = 0;  ///< how often those before were let go
  float ray[6][kMostLanes], grade[kMostLanes];
  float ta[kMostLanes], te[kMostLanes];  ///< te: 3e38 while it goes on
  float t[kMostNodes * kMostLanes], rho[kMostNodes * kMostLanes];
  float D[kMostNodes * kMostLanes];  ///< from ta to node j, for j >= 1
};

}  // namespace noise_fog

namespace noise_fog::inline BRUME_ISA_NS {

constexpr float kFar = 3e38f, kLongest = 1e30f;
constexpr float kBright = 4;             ///< whites: what may shine through
constexpr float kBlack = 30;             ///< optical depth behind which nothing counts
constexpr float kLogGrade = 1.3862944f;  ///< ln 4
constexpr float kEven = 7;               ///< e^-7 of an octave is none
constexpr float kFolds = 0.35f;          ///< e-folds of the smooth fog in a step

// Int over [t0, t1] of e^(a - b t): the thicker end's density, times the length, times
// the mean of what it thins to (height_fog README, eq. 3).
//   The exponent ends at 170: e^170 x 1e-44 m is opaque, and the root of e^170 a float.
template <Real T>
BRUME_INLINE T smooth_integral(T a, T b, T t0, T t1) {
  using S = Scalar_t<T>;
  const T from = min(t0, T(S(kLongest)));
  const T length = max(min(t1, T(S(kLongest))) - from, T(0));
  const T x = clamp(b * length, T(S(-1e37)), T(S(1e37)));
  const T thick = exp(T(S(0.5)) * min(a - b * from + max(-x, T(0)), T(S(170))));
  return min(length * exprel(abs(x)) * thick * thick, T(S(kFar)));
}

/// Four nodes t0 .. t3 and the cubic through them, integrated from t1 on; in units of the
/// middle interval, so that nothing overflows while the densities do not.
template <Real T>
struct Cubic {
  T h1, r, f1, rise, bend, twist;
  BRUME_INLINE Cubic(const T t[4], const T f[4]) {
    using S = Scalar_t<T>;
    const T one(1), least(S(1e-3)), most(S(1e3));  // steps end where floats do
    h1 = max(t[2] - t[1], T(S(1e-37)));
    r = clamp((t[1] - t[0]) / h1, least, most);
    const T s = clamp((t[3] - t[2]) / h1, least, most);
    f1 = f[1];
    rise = f[2] - f[1];
    // Newton's divided differences, times h1^2 and h1^3.
    bend = (rise - (f[1] - f[0]) / r) / (one + r);
    twist = (((f[3] - f[2]) / s - rise) / (one + s) - bend) / (r + one + s);
  }
  // Over the part v of the middle interval, 0 to 1; not negative.
  BRUME_INLINE T to(T v) const {
    using S = Scalar_t<T>;
    const T half(S(0.5)), third(S(1. / 3)), quarter(S(0.25));
    const T b = third * v - half;
    const T w = (quarter * v + third * (r - T(1))) * v - half * r;
    return h1 * max(v * (f1 + v * (half * rise + b * bend + w * twist)), T(0));
  }
};

BRUME_INLINE Batch row(const float* plane, int j) {
  return load<Batch>(plane + j * Batch::W);
}

// Lane by lane, node j of a plane.
BRUME_INLINE Batch column(const float* plane, IntBatch j) {
  return gather(plane, j * IntBatch(std::uint32_t(Batch::W)) + cell(iota<Batch>()));
}

/// The kernel's view of a track.
struct Steps {
  const Fog& fog;
  Track& track;
  Ray<Batch> ray;
  Batch a, b;

  BRUME_INLINE void at(Batch t, Batch x[3]) const {
    for (int i = 0; i < 3; ++i) x[i] = ray.o[i] + t * ray.d[i];
  }

  BRUME_INLINE Batch smooth(Batch t) const {
    return exp(min(a - b * t, Batch(fog.log_rho_most)));
  }

  // What an error counts for where the density is rho: sigma rho^(3/2) 4^-grade, README
  // eq. 7.
  BRUME_INLINE Batch counts(Batch rho) const {
    const Batch held = min(rho, Batch(1e18f));
    return Batch(fog.sigma_most) * held * sqrt(held) *
           exp(load<Batch>(track.grade) * Batch(-kLogGrade));
  }

  // The step that this allows: from the table, no shorter than a
  // pixel is wide, no longer than what the smooth fog and the clearing allow.
  BRUME_INLINE Batch step(Batch V, const Batch x[3]) const {
    const Batch u =
        (log(max(V, Batch(1e-37f))) - Batch(fog.first_log_V)) * Batch(fog.per_log_V);
    const Batch held = select(u > Batch(0.f), min(u, Batch(kStepTable - 1.001f)), 0.f);
    const Batch lower = floor(held);
    const IntBatch i = cell(lower);
    const Batch s0 = gather(fog.log_step, i), s1 = gather(fog.log_step + 1, i);
    Batch h = exp(s0 + (held - lower) * (s1 - s0));
    h = select(u < Batch(0.f), Batch(kLongest), h);
    const Batch r2 = x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
    h = max(h, Batch(2.f) * sqrt(Batch(fog.pixel2) * r2));
    h = min(h, Batch(kFolds) / max(abs(b), Batch(1e-37f)));
    if (fog.clears) {
      const Batch at = abs(dot(fog.clearing, x)), rate = abs(dot(fog.clearing, ray.d));
      h = min(h, Batch(0.2f) * (Batch(1.f) + at) / max(rate, Batch(1e-37f)));
    }
    return h;
  }

  BRUME_INLINE Batch look(Batch t, Batch h) const {
    Batch x[3];
    at(min(t, Batch(kLongest)), x);
    return density(fog, x, h);
  }

  BRUME_INLINE Cubic<Batch> cubic(int j) const {
    const Batch t[4] = {row(track.t, j - 1), row(track.t, j), row(track.t, j + 1),
                        row(track.t, j + 2)};
    const Batch f[4] = {row(track.rho, j - 1), row(track.rho, j), row(track.rho, j + 1),
                        row(track.rho, j + 2)};
    return Cubic<Batch>(t, f);
  }

  BRUME_INLINE void put(Batch t, Batch rho) {
    store(track.t + track.nodes * Batch::W, t);
    store(track.rho + track.nodes * Batch::W, rho);
    ++track.nodes;
  }

  // Where the smooth fog is thick enough for its noise to count, and not so thick that
  // its density is no float (opaque after 1e-28 m); and the first two nodes.
  void begin() {
    const Batch far(kFar), zero(0.f);
    const Batch over = a - Batch(2.f / 3) * (Batch(fog.log_rho_least) +
                                             Batch(kLogGrade) * load<Batch>(track.grade));
    const Batch beyond = a - Batch(fog.log_rho_most);
    const Batch thick = over / b, dense = beyond / b;
    const auto level = b == zero;
    Batch ta = max(select(b < zero, thick, dense), zero);
    Batch te = select(b > zero, thick, dense);
    ta = select(level, select((over > zero) & (beyond < zero), zero, far), ta);
    te = select(level, far, te);
    const auto some = (ta < te) & (ta < Batch(kLongest));
    ta = select(some, ta, far);
    te = select(some, te, zero);
    store(track.ta, ta);
    store(track.te, te);
    const Batch t = min(ta, Batch(kLongest));
    Batch x[3];
    at(t, x);
    const Batch h = step(counts(smooth(t)), x);
    track.nodes = track.turns = 0;
    put(t - h, look(t - h, h));
    put(t, look(t, h));
    store(track.D + Batch::W, zero);
  }

  // One more node. The step goes by the smooth fog alone: were it shorter where the noise
  // is dense, dense places would be looked at more often, and D come out too large. A
  // lane that has reached its end goes on with it, to no effect.
  void advance() {
    const int j = track.nodes - 1;
    const Batch t = row(track.t, j);
    Batch x[3];
    at(t, x);
    const Batch h = max(step(counts(smooth(t)), x), Batch(4e-7f) * t);
    const Batch next = min(t + h, Batch(kLongest));
    put(next, look(next, h));
    if (j < 2) return;
    const auto c = cubic(j - 1);
    const Batch D = min(row(track.D, j - 1) + c.to(Batch(1.f)), Batch(kFar));
    store(track.D + j * Batch::W, D);
    // Ends where nothing can be seen any more, or a pixel no noise: farther on its filter
    // is wider still, on a way that leads outward.
    const Batch te = load<Batch>(track.te);
    const auto black = Batch(fog.sigma_least) * D > Batch(kBlack);
    const auto even = (Batch(fog.octave[0].blur) * filter(fog, x) > Batch(kEven)) &
                      (ray.d[0] * x[0] + ray.d[1] * x[1] + ray.d[2] * x[2] > Batch(0.f));
    const auto ends = black | (even & !Mask(fog.clears)) | (t >= Batch(kLongest));
    store(track.te, select(ends & (t < te), t, te));
  }

  // Lets all nodes go but the last: what comes after them needs no more.
  void turn() {
    const int from = (track.nodes - kCarried) * Batch::W, n = kCarried * Batch::W;
    for (float* plane : {track.t, track.rho, track.D})
      for (int i = 0; i < n; ++i) plane[i] = plane[from + i];
    track.nodes = kCarried;
    ++track.turns;
  }

  // Lanes that know D at t.
  BRUME_INLINE Mask knows(Batch t) const {
    if (track.nodes < 4) return Mask(false);
    const Batch end = row(track.t, track.nodes - 2);
    return (t <= end) | (end >= Batch(kLongest));
  }

  // Goes on until every lane knows D up to t or to its end, or there is no room for more.
  void reach(Batch t) {
    while (track.nodes < kMostNodes) {
      const Batch wanted = min(t, load<Batch>(track.te));
      if (none((wanted > load<Batch>(track.ta)) & !knows(wanted))) return;
      advance();
    }
  }

  // The last interval that begins before t, lane by lane: from 1 on. A node is the end of
  // the interval before it, so that it does not matter how many follow.
  BRUME_INLINE IntBatch interval(Batch t) const {
    Batch found(1.f);
    for (int bit = 2048; bit > 0; bit /= 2) {
      const Batch trial = found + Batch(float(bit));
      const Batch held = min(trial, Batch(float(track.nodes - 3)));
      const auto inside = trial == held;
      found = select(inside & (column(track.t, cell(held)) < t), trial, found);
    }
    return cell(found);
  }
  struct Place {
    Batch D, part;
  };
  BRUME_INLINE Place place(Batch t) const {
    const IntBatch j = interval(t), one(1u);
    Batch ts[4], fs[4];
    IntBatch k = j - one;
    for (int i = 0; i < 4; ++i, k = k + one) {
      ts[i] = column(track.t, k);
      fs[i] = column(track.rho, k);
    }
    const Cubic<Batch> c(ts, fs);
    return {column(track.D, j), c.to(clamp((t - ts[1]) / c.h1, 0.f, 1.f))};
  }

  // The place of t on its track in these lanes, t at most the track's end; from its
  // beginning again where that has been let go.
  Place find(Batch t, Mask lanes) {
    Place found = {0.f, 0.f};
    if (track.turns > 0 && any(lanes & (t < row(track.t, 1)))) begin();
    for (;;) {
      reach(select(lanes, t, Batch(-kFar)));
      const Batch te = load<Batch>(track.te), here = clamp(t, load<Batch>(track.ta), te);
      const auto there = lanes & knows(here);
      if (any(there) && track.nodes >= 4) {
        const Place p = place(here);
        found.D = select(there, p.D, found.D);
        found.part = select(there, p.part, found.part);
      }
      lanes = lanes & !there;
      if (none(lanes) || track.nodes < kMostNodes) return found;
      turn();
      // A ray without end: from here on the noise is at its mean.
      if (track.turns >= kMostTurns)
        store(track.te, min(te, row(track.t, track.nodes - 2)));
    }
  }

  /// Int rho over [t0, t1], and in `from_origin` over [0, t1].
  Batch integral(Batch t0, Batch t1, Batch& from_origin) {
    const Batch zero(0.f), ta = load<Batch>(track.ta);
    const auto some = (t0 < t1) & (t1 > ta) & (ta < load<Batch>(track.te));
    Batch D = smooth_integral(a, b, t0, max(t0, min(t1, ta)));
    from_origin = smooth_integral(a, b, zero, min(t1, ta));
    if (any(some)) {
      const auto p0 = find(max(t0, ta), some & (t0 > ta)), p1 = find(t1, some);
      const Batch te = load<Batch>(track.te);
      // Nothing over nothing: contracted, the difference of equal products is their
      // rounding.
      D += select(some & (max(t0, ta) < min(t1, te)),
                  max((p1.D - p0.D) + (p1.part - p0.part), zero), zero);
      from_origin += select(some, p1.D + p1.part, zero);
    }
    const Batch te = load<Batch>(track.te);
    const auto beyond = (ta < te) & (t1 > te);
    if (any(beyond)) {
      D += select(beyond, smooth_integral(a, b, max(t0, te), t1), zero);
      from_origin += select(beyond, smooth_integral(a, b, te, t1), zero);
    }
    return clamp(D, zero, Batch(kFar));
  }
};

}  // namespace noise_fog
