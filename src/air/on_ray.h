#pragma once
// The media that a batch of rays meets: what the walk and the lamps have in common.

#include "air/along.h"

namespace brume::air::inline BRUME_ISA_NS {

/// One medium on a batch of rays.
struct OnRay {
  const Medium* m;
  Inside in;
  Along<Batch> p;
  Batch weight;
  Batch share[3];  ///< the light it has added
  Mask here;       ///< lanes where the piece at hand is inside

  BRUME_INLINE Mask at(Batch t) const {
    return (in.lo <= t) & (t < in.hi) & !((in.hole0 <= t) & (t < in.hole1));
  }
};

/// Fills `on` with those of k media that some ray of the batch meets; how many they are.
template <class R>  // an OnRay
int meet(int k, const Medium* const* media, const float* const* weights, const Rays& rays,
         int i, const Ray<Batch>& ray, R* on) {
  const Batch begin = rays.begin ? load<Batch>(rays.begin + i) : Batch(0.f);
  const Batch end = load<Batch>(rays.end + i);
  int n = 0;
  for (int j = 0; j < k; ++j) {
    R& r = on[n];
    r.m = media[j];
    r.weight = weights[j] ? load<Batch>(weights[j] + i) : Batch(1.f);
    r.p = along(*r.m, ray);
    r.in = inside(*r.m, r.p, ray, r.weight, begin, end);
    for (Batch& x : r.share) x = Batch(0.f);
    if (any(r.in.lo < r.in.hi)) ++n;
  }
  return n;
}

/// Adds their shares to the planes of all k media, or starts these.
template <class R>
void put_shares(const R* on, int n, int k, const Medium* const* media,
                const Stretch* share, int i, bool add) {
  for (int j = 0, a = 0; j < k; ++j) {
    const bool met = a < n && on[a].m == media[j];
    for (int c = 0; c < 3; ++c) {
      const Batch before = add ? load<Batch>(share[j].L[c] + i) : Batch(0.f);
      store(share[j].L[c] + i, met ? before + on[a].share[c] : before);
    }
    a += met;
  }
}

/// The nearest of what it is shown that lies beyond t.
struct Next {
  Batch t, end, next;

  BRUME_INLINE Next(Batch from, Batch to) : t(from), end(to), next(to) {}
  BRUME_INLINE void consider(Batch x) { next = min(next, select(x > t, x, end)); }
  BRUME_INLINE void consider(const Inside& in) {
    consider(in.lo);
    consider(in.hi);
    if (none(in.hole0 < Batch(kFar))) return;
    consider(in.hole0);
    consider(in.hole1);
  }
};

}  // namespace brume::air::inline BRUME_ISA_NS
