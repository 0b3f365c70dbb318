#include "air/compose.h"

#include "num/batch.h"

namespace brume::air::inline BRUME_ISA_NS {
namespace {

// Where two media overlap without mattering to each other: in every channel at most one
// is there, or neither dims, or both add the same source per optical depth.
bool indifferent(const Medium& a, const Medium& b) {
  if (!a.closed || !b.closed) return false;
  for (int c = 0; c < 3; ++c) {
    const bool both =
        (a.sigma[c] > 0 || a.emission[c] != 0) && (b.sigma[c] > 0 || b.emission[c] != 0);
    const bool clear = !(a.sigma[c] > 0) && !(b.sigma[c] > 0);
    const bool alike = a.source == b.source && a.emission[c] == 0 && b.emission[c] == 0;
    if (both && !clear && !alike) return false;
  }
  return true;
}

void compose(const Layers& layers, int n, float* const T[3], float* const L[3],
             float* walk) noexcept {
  for (int i = 0; i < n; i += Batch::W) {
    Batch t[3] = {1.f, 1.f, 1.f}, sum[3] = {0.f, 0.f, 0.f}, walks(0.f);
    for (int k = 0; k < layers.k; ++k) {
      const Stretch& a = layers.at[k];
      const Batch lo = load<Batch>(a.lo + i), hi = load<Batch>(a.hi + i);
      const auto there = lo < hi;
      if (none(there)) continue;
      if (layers.open[k])
        walks = select(there, max(walks, load<Batch>(layers.open[k] + i)), walks);
      else if (!layers.media[k]->closed)
        walks = select(there, Batch(1.f), walks);
      // What lies before medium k, and whether anything lies in it.
      Batch before[3] = {1.f, 1.f, 1.f};
      for (int j = 0; j < layers.k; ++j) {
        if (j == k) continue;
        const Stretch& b = layers.at[j];
        const Batch lo_j = load<Batch>(b.lo + i), hi_j = load<Batch>(b.hi + i);
        const auto first = j < k ? lo_j <= lo : lo_j < lo;
        if (layers.media[j]->absorbs && any(first & there))
          for (int c = 0; c < 3; ++c)
            before[c] *= select(first, load<Batch>(b.T[c] + i), Batch(1.f));
        if (j < k && !indifferent(*layers.media[j], *layers.media[k]))
          walks = select(there & (lo_j < hi) & (lo < hi_j), Batch(1.f), walks);
      }
      for (int c = 0; c < 3; ++c) {
        t[c] *= load<Batch>(a.T[c] + i);
        const Batch part = before[c] * load<Batch>(a.L[c] + i);
        sum[c] += part;
        store(a.L[c] + i, part);
      }
    }
    for (int c = 0; c < 3; ++c) {
      store(T[c] + i, t[c]);
      store(L[c] + i, sum[c]);
    }
    store(walk + i, walks);
  }
}

}  // namespace

const ComposeKernels compose_kernels = {compose};

}  // namespace brume::air::inline BRUME_ISA_NS
