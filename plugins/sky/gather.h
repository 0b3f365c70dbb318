#pragma once
// One step of the solver: the light that arrives at one altitude along one elevation, for
// all sun heights and azimuths at once. Where the path runs does not depend on them; so
// its nodes, its weights and (for later orders) the sum over l at each node are found
// once, and what is left per sun height and azimuth is short.

#include "lookup.h"

namespace brume::sky::inline BRUME_ISA_NS {

/// Light of the sun, scattered or reflected once. light: [suns.count][N], overwritten.
template <int N, class S>
void gather_first(const Air<S>& air, const Line<S>& line, const Suns<S>& suns,
                  S* light) noexcept {
  using Color = Spectrum<S, N>;
  using V = Lanes<S>;
  const Nodes<S>& n = line.nodes;
  const Weights<S>& w = line.weights;
  for (int j = 0; j < suns.count; j += lanes<V>) {
    const V mu_s = load<V>(suns.mu_s + j),
            nu = V(line.mu) * mu_s + V(line.s) * load<V>(suns.sin_cos + j);
    S p_R[lanes<V>], p_M[lanes<V>], R[lanes<V>], M[lanes<V>], O[lanes<V>], lit[lanes<V>];
    store(p_R, phase_rayleigh(nu));
    store(p_M, phase_mie(nu, air.g));
    // Sunlight at altitude h, t along the path; lit: what is seen of the sun.
    auto sunlight = [&](V h, V t) {
      const V m = clamp((V(line.r) * mu_s + t * nu) / (V(air.shape.R) + h), V(-1), V(1));
      const auto sun = shown_sun(air.shape, max(h, V(0)), m);
      const auto c = columns_to_space(air.shape, h, sun.mu);
      store(R, c.R), store(M, c.M), store(O, c.O);
      store(lit, sun.part);
      return sun.mu;
    };
    Color sum[lanes<V>];
    for (Color& s : sum) s = Color(0);
    for (int q = 0; q < n.count; ++q) {
      const Color w_R = Color::at(w.R + q * N), w_M = Color::at(w.M + q * N);
      sunlight(V(n.h[q]), V(n.t[q]));
      for (int k = 0; k < lanes<V>; ++k)
        if (lit[k] > 0)
          sum[k] += (w_R * Color(p_R[k]) + w_M * Color(p_M[k])) *
                    (Color(lit[k]) * transmittance<S, N>(air, R[k], M[k], O[k]));
    }
    if (line.ground) {
      S m[lanes<V>];
      store(m, sunlight(V(0), V(line.t_end)));
      const Color reflected =
          Color::at(w.T) * Color::at(air.ground_albedo) * Color(S(1 / double(kPi)));
      for (int k = 0; k < lanes<V>; ++k)
        if (lit[k] > 0)
          sum[k] += reflected * Color(lit[k] * m[k]) *
                    transmittance<S, N>(air, R[k], M[k], O[k]);
    }
    for (int k = 0; k < lanes<V>; ++k)
      (sum[k] * Color::at(air.irradiance)).to(light + (j + k) * N);
  }
}

/// Light of `table`, scattered or reflected once more. light: [suns.count][N],
/// overwritten.
template <int N, int L, class S>
void gather_next(const Air<S>& air, const Table<S>& table, const Line<S>& line,
                 const Suns<S>& suns, S* light) noexcept {
  using Color = Spectrum<S, N>;
  using V = Lanes<S>;
  constexpr int kCount = harmonics_count(L);
  const Nodes<S>& n = line.nodes;
  const int row_size = kCount * N, rows = table.suns + 2;
  S folded[(kMaxSuns + 2) * (L + 1) * N];
  for (int i = 0; i < suns.count * N; ++i) light[i] = 0;
  for (int q = 0; q < n.count; ++q) {
    // The source's coefficients at this altitude, summed over l: what is left depends on
    // m and the sun's height.
    const S v = place_altitude(table, n.h[q]);
    const S* a = table.nodes + static_cast<long>(int(v)) * rows * row_size;
    const S* b = a + static_cast<long>(rows) * row_size;
    const Color w_R = Color::at(line.weights.R + q * N),
                w_M = Color::at(line.weights.M + q * N);
    S polar[kCount];
    polar_part<L>(n.z[q], polar);
    Color at_a[kCount], at_b[kCount];
    for (int l = 0; l <= L; ++l) {
      const Color w = Color(S(rayleigh_eigenvalue(l))) * w_R + Color(air.beta_M[l]) * w_M;
      for (int m = 0; m <= l; ++m) {
        at_b[harmonic(l, m)] = w * Color(polar[harmonic(l, m)] * (v - S(int(v))));
        at_a[harmonic(l, m)] = w * Color(polar[harmonic(l, m)]) - at_b[harmonic(l, m)];
      }
    }
    for (int j = 0; j < rows; ++j, a += row_size, b += row_size)
      for (int m = 0; m <= L; ++m) {
        Color sum(0);
        for (int l = m; l <= L; ++l) {
          const int c = harmonic(l, m);
          sum += at_a[c] * Color::at(a + c * N) + at_b[c] * Color::at(b + c * N);
        }
        sum.to(folded + (j * (L + 1) + m) * N);
      }

    for (int j = 0; j < suns.count; j += lanes<V>) {
      const V mu = load<V>(suns.mu_s + j),
              nu = V(line.mu) * mu + V(line.s) * load<V>(suns.sin_cos + j);
      const V mu_s = clamp(
          (V(line.r) * mu + V(n.t[q]) * nu) / (V(air.shape.R) + V(n.h[q])), V(-1), V(1));
      const auto p = place_sun(table, mu_s);
      V azimuth[L + 1];
      azimuth_part<L>(toward_sun(nu, mu_s, V(n.z[q])), V(n.z[q]), azimuth);
      S row[lanes<V>], w[4][lanes<V>], c[L + 1][lanes<V>];
      store(row, p.row);
      const V left = fade(table, V(v / S(table.altitudes - 1)), p.e);
      for (int k = 0; k < 4; ++k) store(w[k], p.w[k] * left);
      for (int m = 0; m <= L; ++m) store(c[m], azimuth[m]);
      for (int i = 0; i < lanes<V>; ++i) {
        Color sum = Color::at(light + (j + i) * N);
        for (int m = 0; m <= L; ++m) {
          const S* f = folded + (int(row[i]) * (L + 1) + m) * N;
          Color cubic(0);
          for (int k = 0; k < 4; ++k)
            cubic += Color(w[k][i]) * Color::at(f + k * (L + 1) * N);
          sum += Color(c[m][i]) * cubic;
        }
        sum.to(light + (j + i) * N);
      }
    }
  }
  const Color reflected = Color::at(line.weights.T) * Color::at(air.ground_albedo) *
                          Color(S(1 / double(kPi)));
  for (int j = 0; j < suns.count; ++j) {
    Color sum = max(Color::at(light + j * N), Color(0));
    if (line.ground) {
      const S mu = suns.mu_s[j], nu = line.mu * mu + line.s * suns.sin_cos[j];
      sum += reflected * ground_irradiance<N>(
                             table, clamp((line.r * mu + line.t_end * nu) / air.shape.R,
                                          S(-1), S(1)));
    }
    sum.to(light + j * N);
  }
}

/// Adds a line's light, times its solid angle, to the coefficients of its altitude: nodes
/// [heights][count][N]; and where `ground` is not null its irradiance to ground
/// [heights][N].
template <int N, int L, class S>
void project(const Line<S>& line, const Suns<S>& suns, S weight, const S* light, S* nodes,
             S* ground) noexcept {
  using Color = Spectrum<S, N>;
  constexpr int kCount = harmonics_count(L);
  S polar[kCount], y[kMaxAround][kCount];
  polar_part<L>(line.mu, polar);
  for (int k = 0; k < suns.azimuths; ++k) {
    S azimuth[L + 1];
    azimuth_part<L>(line.s * suns.cos_phi[k], line.mu, azimuth);
    for (int l = 0; l <= L; ++l)
      for (int m = 0; m <= l; ++m)
        y[k][harmonic(l, m)] = weight * polar[harmonic(l, m)] * azimuth[m];
  }
  for (int j = 0; j < suns.heights; ++j, nodes += kCount * N) {
    Color all(0);
    for (int k = 0; k < suns.azimuths; ++k, light += N) {
      const Color in = Color::at(light);
      all += in;
      for (int c = 0; c < kCount; ++c)
        (Color::at(nodes + c * N) + Color(y[k][c]) * in).to(nodes + c * N);
    }
    if (ground)
      (Color::at(ground + j * N) + Color(weight * line.mu) * all).to(ground + j * N);
  }
}

}  // namespace brume::sky::inline BRUME_ISA_NS
