#pragma once
// Gradient noise in three dimensions, without tables: the same world in Batch, float and
// double, from any thread, at any place.

#include "num/random.h"

namespace brume::inline BRUME_ISA_NS {

/// The integer that is worth x, for integer-valued x: exact for |x| < 2^31, held there
/// beyond; NaN gives some integer.
BRUME_INLINE IntBatch cell(Batch x) {
  using Signed = stdx::rebind_simd_t<std::int32_t, Batch::Simd>;
  const Batch held = clamp(x, -0x1p31f, 0x1.fffffep30f);
  const Signed i = stdx::static_simd_cast<Signed>(held.v);
  return IntBatch(stdx::static_simd_cast<IntBatch::Simd>(i));
}
template <Real S>
requires(lanes<S> == 1) BRUME_INLINE std::uint32_t cell(S x) {
  const S held = clamp(x, S(-0x1p31), S(0x1.fffffep30));
  return static_cast<std::uint32_t>(
      static_cast<std::int32_t>(held == held ? held : S(0)));
}

// v with its sign flipped where the highest bit of h is set.
template <Real T>
BRUME_INLINE T flip(T v, Cell_t<T> h) {
  const Cell_t<T> sign = h & Cell_t<T>(0x80000000u);
  return value(bits(v) ^ (Bits_t<T>(sign) << (is_double<T> ? 32 : 0)));
}

// What one corner adds: the dot product of (x, y, z), the way from it, with one of the
// twelve directions to the middles of a cube's edges, (+-1, +-1, 0) and so on (Perlin
// 2002). The two highest bits of h are the signs, those below pick the axis left out.
template <Real T>
BRUME_INLINE T corner(Cell_t<T> h, T x, T y, T z) {
  const auto r = value(((h << 2) >> 9) | Cell_t<T>(0x3f800000u));  // uniform in [1, 2)
  using F = std::remove_const_t<decltype(r)>;                      // float, or Batch
  const Mask_t<T> no_x = r<F(4 / 3.0f), no_z = r> F(5 / 3.0f);
  return flip(select(no_x, y, x), h) + flip(select(no_z, y, z), h << 1);
}

// noise(x, y, z): Perlin's gradient noise (Perlin 1985, 2002) on the unit lattice.
//   A gradient at each lattice point, picked by a hash of the point and `seed`; between
//   them the eight dot products blended by 6 t^5 - 15 t^4 + 10 t^3.
//   Twice continuously differentiable; 0 at lattice points; |noise| <= 1.0364, the most
//   that any choice of gradients gives; mean 0, as each gradient is as likely as its
//   opposite; rms 0.27; little power far below one cycle per cell.
//   period > 0 [cells]: repeats exactly after so many cells along each axis.
//   `origin`: the lattice point that x = y = z = 0 stands for, so that a place far away
//   keeps the digits of a float; 32 bits, wrapping; with a period, 0 <= origin < period.
//   Domain: |x|, |y|, |z| < 2^31, with a period |x| + origin < 2^22 (in float there is
//   nothing between the lattice points from 2^23 on). Infinity and NaN give NaN.
//   Error in float: 1.5e-6 absolute. Cost: v4 1.8, v3 4, v2 8.5 ns.
template <Real T>
BRUME_INLINE T noise(T x, T y, T z, std::uint32_t seed = 0, int period = 0,
                     const std::array<std::uint32_t, 3>& origin = {}) {
  using S = Scalar_t<T>;
  using U = Cell_t<T>;
  const T p[3] = {x, y, z};
  T t[3], w[3];      // within the cell: place, blend
  U at[3], next[3];  // the cell's lower and upper lattice coordinate
  for (int k = 0; k < 3; ++k) {
    const T lower = floor(p[k]);
    t[k] = p[k] - lower;
    w[k] = t[k] * t[k] * t[k] * (t[k] * (t[k] * T(6) - T(15)) + T(10));
    if (period > 0) {
      const T n = T(static_cast<S>(period));
      const T from = lower + T(static_cast<S>(origin[std::size_t(k)]));
      const T i = from - n * floor(from / n);
      at[k] = cell(i);
      next[k] = cell(select(i + T(1) == n, T(0), i + T(1)));
    } else {
      at[k] = cell(lower) + U(origin[std::size_t(k)]);
      next[k] = cell(lower + T(1)) + U(origin[std::size_t(k)]);
    }
  }

  T layer[2][2];  // blended along x
  for (int b = 0; b < 2; ++b)
    for (int c = 0; c < 2; ++c) {
      const U iy = b ? next[1] : at[1], iz = c ? next[2] : at[2];
      const T dy = t[1] - T(S(b)), dz = t[2] - T(S(c));
      const T n0 = corner<T>(hash<U>(at[0], iy, iz, U(seed)).x, t[0], dy, dz);
      const T n1 = corner<T>(hash<U>(next[0], iy, iz, U(seed)).x, t[0] - T(1), dy, dz);
      layer[b][c] = n0 + w[0] * (n1 - n0);
    }
  const T n0 = layer[0][0] + w[1] * (layer[1][0] - layer[0][0]);
  const T n1 = layer[0][1] + w[1] * (layer[1][1] - layer[0][1]);
  return n0 + w[2] * (n1 - n0);
}

}  // namespace brume::inline BRUME_ISA_NS
