#pragma once
// What an eye sees along a ray: sunlight scattered once with the exact phase functions,
// all further orders from the table.

#include "lookup.h"

namespace brume::sky::inline BRUME_ISA_NS {

/// Light from the nodes `n` with weights `w`, lit by a sun of cosine (start + t nu)/r at
/// each.
template <int N, int L, class S>
void see_nodes(const Air<S>& air, const Forward<S>& forward, const Table<S>& table,
               const Nodes<S>& n, const Weights<S>& w, S start, S nu,
               Seen<S>& out) noexcept {
  using Color = Spectrum<S, N>;
  using V = Lanes<S>;
  constexpr int kCount = harmonics_count(L);
  // The sun at the nodes, and its place in the table.
  S mu_s[kMaxNodes], lit[kMaxNodes], R[kMaxNodes], M[kMaxNodes], O[kMaxNodes];
  S x[kMaxNodes], row[kMaxNodes], pw[4][kMaxNodes];
  for (int i = 0; i < n.count; i += lanes<V>) {
    const V h = load<V>(n.h + i), z = load<V>(n.z + i);
    const V m =
        clamp((V(start) + load<V>(n.t + i) * V(nu)) / (V(air.shape.R) + h), V(-1), V(1));
    const auto c = columns_to_space(air.shape, h, m);
    store(mu_s + i, m), store(R + i, c.R), store(M + i, c.M), store(O + i, c.O);
    store(lit + i, select(sees_space(air.shape, h, m), V(1), V(0)));
    store(x + i, toward_sun(V(nu), m, z));
    const auto p = place_sun(table, m);
    store(row + i, p.row);
    for (int k = 0; k < 4; ++k) store(pw[k] + i, p.w[k]);
  }

  const Color p_R(phase_rayleigh(nu)), p_M(phase_mie(nu, air.g)),
      scatter_M = Color::at(air.scatter_M);
  S q[Forward<S>::kTerms];
  forward_terms(forward, nu, q);
  Color single(0), peak(0), multiple(0);
  for (int i = 0; i < n.count; ++i) {
    const Color w_R = Color::at(w.R + i * N), w_M = Color::at(w.M + i * N);
    if (lit[i] > 0) {
      const Color sun = transmittance<S, N>(air, R[i], M[i], O[i]);
      // Beyond tau = 2 little sunlight is left, and three terms no longer make e^tau.
      const Color tau = min(
          scatter_M * Color(neighbourhood_column(forward, n.h[i], mu_s[i])), Color(2));
      single += (w_R * p_R + w_M * p_M) * sun;
      peak += w_M * sun * tau * (Color(q[0]) + tau * (Color(q[1]) + tau * Color(q[2])));
    }
    const S v = place_altitude(table, n.h[i]), f = v - S(int(v));
    const S* a =
        table.nodes +
        (static_cast<long>(int(v)) * (table.suns + 2) + int(row[i])) * kCount * N;
    const S* b = a + static_cast<long>(table.suns + 2) * kCount * N;
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
      multiple +=
          at_l * (Color(S(rayleigh_eigenvalue(l))) * w_R + Color(air.beta_M[l]) * w_M);
    }
  }
  const Color E = Color::at(air.irradiance);
  (single * E).to(out.single);
  (single * E + max(peak * E + multiple, Color(0))).to(out.L);
  Color::at(w.T).to(out.T);
}

template <int N, int L, class S>
void see(const Air<S>& air, const Forward<S>& forward, const Table<S>& table,
         const Trace& trace, const Ray& ray, int panels, Seen<S>& out) noexcept {
  Nodes<S> n;
  Weights<S> w;
  place_nodes(air.shape, trace, panels, n);
  weigh<N>(air, n, w);
  see_nodes<N, L>(air, forward, table, n, w, S((double(air.shape.R) + ray.h) * ray.mu_s),
                  S(ray.nu), out);
  Spectrum<S, N>::at(w.T).to(out.T);
}

/// The source at the eye's place: light added along the ray per unit of optical depth
/// (out.L); out.T is the extinction there [1/m].
template <int N, int L, class S>
void source(const Air<S>& air, const Forward<S>& forward, const Table<S>& table,
            const Ray& ray, Seen<S>& out) noexcept {
  using Color = Spectrum<S, N>;
  using V = Lanes<S>;
  Nodes<S> n;
  Weights<S> w;
  n.count = 1;
  for (int i = 0; i < lanes<V>; ++i) n.h[i] = S(ray.h), n.z[i] = S(ray.mu), n.t[i] = 0;
  const S R = exp(S(-ray.h) / air.shape.H_R), M = exp(S(-ray.h) / air.shape.H_M),
          O = ozone_density(air.shape, S(ray.h));
  const Color r = Color::at(air.scatter_R) * Color(R),
              m = Color::at(air.scatter_M) * Color(M);
  const Color extinction = Color::at(air.extinct_R) * Color(R) +
                           Color::at(air.extinct_M) * Color(M) +
                           Color::at(air.absorb_O) * Color(O);
  const Color per_depth = Color(1) / max(extinction, Color(S(1e-37)));
  (r * per_depth).to(w.R);
  (m * per_depth).to(w.M);
  see_nodes<N, L>(air, forward, table, n, w, S((double(air.shape.R) + ray.h) * ray.mu_s),
                  S(ray.nu), out);
  extinction.to(out.T);
}

}  // namespace brume::sky::inline BRUME_ISA_NS
