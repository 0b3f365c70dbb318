#pragma once
// One step of the solver: the light that arrives at one altitude along one elevation, for
// all sun heights and azimuths at once. Where the path runs does not depend on them; so
// its nodes, its weights and (for later orders) the sum over l at each node are found
// once, and what is left per sun height and azimuth is short.

#include "air.h"

namespace brume::sky::inline BRUME_ISA_NS {

/// A path and its place in the sphere of directions.
template <class S, int N>
struct Line {
  Nodes<S> nodes;
  Weights<S, N> weights;
  S r, t_end;   // of the node [m]; length of the path
  S mu, s;      // cosine, sine of the direction's zenith angle
  bool ground;  // ends there
};

/// Sun heights times azimuths, padded to full lanes: mu_s, and sin_s cos(phi).
template <class S>
struct Suns {
  int count;
  const S *mu_s, *sin_cos;
};

/// Light of the sun scattered or reflected once. sum: [count][N], overwritten.
template <class S, int N>
void gather_first(const Air<S, N>& air, const Line<S, N>& line, const Suns<S>& suns,
                  S* sum) {
  using Color = Spectrum<S, N>;
  using V = Lanes<S>;
  const Nodes<S>& n = line.nodes;
  for (int i = 0; i < suns.count * N; ++i) sum[i] = 0;
  for (int j = 0; j < suns.count; j += lanes<V>) {
    const V mu_s = load<V>(suns.mu_s + j),
            nu = V(line.mu) * mu_s + V(line.s) * load<V>(suns.sin_cos + j);
    S p_R[lanes<V>], p_M[lanes<V>], R[lanes<V>], M[lanes<V>], O[lanes<V>], lit[lanes<V>];
    store(p_R, phase_rayleigh(nu));
    store(p_M, phase_mie(nu, air.g));
    auto sunlight = [&](V h, V t) {
      const V m = clamp((V(line.r) * mu_s + t * nu) / (V(air.shape.R) + h), V(-1), V(1));
      const auto c = columns_to_space(air.shape, h, m);
      store(R, c.R), store(M, c.M), store(O, c.O);
      store(lit, select(sees_space(air.shape, h, m), max(m, V(S(1e-6))), V(0)));
      return m;
    };
    for (int q = 0; q < n.count; ++q) {
      sunlight(V(n.h[q]), V(n.t[q]));
      for (int k = 0; k < lanes<V>; ++k)
        if (lit[k] > 0) {
          S* to = sum + (j + k) * N;
          (Color::at(to) +
           (line.weights.R[q] * Color(p_R[k]) + line.weights.M[q] * Color(p_M[k])) *
               air.transmittance({R[k], M[k], O[k]}))
              .to(to);
        }
    }
    if (line.ground) {
      S m[lanes<V>];
      store(m, sunlight(V(0), V(line.t_end)));
      for (int k = 0; k < lanes<V>; ++k)
        if (m[k] > 0) {
          S* to = sum + (j + k) * N;
          (Color::at(to) + line.weights.T * air.ground_albedo *
                               Color(m[k] * S(1 / double(kPi))) *
                               air.transmittance({R[k], M[k], O[k]}))
              .to(to);
        }
    }
    for (int k = 0; k < lanes<V>; ++k) {
      S* to = sum + (j + k) * N;
      (Color::at(to) * air.irradiance).to(to);
    }
  }
}

/// Light of `table` scattered or reflected once more. sum: [count][N], overwritten.
template <class S, int N, int L>
void gather_next(const Air<S, N>& air, const Table<S>& table, const Line<S, N>& line,
                 const Suns<S>& suns, S* sum) {
  using Color = Spectrum<S, N>;
  using V = Lanes<S>;
  constexpr int kCount = harmonics_count(L), kMaxSuns = 128;
  const Nodes<S>& n = line.nodes;
  Color folded[kMaxSuns * (L + 1)];
  for (int i = 0; i < suns.count * N; ++i) sum[i] = 0;
  for (int q = 0; q < n.count; ++q) {
    // The source's coefficients at this altitude, summed over l.
    const S v = clamp(sqrt(max(n.h[q], S(0)) * table.inv_top) * S(table.altitudes - 1),
                      S(0), S(table.altitudes - 1) * S(.999999));
    const int i = int(v);
    const S f = v - S(i);
    const S* a = table.nodes + std::size_t(i) * (table.suns + 2) * kCount * N;
    const S* b = a + std::size_t(table.suns + 2) * kCount * N;
    S polar[kCount];
    polar_part<L>(n.z[q], polar);
    Color w[kCount], w0[kCount];
    for (int l = 0; l <= L; ++l)
      for (int m = 0; m <= l; ++m) {
        const Color both = (Color(S(rayleigh_eigenvalue(l))) * line.weights.R[q] +
                            Color(air.beta_M[l]) * line.weights.M[q]) *
                           Color(polar[harmonic(l, m)]);
        w[harmonic(l, m)] = both * Color(f), w0[harmonic(l, m)] = both * Color(1 - f);
      }
    for (int j = 0; j < table.suns + 2; ++j, a += kCount * N, b += kCount * N)
      for (int m = 0; m <= L; ++m) {
        Color g(0);
        for (int l = m; l <= L; ++l) {
          const int c = harmonic(l, m);
          g += w0[c] * Color::at(a + c * N) + w[c] * Color::at(b + c * N);
        }
        folded[j * (L + 1) + m] = g;
      }
    for (int j = 0; j < suns.count; j += lanes<V>) {
      const V mu = load<V>(suns.mu_s + j),
              nu = V(line.mu) * mu + V(line.s) * load<V>(suns.sin_cos + j);
      const V mu_s = clamp(
          (V(line.r) * mu + V(n.t[q]) * nu) / (V(air.shape.R) + V(n.h[q])), V(-1), V(1));
      const auto p = place(table, mu_s);
      V azimuth[L + 1];
      azimuth_part<L>(toward_sun(nu, mu_s, V(n.z[q])), V(n.z[q]), azimuth);
      S row[lanes<V>], pw[4][lanes<V>], c[L + 1][lanes<V>];
      store(row, p.row);
      for (int k = 0; k < 4; ++k) store(pw[k], p.w[k]);
      for (int m = 0; m <= L; ++m) store(c[m], azimuth[m]);
      for (int k = 0; k < lanes<V>; ++k) {
        const Color* g = folded + int(row[k]) * (L + 1);
        Color add = Color::at(sum + (j + k) * N);
        for (int m = 0; m <= L; ++m)
          add +=
              Color(c[m][k]) * (Color(pw[0][k]) * g[m] + Color(pw[1][k]) * g[L + 1 + m] +
                                Color(pw[2][k]) * g[2 * (L + 1) + m] +
                                Color(pw[3][k]) * g[3 * (L + 1) + m]);
        add.to(sum + (j + k) * N);
      }
    }
  }
  for (int j = 0; j < suns.count; ++j) {
    Color total = max(Color::at(sum + j * N), Color(0));
    if (line.ground) {
      const S mu = suns.mu_s[j], nu = line.mu * mu + line.s * suns.sin_cos[j];
      const S m = clamp((line.r * mu + line.t_end * nu) / air.shape.R, S(-1), S(1));
      total += line.weights.T * air.ground_albedo * Color(S(1 / double(kPi))) *
               ground_irradiance<S, N>(table, m);
    }
    total.to(sum + j * N);
  }
}

}  // namespace brume::sky::inline BRUME_ISA_NS
