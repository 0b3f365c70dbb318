// Rays of a run of pixels. Legend: f column offset from the row's middle [pixels], v ray
// with unit planar depth, d unit direction, o origin relative to the eye [m].

#include "scene/view_run.h"
#include "num/batch.h"
#include "num/math.h"
#include "scene/ray_at.h"

namespace brume::inline BRUME_ISA_NS {
namespace {

template <class T>
BRUME_INLINE Ray<T> orthographic(const RayRow& r, T f) {
  return {f * T(r.per_f[0]) + T(r.at_middle[0]),
          f * T(r.per_f[1]) + T(r.at_middle[1]),
          f * T(r.per_f[2]) + T(r.at_middle[2]),
          T(r.forward[0]),
          T(r.forward[1]),
          T(r.forward[2]),
          T(1.f)};
}

// The angle in radians is off by at most 2^-24 (2 pi |turns| + pi), 4e-7 rad within the
// frame: a thousandth of a pixel at 16K.
template <class T>
BRUME_INLINE Ray<T> latlong(const RayRow& r, T f) {
  const T turns = f / T(r.pixels_per_turn) + T(r.turns_at_middle);
  const auto [s, c] = sincos(turns * T(6.283185307f));
  const T o = T(0.f);
  return {o,
          o,
          o,
          s * T(r.east[0]) + (c * T(r.ahead[0]) + T(r.pole[0])),
          s * T(r.east[1]) + (c * T(r.ahead[1]) + T(r.pole[1])),
          s * T(r.east[2]) + (c * T(r.ahead[2]) + T(r.pole[2])),
          T(1.f)};
}

BRUME_INLINE void store_ray(const Ray<Batch>& ray, const RaySpan& out, int i) {
  store(out.ox + i, ray.ox);
  store(out.oy + i, ray.oy);
  store(out.oz + i, ray.oz);
  store(out.dx + i, ray.dx);
  store(out.dy + i, ray.dy);
  store(out.dz + i, ray.dz);
  store(out.per_planar + i, ray.per_planar);
}

// A run: whole batches, then the rest from one more batch of which the head is kept. A
// lane's f comes from its column alone, so a pixel has the same bits in any run.
template <Ray<Batch> (*at)(const RayRow&, Batch)>
void fill(const RayRow& row, int x, int n, const RaySpan& out) noexcept {
  constexpr int W = Batch::W;
  const auto f = [&](int i) { return column_offset(row, x, i); };
  int i = 0;
  for (; i + W <= n; i += W) store_ray(at(row, f(i)), out, i);
  if (i >= n) return;
  float rest[7][W];
  store_ray(at(row, f(i)),
            {rest[0], rest[1], rest[2], rest[3], rest[4], rest[5], rest[6]}, 0);
  float* const to[7] = {out.ox, out.oy, out.oz, out.dx, out.dy, out.dz, out.per_planar};
  for (int k = 0; k < 7; ++k)
    for (int j = 0; i + j < n; ++j) to[k][i + j] = rest[k][j];
}

}  // namespace

extern const RayKernels ray_kernels;
const RayKernels ray_kernels = {fill<perspective<Batch>>, fill<orthographic<Batch>>,
                                fill<latlong<Batch>>};

}  // namespace brume::inline BRUME_ISA_NS
