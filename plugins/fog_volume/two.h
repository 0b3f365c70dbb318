#pragma once
// A number as an unevaluated sum of two, hi + lo, |lo| <= ulp(hi)/2: twice the digits of
// a T. For places and directions that cancel; Dekker 1971, "A floating-point technique
// for extending the available precision"; Knuth, TAOCP 2, 4.2.2.
//
// Errors below are absolute, of the sizes that go in: u^2 with u = 6e-8 (float).
// Domain: sizes up to 1e34 (beyond, on v2, factors' halves overflow).

#include "num/batch.h"

namespace fog_volume::inline BRUME_ISA_NS {

using namespace brume::BRUME_ISA_NS;

template <Real T>
struct Two {
  T hi, lo;
};

/// a + b, exactly.
template <Real T>
BRUME_INLINE Two<T> two_sum(T a, T b) {
  const T s = a + b, v = s - a;
  return {s, (a - (s - v)) + (b - v)};
}

/// The same for |a| >= |b| or a = 0.
template <Real T>
BRUME_INLINE Two<T> quick_two_sum(T a, T b) {
  const T s = a + b;
  return {s, b - (s - a)};
}

/// a b, exactly (where the last digits are normal numbers).
template <Real T>
BRUME_INLINE Two<T> two_product(T a, T b) {
  const T p = a * b;
  if constexpr (kFused) {
    return {p, fused(a, b, -p)};
  } else {
    const auto upper = [](T x) {  // Veltkamp
      const T t = x * T(is_double<T> ? 0x1p27 + 1 : 0x1p12 + 1);
      return t - (t - x);
    };
    const T ah = upper(a), al = a - ah, bh = upper(b), bl = b - bh;
    return {p, ((ah * bh - p) + ah * bl + al * bh) + al * bl};
  }
}

/// Error: 3 u^2 (|a| + |b|).
template <Real T>
BRUME_INLINE Two<T> operator+(Two<T> a, Two<T> b) {
  const Two<T> s = two_sum(a.hi, b.hi);
  return quick_two_sum(s.hi, s.lo + (a.lo + b.lo));
}

/// Error: 3 u^2 |a b|.
template <Real T>
BRUME_INLINE Two<T> operator*(Two<T> a, T b) {
  const Two<T> p = two_product(a.hi, b);
  return quick_two_sum(p.hi, p.lo + a.lo * b);
}

/// x + a rounded to a T: the digits of what is left where they cancel.
template <Real T>
BRUME_INLINE T sum(T x, Two<T> a) {
  const Two<T> s = two_sum(x, a.hi);
  return s.hi + (s.lo + a.lo);
}

}  // namespace fog_volume::inline BRUME_ISA_NS
