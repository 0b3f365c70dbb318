#pragma once
// The error function: how much of a Gaussian lies on a ray. Conventions in math.h.

#include "num/math_exp.h"
#include "num/quadrature.h"

namespace brume::inline BRUME_ISA_NS {

// erfcx(x) = e^(x^2) erfc(x) for x >= 1/2, at compile time: the trapezoidal rule on
// (2x/pi) int e^(-t^2)/(x^2 + t^2) dt over t >= 0 (Abramowitz & Stegun 7.1.4), which errs
// by e^(-2 pi x/h) only (Matta & Reichel 1971): h = 1/16 leaves 1e-21.
constexpr long double erfcx_by_quadrature(long double x) {
  constexpr long double h = 1 / 16.0L, q = 0.9961013694701174900628646L;  // e^(-h^2)
  long double sum = 1 / (2 * x * x), weight = 1, ratio = q;  // q^(k^2), q^(2k-1)
  for (int k = 1; k <= 112; ++k) {
    weight *= ratio;
    ratio *= q * q;
    sum += weight / (x * x + k * k * h * h);
  }
  return 2 * x / kPi * h * sum;
}

// erfcx(x) for x >= 1/2: (1 + 2 x) erfcx(x) is nearly constant, and a polynomial in
// y = (x - 7/2)/(x + 5/2), in [-1, 1) (as Shepherd & Laframboise 1981).
constexpr long double scaled_erfcx(long double y) {
  const long double x = (3.5L + 2.5L * y) / (1 - y);
  return (1 + 2 * x) * erfcx_by_quadrature(x);
}
template <Real T>
BRUME_INLINE T erfcx_far(T x) {
  using S = Scalar_t<T>;
  constexpr auto p = interpolated<(is_double<T> ? 24 : 11)>(scaled_erfcx);
  const T y = T(1) - T(6) / (x + T(S(2.5)));
  return T(S(0.5)) * evaluate(p, y) / (T(S(0.5)) + x);
}

// erf(x) for |x| <= 1/2, by its series.
template <Real T>
BRUME_INLINE T erf_near(T x) {
  constexpr auto erf_over_x = series<20>([](int k) {
    return (k % 2 ? -1 : 1) * 1.12837916709551257390L / (factorial(k) * (2 * k + 1));
  });
  constexpr auto p = economised<(is_double<T> ? 9 : 5)>(erf_over_x, 0, 0.25L);
  return x * evaluate(p, x * x);
}

// e^(+-x^2), its exponent in two pieces: one number would lose eps x^2 of the result.
template <Real T>
BRUME_INLINE ExpPieces<T> exp_square(T sign, T x) {
  const T h = head(x);
  return exp_pieces(sign * h * h, sign * (x - h) * (x + h), exp_top<T>);
}

/// erf and erfc of one argument.
template <Real T>
struct ErrorFunction {
  T erf, erfc;
};

// error_function(x) = {erf(x), erfc(x)}, erfc(x) = 1 - erf(x) without the cancellation.
//   |x| < 1/2: the series of erf; else erfc = e^(-x^2) erfcx(x), and 2 - erfc(-x) below.
//   Domain: all; erf(inf) = 1, erfc(inf) = 0, erfc(-inf) = 2.
//   Bound [erf]: float 3, double 3 ulp
//   Cost [erf]: v4 0.49, v3 1, v2 3.3 ns
//   Bound [erfc]: float 5, double 5 ulp
//   Cost [erfc]: v4 0.48, v3 1, v2 3.3 ns
template <Real T>
BRUME_INLINE ErrorFunction<T> error_function(T x) {
  using S = Scalar_t<T>;
  const T ax = min(abs(x), T(is_double<T> ? 30 : 12));  // erfc is 0 from there on
  const auto near = ax < T(S(0.5));
  const auto e = exp_square(T(-1), ax);
  const T far = ((e.s1 + e.s1 * e.p) * erfcx_far(max(ax, T(S(0.5))))) * e.s2;
  const T series = erf_near(x);
  const auto negative = x < T(0);
  return {select(near, series, select(negative, far - T(1), T(1) - far)),
          select(near, T(1) - series, select(negative, T(2) - far, far))};
}
template <Real T>
BRUME_INLINE T erf(T x) {
  return error_function(x).erf;
}
template <Real T>
BRUME_INLINE T erfc(T x) {
  return error_function(x).erfc;
}

// erfcx(x) = e^(x^2) erfc(x), which does not underflow: about 1/(x sqrt(pi)) for large x.
//   Domain: all; erfcx(inf) = 0; 2 e^(x^2) and then inf for x far below 0.
//   Bound [erfcx]: float 3.5, double 3.5 ulp
//   Cost [erfcx]: v4 0.48, v3 1, v2 3.4 ns
template <Real T>
BRUME_INLINE T erfcx(T x) {
  using S = Scalar_t<T>;
  const auto near = abs(x) < T(S(0.5));
  const T far = erfcx_far(max(abs(x), T(S(0.5))));
  // 2 e^(x^2) - erfcx(-x) below, e^(x^2) (1 - erf(x)) near 0.
  const auto e = exp_square(T(1), clamp(x, T(is_double<T> ? -27 : -10), T(S(0.5))));
  const T grow = (e.s1 + e.s1 * e.p) * select(near, T(1) - erf_near(x), T(2)) * e.s2;
  return select(near, grow, select(x < T(0), grow - far, far));
}

// erf_difference(a, b) = erf(b) - erf(a), what a Gaussian holds between a and b.
//   Signs differ: both parts add up. Equal signs: a difference of erfc, unless a and b
//   are so close that it cancels, (b - a)(a + b) < 1: there 2/sqrt(pi) e^(-a^2) times the
//   integral of e^(-s (2a + s)) by Gauss-Legendre, whose integrand runs from 1 to e^-1.
//   Domain: all; infinite ends are fine. `apart` is |b - a| where that is known to more
//   digits than a and b tell.
//   Bound [erf_difference]: float 5, double 5 ulp
//   Cost [erf_difference]: v4 2.5, v3 5.3, v2 15 ns
template <Real T>
BRUME_INLINE T erf_difference(T a, T b, T apart) {
  using S = Scalar_t<T>;
  constexpr auto rule = gauss_legendre<(is_double<T> ? 10 : 5)>();
  constexpr S two_over_sqrt_pi = S(1.12837916709551257390L);
  const T limit = T(is_double<T> ? 30 : 12);  // erf is 1 from there on
  const T p = clamp(a, -limit, limit), q = clamp(b, -limit, limit);
  const T lo = min(abs(p), abs(q)), hi = max(abs(p), abs(q)),
          width = min(apart, T(2) * limit);
  const auto straddles = (p < T(0)) != (q < T(0));
  const auto close = width * (lo + hi) < T(1);

  const auto at_lo = error_function(lo), at_hi = error_function(hi);
  const T plain = select(straddles, at_lo.erf + at_hi.erf, at_lo.erfc - at_hi.erfc);
  T mean = T(0);
  for (int k = 0; k < rule.size; ++k) {
    const T s = width * T(S((1 + rule.x[k]) / 2));
    const auto e = exp_pieces(-(s * (T(2) * lo + s)));
    mean += T(S(rule.w[k] / 2)) * (e.s1 * e.s2) * (T(1) + e.p);
  }
  const auto e = exp_square(T(-1), lo);
  const T together = (e.s1 + e.s1 * e.p) * (T(two_over_sqrt_pi) * width * mean) * e.s2;
  const T size = select(close & !straddles, together, plain);
  return select((a == a) & (b == b), select(q < p, -size, size), a + b);
}
template <Real T>
BRUME_INLINE T erf_difference(T a, T b) {
  const T limit = T(is_double<T> ? 30 : 12);
  return erf_difference(a, b, abs(clamp(b, -limit, limit) - clamp(a, -limit, limit)));
}

}  // namespace brume::inline BRUME_ISA_NS
