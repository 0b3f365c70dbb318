#pragma once
// Spans whose length is no multiple of a batch: how plugins, which get plain spans, read
// and write them.

#include "num/batch.h"

namespace brume::inline BRUME_ISA_NS {

/// p[i] to p[i + W - 1] of n values; beyond the last, the last again. 0 <= i < n.
inline Batch load_some(const float* p, int i, int n) {
  constexpr int W = Batch::W;
  if (i + W <= n) return load<Batch>(p + i);
  float copy[W];
  for (int k = 0; k < W; ++k) copy[k] = p[i + k < n ? i + k : n - 1];
  return load<Batch>(copy);
}

/// x to p[i] to p[i + W - 1], those of them that are before p[n].
inline void store_some(float* p, int i, int n, Batch x) {
  constexpr int W = Batch::W;
  if (i + W <= n) return store(p + i, x);
  float copy[W];
  store(copy, x);
  for (int k = 0; i + k < n; ++k) p[i + k] = copy[k];
}

}  // namespace brume::inline BRUME_ISA_NS
