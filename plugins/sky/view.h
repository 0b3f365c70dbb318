#pragma once
// What an eye sees along a ray: sunlight scattered once with the exact phase functions,
// all further orders from the table.

#include "air.h"

namespace brume::sky::inline BRUME_ISA_NS {

template <class S, int N>
struct Seen {
  Spectrum<S, N> L;       // radiance the air adds [W m^-2 sr^-1 nm^-1]
  Spectrum<S, N> T;       // transmittance
  Spectrum<S, N> single;  // the part of L scattered once
};

/// Linear in both; h ~ x^3 and mu = scale sinh(y).
template <class S>
BRUME_INLINE S neighbourhood_column(const Forward<S>& f, S h, S mu) {
  const S y = clamp((asinh_(mu / f.kScale) - f.x0) * f.inv_dx, S(0),
                    S(f.kDirections - 1) * S(.9999));
  const S x3 = clamp(h * f.inv_top, S(1e-12), S(1));
  const S x = exp(log(x3) / 3) * S(f.kAltitudes - 1) * S(.9999);
  const int i = int(x), j = int(y);
  const S p = x - S(i), q = y - S(j);
  const S *a = f.column + i * f.kDirections + j, *b = a + f.kDirections;
  return (1 - p) * ((1 - q) * a[0] + q * a[1]) + p * ((1 - q) * b[0] + q * b[1]);
}

template <class S, int N, int L>
Seen<S, N> see(const Air<S, N>& air, const Forward<S>& forward, const Table<S>& table,
               const Trace& trace, const Ray& ray, int panels) {
  using Color = Spectrum<S, N>;
  using V = Lanes<S>;
  constexpr int kCount = harmonics_count(L);
  Nodes<S> n;
  Weights<S, N> w;
  place_nodes(air.shape, trace, panels, n);
  weigh(air.at1, n, w);

  // Sunlight at the nodes, and their places in the table.
  S mu_s[kMaxNodes], lit[kMaxNodes], R[kMaxNodes], M[kMaxNodes], O[kMaxNodes],
      x[kMaxNodes], row[kMaxNodes], pw[4][kMaxNodes];
  const S start = S((double(air.shape.R) + ray.h) * ray.mu_s), nu = S(ray.nu);
  for (int i = 0; i < n.count; i += lanes<V>) {
    const V h = load<V>(n.h + i), z = load<V>(n.z + i);
    const V m =
        clamp((V(start) + load<V>(n.t + i) * V(nu)) / (V(air.shape.R) + h), V(-1), V(1));
    const auto c = columns_to_space(air.shape, h, m);
    store(mu_s + i, m), store(R + i, c.R), store(M + i, c.M), store(O + i, c.O);
    store(lit + i, select(sees_space(air.shape, h, m), V(1), V(0)));
    store(x + i, toward_sun(V(nu), m, z));
    const auto p = place(table, m);
    store(row + i, p.row);
    for (int k = 0; k < 4; ++k) store(pw[k] + i, p.w[k]);
  }

  // The forward peak's series at this scattering angle.
  const S angle = sqrt(max((1 - nu) / 2, S(0))) * S(forward.kAngles) * S(.9999);
  const S part = angle - S(int(angle));
  S series[Forward<S>::kTerms];
  for (int k = 0; k < forward.kTerms; ++k) {
    const S* s = forward.series + int(angle) * forward.kTerms + k;
    series[k] = s[0] + part * (s[forward.kTerms] - s[0]);
  }

  const Color p_R(phase_rayleigh(nu)), p_M(phase_mie(nu, air.g));
  Color single(0), peak(0), multiple(0);
  for (int i = 0; i < n.count; ++i) {
    if (lit[i] > 0) {
      const Color sun = air.transmittance({R[i], M[i], O[i]});
      const Color tau =
          min(air.at1.scatter_M * Color(neighbourhood_column(forward, n.h[i], mu_s[i])),
              Color(2));
      single += (w.R[i] * p_R + w.M[i] * p_M) * sun;
      peak += w.M[i] * sun * tau *
              (Color(series[0]) + tau * (Color(series[1]) + tau * Color(series[2])));
    }
    const S v = clamp(sqrt(max(n.h[i], S(0)) * table.inv_top) * S(table.altitudes - 1),
                      S(0), S(table.altitudes - 1) * S(.999999));
    const S f = v - S(int(v));
    const S* a =
        table.nodes + (std::size_t(v) * (table.suns + 2) + int(row[i])) * kCount * N;
    const S* b = a + std::size_t(table.suns + 2) * kCount * N;
    S polar[kCount], azimuth[L + 1];
    polar_part<L>(n.z[i], polar);
    azimuth_part<L>(x[i], n.z[i], azimuth);
    for (int l = 0; l <= L; ++l) {
      Color at_l(0);
      for (int m = 0; m <= l; ++m) {
        const int c = harmonic(l, m) * N;
        Color low(0), high(0);
        for (int k = 0; k < 4; ++k) {
          low += Color(pw[k][i]) * Color::at(a + k * kCount * N + c);
          high += Color(pw[k][i]) * Color::at(b + k * kCount * N + c);
        }
        at_l +=
            Color(polar[harmonic(l, m)] * azimuth[m]) * (low + Color(f) * (high - low));
      }
      multiple += at_l * (Color(S(rayleigh_eigenvalue(l))) * w.R[i] +
                          Color(air.beta_M[l]) * w.M[i]);
    }
  }
  single *= air.irradiance;
  return {single + max(peak * air.irradiance + multiple, Color(0)), w.T, single};
}

}  // namespace brume::sky::inline BRUME_ISA_NS
