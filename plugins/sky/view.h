#pragma once
// What an eye sees along a ray: sunlight scattered once with the exact phase functions,
// all further orders from the table.

#include "lookup.h"

namespace brume::sky::inline BRUME_ISA_NS {

/// The light of a path, by how it depends on the scattering angle nu:
///   E (R p_R(nu) + M[0] p_M(nu) + sum_k M[k] q_k(nu)) + D,  k = 1, 2, 3  (forward.h)
template <class S, int N>
struct Parts {
  Spectrum<S, N> R, M[4], D;
};

/// The parts of the light of all nodes; `at(panel, parts)` is called after each panel.
/// `start` = r mu_s of the eye.
template <int N, int L, class S, class At>
BRUME_INLINE Parts<S, N> gather_parts(const Air<S>& air, const Forward<S>& forward,
                                      const Table<S>& table, const Nodes<S>& n,
                                      const Weights<S>& w, S start, S nu,
                                      At at) noexcept {
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
    const auto sun = shown_sun(air.shape, max(h, V(0)), m);
    const auto c = columns_to_space(air.shape, max(h, V(0)), sun.mu);
    store(mu_s + i, m), store(R + i, c.R), store(M + i, c.M), store(O + i, c.O);
    store(lit + i, sun.part);
    store(x + i, toward_sun(V(nu), m, z));
    const auto p = place_sun(table, m);
    store(row + i, p.row);
    const V left = fade(table, sqrt(within(h * V(table.inv_top), V(0), V(1))), p.e);
    for (int k = 0; k < 4; ++k) store(pw[k] + i, p.w[k] * left);
  }

  const Color scatter_M = Color::at(air.scatter_M);
  Parts<S, N> sum = {Color(0), {Color(0), Color(0), Color(0), Color(0)}, Color(0)};
  for (int i = 0; i < n.count; ++i) {
    const Color w_R = Color::at(w.R + i * N), w_M = Color::at(w.M + i * N);
    if (lit[i] > 0) {
      const Color sun = Color(lit[i]) * transmittance<S, N>(air, R[i], M[i], O[i]);
      // Beyond tau = 2 little sunlight is left, and three terms no longer make e^tau.
      const Color tau = min(
          scatter_M * Color(neighbourhood_column(forward, n.h[i], mu_s[i])), Color(2));
      sum.R += w_R * sun;
      Color m = w_M * sun;
      for (int k = 0; k < 4; ++k, m = m * tau) sum.M[k] += m;
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
      sum.D +=
          at_l * (Color(S(rayleigh_eigenvalue(l))) * w_R + Color(air.beta_M[l]) * w_M);
    }
    if (i % 3 == 2) at(i / 3, sum);
  }
  return sum;
}

/// The light of the parts. What is scattered twice or more is never negative.
template <class S, int N>
BRUME_INLINE void assemble(const Air<S>& air, const Forward<S>& forward,
                           const Parts<S, N>& p, S nu, Seen<S>& out) {
  using Color = Spectrum<S, N>;
  S q[Forward<S>::kTerms];
  forward_terms(forward, nu, q);
  const Color E = Color::at(air.irradiance);
  const Color single =
      E * (p.R * Color(phase_rayleigh(nu)) + p.M[0] * Color(phase_mie(nu, air.g)));
  const Color peak =
      E * (p.M[1] * Color(q[0]) + p.M[2] * Color(q[1]) + p.M[3] * Color(q[2]));
  single.to(out.single);
  (single + max(peak + p.D, Color(0))).to(out.L);
}

template <int N, int L, class S>
void see(const Air<S>& air, const Forward<S>& forward, const Table<S>& table,
         const Trace& trace, const Ray& ray, int panels, Seen<S>& out) noexcept {
  Nodes<S> n;
  Weights<S> w;
  place_nodes(air.shape, trace, panels, n);
  weigh<N>(air, n, S(ray.weight), w);
  const S start = S((double(air.shape.R) + ray.h) * ray.mu_s), nu = S(ray.nu);
  assemble(
      air, forward,
      gather_parts<N, L>(air, forward, table, n, w, start, nu, [](int, const auto&) {}),
      nu, out);
  Spectrum<S, N>::at(w.T).to(out.T);
}

/// The parts up to each of the trace's marked distances and, last, up to the path's end:
/// parts [distances + 1][6][N] (R, M[0] to M[3], each times E; D), T [distances + 1][N].
/// Distances beyond the end keep what was there.
template <int N, int L, class S>
void see_along(const Air<S>& air, const Forward<S>& forward, const Table<S>& table,
               const Trace& trace, const Ray& ray, int panels, int distances, S* parts,
               S* T) noexcept {
  using Color = Spectrum<S, N>;
  Nodes<S> n;
  Weights<S> w;
  place_nodes(air.shape, trace, panels, n);
  weigh<N>(air, n, S(ray.weight), w);
  const Color E = Color::at(air.irradiance);
  const auto write = [&](int i, const Parts<S, N>& p, const S* through) {
    S* to = parts + i * 6 * N;
    (E * p.R).to(to);
    for (int k = 0; k < 4; ++k) (E * p.M[k]).to(to + (1 + k) * N);
    p.D.to(to + 5 * N);
    Color::at(through).to(T + i * N);
  };
  const auto all = gather_parts<N, L>(air, forward, table, n, w,
                                      S((double(air.shape.R) + ray.h) * ray.mu_s),
                                      S(ray.nu), [&](int panel, const Parts<S, N>& p) {
                                        if (n.mark[panel] >= 0)
                                          write(n.mark[panel], p, w.T_panel + panel * N);
                                      });
  write(distances, all, w.T);
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
  const S start = S((double(air.shape.R) + ray.h) * ray.mu_s), nu = S(ray.nu);
  assemble(
      air, forward,
      gather_parts<N, L>(air, forward, table, n, w, start, nu, [](int, const auto&) {}),
      nu, out);
  extinction.to(out.T);
}

}  // namespace brume::sky::inline BRUME_ISA_NS
