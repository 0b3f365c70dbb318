#pragma once
// Logarithms and powers. Conventions in math.h.

#include <limits>

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
  constexpr auto r = economised<(is_double<T> ? 7 : 3)>(atanh_tail, 0, 0.0295L);
  const T s = f / (T(2) + f), z = s * s;
  return s * (half_ff + z * evaluate(r, z));
}

// log(x), natural.
//   n ln 2 + log m (log_pieces, log_tail), added from the small to the large.
//   Domain: x >= 0; log(0) = -inf, log(inf) = inf, log(x < 0) = NaN.
//   Bound [log]: float 1, double 1 ulp
//   Cost [log]: v4 0.26, v3 0.43, v2 1 ns
template <Real T>
BRUME_INLINE T log(T x) {
  using S = Scalar_t<T>;
  constexpr S inf = std::numeric_limits<S>::infinity();
  const auto [n, m] = log_pieces(x);
  const T f = m - T(1), half_ff = T(S(0.5)) * f * f;
  const T y =
      n * T(ln2_hi<T>) + (f - (half_ff - (log_tail(f, half_ff) + n * T(ln2_lo<T>))));
  // 0, inf, negative and NaN, all of which the bit tricks mistake for numbers.
  const T special =
      select(x == T(0), T(-inf),
             select(x == T(inf), x, x * T(std::numeric_limits<S>::quiet_NaN())));
  return select((x > T(0)) & (x < T(inf)), y, special);
}

// log1p(x) = log(1 + x), to full relative accuracy near 0.
//   u = 1 + x rounds; what it lost, over u, is added to log u (first order; Kahan).
//   Domain: x >= -1; log1p(-1) = -inf, log1p(inf) = inf, log1p(x < -1) = NaN.
//   Bound [log1p]: float 1, double 1 ulp
//   Cost [log1p]: v4 0.3, v3 0.5, v2 1.2 ns
template <Real T>
BRUME_INLINE T log1p(T x) {
  using S = Scalar_t<T>;
  constexpr S inf = std::numeric_limits<S>::infinity();
  const T u = T(1) + x;
  const T lost = select(x > T(1), T(1) - (u - x), x - (u - T(1))) / u;
  const auto [n, m] = log_pieces(u);
  const T f = m - T(1), half_ff = T(S(0.5)) * f * f;
  const T y = n * T(ln2_hi<T>) +
              (f - (half_ff - (log_tail(f, half_ff) + (n * T(ln2_lo<T>) + lost))));
  const T special =
      select(x == T(-1), T(-inf),
             select(x == T(inf), x, x * T(std::numeric_limits<S>::quiet_NaN())));
  return select((x > T(-1)) & (x < T(inf)), y, special);
}

// The logarithm in two pieces, about half as many digits again: hi of few digits + lo.
//   s = f/(2 + f) = f/(1 + m) with the remainder of its division, and 2 s apart from the
//   series' tail, which is 1/100 of it.
template <Real T>
BRUME_INLINE void log_two_pieces(T x, T& hi, T& lo) {
  constexpr auto atanh_tail = series<24>([](int k) { return 2.0L / (2 * k + 3); });
  constexpr auto r = economised<(is_double<T> ? 9 : 4)>(atanh_tail, 0, 0.0295L);
  const auto [n, m] = log_pieces(x);
  const T f = m - T(1), den = m + T(1), s = f / den, z = s * s;
  const T sh = head(s), mh = head(m);
  const T rest = (((f - sh) - sh * mh) - sh * (m - mh)) / den;  // s - sh, all digits
  const T a = n * T(ln2_hi<T>), b = T(2) * sh, sum = a + b;
  const T tail =
      (b - (sum - a)) + (T(2) * rest + s * z * evaluate(r, z)) + n * T(ln2_lo<T>);
  hi = head(sum + tail);
  lo = (sum - hi) + tail;
}

// pow(x, y) = x^y = e^(y log x), the logarithm and its product with y in two pieces each.
//   Domain: x >= 0, any y; x < 0 gives NaN; pow(0, y) = 0, inf for y > 0, y < 0;
//   pow(1, y) = pow(x, 0) = 1 even for NaN, as in C.
//   The bound is met near the ends of the range; where |y log x| < 10 it is 2 ulp.
//   Bound [pow]: float 5, double 40 ulp
//   Cost [pow]: v4 0.89, v3 1.8, v2 4.4 ns
template <Real T>
BRUME_INLINE T pow(T x, T y) {
  using S = Scalar_t<T>;
  constexpr S inf = std::numeric_limits<S>::infinity();
  T lh, ll;
  log_two_pieces(x, lh, ll);
  lh = select(x == T(0), T(-inf), select(x == T(inf), x, lh));
  // y log x = hi + lo; where it is far out of range only its sign matters.
  const T yh = head(y), product = y * lh;
  const auto out = abs(product) > T(is_double<T> ? 1000 : 200);
  const T hi = select(out, product, yh * lh);
  const T lo = select(out, T(0), y * ll + (y - yh) * lh);
  const auto e = exp_pieces(hi, lo, exp_top<T>);
  const T p = (e.s1 + e.s1 * e.p) * e.s2;
  return select((x == T(1)) | (y == T(0)), T(1),
                select(x >= T(0), p, x * T(std::numeric_limits<S>::quiet_NaN())));
}

// log_mean(a, b) = (b - a)/log(b/a), the mean of an exponential that runs from a to b;
// lies between the geometric and the arithmetic mean.
//   = max exprel(log(max/min)).
//   Domain: a, b >= 0; log_mean(a, a) = a, log_mean(0, b) = 0, log_mean(a, inf) = inf;
//   negative gives NaN.
//   Bound [log_mean]: float 4, double 4 ulp
//   Cost [log_mean]: v4 1.2, v3 2.5, v2 6.1 ns
template <Real T>
BRUME_INLINE T log_mean(T a, T b) {
  using S = Scalar_t<T>;
  constexpr S inf = std::numeric_limits<S>::infinity();
  const T hi = max(a, b), lo = min(a, b);
  // The quotient keeps what matters, but could overflow; then the logarithms do not
  // cancel.
  const auto near = hi < T(is_double<T> ? S(0x1p512) : S(0x1p64)) * lo;
  const T x = log(select(near, hi / lo, hi)) - select(near, T(0), log(lo));
  const T mean = select(hi == T(inf), hi, select(hi == T(0), hi, hi * exprel(x)));
  return select((a == a) & (b == b) & (lo >= T(0)), mean,
                (a + b) * T(std::numeric_limits<S>::quiet_NaN()));
}

}  // namespace brume::inline BRUME_ISA_NS
