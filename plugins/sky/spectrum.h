#pragma once
// The value types of the sky's kernels. Spectrum<S, N> holds one value per wavelength and
// behaves like one: the formulas of num/math.h take it as they take a Batch, whose lanes
// are points. Lanes<S> is what points are taken in: Batch for float, one by one for
// double. (Vectors of the compiler: unlike simd's fixed_size they may be bit-cast.)

#include "num/math.h"

namespace brume::inline BRUME_ISA_NS {

template <class S, int N>
struct VectorOf {
  typedef S type __attribute__((vector_size(N * sizeof(S))));
};

template <class S, int N>
struct SpectrumBits {
  using U = Bits_t<S>;
  using Simd = typename VectorOf<U, N>::type;
  SpectrumBits() = default;
  BRUME_INLINE SpectrumBits(U x) : v(x - Simd{}) {}
  BRUME_INLINE explicit SpectrumBits(Simd s) : v(s) {}
  BRUME_INLINE friend SpectrumBits operator+(SpectrumBits a, SpectrumBits b) {
    return SpectrumBits(a.v + b.v);
  }
  BRUME_INLINE friend SpectrumBits operator-(SpectrumBits a, SpectrumBits b) {
    return SpectrumBits(a.v - b.v);
  }
  BRUME_INLINE friend SpectrumBits operator&(SpectrumBits a, SpectrumBits b) {
    return SpectrumBits(a.v & b.v);
  }
  BRUME_INLINE friend SpectrumBits operator<<(SpectrumBits a, int n) {
    return SpectrumBits(a.v << n);
  }
  BRUME_INLINE friend SpectrumBits operator>>(SpectrumBits a, int n) {
    return SpectrumBits(a.v >> n);
  }
  Simd v;
};

template <class S, int N>
class Spectrum {
 public:
  using Simd = typename VectorOf<S, N>::type;
  struct Mask {
    decltype(Simd{} < Simd{}) v;
    BRUME_INLINE friend Mask operator&(Mask a, Mask b) { return {a.v & b.v}; }
    BRUME_INLINE friend Mask operator|(Mask a, Mask b) { return {a.v | b.v}; }
  };
  Spectrum() = default;
  BRUME_INLINE Spectrum(S x) : v(x - Simd{}) {}  // the same value at every wavelength
  BRUME_INLINE explicit Spectrum(Simd s) : v(s) {}
  BRUME_INLINE static Spectrum at(const S* p) {
    Spectrum r;
    __builtin_memcpy(&r.v, p, sizeof r.v);
    return r;
  }
  BRUME_INLINE void to(S* p) const { __builtin_memcpy(p, &v, sizeof v); }
  BRUME_INLINE S operator[](int i) const { return v[i]; }

  BRUME_INLINE friend Spectrum operator+(Spectrum a, Spectrum b) {
    return Spectrum(a.v + b.v);
  }
  BRUME_INLINE friend Spectrum operator-(Spectrum a, Spectrum b) {
    return Spectrum(a.v - b.v);
  }
  BRUME_INLINE friend Spectrum operator*(Spectrum a, Spectrum b) {
    return Spectrum(a.v * b.v);
  }
  BRUME_INLINE friend Spectrum operator/(Spectrum a, Spectrum b) {
    return Spectrum(a.v / b.v);
  }
  BRUME_INLINE friend Spectrum operator-(Spectrum a) { return Spectrum(-a.v); }
  BRUME_INLINE Spectrum& operator+=(Spectrum b) { return *this = *this + b; }
  BRUME_INLINE Spectrum& operator*=(Spectrum b) { return *this = *this * b; }
  BRUME_INLINE friend Mask operator<(Spectrum a, Spectrum b) { return {a.v < b.v}; }
  BRUME_INLINE friend Mask operator>(Spectrum a, Spectrum b) { return {a.v > b.v}; }
  Simd v;
};

template <class S, int N>
struct Traits<Spectrum<S, N>> {
  using Scalar = S;
  using Mask = typename Spectrum<S, N>::Mask;
  using Bits = SpectrumBits<S, N>;
};

template <class S, int N>
BRUME_INLINE Spectrum<S, N> select(typename Spectrum<S, N>::Mask m, Spectrum<S, N> a,
                                   Same<Spectrum<S, N>> b) {
  return Spectrum<S, N>(m.v ? a.v : b.v);
}
template <class S, int N>
BRUME_INLINE Spectrum<S, N> min(Spectrum<S, N> a, Same<Spectrum<S, N>> b) {
  return Spectrum<S, N>(b.v < a.v ? b.v : a.v);
}
template <class S, int N>
BRUME_INLINE Spectrum<S, N> max(Spectrum<S, N> a, Same<Spectrum<S, N>> b) {
  return Spectrum<S, N>(a.v < b.v ? b.v : a.v);
}
template <class S, int N>
BRUME_INLINE SpectrumBits<S, N> bits(Spectrum<S, N> x) {
  return SpectrumBits<S, N>(__builtin_bit_cast(typename SpectrumBits<S, N>::Simd, x.v));
}
template <class S, int N>
BRUME_INLINE Spectrum<S, N> value(SpectrumBits<S, N> u) {
  return Spectrum<S, N>(__builtin_bit_cast(typename Spectrum<S, N>::Simd, u.v));
}

template <class S>
struct LanesOf {
  using type = S;
};
template <>
struct LanesOf<float> {
  using type = Batch;
};
template <class S>
using Lanes = typename LanesOf<S>::type;

}  // namespace brume::inline BRUME_ISA_NS
