#include "air/compose.h"

#include "num/batch.h"

namespace brume::air::inline BRUME_ISA_NS {
namespace {

// Whether they all only shine: nothing to look for.
bool all_clear(const Layers& layers) {
  for (int k = 0; k < layers.k; ++k)
    if (!layers.media[k]->closed || layers.media[k]->absorbs) return false;
  return true;
}

/// What a batch of rays has gathered, from the eye outward.
struct Gathered {
  Batch t[3] = {1.f, 1.f, 1.f}, sum[3] = {0.f, 0.f, 0.f};

  // One more medium, in these lanes; elsewhere T = 1 and L = 0. Fused by name: the
  // compiler's own choice might differ from place to place, and bits with it.
  BRUME_INLINE void add(const Batch T[3], const Batch L[3]) {
    for (int c = 0; c < 3; ++c) {
      sum[c] = fused(t[c], L[c], sum[c]);
      t[c] *= T[c];
    }
  }
};

// Those of the layers that some ray of the batch meets, by where the first of its rays
// does; equal ones in their own order. `order` begins as the last batch left it, which is
// nearly that. How many.
int sorted(const Layers& layers, int i) {
  int n = 0;
  for (int p = 0; p < layers.k; ++p) {
    const int k = layers.order[p];
    const Stretch& a = layers.at[k];
    const Batch lo = load<Batch>(a.lo + i), hi = load<Batch>(a.hi + i);
    if (none(lo < hi)) continue;
    const float key = lowest(select(lo < hi, lo, Batch(3e38f)));
    layers.order[p] = layers.order[n];  // they stay a permutation
    int at = n++;
    for (; at > 0 && (layers.key[at - 1] > key ||
                      (layers.key[at - 1] == key && layers.order[at - 1] > k));
         --at) {
      layers.key[at] = layers.key[at - 1];
      layers.order[at] = layers.order[at - 1];
    }
    layers.key[at] = key;
    layers.order[at] = k;
  }
  return n;
}

// Whether all rays meet them in that order, and where some overlap.
bool in_order(const Layers& layers, int n, int i, Mask& overlap) {
  Batch last(-1.f), end(0.f);
  Mask wrong(false);
  int highest_before = -1;
  overlap = Mask(false);
  for (int p = 0; p < n; ++p) {
    const int k = layers.order[p];
    const Batch lo = load<Batch>(layers.at[k].lo + i),
                hi = load<Batch>(layers.at[k].hi + i);
    const auto there = lo < hi;
    wrong = wrong | (there & (k > highest_before ? lo < last : lo <= last));
    overlap = overlap | (there & (lo < end));
    last = select(there, max(last, lo), last);
    end = select(there, max(end, hi), end);
    highest_before = k > highest_before ? k : highest_before;
  }
  return none(wrong);
}

// Lanes where media overlap that matter to each other, among the first n in `order`.
Mask mixed(const Layers& layers, int n, int i) {
  Mask found(false);
  for (int p = 1; p < n; ++p)
    for (int q = 0; q < p; ++q) {
      const Stretch &a = layers.at[layers.order[p]], &b = layers.at[layers.order[q]];
      const Batch lo_a = load<Batch>(a.lo + i), hi_a = load<Batch>(a.hi + i),
                  lo_b = load<Batch>(b.lo + i), hi_b = load<Batch>(b.hi + i);
      const auto both = (lo_a < hi_a) & (lo_b < hi_b) & (lo_b < hi_a) & (lo_a < hi_b);
      if (any(both) &&
          !indifferent(*layers.media[layers.order[p]], *layers.media[layers.order[q]]))
        found = found | both;
    }
  return found;
}

BRUME_INLINE void read(const Stretch& a, int i, Batch T[3], Batch L[3]) {
  for (int c = 0; c < 3; ++c) {
    T[c] = load<Batch>(a.T[c] + i);
    L[c] = load<Batch>(a.L[c] + i);
  }
}

void in_common_order(const Layers& layers, int n, int i, float* const T[3],
                     float* const L[3]) {
#pragma GCC unroll 3
  for (int c = 0; c < 3; ++c) {
    Batch t(1.f), sum(0.f);
    for (int p = 0; p < n; ++p) {
      const Stretch& a = layers.at[layers.order[p]];
      const Batch L_k = load<Batch>(a.L[c] + i);
      if (layers.shares) store(a.L[c] + i, t * L_k);
      sum = fused(t, L_k, sum);
      t *= load<Batch>(a.T[c] + i);
    }
    store(T[c] + i, t);
    store(L[c] + i, sum);
  }
}

// Every lane in an order of its own: the next of each is sought among all.
void in_own_orders(const Layers& layers, int n, int i, float* const T_out[3],
                   float* const L_out[3]) {
  Gathered g;
  Batch last(-1.f), last_k(-1.f);
  for (int rank = 0; rank < n; ++rank) {
    Batch next(3e38f), next_k(-1.f), T[3] = {1.f, 1.f, 1.f}, L[3] = {0.f, 0.f, 0.f};
    for (int p = 0; p < n; ++p) {
      const int k = layers.order[p];
      const Stretch& a = layers.at[k];
      const Batch lo = load<Batch>(a.lo + i), own = Batch(float(k));
      const auto there = lo < load<Batch>(a.hi + i);
      const auto later = (lo > last) | ((lo == last) & (own > last_k));
      const auto sooner = (lo < next) | ((lo == next) & (own < next_k));
      const auto best = there & later & sooner;
      if (none(best)) continue;
      Batch T_a[3], L_a[3];
      read(a, i, T_a, L_a);
      for (int c = 0; c < 3; ++c) {
        T[c] = select(best, T_a[c], T[c]);
        L[c] = select(best, L_a[c], L[c]);
      }
      next = select(best, lo, next);
      next_k = select(best, own, next_k);
    }
    if (layers.shares)
      for (int p = 0; p < n; ++p) {
        const int k = layers.order[p];
        const auto own = next_k == Batch(float(k));
        for (int c = 0; any(own) && c < 3; ++c) {
          float* share = layers.at[k].L[c] + i;
          store(share, select(own, g.t[c] * L[c], load<Batch>(share)));
        }
      }
    g.add(T, L);
    const auto found = next_k >= Batch(0.f);
    last = select(found, next, Batch(3e38f));
    last_k = select(found, next_k, Batch(3e38f));
  }
  for (int c = 0; c < 3; ++c) {
    store(T_out[c] + i, g.t[c]);
    store(L_out[c] + i, g.sum[c]);
  }
}

// Any number of layers: in the last batch's order where it met them all and that still
// does, else sorted for the batch, or lane by lane. Returns where some overlap that
// matter to each other.
Mask compose_all(const Layers& layers, int i, bool clear, int& met, float* const T[3],
                 float* const L[3]) {
  Mask overlap;
  bool common = met == layers.k && in_order(layers, met, i, overlap);
  if (!common) {
    met = sorted(layers, i);
    common = in_order(layers, met, i, overlap);
  }
  common ? in_common_order(layers, met, i, T, L) : in_own_orders(layers, met, i, T, L);
  if (clear || (common && none(overlap))) return Mask(false);
  return mixed(layers, met, i);
}

// Two need no order: in each lane the one that begins first (of two alike the first)
// stands before the other. The same bits as above. Returns where they overlap.
BRUME_INLINE Mask compose_two(const Layers& layers, int i, float* const T[3],
                              float* const L[3]) {
  const Stretch &a = layers.at[0], &b = layers.at[1];
  const Batch lo_a = load<Batch>(a.lo + i), hi_a = load<Batch>(a.hi + i),
              lo_b = load<Batch>(b.lo + i), hi_b = load<Batch>(b.hi + i);
  const auto b_first = lo_b < lo_a;  // what is nowhere begins at kFar
#pragma GCC unroll 3
  for (int c = 0; c < 3; ++c) {
    const Batch T_a = load<Batch>(a.T[c] + i), T_b = load<Batch>(b.T[c] + i);
    const Batch L_a = load<Batch>(a.L[c] + i), L_b = load<Batch>(b.L[c] + i);
    store(T[c] + i, T_a * T_b);
    store(L[c] + i, fused(select(b_first, T_b, T_a), select(b_first, L_a, L_b),
                          select(b_first, L_b, L_a)));
    if (!layers.shares) continue;
    store(a.L[c] + i, select(b_first, T_b * L_a, L_a));
    store(b.L[c] + i, select(b_first, L_b, T_a * L_b));
  }
  return (lo_a < hi_a) & (lo_b < hi_b) & (lo_b < hi_a) & (lo_a < hi_b);
}

// Whether it knows its own T and L.
bool answers(const Medium& m) { return m.closed || m.alone; }

// Media that no closed form answers for have to be walked wherever they are.
Batch not_closed(const Layers& layers, int i, Batch walks) {
  for (int k = 0; k < layers.k; ++k) {
    if (answers(*layers.media[k])) continue;
    const Stretch& a = layers.at[k];
    const auto there = load<Batch>(a.lo + i) < load<Batch>(a.hi + i);
    walks = select(there, Batch(1.f), walks);
  }
  return walks;
}

bool compose(const Layers& layers, int n, float* const T[3], float* const L[3],
             float* walk) noexcept {
  const bool clear = all_clear(layers);
  const bool two = layers.k == 2,
             alike = two && indifferent(*layers.media[0], *layers.media[1]);
  bool some = false, all_answer = true;
  int met = layers.k;  // in their own order at first
  for (int k = 0; k < layers.k; ++k) {
    layers.order[k] = k;
    all_answer = all_answer && answers(*layers.media[k]);
  }
  for (int i = 0; i < n; i += Batch::W) {
    const Mask mix =
        two ? compose_two(layers, i, T, L) : compose_all(layers, i, clear, met, T, L);
    Batch walks(0.f);
    if (!clear && !alike) walks = select(mix, Batch(1.f), walks);
    if (!all_answer) walks = not_closed(layers, i, walks);
    store(walk + i, walks);
    some = some || any(walks != Batch(0.f));
  }
  return some;
}

}  // namespace

const ComposeKernels compose_kernels = {compose};

}  // namespace brume::air::inline BRUME_ISA_NS
