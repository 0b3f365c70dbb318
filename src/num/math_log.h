#pragma once
// Logarithms and powers. Conventions in math.h.

#include "num/math_exp.h"

namespace brume::inline BRUME_ISA_NS {

// x = 2^n m with m in [sqrt(1/2), sqrt(2)), for x > 0 and finite; n as a T.
template <Real T>
struct LogPieces {
  T n, m;
};

template <Real T>
BRUME_INLINE LogPieces<T> log_pieces(T x) {
  using S = Scalar_t<T>;
  using B = Bits_t<T>;
  constexpr int mantissa = is_double<T> ? 52 : 23, bias = is_double<T> ? 1023 : 127;
  constexpr S integer = is_double<T> ? S(0x1p52) : S(0x1p23);  // its low bits count ones
  constexpr S sqrt_half = S(0.70710678118654752440L);
  // A denormal is first made a normal number.
  const auto tiny = x < T(is_double<T> ? S(0x1p-1022) : S(0x1p-126));
  const T y = select(tiny, x * T(integer), x);
  // The exponent field counts from sqrt(1/2) when the bits are shifted by the difference.
  const B u = bits(y) + B(bits(S(1)) - bits(sqrt_half));
  const T exponent = value((u >> mantissa) | B(bits(integer))) - T(integer);
  const T n = exponent - select(tiny, T(S(bias + mantissa)), T(S(bias)));
  const B mask = B((Bits_t<S>(1) << mantissa) - 1);
  return {n, value((u & mask) + B(bits(sqrt_half)))};
}

// log(m) - f + f^2/2 = s (f^2/2 + R(s^2)), f = m - 1, s = f/(2 + f): the series of
// 2 atanh(s) with its two leading terms apart, so that they round last.
template <Real T>
BRUME_INLINE T log_tail(T f, T half_ff) {
  constexpr auto atanh_tail = series<24>([](int k) { return 2.0L / (2 * k + 3); });
  constexpr auto r = economised < is_double<T> ? 7 : 3 > (atanh_tail, 0, 0.0295L);
  const T s = f / (T(2) + f), z = s * s;
  return s * (half_ff + z * evaluate(r, z));
}

// The two parts of ln 2: the first times any exponent is exact.
template <Real T>
inline constexpr Scalar_t<T> ln2_hi = is_double<T> ? 0x1.62e42feep-1 : 0x1.62e4p-1;
template <Real T>
inline constexpr Scalar_t<T> ln2_lo =
    is_double<T> ? 0x1.a39ef35793c76p-33 : 0x1.7f7d1cf8p-20;

// log(x), natural.
//   n ln 2 + log m (log_pieces, log_tail), added from the small to the large.
//   Domain: x >= 0; log(0) = -inf, log(inf) = inf, log(x < 0) = NaN.
//   Bound [log]: float 1, double 1 ulp
template <Real T>
BRUME_INLINE T log(T x) {
  using S = Scalar_t<T>;
  constexpr S inf = __builtin_inf();
  const auto [n, m] = log_pieces(x);
  const T f = m - T(1), half_ff = T(S(0.5)) * f * f;
  const T y =
      n * T(ln2_hi<T>) + (f - (half_ff - (log_tail(f, half_ff) + n * T(ln2_lo<T>))));
  // 0, inf, negative and NaN, all of which the bit tricks mistake for numbers.
  const T special =
      select(x == T(0), T(-inf), select(x == T(inf), x, x * T(S(__builtin_nan("")))));
  return select((x > T(0)) & (x < T(inf)), y, special);
}

// log1p(x) = log(1 + x), to full relative accuracy near 0.
//   u = 1 + x rounds; what it lost, over u, is added to log u (first order; Kahan).
//   Domain: x >= -1; log1p(-1) = -inf, log1p(inf) = inf, log1p(x < -1) = NaN.
//   Bound [log1p]: float 1.5, double 1.5 ulp
template <Real T>
BRUME_INLINE T log1p(T x) {
  using S = Scalar_t<T>;
  constexpr S inf = __builtin_inf();
  const T u = T(1) + x;
  const T lost = select(x > T(1), T(1) - (u - x), x - (u - T(1))) / u;
  const auto [n, m] = log_pieces(u);
  const T f = m - T(1), half_ff = T(S(0.5)) * f * f;
  const T y = n * T(ln2_hi<T>) +
              (f - (half_ff - (log_tail(f, half_ff) + (n * T(ln2_lo<T>) + lost))));
  const T special =
      select(x == T(-1), T(-inf), select(x == T(inf), x, x * T(S(__builtin_nan("")))));
  return select((x > T(-1)) & (x < T(inf)), y, special);
}

}  // namespace brume::inline BRUME_ISA_NS
