#pragma once
// What the row kernels of the pipeline share: runs of any length, coverage, light under
// air. For kernel files.

#include "num/batch.h"

namespace brume::pipeline::inline BRUME_ISA_NS {

/// Batch::W as a type, so that the code for whole batches knows.
struct WholeBatch {
  BRUME_INLINE constexpr operator int() const { return Batch::W; }
};

/// Runs `f(i, count)` over n lanes: whole batches, then the rest as one padded batch;
/// bits of a lane are the same in either.
template <class F>
BRUME_INLINE void by_batch(int n, F&& f) {
  constexpr int W = Batch::W;
  int i = 0;
  for (; i + W <= n; i += W) f(i, WholeBatch{});
  if (i < n) f(i, n - i);
}

BRUME_INLINE Batch get(const float* p, int i, int count) {
  if (count == Batch::W) return load<Batch>(p + i);
  alignas(64) float lanes[Batch::W] = {};
  for (int k = 0; k < count; ++k) lanes[k] = p[i + k];
  return load<Batch>(lanes);
}

BRUME_INLINE void put(float* p, int i, int count, Batch x) {
  if (count == Batch::W) return store(p + i, x);
  alignas(64) float lanes[Batch::W];
  store(lanes, x);
  for (int k = 0; k < count; ++k) p[i + k] = lanes[k];
}

/// Coverage as the formulas take it.
BRUME_INLINE Batch coverage(Batch a) {
  return select(a == a, min(max(a, Batch(0.f)), Batch(1.f)), Batch(1.f));
}

/// T S, where T = 0 hides even an infinite S.
BRUME_INLINE Batch under(Batch T, Batch S) {
  return select(T == Batch(0.f), Batch(0.f), T * S);
}

}  // namespace brume::pipeline::inline BRUME_ISA_NS
