#pragma once
// The glow that has a closed form: a lamp that shines evenly in uniform media that
// scatter evenly (Light::closed), on rays where they all begin and end together. Shapes
// are convex and hold the lamp, so that every way to it lies in the media too.

#include "air/airlight.h"
#include "air/lamp_rays.h"

namespace brume::air::inline BRUME_ISA_NS {

/// Adds the lamp's light to L and to the media's shares on the rays that have a closed
/// form; which they are, those that meet nothing among them.
inline Mask add_closed(const LampRays& g, Batch L[3]) {
  const Batch zero(0.f), one(1.f);
  Batch lo(kFar), hi(kFar), s[3] = {zero, zero, zero}, met = zero;
  Mask closed(true);
  for (int j = 0; j < g.k; ++j) {  // what other rays meet is nothing to this one
    const Lit& r = g.on[j];
    if (!r.m->absorbs) continue;
    const auto meets = r.in.lo < r.in.hi, first = meets & (met == zero);
    met += select(meets, one, zero);
    lo = select(first, r.in.lo, lo);
    hi = select(first, r.in.hi, hi);
    auto fits = (r.in.lo == lo) & (r.in.hi == hi);
    // A stage's weight belongs to the way to the eye alone.
    if (g.lamp.attenuated) fits = fits & (r.weight == one);
    closed = closed & (fits | !meets);
    for (int c = 0; c < 3; ++c)
      s[c] += select(meets, r.weight * Batch(r.m->sigma[c]), zero);
  }
  // One that the ray does not meet is still on the lamp's way.
  if (g.lamp.attenuated)
    closed = closed & (met == Batch(static_cast<float>(g.world.absorbers.size)));
  // Farther away no square is a float: left to the rule.
  closed = closed & (g.f.h2 < Batch(1e36f)) & (abs(g.f.t) < Batch(1e18f));
  const auto there = lo < hi;
  const Batch x = lo - g.f.t, end = hi - g.f.t;
  if (g.lamp.radius2 > 0) {  // within the lamp's radius light grows no more
    const Batch within = sqrt(max(Batch(g.lamp.radius2) - g.f.h2, zero));
    closed = closed & !((within > zero) & (x < within) & (end > -within));
  }
  const auto sees = sight(g.f.h, x, end, hi - lo);
  if (!g.lamp.attenuated)
    closed = closed & clear_leg_is_closed(max(s[0], max(s[1], s[2])), sees);
  closed = closed | !there;
  if (none(closed & there)) return closed;

  Batch I = zero;  // per unit of power and scattering
  for (int c = 0; c < 3; ++c) {
    const Batch sc = max(s[c], Batch(1e-30f));
    if (c == 0 || any(s[c] != s[c - 1]))
      I = g.lamp.attenuated ? airlight(sc, sees) : airlight_of_clear_leg(sc, sees);
    for (int j = 0; j < g.k; ++j) {
      Lit& r = g.on[j];
      if (!r.m->glows_by_lamp) continue;
      const float even = static_cast<float>(1 / (4 * kPi));
      const Batch rate = r.weight * Batch(even * r.m->sigma[c] * r.m->albedo[c]);
      const Batch part = select(
          closed & there & (r.in.lo < r.in.hi),
          min(rate * min(I, Batch(kFar)) * Batch(g.lamp.power[c]), Batch(kFar)), zero);
      L[c] += part;
      r.share[c] += part;
    }
  }
  return closed;
}

}  // namespace brume::air::inline BRUME_ISA_NS
