#pragma once
// Roots and lengths without cancellation or overflow. Conventions in math.h.

#include <limits>

#include "num/batch.h"

namespace brume::inline BRUME_ISA_NS {

// saturate(x): x in [0, 1]; NaN stays.
template <Real T>
BRUME_INLINE T saturate(T x) {
  return clamp(x, T(0), T(1));
}

// smoothstep(x) = 3 x^2 - 2 x^3 between 0 and 1, flat outside.
//   Bound [smoothstep]: float 2.5, double 2.5 ulp
//   Cost [smoothstep]: v4 0.034, v3 0.07, v2 0.2 ns
template <Real T>
BRUME_INLINE T smoothstep(T x) {
  const T t = saturate(x);
  return t * t * (T(3) - T(2) * t);
}

// hypot(x, y) = sqrt(x^2 + y^2) = hi sqrt(1 + (lo/hi)^2): no overflow, no underflow.
//   Domain: all; hypot(0, 0) = 0, inf if either is.
//   Bound [hypot]: float 2.5, double 2.5 ulp
//   Cost [hypot]: v4 0.13, v3 0.25, v2 0.51 ns
template <Real T>
BRUME_INLINE T hypot(T x, T y) {
  using S = Scalar_t<T>;
  constexpr S inf = std::numeric_limits<S>::infinity();
  const T ax = abs(x), ay = abs(y), hi = max(ax, ay), lo = min(ax, ay);
  const T ratio = lo / hi;
  const T length = hi * sqrt(T(1) + ratio * ratio);
  const T plain = ax + ay;  // where both are 0, one is infinite, or one is NaN
  return select((hi > T(0)) & (hi < T(inf)) & (plain == plain), length, plain);
}

// a b - c d, correct though the two almost cancel.
//   What rounding took from each product is added back: with fused multiply-add (Kahan;
//   Jeannerod, Louvet & Muller 2013), else from the halves of the factors (Dekker 1971).
//   Domain: 0 or from 1e-15 to 1e15 in size (double: 1e-140 to 1e150), so that the last
//   digits of the products are normal numbers; beyond, digits are lost.
//   Bound [difference_of_products]: float 1.5, double 1.5 ulp
//   Cost [difference_of_products]: v4 0.091, v3 0.1, v2 0.77 ns
template <Real T>
BRUME_INLINE T difference_of_products(T a, T b, T c, T d) {
  if constexpr (kFused) {
    const T cd = c * d;
    return fused(a, b, -cd) + fused(-c, d, cd);
  } else {
    const auto upper = [](T x) {  // rounded, so that the rest is half as long (Veltkamp)
      const T t = x * T(is_double<T> ? 0x1p27 + 1 : 0x1p12 + 1);
      return t - (t - x);
    };
    const auto lost = [&](T x, T y, T xy) {
      const T xh = upper(x), xl = x - xh, yh = upper(y), yl = y - yh;
      return ((xh * yh - xy) + xh * yl + xl * yh) + xl * yl;
    };
    const T ab = a * b, cd = c * d;
    return (ab - cd) + (lost(a, b, ab) - lost(c, d, cd));
  }
}

/// The real roots of a quadratic, lo <= hi. Where there are none, both are its vertex.
template <Real T>
struct Roots {
  Mask_t<T> real;
  T lo, hi;
};

// quadratic(a, b, c): roots of a x^2 + 2 b x + c = 0 (note the 2).
//   The discriminant b^2 - a c by difference_of_products, so that grazing rays keep their
//   digits; q = -(b + sign(b) sqrt), roots q/a and c/q, so that neither cancels.
//   Domain: that of difference_of_products. a = 0: lo is the one root, hi = inf;
//   a = b = 0: no root. A double root at 0 is {true, 0, 0}.
//   Bound [quadratic lo]: float 3, double 3 ulp
//   Cost [quadratic lo]: v4 0.25, v3 0.47, v2 1.5 ns
//   Bound [quadratic hi]: float 3, double 3 ulp
//   Cost [quadratic hi]: v4 0.25, v3 0.47, v2 1.5 ns
template <Real T>
BRUME_INLINE Roots<T> quadratic(T a, T b, T c) {
  using S = Scalar_t<T>;
  constexpr S inf = std::numeric_limits<S>::infinity();
  const T disc = difference_of_products(b, b, a, c);
  const T root = sqrt(max(disc, T(0)));
  const T q = -select(b < T(0), b - root, b + root);
  const auto linear = a == T(0);
  const T x0 = select(linear, T(inf), q / a);
  const T x1 = select(q == T(0), select(linear, c, T(0)), c / q);
  const Mask_t<T> real = (disc >= T(0)) & !(linear & (b == T(0)));
  const T vertex = select(disc == disc, -b / a, disc);
  return {real, select(real, min(x0, x1), vertex), select(real, max(x0, x1), vertex)};
}

}  // namespace brume::inline BRUME_ISA_NS
