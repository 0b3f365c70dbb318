#include "air/closed.h"

#include "air/along.h"
#include "air/steady.h"

namespace brume::air::inline BRUME_ISA_NS {
namespace {

// `inside` of a medium without bounds, start and cap, on rays from the eye: all of [0,
// end].
BRUME_INLINE Inside all_the_way(Batch end) {
  const Batch far(kFar);
  const auto there = end > Batch(0.f);
  const Batch hi = select(there, min(end, far), far);
  return {select(there, Batch(0.f), far), hi, far, far, hi, far};
}

template <brume_profile profile, bool open>
void rows(const Medium& given, const Compiled& world, const Rays& rays,
          const float* weight, const Stretch& out, bool ends) noexcept {
  Medium m = given;
  m.profile = profile;  // so that the compiler knows
  const bool lit = m.glows_by_sun && m.closed;
  const Batch zero(0.f), far(kFar);
  for (int i = 0; i < rays.n; i += Batch::W) {
    const auto ray = load_ray(rays, i);
    const Batch w = weight ? load<Batch>(weight + i) : Batch(1.f);
    const Batch begin = rays.begin ? load<Batch>(rays.begin + i) : zero;
    const Batch end = load<Batch>(rays.end + i);
    const auto p = along(m, ray);
    const auto in = open ? all_the_way(end)
                         : inside(m, p, ray, w, begin, end, ends && out.lo != nullptr);
    Batch D;
    if (!open)
      D = depth_to(m, p, ray, w, in, far);
    else if (m.profile == BRUME_EXPONENTIAL)
      D = exponential_from_origin<open>(m, p, ray, in, end);
    else
      D = integral_inside(m, p, ray, in, in.lo, in.hi);
    D = min(D, far);  // a channel without extinction must not meet infinity

    if (out.lo) {
      store(out.lo + i, in.lo);
      store(out.hi + i, in.hi);
    }
    Batch S[3] = {m.S[0], m.S[1], m.S[2]};
    if (lit) add_steady(m, world, ray, S);
    Transmit<Batch> x;
    for (int c = 0; c < 3; ++c) {
      if (c == 0 || !m.grey) x = transmit(min(Batch(m.sigma[c]) * D, Batch(kFar)));
      store(out.T[c] + i, x.T);
      if (!out.L[c]) continue;
      Batch L = m.closed ? S[c] * x.A : zero;
      if (m.emits && m.closed)
        L += Batch(m.emission[c]) * D * exprel(Batch(m.sigma[c]) * D);
      store(out.L[c] + i, L);
    }
  }
}

template <brume_profile profile>
void pick(const Medium& m, const Compiled& world, const Rays& rays, const float* weight,
          const Stretch& out, bool ends) noexcept {
  const bool open = m.shape == BRUME_EVERYWHERE && m.start == 0 && m.cap == 0 &&
                    !rays.ox && !rays.begin && !weight;
  open ? rows<profile, true>(m, world, rays, weight, out, ends)
       : rows<profile, false>(m, world, rays, weight, out, ends);
}

void one(const Medium& m, const Compiled& world, const Rays& rays, const float* weight,
         const Stretch& out, bool ends) noexcept {
  switch (m.profile) {
    case BRUME_UNIFORM:
      return pick<BRUME_UNIFORM>(m, world, rays, weight, out, ends);
    case BRUME_EXPONENTIAL:
      return pick<BRUME_EXPONENTIAL>(m, world, rays, weight, out, ends);
    case BRUME_LORENTZIAN:
      return pick<BRUME_LORENTZIAN>(m, world, rays, weight, out, ends);
    case BRUME_CUSTOM:
      return pick<BRUME_CUSTOM>(m, world, rays, weight, out, ends);
  }
}

}  // namespace

const ClosedKernels closed_kernels = {one};

}  // namespace brume::air::inline BRUME_ISA_NS
