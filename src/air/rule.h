#pragma once
// The rule for a piece of a ray on which several media overlap (METHODS O).
//
//   L = Int e^-tau dJ over the piece,  d its optical depth, J the light added on it
//   before any is lost, both exact. With u = tau/d the source S = dJ/dtau is taken as the
//   parabola that has its true end values Sa, Sb and its true mean J/d:
//     S = Sa + p u + q u^2,  p = 6 J/d - 4 Sa - 2 Sb,  q = 3 Sa + 3 Sb - 6 J/d
//     L = E0 Sa + E1 p + E2 q                             (Olson & Kunasz 1987 for E_k)
//   Where the parabola leaves [least, most], the range of what is there, L = J exprel(d).

#include "num/math.h"

namespace brume::air::inline BRUME_ISA_NS {

/// L as weights of what went into it: L = a Sa + b Sb + j J. Shares of single media
/// follow by the same weights.
template <Real T>
struct PieceWeights {
  T a, b, j;
};

template <Real T>
BRUME_INLINE PieceWeights<T> piece_weights(T d, T Sa, T Sb, T J, T least, T most,
                                           const SourceWeights<T>& E) {
  // A piece too thin for its source to matter: also keeps J/d finite.
  const auto thin = d < T(1e-7f);
  const T inv_d = T(1) / max(d, T(1e-7f));
  const T Sm = J * inv_d;
  const T p = T(6) * Sm - T(4) * Sa - T(2) * Sb;
  const T q = T(3) * (Sa + Sb) - T(6) * Sm;
  // Its extreme value, where u = -p/2q lies within the piece.
  const auto bends = (p * q < T(0)) & (abs(p) < T(2) * abs(q));
  const T extreme = select(bends, Sa - p * p / (T(4) * select(bends, q, T(1))), Sa);
  const T slack = T(1e-6f) * abs(Sm);
  const auto mean_only =
      thin | (extreme < least - slack) | (extreme > most + slack) | !(abs(p) < T(1e30f));
  const T zero(0);
  return {select(mean_only, zero, E.E0 - T(4) * E.E1 + T(3) * E.E2),
          select(mean_only, zero, T(3) * E.E2 - T(2) * E.E1),
          select(mean_only, select(thin, T(1) - T(0.5f) * d, E.E0 * inv_d),
                 T(6) * (E.E1 - E.E2) * inv_d)};
}

// The mean of f over u in [0, 1] from f(0), f(v), f(1), by their parabola; where v is so
// near an end that it would amplify, or the parabola would go negative, by two straight
// lines.
template <Real T>
BRUME_INLINE T mean_of_three(T f0, T fv, T f1, T v) {
  const T lines = T(0.5f) * (v * (f0 + fv) + (T(1) - v) * (fv + f1));
  const auto central = (v > T(0.1f)) & (v < T(0.9f));
  const T w = select(central, v, T(0.5f));
  const T c1 = (fv - f0) / w;
  const T c2 = (f1 - f0 - c1) / (T(1) - w);
  const T parabola = f0 + T(0.5f) * c1 + c2 * (T(1.f / 3) - T(0.5f) * w);
  const T low = min(f0, min(fv, f1)), high = max(f0, max(fv, f1));
  return select(central & (parabola >= low) & (parabola <= high), parabola, lines);
}

}  // namespace brume::air::inline BRUME_ISA_NS
