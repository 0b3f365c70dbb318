#pragma once
// A ray in the coordinates of a soft volume.
//
//   x = o + t d     local coordinates, in which the shape is |x_i| <= 1 or |x| <= 1
//
// A volume that is flat, or small and far, is many of its own thicknesses from the eye:
// in x = o + t d the two cancel, and what is left of floats is no place in it. So x is
// taken in twice the digits (two.h) at one t near the fog, and all else from there.

#include "two.h"

namespace fog_volume {

/// What kernels see of a soft volume. Positions of rays are relative to the eye.
struct Soft {
  bool box = true;
  float softness = 1;
  /// Rows (a0 a1 a2 | b), value = a . x + b, each number as a sum of two: three for local
  /// coordinates, the last for the logarithm of the density.
  float hi[4][4] = {}, lo[4][4] = {};
};

}  // namespace fog_volume

namespace fog_volume::inline BRUME_ISA_NS {

constexpr float kFar = 3e38f;
constexpr float kAway = 1e18f;  // no fog is as far [m]; its square is a float

/// A row's value at a place along a ray, and how it changes per metre.
template <Real T>
struct Row {
  Two<T> at, per;

  BRUME_INLINE void go(T s) { at = at + per * s; }
};

template <Real T>
BRUME_INLINE Two<T> scaled(const Soft& v, int row, const T x[3]) {
  const auto a = [&](int k) { return Two<T>{T(v.hi[row][k]), T(v.lo[row][k])}; };
  return a(0) * x[0] + a(1) * x[1] + a(2) * x[2];
}

/// A ray, all rows of it, at its origin; o null: at the eye.
template <Real T>
BRUME_INLINE void start(const Soft& v, const T* o, const T d[3], Row<T> rows[4]) {
  for (int i = 0; i < 4; ++i) {
    rows[i] = {{T(v.hi[i][3]), T(v.lo[i][3])}, scaled(v, i, d)};
    if (o) rows[i].at = rows[i].at + scaled(v, i, o);
  }
}

// x . d, or d . d.
template <bool square, Real T>
BRUME_INLINE T dot(const Row<T> rows[4]) {
  using S = Scalar_t<T>;
  T sum(square ? S(1e-36) : S(0));
  for (int i = 0; i < 3; ++i)
    sum += (square ? rows[i].per.hi : rows[i].at.hi) * rows[i].per.hi;
  return sum;
}

/// 1 - |x|^2.
template <Real T>
BRUME_INLINE T inward(const Row<T> rows[4]) {
  Two<T> r2{T(0), T(0)};
  for (int i = 0; i < 3; ++i) {
    const Two<T>& x = rows[i].at;
    const Two<T> x2 = two_product(x.hi, x.hi);
    r2 = r2 + Two<T>{x2.hi, x2.lo + T(2) * x.hi * x.lo};
  }
  return sum(T(1), {-r2.hi, -r2.lo});
}

// Brings the rows to where the ray is to be looked at from: the point of [t0, t1] where
// it enters the box, or next to the middle of the ball. In two steps, as the first is
// only as good as floats of its own length. t0 and t1 count from there, then.
template <Real T>
BRUME_INLINE void near(const Soft& v, Row<T> rows[4], T& t0, T& t1) {
  using S = Scalar_t<T>;
  const T far{S(kFar)}, away{S(kAway)};
  for (int step = 0; step < 2; ++step) {
    T s = -far;
    if (v.box) {
      for (int i = 0; i < 3; ++i) {
        const T d = rows[i].per.hi, face = select(d > T(0), T(-1), T(1));
        const T enters = sum(face, {-rows[i].at.hi, -rows[i].at.lo}) / d;
        s = max(s, select(d == T(0), -far, enters));
      }
    } else {
      s = -dot<false>(rows) / dot<true>(rows);
    }
    s = clamp(clamp(s, t0, t1), -away, away);
    for (int i = 0; i < 4; ++i) rows[i].go(s);
    t0 = t0 - s;
    t1 = t1 - s;
  }
}

}  // namespace fog_volume::inline BRUME_ISA_NS
