#pragma once
// Integrals of the density along rays, in steps that follow what can be seen (README,
// "Steps"). The steps of a ray depend on the ray alone, not on the stretch that is asked
// for, so that stretches add up; and they are kept, so that the next stretch costs
// little.
//
//   [ta, te]  where there is fog and its noise counts; elsewhere it is at its mean, in
//             closed form
//   node      a place t_j where rho was looked at, from five steps before ta
//   D         Int rho from node 1 to node j, by cubics through four nodes: all inner
//             weights are 1, so that waves average out though no step resolves them
//   F         Int rho from node 1 to any t: D of a node two steps before, and from there
//             looks ever closer together up to t (`landing`)

#include "kernel.h"

namespace brume::noise_fog {

constexpr int kFineNodes = 16384;  ///< of a ray, made as they should be,
constexpr int kDoubled = 1024;     ///< twice as far apart after so many more, and again,
constexpr int kDoublings = 12;     ///< until the smooth fog alone counts
constexpr int kMostNodes = 32768;  ///< where the noise ends, if that is still too few
constexpr int kMostLanes = 16;

/// A batch of rays and what is known of it. Plain memory: kernels never allocate.
struct Track {
  std::uint64_t id = 0;  ///< of the fog; 0: empty
  int nodes = 0;
  int looks = 0;  ///< at the density, ends of stretches included
  float ray[6][kMostLanes], grade[kMostLanes];
  float longest[kMostLanes];             ///< step
  float begins[kMostLanes];              ///< nobody asks about what is nearer
  float ta[kMostLanes], te[kMostLanes];  ///< te: 3e38 while it goes on
  float banks[kMostLanes];               ///< ln of what the coarse octaves are, last node
  float first[kMostLanes];               ///< F at ta
  float since[kMostLanes];               ///< D at the first node from ta on
  float last_t[kMostLanes], last[kMostLanes];  ///< F where it was last asked for
  float t[kMostNodes * kMostLanes], rho[kMostNodes * kMostLanes];
  float D[kMostNodes * kMostLanes];  ///< from node 1 to node j, for j >= 1
};

}  // namespace brume::noise_fog

namespace brume::noise_fog::inline BRUME_ISA_NS {

constexpr float kFar = 3e38f, kLongest = 1e30f;
constexpr float kBright = 30;            ///< whites: what may shine through
constexpr float kLogGrade = 1.3862944f;  ///< ln 4
constexpr float kEven = 7;               ///< e^-7 of an octave is none
constexpr float kFolds = 0.2f;           ///< e-folds of the smooth fog in a step

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

// Int over [t1, t2] of the cubic through four nodes t0 .. t3; not negative. In units of
// the middle interval, so that nothing overflows while the densities do not.
template <Real T>
BRUME_INLINE T cubic_integral(const T t[4], const T f[4]) {
  using S = Scalar_t<T>;
  const T one(1), least(S(1e-3)), most(S(1e3));  // steps end where floats do
  const T h1 = max(t[2] - t[1], T(S(1e-37)));
  const T r = clamp((t[1] - t[0]) / h1, least, most);
  const T s = clamp((t[3] - t[2]) / h1, least, most);
  // Newton's divided differences, times h1^2 and h1^3.
  const T rise = f[2] - f[1];
  const T bend = (rise - (f[1] - f[0]) / r) / (one + r);
  const T twist = (((f[3] - f[2]) / s - rise) / (one + s) - bend) / (r + one + s);
  return h1 * max(f[1] + T(S(0.5)) * rise - T(S(1. / 6)) * bend -
                      (T(S(1. / 12)) + T(S(1. / 6)) * r) * twist,
                  T(0));
}

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
  Slopes<Batch> slopes;
  Batch begins;  // nobody asks about what is nearer

  BRUME_INLINE void at(Batch t, Batch x[3]) const {
    for (int i = 0; i < 3; ++i) x[i] = ray.o[i] + t * ray.d[i];
  }

  // What an error at t counts for: sigma rho^(3/2) 4^-grade (README, "Steps"), rho of the
  // smooth fog and `banks`, the coarse octaves' part of the noise.
  BRUME_INLINE Batch counts(Batch t, Batch banks) const {
    const Batch held = min(smooth_density(fog, slopes, t, banks), Batch(1e18f));
    return Batch(fog.sigma_most) * held * sqrt(held) *
           exp(load<Batch>(track.grade) * Batch(-kLogGrade));
  }

  // The step that this allows: from the table, longer where pixels are wider than the
  // finest cells, no longer than what the smooth fog and the clearing allow.
  BRUME_INLINE Batch step(Batch V, Batch t, const Batch x[3]) const {
    const Batch u =
        (log(max(V, Batch(1e-37f))) - Batch(fog.first_log_V)) * Batch(fog.per_log_V);
    const Batch held = select(u > Batch(0.f), min(u, Batch(kStepTable - 1.001f)), 0.f);
    const Batch lower = floor(held);
    const IntBatch i = cell(lower);
    const Batch s0 = gather(fog.log_step, i), s1 = gather(fog.log_step + 1, i);
    Batch h = exp(s0 + (held - lower) * (s1 - s0));
    h = select(u < Batch(0.f), Batch(kLongest), h);
    const Batch wide = Batch(16 * fog.per_finest * fog.per_finest) * pixel_filter(fog, x);
    h *= exp(Batch(0.5f * fog.coarsens) * log(clamp(wide, Batch(1.f), Batch(1e30f))));
    const int doublings = (track.nodes - kFineNodes) / kDoubled;
    if (doublings > 0)
      h *= Batch(doublings < kDoublings ? float(1 << doublings) : kLongest);
    h = min(h, Batch(kFolds) / max(abs(slopes.b), Batch(1e-37f)));
    if (fog.clears) {
      const Batch height = abs(slopes.cleared_height(t)), rate = abs(slopes.u1);
      h = min(h, Batch(0.05f) * (Batch(1.f) + height) / max(rate, Batch(1e-37f)));
    }
    return min(h, load<Batch>(track.longest));
  }

  BRUME_INLINE Batch look(Batch t, Batch h, Batch* banks = nullptr) const {
    Batch x[3];
    const Batch held = min(t, Batch(kLongest));
    at(held, x);
    ++track.looks;
    return density(fog, slopes, held, x, h, banks);
  }

  BRUME_INLINE Batch cubic(int j) const {
    const Batch t[4] = {row(track.t, j - 1), row(track.t, j), row(track.t, j + 1),
                        row(track.t, j + 2)};
    const Batch f[4] = {row(track.rho, j - 1), row(track.rho, j), row(track.rho, j + 1),
                        row(track.rho, j + 2)};
    return cubic_integral(t, f);
  }

  // A node at t, after a step h.
  BRUME_INLINE void put(Batch t, Batch h) {
    Batch banks(0.f);
    store(track.t + track.nodes * Batch::W, t);
    store(track.rho + track.nodes * Batch::W, look(t, h, &banks));
    store(track.banks, banks);
    ++track.nodes;
  }

  // Where the smooth fog is thick enough for its noise to count, and not so thick that
  // its density is no float (opaque after 1e-28 m); and the first two nodes.
  void begin() {
    const Batch far(kFar), zero(0.f), a = slopes.a, b = slopes.b;
    const Batch over = a - Batch(2.f / 3) * (Batch(fog.log_rho_least) +
                                             Batch(kLogGrade) * load<Batch>(track.grade));
    const Batch beyond = a - Batch(fog.log_rho_most);
    const Batch thick = over / b, dense = beyond / b;
    const auto level = b == zero;
    Batch ta = max(select(b < zero, thick, dense), zero);
    Batch te = select(b > zero, thick, dense);
    ta = select(level, select((over > zero) & (beyond < zero), zero, far), ta);
    ta = max(ta, begins);
    te = select(level, far, te);
    const auto some = (ta < te) & (ta < Batch(kLongest));
    ta = select(some, ta, far);
    te = select(some, te, zero);
    store(track.ta, ta);
    store(track.te, te);
    const Batch t = min(ta, Batch(kLongest));
    Batch x[3];
    at(t, x);
    track.nodes = track.looks = 0;
    const Batch h = step(counts(t, zero), t, x);
    put(t - Batch(5.f) * h, h);
    put(t - Batch(4.f) * h, h);
    store(track.D + Batch::W, zero);
    store(track.first, zero);
    store(track.since, zero);
    store(track.last_t, Batch(-kFar));
    reach(select(some, t, Batch(-kFar)));
    if (any(some)) store(track.first, landing(t));
  }

  // One more node. The step goes by the smooth fog and by octaves that it resolves many
  // times over: were it shorter wherever the noise is dense, dense places would be looked
  // at more often, and D come out too large. A lane that has reached its end goes on with
  // it, to no effect.
  void advance() {
    const int j = track.nodes - 1;
    const Batch t = row(track.t, j), ta = load<Batch>(track.ta);
    Batch x[3];
    at(t, x);
    const Batch wanted = step(counts(t, load<Batch>(track.banks)), t, x);
    const Batch h = max(wanted, Batch(4e-7f) * abs(t));
    const auto none_left =
        (h * Batch(fog.per_size) > Batch(1.5f)) & Mask(track.nodes > kFineNodes);
    put(min(t + h, Batch(kLongest)), h);
    if (j < 2) return;
    const Batch D = min(row(track.D, j - 1) + cubic(j - 1), Batch(kFar));
    store(track.D + j * Batch::W, D);
    // Ends where nothing can be seen any more, or no noise: by steps of which there is no
    // end, or by a pixel, whose filter is wider still farther on, on a way that leads
    // outward.
    const Batch te = load<Batch>(track.te);
    const Batch since = select(row(track.t, j - 1) < ta, D, load<Batch>(track.since));
    store(track.since, since);
    const auto black = Batch(fog.sigma_least) * (D - since) > Batch(fog.black);
    const Batch r2 = x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
    const Batch outward = ray.d[0] * x[0] + ray.d[1] * x[1] + ray.d[2] * x[2];
    const auto even =
        (Batch(fog.octave[0].blur) * (Batch(fog.narrowest) * r2 + Batch(fog.blur2)) >
         Batch(kEven)) &
        (outward > Batch(0.f));
    const auto ends =
        black | ((even | none_left) & !Mask(fog.clears)) | (t >= Batch(kLongest));
    store(track.te, select(ends & (t > ta) & (t < te), t, te));
  }

  // Where the stretch that begins at node j lands: two steps farther.
  BRUME_INLINE static Batch runway(Batch t, Batch next) { return next + (next - t); }

  // Lanes that know F at t.
  BRUME_INLINE Mask knows(Batch t) const {
    if (track.nodes < 4) return Mask(false);
    // By then every node up to t has been asked whether the noise ends there.
    const Batch end = row(track.t, track.nodes - 2);
    return (t <= end) | (end >= Batch(kLongest));
  }

  // Goes on until every lane knows F up to t or to its end, which is where there is no
  // room for more.
  void reach(Batch t) {
    for (;;) {
      const Batch te = load<Batch>(track.te), wanted = min(t, te);
      const auto not_yet = (wanted >= load<Batch>(track.ta)) & !knows(wanted);
      if (none(not_yet)) return;
      if (track.nodes == kMostNodes) {
        store(track.te, select(not_yet, min(te, row(track.t, kMostNodes - 3)), te));
        return;
      }
      advance();
    }
  }

  // The last node from which two steps end at t or before, lane by lane: from 1 on, and
  // with two after it. It does not matter how many follow.
  BRUME_INLINE IntBatch before(Batch t) const {
    Batch found(1.f);
    const IntBatch one(1u);
    for (int bit = kMostNodes / 2; bit > 0; bit /= 2) {
      const Batch trial = found + Batch(float(bit));
      const Batch held = min(trial, Batch(float(track.nodes - 2)));
      const IntBatch j = cell(held);
      const auto inside = trial == held;
      const Batch lands = runway(column(track.t, j), column(track.t, j + one));
      found = select(inside & (lands <= t), trial, found);
    }
    return cell(found);
  }

  // F at t: D of the node m two steps before, and from there steps that shrink to nothing
  // smoothly, so that no rule for an end is needed (a sum of even steps in the variable
  // u, t = t_m + 2 x Int_0^u (1 - S), S the smoothstep of seventh degree, x the way that
  // is left). The cubics' end at m is taken off again: h^2/12 rho' (Euler-Maclaurin).
  Batch landing(Batch t) const {
    const IntBatch m = before(t), one(1u);
    const Batch t0 = column(track.t, m - one), t1 = column(track.t, m),
                t2 = column(track.t, m + one);
    const Batch f0 = column(track.rho, m - one), f1 = column(track.rho, m),
                f2 = column(track.rho, m + one);
    const Batch tiny(1e-37f), zero(0.f), unit(1.f);
    const Batch back = max(t1 - t0, tiny), on = max(t2 - t1, tiny);
    const Batch left = max(min(t, Batch(kLongest)) - t1, zero);
    const Batch h = min(max(on, Batch(0.125f) * left), left);
    const Batch per_step = Batch(0.5f) * h / max(left, tiny);
    Batch seen = zero, weights = zero;
    for (int i = 1; i < 16; ++i) {
      const Batch u = Batch(float(i)) * per_step;
      const Batch u4 = u * u * u * u;
      const Batch step =
          u4 * (Batch(35.f) - u * (Batch(84.f) - u * (Batch(70.f) - Batch(20.f) * u)));
      // Near u = 1 the difference may round to less than nothing, and the lanes beside
      // decide whether there is another round.
      const Batch w = select(u < unit, max(unit - step, zero), zero);
      if (none(w > zero)) break;
      const Batch part =
          u -
          u * u4 * (Batch(7.f) - u * (Batch(14.f) - u * (Batch(10.f) - Batch(2.5f) * u)));
      seen += w * look(t1 + Batch(2.f) * left * part, on);
      weights += w;
    }
    const Batch sum = back + on, limit(1e3f);
    const Batch bend = (f2 - f1) * min(h / on, limit) * (back / sum) +
                       (f1 - f0) * min(h / back, limit) * (on / sum);
    // Before it is times `left`, which may be as long as fog is dense.
    const Batch mean =
        Batch(2.f) * per_step * (Batch(0.5f) * f1 + Batch(1.f / 12) * bend) +
        (unit - per_step) * (seen / max(weights, tiny));
    return min(column(track.D, m) + left * max(mean, zero), Batch(kFar));
  }

  // F at t in these lanes, ta <= t; past te as at te.
  Batch find(Batch t, Mask lanes) {
    if (none(lanes & (t != load<Batch>(track.last_t)))) return load<Batch>(track.last);
    reach(select(lanes, t, Batch(-kFar)));
    const Batch te = load<Batch>(track.te);
    const Batch found = landing(clamp(t, load<Batch>(track.ta), te));
    store(track.last_t, select(lanes, t, Batch(-kFar)));
    store(track.last, found);
    return found;
  }

  // Int rho over [t0, t1] where the noise is not followed. Where that is because the fog
  // is dense beyond all floats, there is no light left after next to no way: noise is
  // what it is where that begins, clearing its mean over 50 optical depths.
  BRUME_INLINE Batch closed(Batch t0, Batch t1) const {
    const Batch D = smooth_integral(slopes.a, slopes.b, t0, t1);
    const Batch log_rho = slopes.a - slopes.b * min(t0, Batch(kLongest));
    const auto dense = (log_rho > Batch(fog.log_rho_most)) & (t0 < t1);
    if (none(dense) || (fog.octaves == 0 && !fog.clears)) return D;
    return select(dense, min(D * dense_factor(log_rho, t0, t1), Batch(kFar)), D);
  }

  [[gnu::noinline]] Batch dense_factor(Batch log_rho, Batch t0, Batch t1) const {
    Batch x[3];
    at(min(t0, Batch(kLongest)), x);
    const Batch factor = exp(log_factor(fog, x, filter(fog, x), Batch(0.f)));
    if (!fog.clears) return factor;
    const Batch thin = exp(Batch(-0.5f) * min(log_rho, Batch(170.f)));
    const Batch seen = min(t1 - t0, Batch(50 / kCleared / fog.sigma_least) * thin * thin);
    return factor *
           mean_cleared(slopes.cleared_height(t0), slopes.cleared_height(t0 + seen));
  }

  /// Int rho over [t0, t1], and in `in_all` from where the fog begins.
  Batch integral(Batch t0, Batch t1, Batch& in_all) {
    const Batch zero(0.f), ta = load<Batch>(track.ta);
    const auto some = (t0 < t1) & (t1 > ta) & (ta < load<Batch>(track.te));
    Batch D = closed(t0, max(t0, min(t1, ta)));
    in_all = closed(begins, max(begins, min(t1, ta)));
    if (any(some)) {
      const Batch first = load<Batch>(track.first);
      const auto later = some & (t0 > ta);
      const Batch F0 = any(later) ? select(later, find(t0, later), first) : first;
      const Batch F1 = find(t1, some), te = load<Batch>(track.te);
      const auto full = F1 >= Batch(kFar);
      const Batch part = select(full, F1, max(F1 - F0, zero));
      D += select(some & (max(t0, ta) < min(t1, te)), part, zero);
      in_all += select(some, select(full, F1, max(F1 - first, zero)), zero);
    }
    const Batch te = load<Batch>(track.te);
    const auto beyond = (ta < te) & (t1 > te);
    if (any(beyond)) {
      D += select(beyond, closed(max(t0, te), t1), zero);
      in_all += select(beyond, closed(te, t1), zero);
    }
    return clamp(D, zero, Batch(kFar));
  }
};

}  // namespace brume::noise_fog
