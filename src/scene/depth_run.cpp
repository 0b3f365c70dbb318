// Depth channels to distances along the ray. Legend: z depth as the channel has it, p
// distance per planar depth [1], s metres per unit, result [m]; +inf is background.
// Comparisons with NaN are false, so every test asks for what makes a depth good.

#include <cstring>
#include <limits>

#include "num/batch.h"
#include "scene/depth_run.h"
#include "scene/ray_at.h"

namespace brume::inline BRUME_ISA_NS {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Error as planar (ray_at.h), for each of the next two.
template <class T>
BRUME_INLINE T distance(const DepthConstants& c, T z, T) {
  return select((z > T(0.f)) & (z < T(c.from)), z * T(c.scale), T(kInfinity));
}
// 1/Z; 0 is infinitely far.
template <class T>
BRUME_INLINE T inverse(const DepthConstants& c, T z, T p) {
  return select((z > T(0.f)) & (z < T(kInfinity)), T(c.scale) * p / z, T(kInfinity));
}
// t runs from 0 at the near to 1 at the far end; nearer than near was clamped by the
// writer, the far end is background.
template <class T>
BRUME_INLINE T normalised(const DepthConstants& c, T z, T p) {
  const T t = max(T(c.slope) * z + T(c.intercept), T(0.f));
  return select((t < T(1.f)) & (abs(z) < T(kInfinity)), (t * T(c.scale) + T(c.near)) * p,
                T(kInfinity));
}

template <Batch (*at)(const DepthConstants&, Batch, Batch)>
void run(const DepthConstants& c, int n, const float* z, const float* p,
         float* out) noexcept {
  constexpr int W = Batch::W;
  int i = 0;
  for (; i + W <= n; i += W)
    store(out + i, at(c, load<Batch>(z + i), load<Batch>(p + i)));
  if (i >= n) return;
  const std::size_t rest = sizeof(float) * static_cast<std::size_t>(n - i);
  float a[W] = {}, b[W] = {};
  std::memcpy(a, z + i, rest);
  std::memcpy(b, p + i, rest);
  store(a, at(c, load<Batch>(a), load<Batch>(b)));
  std::memcpy(out + i, a, rest);
}

// (P - eye - o) . d, P - eye exact wherever P is within a factor 2 of the eye's `high`.
BRUME_INLINE Batch project(const PositionConstants& c, Batch x, Batch y, Batch z,
                           Batch alpha, Batch ox, Batch oy, Batch oz, Batch dx, Batch dy,
                           Batch dz) {
  const Batch s(c.metres), zero(0.f), infinity(kInfinity);
  const Batch along = (((x - Batch(c.high[0])) - Batch(c.low[0])) * s - ox) * dx +
                      (((y - Batch(c.high[1])) - Batch(c.low[1])) * s - oy) * dy +
                      (((z - Batch(c.high[2])) - Batch(c.low[2])) * s - oz) * dz;
  const Mask finite =
      (abs(x) < infinity) & (abs(y) < infinity) & (abs(z) < infinity) & (along == along);
  const Mask somewhere = (x != zero) | (y != zero) | (z != zero);
  return select(finite & somewhere & (alpha > zero), max(along, zero), infinity);
}

void position(const PositionConstants& c, int n, const float* px, const float* py,
              const float* pz, const float* alpha, const RaySpan& r,
              float* out) noexcept {
  constexpr int W = Batch::W;
  int i = 0;
  for (; i + W <= n; i += W) {
    const auto at = [i](const float* p) { return load<Batch>(p + i); };
    store(out + i, project(c, at(px), at(py), at(pz), alpha ? at(alpha) : Batch(1.f),
                           at(r.ox), at(r.oy), at(r.oz), at(r.dx), at(r.dy), at(r.dz)));
  }
  if (i >= n) return;
  const auto at = [&](const float* p) {
    float padded[W] = {};
    std::memcpy(padded, p + i, sizeof(float) * static_cast<std::size_t>(n - i));
    return load<Batch>(padded);
  };
  float rest[W];
  store(rest, project(c, at(px), at(py), at(pz), alpha ? at(alpha) : Batch(1.f), at(r.ox),
                      at(r.oy), at(r.oz), at(r.dx), at(r.dy), at(r.dz)));
  std::memcpy(out + i, rest, sizeof(float) * static_cast<std::size_t>(n - i));
}

bool uncovered(int n, const float* alpha, const float* distance) noexcept {
  constexpr int W = Batch::W;
  int i = 0;
  for (; i + W <= n; i += W)
    if (any((load<Batch>(alpha + i) > Batch(0.f)) &
            (load<Batch>(distance + i) == Batch(kInfinity))))
      return true;
  for (; i < n; ++i)
    if (alpha[i] > 0 && distance[i] == kInfinity) return true;
  return false;
}

bool any_finite(int n, const float* distance) noexcept {
  constexpr int W = Batch::W;
  Mask some = false;
  int i = 0;
  for (; i + W <= n; i += W) some = some | (load<Batch>(distance + i) < Batch(kInfinity));
  bool found = any(some);
  for (; i < n; ++i) found |= distance[i] < kInfinity;
  return found;
}

}  // namespace

extern const DepthKernels depth_kernels;
const DepthKernels depth_kernels = {run<planar<Batch>>,
                                    run<distance<Batch>>,
                                    run<inverse<Batch>>,
                                    run<normalised<Batch>>,
                                    position,
                                    uncovered,
                                    any_finite};

}  // namespace brume::inline BRUME_ISA_NS
