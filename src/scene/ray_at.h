#pragma once
// A pixel's ray and the distance along it, for kernels: what view_run.cpp and
// depth_run.cpp compute plane by plane and other kernels in passing. Legend as there.

#include "num/batch.h"
#include "scene/depth_run.h"
#include "scene/view_run.h"

namespace brume::inline BRUME_ISA_NS {

template <class T>
struct Ray {
  T ox, oy, oz, dx, dy, dz, per_planar;
};

// d = v / |v|, and a point at planar depth 1 lies at distance |v|, for v . forward = 1.
// The offset f is exact and the middle of the row was rounded once from double, so v is
// off by at most 3 roundings of 2^-24 |v|.
template <class T>
struct PlanarRay {
  T x, y, z;
};
template <class T>
BRUME_INLINE PlanarRay<T> planar_ray(const RayRow& r, T f) {
  return {f * T(r.per_f[0]) + T(r.at_middle[0]), f * T(r.per_f[1]) + T(r.at_middle[1]),
          f * T(r.per_f[2]) + T(r.at_middle[2])};
}
template <class T>
BRUME_INLINE T planar_length(const RayRow& r, T f) {
  const auto v = planar_ray(r, f);
  return sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
}
template <class T>
BRUME_INLINE Ray<T> perspective(const RayRow& r, T f) {
  const auto v = planar_ray(r, f);
  const T length = sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
  const T o = T(0.f);
  return {o, o, o, v.x / length, v.y / length, v.z / length, length};
}

// Planar depth z to distance, p distance per planar depth; +inf where it is background.
// Error 2 roundings, 2^-23 relative.
template <class T>
BRUME_INLINE T planar(const DepthConstants& c, T z, T p) {
  return select((z > T(0.f)) & (z < T(c.from)), z * T(c.scale) * p, T(__builtin_inff()));
}

// Column offset from the row's middle, for pixels x + i, x + i + 1, ...
BRUME_INLINE Batch column_offset(const RayRow& r, int x, int i) {
  return Batch(static_cast<float>(std::int64_t{x} + i - r.middle) + 0.5f) + iota<Batch>();
}

}  // namespace brume::inline BRUME_ISA_NS
