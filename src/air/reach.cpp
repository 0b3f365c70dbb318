// Where a capped medium ends that has no inverse: along.h.

#include "air/along.h"

namespace brume::air::inline BRUME_ISA_NS {

// Two places are kept, one before it and one behind, and between them false position in
// ln D against ln t, which a power of t solves at once; the Illinois rule (Dowell &
// Jarratt 1971) lets both close in. First where D would be reached if density stayed what
// it is at lo; every third time halfway between the bits of the two, which floats order
// as integers do: 100 steps are enough whatever the profile.
//   Integrals may be dear and are asked for n rays at once: a lane that is done, or that
// has no such place, asks for nothing; and none asks beyond its `end`.
Batch sought_reach(const Medium& m, const Along<Batch>& p, const Ray<Batch>& ray,
                   Batch lo, Batch D, Batch end) {
  const Batch zero(0.f), far(kFar), half(0.5f), tiny(1e-37f);
  const Batch begin = lo + zero;  // not -0
  const auto part = [&](Batch t) { return min(integral(m, p, ray, begin, t) / D, far); };
  const Batch most = part(max(begin, end));
  const auto somewhere = (most >= Batch(1.f)) & (begin < end);
  if (none(somewhere)) return far;
  // a before, b behind, and what has been reached there: ln of its part of D.
  Batch a = begin, ln_a = -far, b = end, ln_b = log(most);
  Batch c = begin + D / max(density(m, p, ray, begin), tiny);
  auto last_before = somewhere;
  for (int step = 0; step < 100; ++step) {
    const IntBatch low = bits(a), room = bits(b) - low, one(1u);
    const auto open = somewhere & (value(low + IntBatch(4u)) < b);
    if (none(open)) break;
    const Batch middle = value(low + (room >> 1));
    const Batch wanted = step % 3 == 2 ? middle : select(c == c, c, middle);
    c = select(open, clamp(wanted, value(low + one), value(low + room - one)), begin);
    const Batch x = part(c), ln_c = log(max(x, tiny));
    const auto before = open & (x < Batch(1.f)), behind = open & (x >= Batch(1.f));
    if (step > 0) {
      ln_b = select(before & last_before, half * ln_b, ln_b);
      ln_a = select(behind & (!last_before), half * ln_a, ln_a);
    }
    last_before = before;
    a = select(before, c, a);
    ln_a = select(before, ln_c, ln_a);
    b = select(behind, c, b);
    ln_b = select(behind, ln_c, ln_b);
    const Batch from_a = a - begin, from_b = b - begin;
    const Batch way = log(from_b / max(from_a, tiny));
    c = begin +
        select(a > begin, from_a * exp(ln_a / (ln_a - ln_b) * way), from_b * exp(-ln_b));
  }
  return select(somewhere, b, far);
}

}  // namespace brume::air::inline BRUME_ISA_NS
