// One fog over a row of pixels, once per instruction set. Legend: t distance [m], y =
// falloff x rise [1], D integral of density [m], T, A transmittance and 1 - T; S, C
// colour before and after, a coverage.

#include "pipeline/sole.h"

#include "air/profile.h"
#include "num/math.h"
#include "pipeline/lanes.h"
#include "scene/ray_at.h"

namespace brume::pipeline::inline BRUME_ISA_NS {
namespace {

/// The air over planar depth z of rays with unit planar depth of this length, along which
/// the exponent of density falls by `fall` per planar depth. Neither needs the unit
/// direction: no division but exprel's own.
BRUME_INLINE Transmit<Batch> through(const SoleMedium& m, Batch fall, Batch length,
                                     Batch z) {
  const Batch t = z * length, y = fall * z;
  // One exponential while the far end is no denser than e^60 times the eye's, else by the
  // densest end.
  const Mask plain = (y > Batch(-60.f)) & Mask(m.rho0 > 0);
  // exprel where neither its quotient nor its exponential can overflow.
  const Batch x = max(y, Batch(-60.f));
  const auto e = exp_pieces(-x);
  const Batch s = e.s1 * e.s2;
  const Batch mean =
      select(x == Batch(0.f), Batch(1.f), ((Batch(1.f) - s) - s * e.p) / x);
  Batch D = Batch(m.rho0) * mean * t;
  if (!all(plain)) {
    const air::Along<Batch> along{Batch(m.log_rho0), fall / length, Batch(0.f)};
    D = select(plain, D, air::exponential_integral(along, Batch(0.f), t));
  }
  return transmit(min(Batch(m.sigma) * D, Batch(air::kFar)));
}

bool apply(const SoleMedium& m, const SoleRun& run) noexcept {
  const Batch one(1.f), zero(0.f), forever(air::kMaxLength);
  Mask touched = false;
  by_batch(
      run.n, [&](int i, auto count) __attribute__((always_inline)) {
        const Batch f = column_offset(run.row, run.x, i);
        const Batch length = planar_length(run.row, f);
        const Batch fall = f * Batch(run.fall_per_f) + Batch(run.fall_at_middle);
        const Batch depth = get(run.z, i, count);
        Mask known = (depth > zero) & (depth < Batch(run.depth.from));
        Batch z = select(known, depth * Batch(run.depth.scale), forever);
        if (run.distance) {
          const Batch t = get(run.distance, i, count);
          z = select(known, z, min(t / length, forever));
          known = known | (t < forever);
        }
        const auto near = through(m, fall, length, z);
        const Batch a_in = run.a ? get(run.a, i, count) : select(known, one, zero);
        const Batch a = coverage(a_in), uncovered = one - a;
        Transmit<Batch> beyond = near;
        const Mask both = (a < one) & known;
        if (any(both)) {
          const auto far = through(m, fall, length, forever);
          beyond = {select(both, far.T, near.T), select(both, far.A, near.A)};
        }
        const Mask covered = uncovered == zero, empty = a == zero;
        const Mask changed = (near.T != one) | ((!covered) & (beyond.T != one));
        touched = touched | (changed & (iota<Batch>() < Batch(float(int(count)))));
        // L = color (a A + (1 - a) A_inf): the source is one colour.
        const Batch A = select(
            covered, near.A, select(empty, beyond.A, a * near.A + uncovered * beyond.A));
        for (int c = 0; c < 3; ++c) {
          const Batch S = get(run.S[c], i, count);
          put(run.C[c], i, count,
              select(changed, under(near.T, S) + Batch(m.color[c]) * A, S));
        }
        if (run.a_out)
          put(run.a_out, i, count,
              select(changed & (!covered), a + uncovered * beyond.A, a_in));
      });
  return any(touched);
}

bool uncovered(const SoleRun& run) noexcept {
  const Batch zero(0.f);
  Mask found = false;
  by_batch(
      run.n, [&](int i, auto count) __attribute__((always_inline)) {
        const Batch z = get(run.z, i, count);
        const Mask depth = (z > zero) & (z < Batch(run.depth.from));
        found = found | ((get(run.a, i, count) > zero) & !depth &
                         (iota<Batch>() < Batch(float(int(count)))));
      });
  return any(found);
}

}  // namespace

const SoleKernels sole_kernels = {apply, uncovered};

}  // namespace brume::pipeline::inline BRUME_ISA_NS
