// Rows of pixels under air, once per instruction set. See composite.h.

#include "pipeline/composite.h"

#include "pipeline/lanes.h"

namespace brume::pipeline::inline BRUME_ISA_NS {
namespace {

bool composite(const CompositeRun& run) noexcept {
  const Batch one(1.f), zero(0.f);
  bool touched = false;
  by_batch(
      run.n, [&](int i, auto count) __attribute__((always_inline)) {
        const Batch a_in = run.a ? get(run.a, i, count) : one;
        const Batch a = coverage(a_in), uncovered = one - a;
        const Batch filled = !run.B[0]   ? zero
                             : run.fills ? get(run.fills, i, count)
                                         : one;
        Mask changed = (a < one) & (filled != zero);
        Batch T[3], L[3], sum_T_inf = zero;
        for (int c = 0; c < 3; ++c) {
          T[c] = get(run.T[c], i, count);
          const Batch L_d = get(run.L[c], i, count);
          Batch T_inf = T[c], beyond = L_d;
          if (run.T_inf[0]) {
            T_inf = get(run.T_inf[c], i, count);
            beyond = get(run.L_inf[c], i, count);
          }
          if (run.B[0]) beyond = beyond + under(T_inf, get(run.B[c], i, count));
          // Either side of the coverage is left out where it has no share, so that 0 x
          // inf cannot arise.
          L[c] = select(uncovered == zero, L_d,
                        select(a == zero, beyond, a * L_d + uncovered * beyond));
          sum_T_inf = sum_T_inf + T_inf;
          changed = changed | (T[c] != one) | (L[c] != zero) |
                    ((uncovered != zero) & (T_inf != one));
        }
        touched =
            touched ||
            any(changed & (iota<Batch>() < Batch(float(int(count)))));  // not the padding
        for (int c = 0; c < 3; ++c) {
          const Batch S = get(run.S[c], i, count);
          put(run.C[c], i, count, select(changed, under(T[c], S) + L[c], S));
          if (run.L_out[0]) put(run.L_out[c], i, count, L[c]);
        }
        if (run.a_out) {
          const Batch hidden = max(filled, one - sum_T_inf * Batch(1.f / 3.f));
          const Batch opaque = select(filled == one, one, a + uncovered * hidden);
          put(run.a_out, i, count, select(changed & (uncovered != zero), opaque, a_in));
        }
      });
  return touched;
}

void blend(int n, const float* before, const float* after, const float* w,
           float* out) noexcept {
  by_batch(
      n, [&](int i, auto count) __attribute__((always_inline)) {
        const Batch b = get(before, i, count), f = get(after, i, count),
                    u = get(w, i, count);
        put(out, i, count,
            select(u == Batch(0.f), b, select(u == Batch(1.f), f, b + u * (f - b))));
      });
}

void difference(int n, const float* after, const float* before, float* out) noexcept {
  by_batch(
      n, [&](int i, auto count) __attribute__((always_inline)) {
        const Batch more = get(after, i, count) - get(before, i, count);
        put(out, i, count, select(abs(more) < Batch(__builtin_inff()), more, Batch(0.f)));
      });
}

void weight(int n, const float* mask, float mix, float* w) noexcept {
  by_batch(
      n, [&](int i, auto count) __attribute__((always_inline)) {
        const Batch m = get(mask, i, count);
        put(w, i, count,
            select(m == m, min(max(m, Batch(0.f)), Batch(1.f)), Batch(0.f)) * Batch(mix));
      });
}

bool needs_infinity(int n, const float* a, const float* distance) noexcept {
  const Batch infinity(__builtin_inff());
  bool found = false;
  by_batch(
      n, [&](int i, auto count) __attribute__((always_inline)) {
        const Mask both = (coverage(get(a, i, count)) < Batch(1.f)) &
                          (get(distance, i, count) < infinity) &
                          (iota<Batch>() < Batch(float(int(count))));
        found = found || any(both);
      });
  return found;
}

}  // namespace

const CompositeKernels composite_kernels = {composite, blend, difference, weight,
                                            needs_infinity};

}  // namespace brume::pipeline::inline BRUME_ISA_NS
