#pragma once
// Batch: W floats that behave like one; W = 4, 8 or 16 by instruction set. A kernel is
// written once as template <class T> and compiled for T = Batch (speed), float (tails)
// and double (its own rounding error). What is here exists for all three:
//
//   arithmetic, comparison   + - * /   < <= > >= == !=  giving Mask_t<T> (Mask or bool)
//   masks                    & | !  any all none
//   choice                   select(mask, a, b): lanes of a where mask, else of b
//   one value                min max clamp abs sqrt floor round fused
//   lanes                    lanes<T>  load store iota gather sum lowest highest
//   bits                     bits(x) and value(u): as unsigned integers, and back; head
//
// Comparisons with NaN are false: min(a, b) and max(a, b) give a when either is NaN, and
// clamp keeps a NaN. Products and sums are fused where the compiler may (-ffp-contract,
// v3 and v4 only), so bounds hold with and without.

#include <cstdint>
#include <type_traits>

// GCC 12 takes its own AVX-512 "undefined" registers for a mistake of ours.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wuninitialized"
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <experimental/simd>
#pragma GCC diagnostic pop

#include "num/isa.h"

namespace brume::inline BRUME_ISA_NS {

namespace stdx = std::experimental;

/// A truth value per lane.
class Mask {
 public:
  using Simd = stdx::native_simd_mask<float>;
  Mask() = default;
  BRUME_INLINE Mask(bool all) : v(all) {}
  BRUME_INLINE explicit Mask(Simd s) : v(s) {}
  BRUME_INLINE bool operator[](int i) const { return v[static_cast<std::size_t>(i)]; }

  BRUME_INLINE friend Mask operator&(Mask a, Mask b) { return Mask(a.v && b.v); }
  BRUME_INLINE friend Mask operator|(Mask a, Mask b) { return Mask(a.v || b.v); }
  BRUME_INLINE friend Mask operator==(Mask a, Mask b) { return Mask(a.v == b.v); }
  BRUME_INLINE friend Mask operator!=(Mask a, Mask b) { return Mask(a.v != b.v); }
  BRUME_INLINE friend Mask operator!(Mask a) { return Mask(!a.v); }

  Simd v;
};

/// W floats.
class Batch {
 public:
  using Simd = stdx::native_simd<float>;
  static constexpr int W = static_cast<int>(Simd::size());

  Batch() = default;
  BRUME_INLINE Batch(float x) : v(x) {}  // the same value in every lane
  BRUME_INLINE explicit Batch(Simd s) : v(s) {}
  BRUME_INLINE float operator[](int i) const { return v[static_cast<std::size_t>(i)]; }

  BRUME_INLINE friend Batch operator+(Batch a, Batch b) { return Batch(a.v + b.v); }
  BRUME_INLINE friend Batch operator-(Batch a, Batch b) { return Batch(a.v - b.v); }
  BRUME_INLINE friend Batch operator*(Batch a, Batch b) { return Batch(a.v * b.v); }
  BRUME_INLINE friend Batch operator/(Batch a, Batch b) { return Batch(a.v / b.v); }
  BRUME_INLINE friend Batch operator-(Batch a) { return Batch(-a.v); }
  BRUME_INLINE Batch& operator+=(Batch b) { return *this = *this + b; }
  BRUME_INLINE Batch& operator-=(Batch b) { return *this = *this - b; }
  BRUME_INLINE Batch& operator*=(Batch b) { return *this = *this * b; }
  BRUME_INLINE Batch& operator/=(Batch b) { return *this = *this / b; }

  BRUME_INLINE friend Mask operator<(Batch a, Batch b) { return Mask(a.v < b.v); }
  BRUME_INLINE friend Mask operator<=(Batch a, Batch b) { return Mask(a.v <= b.v); }
  BRUME_INLINE friend Mask operator>(Batch a, Batch b) { return Mask(a.v > b.v); }
  BRUME_INLINE friend Mask operator>=(Batch a, Batch b) { return Mask(a.v >= b.v); }
  BRUME_INLINE friend Mask operator==(Batch a, Batch b) { return Mask(a.v == b.v); }
  BRUME_INLINE friend Mask operator!=(Batch a, Batch b) { return Mask(a.v != b.v); }

  Simd v;
};

/// W unsigned 32-bit integers: bit patterns of a Batch, lattice points, hashes.
/// Arithmetic wraps.
class IntBatch {
 public:
  using Simd = stdx::rebind_simd_t<std::uint32_t, Batch::Simd>;
  IntBatch() = default;
  BRUME_INLINE IntBatch(std::uint32_t x) : v(x) {}
  BRUME_INLINE explicit IntBatch(Simd s) : v(s) {}
  BRUME_INLINE std::uint32_t operator[](int i) const {
    return v[static_cast<std::size_t>(i)];
  }

  BRUME_INLINE friend IntBatch operator+(IntBatch a, IntBatch b) {
    return IntBatch(a.v + b.v);
  }
  BRUME_INLINE friend IntBatch operator-(IntBatch a, IntBatch b) {
    return IntBatch(a.v - b.v);
  }
  BRUME_INLINE friend IntBatch operator*(IntBatch a, IntBatch b) {
    return IntBatch(a.v * b.v);
  }
  BRUME_INLINE friend IntBatch operator&(IntBatch a, IntBatch b) {
    return IntBatch(a.v & b.v);
  }
  BRUME_INLINE friend IntBatch operator|(IntBatch a, IntBatch b) {
    return IntBatch(a.v | b.v);
  }
  BRUME_INLINE friend IntBatch operator^(IntBatch a, IntBatch b) {
    return IntBatch(a.v ^ b.v);
  }
  BRUME_INLINE friend IntBatch operator<<(IntBatch a, int n) {
    return IntBatch(a.v << n);
  }
  BRUME_INLINE friend IntBatch operator>>(IntBatch a, int n) {
    return IntBatch(a.v >> n);
  }

  Simd v;
};

// ---- the types that belong to T ------------------------------------------------------

template <class T>
struct Traits;  // of float, double and Batch

template <>
struct Traits<float> {
  using Scalar = float;
  using Mask = bool;
  using Bits = std::uint32_t;
};
template <>
struct Traits<double> {
  using Scalar = double;
  using Mask = bool;
  using Bits = std::uint64_t;
};
template <>
struct Traits<Batch> {
  using Scalar = float;
  using Mask = brume::BRUME_ISA_NS::Mask;
  using Bits = IntBatch;
};

template <class T>
concept Real = requires {
  typename Traits<T>::Scalar;
};

template <Real T>
using Scalar_t = typename Traits<T>::Scalar;  ///< one lane: float or double
template <Real T>
using Mask_t = typename Traits<T>::Mask;  ///< what a comparison gives: Mask or bool
template <Real T>
using Bits_t = typename Traits<T>::Bits;  ///< unsigned integer of the same width
template <class T>
using Same = std::type_identity_t<T>;  ///< converts to the T of the other argument

template <Real T>
inline constexpr bool is_double = sizeof(Scalar_t<T>) == 8;
/// How many values T holds: 1, or Batch::W.
template <Real T>
inline constexpr int lanes = static_cast<int>(sizeof(T) / sizeof(Scalar_t<T>));

// ---- choice --------------------------------------------------------------------------

/// Lanes of a where m, else of b.
template <Real T>
BRUME_INLINE T select(Mask_t<T> m, T a, Same<T> b) {
  if constexpr (lanes<T> == 1) {
    return m ? a : b;
  } else {
    stdx::where(m.v, b.v) = a.v;
    return b;
  }
}

BRUME_INLINE bool any(Mask m) { return stdx::any_of(m.v); }
BRUME_INLINE bool all(Mask m) { return stdx::all_of(m.v); }
BRUME_INLINE bool none(Mask m) { return stdx::none_of(m.v); }
BRUME_INLINE bool any(bool m) { return m; }
BRUME_INLINE bool all(bool m) { return m; }
BRUME_INLINE bool none(bool m) { return !m; }

// ---- one value -----------------------------------------------------------------------

// The processor's own minimum and maximum do just this, a second operand where either is
// NaN; GCC does not see it by itself.
#if defined(__AVX512F__)
BRUME_INLINE auto cpu_min(__m512 a, __m512 b) { return _mm512_min_ps(a, b); }
BRUME_INLINE auto cpu_max(__m512 a, __m512 b) { return _mm512_max_ps(a, b); }
using CpuFloats = __m512;
#elif defined(__AVX__)
BRUME_INLINE auto cpu_min(__m256 a, __m256 b) { return _mm256_min_ps(a, b); }
BRUME_INLINE auto cpu_max(__m256 a, __m256 b) { return _mm256_max_ps(a, b); }
using CpuFloats = __m256;
#else
BRUME_INLINE auto cpu_min(__m128 a, __m128 b) { return _mm_min_ps(a, b); }
BRUME_INLINE auto cpu_max(__m128 a, __m128 b) { return _mm_max_ps(a, b); }
using CpuFloats = __m128;
#endif

template <Real T>
BRUME_INLINE T min(T a, Same<T> b) {
  if constexpr (lanes<T> == 1)
    return b < a ? b : a;
  else
    return T(typename T::Simd(
        cpu_min(static_cast<CpuFloats>(b.v), static_cast<CpuFloats>(a.v))));
}
template <Real T>
BRUME_INLINE T max(T a, Same<T> b) {
  if constexpr (lanes<T> == 1)
    return a < b ? b : a;
  else
    return T(typename T::Simd(
        cpu_max(static_cast<CpuFloats>(b.v), static_cast<CpuFloats>(a.v))));
}
template <Real T>
BRUME_INLINE T clamp(T x, Same<T> lo, Same<T> hi) {
  return min(max(x, lo), hi);
}

BRUME_INLINE Batch abs(Batch x) { return Batch(stdx::abs(x.v)); }
BRUME_INLINE float abs(float x) { return __builtin_fabsf(x); }
BRUME_INLINE double abs(double x) { return __builtin_fabs(x); }

BRUME_INLINE Batch sqrt(Batch x) { return Batch(stdx::sqrt(x.v)); }
BRUME_INLINE float sqrt(float x) { return __builtin_sqrtf(x); }
BRUME_INLINE double sqrt(double x) { return __builtin_sqrt(x); }

BRUME_INLINE Batch floor(Batch x) { return Batch(stdx::floor(x.v)); }
BRUME_INLINE float floor(float x) { return __builtin_floorf(x); }
BRUME_INLINE double floor(double x) { return __builtin_floor(x); }

/// To the nearest integer, halves to the even one.
BRUME_INLINE Batch round(Batch x) { return Batch(stdx::rint(x.v)); }
BRUME_INLINE float round(float x) { return __builtin_rintf(x); }
BRUME_INLINE double round(double x) { return __builtin_rint(x); }

/// a b + c, rounded once on v3 and v4 (kFused), twice on v2 and in host code. For the few
/// places that are about that rounding; elsewhere write a * b + c.
#ifdef __FMA__
inline constexpr bool kFused = true;
BRUME_INLINE Batch fused(Batch a, Batch b, Batch c) {
  return Batch(stdx::fma(a.v, b.v, c.v));
}
BRUME_INLINE float fused(float a, float b, float c) { return __builtin_fmaf(a, b, c); }
BRUME_INLINE double fused(double a, double b, double c) { return __builtin_fma(a, b, c); }
#else
inline constexpr bool kFused = false;
template <Real T>
BRUME_INLINE T fused(T a, T b, T c) {
  return a * b + c;
}
#endif

// ---- bits ----------------------------------------------------------------------------

BRUME_INLINE IntBatch bits(Batch x) {
  return IntBatch(__builtin_bit_cast(IntBatch::Simd, x.v));
}
BRUME_INLINE std::uint32_t bits(float x) { return __builtin_bit_cast(std::uint32_t, x); }
BRUME_INLINE std::uint64_t bits(double x) { return __builtin_bit_cast(std::uint64_t, x); }
BRUME_INLINE Batch value(IntBatch u) {
  return Batch(__builtin_bit_cast(Batch::Simd, u.v));
}
BRUME_INLINE float value(std::uint32_t u) { return __builtin_bit_cast(float, u); }
BRUME_INLINE double value(std::uint64_t u) { return __builtin_bit_cast(double, u); }

/// The upper half of x's significant bits (12 of 24, 26 of 53) and the rest: x = head +
/// tail exactly, and a product of two heads is exact.
template <Real T>
BRUME_INLINE T head(T x) {
  return value(bits(x) & Bits_t<T>(is_double<T> ? 0xfffffffff8000000 : 0xfffff000));
}

// ---- lanes ---------------------------------------------------------------------------

/// The lanes<T> values from p on, any alignment.
template <Real T>
BRUME_INLINE T load(const Scalar_t<T>* p) {
  if constexpr (lanes<T> == 1)
    return *p;
  else
    return T(typename T::Simd(p, stdx::element_aligned));
}
BRUME_INLINE void store(float* p, Batch x) { x.v.copy_to(p, stdx::element_aligned); }
BRUME_INLINE void store(float* p, float x) { *p = x; }
BRUME_INLINE void store(double* p, double x) { *p = x; }

/// 0, 1, 2, ...: the number of each lane.
template <Real T>
BRUME_INLINE T iota() {
  if constexpr (lanes<T> == 1)
    return T(0);
  else
    return T(typename T::Simd([](auto i) { return static_cast<float>(+i); }));
}

/// p[index], lane by lane: a loop of loads, which beat the gather instructions (DESIGN).
BRUME_INLINE Batch gather(const float* p, IntBatch index) {
  float out[Batch::W];
  for (int i = 0; i < Batch::W; ++i) out[i] = p[index[i]];
  return load<Batch>(out);
}
BRUME_INLINE float gather(const float* p, std::uint32_t index) { return p[index]; }
BRUME_INLINE double gather(const double* p, std::uint32_t index) { return p[index]; }

/// Over all lanes.
BRUME_INLINE float sum(Batch x) { return stdx::reduce(x.v); }
BRUME_INLINE float sum(float x) { return x; }
BRUME_INLINE double sum(double x) { return x; }
BRUME_INLINE float lowest(Batch x) { return stdx::hmin(x.v); }
BRUME_INLINE float lowest(float x) { return x; }
BRUME_INLINE double lowest(double x) { return x; }
BRUME_INLINE float highest(Batch x) { return stdx::hmax(x.v); }
BRUME_INLINE float highest(float x) { return x; }
BRUME_INLINE double highest(double x) { return x; }

}  // namespace brume::inline BRUME_ISA_NS
