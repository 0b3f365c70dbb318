#pragma once
// Angles. Conventions in math.h.

#include <limits>

#include "num/math_exp.h"

namespace brume::inline BRUME_ISA_NS {

template <Real T>
struct SinCos {
  T sin, cos;
};

// sincos(x): sine and cosine of x radians together.
//   n = round(x 2/pi), r = x - n pi/2 with pi/2 in pieces (n times all but the last is
//   exact; Cody & Waite 1980), series of sine and cosine on |r| <= pi/4, swapped and
//   signed by n mod 4.
//   Domain: |x| <= 8192; beyond, the answer is that of the nearest end (an angle so large
//   has lost its digits, but a kernel must stay finite).
//   Bound [sin]: float 2.5, double 2 ulp
//   Cost [sin]: v4 0.19, v3 0.39, v2 1.1 ns
//   Bound [cos]: float 2.5, double 2 ulp
//   Cost [cos]: v4 0.19, v3 0.4, v2 1.1 ns
template <Real T>
BRUME_INLINE SinCos<T> sincos(T angle) {
  using S = Scalar_t<T>;
  using B = Bits_t<T>;
  constexpr S p1 = is_double<T> ? S(0x1.921fb544p0) : S(0x1.92p0);
  constexpr S p2 = is_double<T> ? S(0x1.0b4611a6p-34) : S(0x1.fb4p-12);
  constexpr S p3 = is_double<T> ? S(0x1.3198a2e037073p-69) : S(0x1.444p-24);
  constexpr S p4 = is_double<T> ? S(0) : S(0x1.68c234c4c66p-39);
  constexpr int top = is_double<T> ? 63 : 31;
  constexpr auto sin_tail =
      series<12>([](int k) { return (k % 2 ? 1 : -1) / factorial(2 * k + 3); });
  constexpr auto cos_tail =
      series<12>([](int k) { return (k % 2 ? -1 : 1) / factorial(2 * k + 4); });
  constexpr auto ps = economised<(is_double<T> ? 6 : 3)>(sin_tail, 0, 0.617L);
  constexpr auto pc = economised<(is_double<T> ? 6 : 3)>(cos_tail, 0, 0.617L);

  const T x = clamp(angle, T(-8192), T(8192));
  const T t = x * T(S(2 / kPi)) + T(rounder<T>);
  const T n = t - T(rounder<T>);
  const T r = (((x - n * T(p1)) - n * T(p2)) - n * T(p3)) - n * T(p4);
  const T z = r * r;
  const T s = r + r * z * evaluate(ps, z);
  const T c = T(1) - (T(S(0.5)) * z - z * z * evaluate(pc, z));

  // Bit 0 of n swaps, bit 1 negates the sine, bit 1 of n + 1 the cosine.
  const B q = bits(t);
  const auto odd = value((q << top) | B(bits(S(1)))) < T(0);
  const B sign = B(Bits_t<S>(1) << top);
  const T sn = select(odd, c, s), cs = select(odd, s, c);
  return {value(bits(sn) ^ ((q << (top - 1)) & sign)),
          value(bits(cs) ^ (((q + B(1)) << (top - 1)) & sign))};
}
template <Real T>
BRUME_INLINE T sin(T x) {
  return sincos(x).sin;
}
template <Real T>
BRUME_INLINE T cos(T x) {
  return sincos(x).cos;
}

// atan2pos(y, x): the angle of (x, y) for y >= 0, in [0, pi].
//   The ratio is brought to |u| <= tan(pi/8) by atan(v) = pi/2 - atan(1/v) and
//   atan(v) = pi/4 + atan((v - 1)/(v + 1)) with a single division, then u + u^3 P(u^2),
//   the arctangent's series.
//   Domain: y >= 0, all x; (0, 0) gives 0, (inf, inf) as in C.
//   Bound [atan2pos]: float 3, double 2.5 ulp
//   Cost [atan2pos]: v4 0.31, v3 0.58, v2 1.5 ns
template <Real T>
BRUME_INLINE T atan2pos(T y, T x) {
  using S = Scalar_t<T>;
  constexpr S inf = std::numeric_limits<S>::infinity();
  constexpr S largest = std::numeric_limits<S>::max();
  constexpr S smallest = std::numeric_limits<S>::denorm_min();
  constexpr auto atan_tail =
      series<40>([](int k) { return (k % 2 ? 1.0L : -1.0L) / (2 * k + 3); });
  constexpr auto p = economised<(is_double<T> ? 11 : 5)>(atan_tail, 0, 0.1716L);

  const T ax = abs(x);
  const auto steep = y > ax;
  const T near = select(steep, ax, y), far = select(steep, y, ax);
  // inf/inf is taken as 1, 0/0 as 0; and a sum of two large numbers must not overflow.
  const Mask_t<T> endless = (near == T(inf)) & (far == T(inf));
  const T scale = select(far > T(largest / 4), T(S(0.25)), T(1));
  const T num = select(endless, T(1), near * scale);
  const T den = select(endless, T(1), max(far * scale, T(smallest)));
  const auto mid = num > T(S(0.41421356237309504880L)) * den;
  const T u = select(mid, num - den, num) / select(mid, num + den, den);
  const T z = u * u;
  T a = u + u * (z * evaluate(p, z));
  a = select(mid, T(S(kPi / 4)) + a, a);
  a = select(steep, T(S(kPi / 2)) - a, a);
  return select(x < T(0), T(S(kPi)) - a, a);
}

// atan2(y, x): the angle of (x, y) in [-pi, pi].
//   Domain: all; atan2(0, x) = 0 for x >= 0, pi for x < 0 whatever the sign of the zero;
//   infinities as in C.
//   Bound [atan2]: float 3, double 2.5 ulp
//   Cost [atan2]: v4 0.34, v3 0.66, v2 1.6 ns
template <Real T>
BRUME_INLINE T atan2(T y, T x) {
  const T a = atan2pos(abs(y), x);
  return select(y < T(0), -a, a);
}

// atan_difference(a, b) = atan(b) - atan(a), without the cancellation of the two.
//   = atan2(b - a, 1 + a b), both divided by max(1, |a|) so that nothing overflows
//   (METHODS A12: the plain difference loses everything, this form nothing).
//   Domain: all; from 2^126 (double: 2^1022) on a number counts as that.
//   Bound [atan_difference]: float 4.5, double 4.5 ulp
//   Cost [atan_difference]: v4 0.51, v3 1, v2 2.6 ns
template <Real T>
BRUME_INLINE T atan_difference(T a, T b) {
  using S = Scalar_t<T>;
  constexpr S large = is_double<T> ? S(0x1p1022) : S(0x1p126);
  const T p = clamp(a, T(-large), T(large)), q = clamp(b, T(-large), T(large));
  const T scale = T(1) / max(abs(p), T(1));
  return atan2((q - p) * scale, scale + (p * scale) * q);
}

// asin(v) by its series, z = v^2 <= 1/4.
template <Real T>
BRUME_INLINE T asin_core(T v, T z) {
  // c_k = (2k)! / (4^k k!^2 (2k + 1)), from k = 1.
  constexpr auto asin_tail = series<30>([](int k) {
    long double c = 1;
    for (int i = 1; i <= k + 1; ++i) c *= (2 * i - 1) / (2.0L * i);
    return c / (2 * k + 3);
  });
  constexpr auto p = economised<(is_double<T> ? 12 : 5)>(asin_tail, 0, 0.25L);
  return v + v * (z * evaluate(p, z));
}

// asin(x), acos(x).
//   |x| <= 1/2: the arcsine's series; beyond, asin x = pi/2 - 2 asin(sqrt((1 - x)/2)).
//   Domain: [-1, 1]; beyond it the nearest end (products of unit vectors overshoot).
//   Bound [asin]: float 3, double 3 ulp
//   Cost [asin]: v4 0.11, v3 0.29, v2 0.79 ns
//   Bound [acos]: float 2, double 2 ulp
//   Cost [acos]: v4 0.15, v3 0.34, v2 0.87 ns
template <Real T>
BRUME_INLINE T asin(T x) {
  using S = Scalar_t<T>;
  const T ax = min(abs(x), T(1));
  const auto far = ax > T(S(0.5));
  const T z = select(far, T(S(0.5)) * (T(1) - ax), ax * ax);
  const T a = asin_core(select(far, sqrt(z), ax), z);
  const T y = select(far, T(S(kPi / 2)) - T(2) * a, a);
  return select(x < T(0), -y, y);
}
template <Real T>
BRUME_INLINE T acos(T x) {
  using S = Scalar_t<T>;
  const T ax = min(abs(x), T(1));
  const auto far = ax > T(S(0.5));
  const T z = select(far, T(S(0.5)) * (T(1) - ax), ax * ax);
  const T a = asin_core(select(far, sqrt(z), ax), z);
  const T near = T(S(kPi / 2)) - select(x < T(0), -a, a);
  return select(far, select(x < T(0), T(S(kPi)) - T(2) * a, T(2) * a), near);
}

}  // namespace brume::inline BRUME_ISA_NS
