#pragma once
// The exponential family: what becomes of light along a ray. Conventions in math.h.

#include "num/polynomial.h"

namespace brume::inline BRUME_ISA_NS {

inline constexpr long double kLn2 = 0.693147180559945309417232121458176568L;

// Adding it rounds to an integer, which then sits in the low bits of the sum.
template <Real T>
inline constexpr Scalar_t<T> rounder = is_double<T> ? 0x1.8p52 : 0x1.8p23;

// The pieces of e^x = s1 s2 (1 + p): s1, s2 powers of two whose product is 2^n (two of
// them, so that 2^n may lie beyond the range of T), p = e^r - 1, |r| <= ln(2)/2.
// Everything below is made of them without a subtraction that cancels.
template <Real T>
struct ExpPieces {
  T s1, s2, p;
};

// ln 2 in two parts; the first times any exponent is exact.
template <Real T>
inline constexpr Scalar_t<T> ln2_hi = is_double<T> ? 0x1.62e42feep-1 : 0x1.62e4p-1;
template <Real T>
inline constexpr Scalar_t<T> ln2_lo =
    is_double<T> ? 0x1.a39ef35793c76p-33 : 0x1.7f7d1cf8p-20;

// From r and t = n + round, n sitting in the low bits of t.
template <Real T>
BRUME_INLINE ExpPieces<T> exp_pieces_of(T r, T t) {
  using B = Bits_t<T>;
  constexpr auto expm1_over_r = series<16>([](int k) { return 1 / factorial(k + 1); });
  constexpr auto q = economised<(is_double<T> ? 11 : 6)>(expm1_over_r, -0.347L, 0.347L);
  // Half of n goes into each exponent; the offset keeps both halves positive.
  constexpr int mantissa = is_double<T> ? 52 : 23, bias = is_double<T> ? 1023 : 127;
  constexpr int offset = 4 * bias;
  const B m = bits(t) - B(bits(rounder<T>) - offset);
  const B half = m >> 1, rest = m - half;
  const T s1 = value((half - B(offset / 2 - bias)) << mantissa);
  const T s2 = value((rest - B(offset / 2 - bias)) << mantissa);
  return {s1, s2, r * evaluate(q, r)};
}

// n = round(x / ln 2), r = x - n ln 2 with ln 2 in two parts, n times the first exact
// (Cody & Waite 1980); p = r q(r), q the series of (e^r - 1)/r.
// x is clamped from -105 (double: -746) to `top`, where 2^n fits two factors; with the
// default it fits one. NaN stays in p.
template <Real T>
BRUME_INLINE ExpPieces<T> exp_pieces(T x, Scalar_t<T> top = is_double<T> ? 709 : 88) {
  using S = Scalar_t<T>;
  x = clamp(x, T(is_double<T> ? -746 : -105), T(top));
  const T t = x * T(S(1 / kLn2)) + T(rounder<T>);
  const T n = t - T(rounder<T>);
  return exp_pieces_of((x - n * T(ln2_hi<T>)) - n * T(ln2_lo<T>), t);
}

// e^(hi + lo): an exponent in two pieces, for one number would lose eps |x| of the
// result. |lo| <= 1.
template <Real T>
BRUME_INLINE ExpPieces<T> exp_pieces(T hi, T lo, Scalar_t<T> top) {
  using S = Scalar_t<T>;
  hi = clamp(hi, T(is_double<T> ? -746 : -105), T(top));
  const T t = (hi + lo) * T(S(1 / kLn2)) + T(rounder<T>);
  const T n = t - T(rounder<T>);
  return exp_pieces_of((hi - n * T(ln2_hi<T>)) + (lo - n * T(ln2_lo<T>)), t);
}

// Where even e^x/x^2 is beyond the largest T, and 2^n still fits two factors.
template <Real T>
inline constexpr Scalar_t<T> exp_top = is_double<T> ? 724 : 99;

// exp(x) = e^x.
//   Domain: all; exp(-inf) = 0, exp(inf) = inf.
//   Bound [exp]: float 1.5, double 1.5 ulp
//   Cost [exp]: v4 0.16, v3 0.28, v2 0.87 ns
template <Real T>
BRUME_INLINE T exp(T x) {
  const auto e = exp_pieces(x, exp_top<T>);
  return (e.s1 + e.s1 * e.p) * e.s2;
}

// expm1(x) = e^x - 1, to full relative accuracy near 0.
//   = (2^n - 1) + 2^n p: n = 0 leaves p alone, and for other n the terms do not cancel.
//   Domain: all; expm1(-inf) = -1, expm1(inf) = inf. The sign of -0 is lost.
//   Bound [expm1]: float 2.5, double 3 ulp
//   Cost [expm1]: v4 0.19, v3 0.35, v2 1.1 ns
template <Real T>
BRUME_INLINE T expm1(T x) {
  const auto e = exp_pieces(x, exp_top<T>);
  const T s = e.s1 * e.s2;
  // Beyond x = 40 the 1 is below half an ulp, and 2^n may overflow where e^x does not.
  return select(x > T(40), (e.s1 + e.s1 * e.p) * e.s2, (s - T(1)) + s * e.p);
}

/// What a stretch of optical depth lets through and what it adds of its own source.
template <Real V>
struct Transmit {
  V T;  ///< transmittance e^-tau
  V A;  ///< opacity 1 - e^-tau
};

// transmit(tau) = {e^-tau, 1 - e^-tau} from one range reduction, neither cancelling.
//   Domain: all; tau = 0 gives {1, 0}, inf gives {0, 1}; tau < 0 is gain (T > 1, A < 0),
//   and stays at e^88 (double: e^709) from there down.
//   Bound [transmit T]: float 1.5, double 1.5 ulp
//   Cost [transmit T]: v4 0.18, v3 0.28, v2 0.9 ns
//   Bound [transmit A]: float 2.5, double 3 ulp
//   Cost [transmit A]: v4 0.18, v3 0.3, v2 0.94 ns
template <Real T>
BRUME_INLINE Transmit<T> transmit(T tau) {
  const auto e = exp_pieces(-tau);
  const T s = e.s1 * e.s2, sp = s * e.p;
  return {s + sp, (T(1) - s) - sp};
}

// exprel as a product {quotient, factor}; the factor is not 1 only where the 1 of 1 -
// e^-x is lost and 2^n may overflow before the quotient does.
template <Real T>
struct ExprelPieces {
  T quotient, factor, x;  // x no lower than where everything overflows anyway
  Mask_t<T> huge;
};
template <Real T>
BRUME_INLINE ExprelPieces<T> exprel_pieces(T x) {
  const T xc = max(x, T(-exp_top<T>));
  const auto e = exp_pieces(-xc, exp_top<T>);
  const T s = e.s1 * e.s2;
  const Mask_t<T> huge = xc < T(-40);
  const T num = select(huge, -(e.s1 + e.s1 * e.p), (T(1) - s) - s * e.p);
  return {num / xc, select(huge, e.s2, T(1)), xc, huge};
}

// exprel(x) = (1 - e^-x)/x, the mean transmittance of a stretch of optical depth x; also
// phi_1 of exponential integrators.
//   Domain: all; exprel(0) = 1, exprel(inf) = 0, exprel(-inf) = inf.
//   Bound [exprel]: float 2.5, double 2.5 ulp
//   Cost [exprel]: v4 0.26, v3 0.5, v2 1.5 ns
template <Real T>
BRUME_INLINE T exprel(T x) {
  const auto e = exprel_pieces(x);
  return select(x == T(0), T(1), e.quotient * e.factor);
}

// exprel2(x) = (1 - exprel(x))/x = (e^-x - 1 + x)/x^2, the next of the family (phi_2).
//   |x| <= 2: its series sum (-x)^k/(k+2)!, else the quotient, which no longer cancels.
//   Domain: all; exprel2(0) = 1/2, exprel2(inf) = 0, exprel2(-inf) = inf.
//   Bound [exprel2]: float 4, double 4 ulp
//   Cost [exprel2]: v4 0.37, v3 0.78, v2 2.5 ns
template <Real T>
BRUME_INLINE T exprel2(T x) {
  constexpr auto phi2 =
      series<24>([](int k) { return (k % 2 ? -1 : 1) / factorial(k + 2); });
  constexpr auto near0 = economised<(is_double<T> ? 18 : 11)>(phi2, -2, 2);
  const auto e = exprel_pieces(x);
  const T away = (select(e.huge, T(0), T(1)) - e.quotient) / e.x * e.factor;
  return select(abs(x) <= T(2), evaluate(near0, x), away);
}

/// Weights of a source a + b u + c u^2 along a stretch of optical depth d, u = tau/d:
/// the light that leaves it is E0 a + E1 b + E2 c.
template <Real V>
struct SourceWeights {
  V T;  ///< e^-d
  V E0, E1, E2;
};

// source_weights(d): E_k = integral over u in [0, 1] of u^k d e^(-d u).
//   E0 = 1 - e^-d, E_k = k E_(k-1)/d - e^-d (METHODS O; Olson & Kunasz 1987). That way up
//   cancels for small d. There E2 = d e^-d sum 2 d^k/(k+3)! (incomplete gamma, Abramowitz
//   & Stegun 6.5.29; all terms positive) and down, E_(k-1) = d (E_k + e^-d)/k.
//   Domain: d >= 0; d = 0 gives {1, 0, 0, 0}, d = inf {0, 1, 0, 0}; d < 0 counts as 0.
//   Bound [source_weights E1]: float 4, double 4 ulp
//   Cost [source_weights E1]: v4 0.31, v3 0.65, v2 2.2 ns
//   Bound [source_weights E2]: float 5, double 5 ulp
//   Cost [source_weights E2]: v4 0.36, v3 0.73, v2 2.4 ns
template <Real T>
BRUME_INLINE SourceWeights<T> source_weights(T depth) {
  constexpr auto gamma3 = series<30>([](int k) { return 2 / factorial(k + 3); });
  constexpr auto near0 = economised<(is_double<T> ? 18 : 10)>(gamma3, 0, 4);
  const T d = max(depth, T(0));
  const auto [t, e0] = transmit(d);
  const auto thin = d < T(4);
  const T inv = T(1) / max(d, T(1));
  const T e2_thin = d * t * evaluate(near0, min(d, T(4)));
  const T e1 = select(thin, T(0.5f) * d * (e2_thin + t), e0 * inv - t);
  return {t, e0, e1, select(thin, e2_thin, T(2) * e1 * inv - t)};
}

}  // namespace brume::inline BRUME_ISA_NS
