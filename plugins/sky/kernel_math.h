#pragma once
// Value types of the sky's kernels: S is float or double; Lanes<S> as many points as fit
// a register; Spectrum<S, N> one value per wavelength. The same formula takes each.

#include <cmath>
#include <experimental/simd>
#include <type_traits>

namespace brume::sky {

namespace stdx = std::experimental;
template <class S>
using Lanes = stdx::native_simd<S>;
template <class S, int N>
using Spectrum = stdx::fixed_size_simd<S, N>;

template <class T>
struct scalar_of {
  using type = T;
};
template <class S, class A>
struct scalar_of<stdx::simd<S, A>> {
  using type = S;
};

template <class T>
requires std::is_arithmetic_v<T>
inline T max(T a, T b) { return a > b ? a : b; }
template <class T>
requires std::is_arithmetic_v<T>
inline T min(T a, T b) { return a < b ? a : b; }
template <class T>
requires std::is_arithmetic_v<T>
inline T select(bool m, T a, T b) { return m ? a : b; }
template <class S, class A>
inline stdx::simd<S, A> select(stdx::simd_mask<S, A> m, stdx::simd<S, A> a,
                               stdx::simd<S, A> b) {
  where(m, b) = a;
  return b;
}

/// e^x for x <= 0; 0 below -87 (float) or -708 (double). Relative error 2e-7 (float),
/// 4e-16 (double).
template <class T>
inline T exp_neg(T x) {
  using S = typename scalar_of<T>::type;
  if constexpr (std::is_arithmetic_v<T>) {
    return std::exp(x);
  } else {
    constexpr bool wide = sizeof(S) == 8;
    using I = std::conditional_t<wide, long long, int>;
    const auto gone = x < T(wide ? S(-708) : S(-87));
    x = max(x, T(wide ? S(-708) : S(-87)));
    const S magic = wide ? S(6755399441055744.0) : S(12582912.0f);
    const T t = x * T(S(1.4426950408889634074)) + T(magic);
    const T n = t - T(magic);
    T r = x - n * T(wide ? S(0x1.62e42fee00000p-1) : S(0x1.62e400p-1f));
    r = r - n * T(wide ? S(0x1.a39ef35793c76p-33) : S(0x1.7f7d1cf79abcap-20));
    T q(S(1));
    if constexpr (wide) {
      q = T(S(1 / 6227020800.));
      for (double k :
           {1 / 479001600., 1 / 39916800., 1 / 3628800., 1 / 362880., 1 / 40320.,
            1 / 5040., 1 / 720., 1 / 120., 1 / 24., 1 / 6., .5, 1., 1.})
        q = q * r + T(S(k));
    } else {
      q = T(S(1 / 5040.f));
      for (float k : {1 / 720.f, 1 / 120.f, 1 / 24.f, 1 / 6.f, .5f, 1.f, 1.f})
        q = q * r + T(k);
    }
    // 2^n through the exponent bits
    T scale;
    alignas(64) S lanes[T::size()];
    n.copy_to(lanes, stdx::element_aligned);
    for (std::size_t i = 0; i < T::size(); ++i) {
      const I bits = (static_cast<I>(lanes[i]) + (wide ? 1023 : 127)) << (wide ? 52 : 23);
      lanes[i] = __builtin_bit_cast(S, bits);
    }
    scale.copy_from(lanes, stdx::element_aligned);
    q *= scale;
    where(gone, q) = T(S(0));
    return q;
  }
}

}  // namespace brume::sky
