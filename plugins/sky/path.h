#pragma once
// The quadrature of everything that happens along a straight path through the air.
//
// On each monotone piece of the path (trace.h) the distance from its lowest point is u =
// U x^2: nodes lie dense where the air is. Each panel in x holds three Gauss-Legendre
// nodes; the optical depth up to each node comes from the same three extinctions by
// collocation (the Kuntzmann-Butcher method of order 6: Hairer, Norsett, Wanner, Solving
// Ordinary Differential Equations I, table II.7.4). A panel's weights are scaled so that
// they sum to exactly T (1 - e^-d): a constant source is exact, and no energy is gained
// however thick the panel is.

#include "column.h"
#include "types.h"

namespace brume::sky::inline BRUME_ISA_NS {

// Row k: integral from the panel's start to node k, of the three nodal values.
constexpr double kUpTo[3][3] = {{5. / 36, 2. / 9 - kRoot15 / 15, 5. / 36 - kRoot15 / 30},
                                {5. / 36 + kRoot15 / 24, 2. / 9, 5. / 36 - kRoot15 / 24},
                                {5. / 36 + kRoot15 / 30, 2. / 9 + kRoot15 / 15, 5. / 36}};

/// `panels` (1 to kMaxPanels) on each whole piece, at least one on every stretch.
template <class S>
void place_nodes(const Shape<S>& a, const Trace& trace, int panels,
                 Nodes<S>& out) noexcept {
  using V = Lanes<S>;
  S u[kMaxNodes], c_low[kMaxNodes], b_low[kMaxNodes], sign[kMaxNodes];
  int count = 0;
  for (int i = 0; i < trace.count; ++i) {
    const Stretch& s = trace.stretches[i];
    const double x0 = sqrt(s.u_begin / s.U), x1 = sqrt(s.u_end / s.U),
                 width = abs(x1 - x0);
    const int whole = static_cast<int>(panels * width + .999), n = whole > 1 ? whole : 1;
    for (int p = 0; p < n; ++p)
      for (int k = 0; k < 3; ++k, ++count) {
        const double x = x0 + (x1 - x0) * (p + kGaussNode[k]) / n, along = s.U * x * x;
        u[count] = S(along);
        out.t[count] = S(s.t_low + s.sign * along);
        out.du[count] = S(kGaussWeight[k] * 2 * s.U * x * width / n);
        c_low[count] = S(s.c_low), b_low[count] = S(s.b_low), sign[count] = S(s.sign);
        out.mark[count / 3] = p + 1 == n ? s.mark : -1;
      }
  }
  out.count = count;
  for (; count % lanes<V>; ++count)
    u[count] = out.t[count] = out.du[count] = c_low[count] = b_low[count] = sign[count] =
        0;

  for (int i = 0; i < count; i += lanes<V>) {
    const V along = load<V>(u + i), b = load<V>(b_low + i);
    const V h = altitude(load<V>(c_low + i) + along * (b + b + along), V(a.R));
    store(out.h + i, h);
    store(out.z + i, load<V>(sign + i) * (b + along) / (V(a.R) + h));
    store(out.R + i, exp(h * V(-1 / a.H_R)));
    store(out.M + i, exp(h * V(-1 / a.H_M)));
    store(out.O + i, ozone_density(a, h));
  }
}

/// `weight`: how much of the air there is, along this path only.
template <int N, class S>
void weigh(const Air<S>& air, const Nodes<S>& n, S weight, Weights<S>& out) noexcept {
  using Color = Spectrum<S, N>;
  const Color extinct_R = Color::at(air.extinct_R), extinct_M = Color::at(air.extinct_M),
              absorb_O = Color::at(air.absorb_O);
  const Color scatter_R = Color::at(air.scatter_R), scatter_M = Color::at(air.scatter_M);
  Color tau(0), T(1);
  for (int i = 0; i < n.count; i += 3) {
    // Extinction at the panel's nodes, times its length.
    Color e[3], seen[3], d(0), sum(0);
    for (int k = 0; k < 3; ++k) {
      e[k] = (extinct_R * Color(n.R[i + k]) + extinct_M * Color(n.M[i + k]) +
              absorb_O * Color(n.O[i + k])) *
             Color(weight * n.du[i + k] * S(1 / kGaussWeight[k]));
      d += Color(S(kGaussWeight[k])) * e[k];
    }
    // Transmittance from the panel's start to each node; e^-80 still leaves the sum above
    // 0.
    for (int k = 0; k < 3; ++k) {
      Color to(0);
      for (int j = 0; j < 3; ++j) to += Color(S(kUpTo[k][j])) * e[j];
      seen[k] = exp(-clamp(to, Color(0), Color(80)));
      sum += Color(S(kGaussWeight[k])) * e[k] * seen[k];
    }
    const Color tiny(S(1e-30)),
        scale = T * select(sum > tiny, transmit(d).A / max(sum, tiny), Color(1));
    for (int k = 0; k < 3; ++k) {
      const Color w = scale * seen[k] * Color(weight * n.du[i + k]);
      (w * scatter_R * Color(n.R[i + k])).to(out.R + (i + k) * N);
      (w * scatter_M * Color(n.M[i + k])).to(out.M + (i + k) * N);
    }
    tau += d;
    T = exp(-tau);
    T.to(out.T_panel + i / 3 * N);
  }
  T.to(out.T);
}

}  // namespace brume::sky::inline BRUME_ISA_NS
