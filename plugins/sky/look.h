#pragma once
// Looking pixels up in a SkyMap.

#include <limits>

#include "lookup.h"
#include "map.h"

namespace brume::sky::inline BRUME_ISA_NS {

/// Where a lane lies on an axis of nodes 0 to `last`, with a ghost at each end: the first
/// of four rows, and their Catmull-Rom weights.
template <Real T>
BRUME_INLINE Place<T> place_on(T x, Same<T> last) {
  using S = Scalar_t<T>;
  const T y = within(x, T(0), last * T(S(.999999)));
  const T i = floor(y), f = y - i, half(S(.5));
  return {i,
          {half * f * (f * (T(2) - f) - T(1)), half * (f * f * (T(3) * f - T(5)) + T(2)),
           half * f * (f * (T(4) - T(3) * f) + T(1)), half * f * f * (f - T(1))},
          y};
}

/// Transmittance of three colours over columns.
BRUME_INLINE void colors_through(const SkyPlace& a, const Columns<Batch>& c, Batch T[3]) {
  for (int k = 0; k < 3; ++k) T[k] = Batch(0);
  for (int i = 0; i < a.wavelengths; ++i) {
    const Batch t = exp(-(Batch(a.extinct_R[i]) * c.R + Batch(a.extinct_M[i]) * c.M +
                          Batch(a.absorb_O[i]) * c.O));
    for (int k = 0; k < 3; ++k) T[k] += Batch(a.weight[k][i]) * t;
  }
  for (int k = 0; k < 3; ++k) T[k] = min(T[k], Batch(1));
}

/// Where a surface is seen, at t, air may go on below the ground.
BRUME_INLINE auto seen(Batch t) {
  return t < Batch(std::numeric_limits<float>::infinity());
}

inline void through(const SkyPlace& a, int n, const float* const o[3],
                    const float* const d[3], const float* t0, const float* t1,
                    float* const T[3]) noexcept {
  using V = Batch;
  constexpr int W = lanes<V>;
  const float R = a.shape.R, top = a.shape.top;
  for (int begin = 0; begin < n; begin += W) {
    const int used = n - begin < W ? n - begin : W;
    const auto lane = [&](const float* from) {
      float x[W];
      for (int i = 0; i < W; ++i) x[i] = from[begin + (i < used ? i : 0)];
      return load<V>(x);
    };
    // Distance from the planet's centre without the square of its radius.
    V qq(0), q_up(0), qd(0), up_d(0);
    for (int k = 0; k < 3; ++k) {
      const V dk = lane(d[k]), q = V(a.ground[k]) + (o[0] ? lane(o[k]) : V(0));
      qq += q * q, q_up += q * V(a.up[k]), qd += q * dk, up_d += V(a.up[k]) * dk;
    }
    const V c = qq + V(2 * R) * q_up, b = qd + V(R) * up_d;
    const V c_top(top * (2 * R + top));
    // The part within the air: from its top if outside, to the ground or out again.
    const V in = b * b - c + c_top, root = sqrt(max(in, V(0)));
    const V out = select(b > V(0), (c_top - c) / max(b + root, V(1e-6f)), root - b);
    const V enter = select(
        c > c_top, select(b < V(0), (c - c_top) / max(root - b, V(1e-6f)), out), V(0));
    const float deep = float(kDeep) * a.shape.H_M;
    const V c_ground = min(c, select(seen(lane(t1)) | (c < V(float(-2 * kGrain) * R * R)),
                                     V(-deep * (2 * R - deep)), V(0))),
            under = b * b - (c - c_ground);
    const V hit = select((b < V(0)) & (under > V(0)),
                         (c - c_ground) / max(sqrt(max(under, V(0))) - b, V(1e-6f)), out);
    const V from = max(lane(t0), enter), to = min(min(lane(t1), hit), out);
    const auto inside = (in > V(0)) & (to > from);
    const V start = select(inside, from, V(0)), b0 = b + start;
    const V h = clamp(altitude(c + start * (b + b0), V(R)), V(-deep), V(top));
    V colors[3];
    colors_through(a,
                   columns_between(a.shape, h, clamp(b0 / (V(R) + h), V(-1), V(1)),
                                   select(inside, to - from, V(0))),
                   colors);
    for (int k = 0; k < 3; ++k) {
      float x[W];
      store(x, select(inside, colors[k], V(1)));
      for (int i = 0; i < used; ++i) T[k][begin + i] = x[i];
    }
  }
}

inline void look(const SkyMap& map, const SkyPlace& place, int n, const float* dx,
                 const float* dy, const float* dz, const float* t1, float* const L[3],
                 float* const T[3]) noexcept {
  using V = Batch;
  using Sixteen = Spectrum<float, kMapParts>;
  constexpr int W = lanes<V>;
  const bool outside = map.q < 0;
  for (int start = 0; start < n; start += W) {
    const int used = n - start < W ? n - start : W;
    float rays[4][W];
    for (int i = 0; i < W; ++i) {
      const int k = start + (i < used ? i : 0);
      rays[0][i] = dx[k], rays[1][i] = dy[k], rays[2][i] = dz[k], rays[3][i] = t1[k];
    }
    const V x = load<V>(rays[0]), y = load<V>(rays[1]), z = load<V>(rays[2]),
            far = load<V>(rays[3]);
    const V mu =
        clamp(x * V(map.up[0]) + y * V(map.up[1]) + z * V(map.up[2]), V(-1), V(1));
    const V nu =
        clamp(x * V(map.sun[0]) + y * V(map.sun[1]) + z * V(map.sun[2]), V(-1), V(1));
    const V sin_v = sqrt(max(V(1) - mu * mu, V(1e-12f)));
    const V cos_a = (nu - mu * V(map.mu_s)) / (sin_v * V(max(map.sin_s, 1e-6f)));
    const V a = acos(clamp(cos_a, V(-1), V(1)));

    // Elevation, and the end of the path.
    const V zenith = acos(mu);
    const auto under = zenith > V(map.horizon);
    const V angle = abs(zenith - V(map.horizon));
    const V crowd = select(under, V(kCrowdBelow), V(kCrowdAbove)),
            turned = angle / select(under, V(float(kPi) - map.horizon),
                                    V(map.horizon - map.limb));
    const V v = sqrt(V(2) * turned /
                     (crowd + sqrt(crowd * crowd + V(4) * (V(1) - crowd) * turned)));
    const V b = V(map.r) * mu, in = b * b + V(map.q), root = sqrt(max(in, V(0)));
    const V out = select(b > V(0), V(map.q) / (b + root), root - b);
    const V hit = V(map.c) / max(sqrt(max(b * b - V(map.c), V(0))) - b, V(1e-3f));
    const V begin = outside ? V(-map.q) / max(root - b, V(1e-3f)) : V(0);
    const V end = max(select(under, hit, out) - begin, V(1e-3f));
    const V d = clamp(far - begin, V(0), end);
    const auto there = outside ? (in > V(0)) & (b < V(0)) : b == b;
    const auto whole =
        (far - begin >= end) & (zenith <= V(map.horizon)) & Mask(map.sky.elevations > 0);
    // Past the ground, to a surface below it or beyond a bulge of it.
    const V to_deep(map.to_deep);
    const auto past = under & seen(far) & (far - begin > end) & Mask(map.to_deep > map.c);
    const V hit_deep =
        select(b * b > to_deep,
               to_deep / max(sqrt(max(b * b - to_deep, V(0))) - b, V(1e-3f)), V(1e12f));
    const V through = select(past, max(min(far, hit_deep) - begin, d), d);
    // x of d/d_end = (1 - k) x + k x^2, the root that stays in [0, 1], or beyond the
    // ground.
    const V k = select(under, V(map.below.bend), V(map.above.bend)), straight = V(1) - k,
            part = through / end;
    const V slice =
        V(2) * part /
        (straight + sqrt(max(straight * straight + V(4) * k * part, V(1e-12f))));
    const V last_slice(float(map.above.slices - 1));
    auto slices = place_on(slice * last_slice, last_slice);
    // For a slice more the mean light per opacity goes on as between the last two; what
    // is farther these tables do not have.
    const V slices_past = select(past, (slice - V(1)) * last_slice, V(0)),
            on = min(slices_past, V(1));
    const auto unknown = slices_past > V(1);
    slices.w[1] -= on;
    slices.w[2] += on;

    const V turn = within(a * V(float((map.azimuths - 1) / kPi)), V(0),
                          V(float(map.azimuths) - 1.001f));
    const V last(float(map.sky.elevations > 0 ? map.sky.elevations - 1 : 0)),
        last_near = select(under, V(float(map.below.elevations - 1)),
                           V(float(map.above.elevations - 1)));
    const auto sky = place_on(v * last, last),
               nearby = place_on(v * last_near, last_near);
    float turn_at[W], s_row[W], s_w[4][W], e_row[2][W], e_w[2][4][W], is_under[W],
        is_whole[W];
    store(turn_at, turn), store(s_row, slices.row), store(e_row[0], nearby.row),
        store(e_row[1], sky.row);
    for (int i = 0; i < 4; ++i)
      store(s_w[i], slices.w[i]), store(e_w[0][i], nearby.w[i]),
          store(e_w[1][i], sky.w[i]);
    store(is_under, select(under, V(1), V(0))),
        store(is_whole, select(whole, V(1), V(0)));

    const V mu_begin = outside ? clamp((b + begin) / V(map.r_top), V(-1), V(0)) : mu;
    V colors[3];
    auto columns = columns_between(place.shape, V(map.h), mu_begin, through);
    const V weight(map.weight);
    columns.R *= weight, columns.M *= weight, columns.O *= weight;
    colors_through(place, columns, colors);
    float grown[3][W];
    for (int c = 0; c < 3; ++c) {
      float t[W];
      store(t, select(unknown, V(-1), select(there, colors[c], V(1))));
      store(
          grown[c],
          select(there, growth_over<V>(columns, place.grow_R[c], place.grow_M[c]), V(0)));
      for (int i = 0; i < used; ++i) T[c][start + i] = t[i];
    }

    float nus[W], p_R[W], p_M[W];
    store(nus, nu), store(p_R, phase_rayleigh(nu)), store(p_M, phase_mie(nu, map.g));
    for (int i = 0; i < used; ++i) {
      const int fine = is_whole[i] > 0;
      const HalfMap& half = fine ? map.sky : is_under[i] > 0 ? map.below : map.above;
      // Rows of memory: slices (with ghosts) within azimuths within elevations.
      const int taps = fine ? 1 : 4;
      const long row = long(fine ? 1 : half.slices + 2), ring = row * map.azimuths;
      const int a0 = int(turn_at[i]);
      const float fa = turn_at[i] - float(a0);
      const long first = fine ? 0 : long(s_row[i]);
      const float* p =
          half.parts + (long(e_row[fine][i]) * ring + a0 * row + first) * kMapParts;
      Sixteen mean(0);
      for (int e = 0; e < 4; ++e, p += ring * kMapParts)
        for (int j = 0; j < taps; ++j) {
          const float w = e_w[fine][e][i] * (fine ? 1.f : s_w[j][i]);
          const Sixteen one = Sixteen::at(p + j * kMapParts),
                        two = Sixteen::at(p + (row + j) * kMapParts);
          mean += Sixteen(w) * (one + Sixteen(fa) * (two - one));
        }
      float q[3], parts[kMapParts];
      forward_terms(map.forward, nus[i], q);
      mean.to(parts);
      const int o = start + i;
      for (int c = 0; c < 3; ++c) {
        const float m1 = parts[6 + c], m2 = parts[9 + c],
                    m3 = m1 > 1e-30f ? m2 * m2 / m1 : 0.f;
        const float once = parts[c] * p_R[i] + parts[3 + c] * p_M[i];
        const float more = m1 * q[0] + m2 * q[1] + m3 * q[2] + parts[12 + c];
        L[c][o] = grown[c][i] * max(once + max(more, 0.f), 0.f);
      }
    }
  }
}

}  // namespace brume::sky::inline BRUME_ISA_NS
