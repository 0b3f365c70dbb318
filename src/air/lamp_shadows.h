#pragma once
// Where a ray passes through the shadow that a bounded medium throws in a lamp's light.
// Light along the ray has a kink at either end; the lamps' walk cuts there, so that no
// shadow falls between its nodes.

#include "air/lamp_rays.h"

namespace brume::air::inline BRUME_ISA_NS {

/// Cuts of a ray by the shadows of bodies, up to kMost of them (some hundred shadows); of
/// more the rule's own error tells. To look through them costs far less than the ways to
/// the lamp, which ask each body at every node.
class LampShadows {
 public:
  LampShadows(const LampRays& g, Batch begin, Batch end) : begin_(begin), end_(end) {
    if (!g.lamp.attenuated) return;
    for (const Medium* m : g.world.casters) {
      if (count_ + kMostOfOne > kMost) return;
      const Local l(*m, g);
      float far = 0;  // of the lamp from the middle: within the body it throws no shadow
      for (const float p : l.p)
        far = m->shape == BRUME_BOX ? max(far, p < 0 ? -p : p) : far + p * p;
      if (far <= 1) continue;
      if (m->shape == BRUME_BOX)
        add_edges(l);
      else
        add_tangents(l);
    }
  }

  BRUME_INLINE int count() const { return count_; }
  BRUME_INLINE void put_into(Next& next) const {
    for (int i = 0; i < count_; ++i) next.consider(at_[i]);
  }

 private:
  static constexpr int kMostOfOne = 12, kMost = 384;

  // Rays x = o + t d and lamp p in the body's own coordinates; u = p - x.
  struct Local {
    Batch o[3], d[3];
    float p[3];

    Local(const Medium& m, const LampRays& g) {
      for (int i = 0; i < 3; ++i) {
        const Batch row[3] = {m.A[3 * i], m.A[3 * i + 1], m.A[3 * i + 2]};
        o[i] = Batch(m.b[i]);
        if (!g.ray.from_eye) o[i] += dot(row, g.ray.o);
        d[i] = dot(row, g.ray.d);
        p[i] = m.b[i];
        for (int c = 0; c < 3; ++c) p[i] += m.A[3 * i + c] * g.lamp.position[c];
      }
    }
  };

  // Where the way to the lamp meets an edge, a + s e with |s| <= 1, before the lamp: x -
  // a and p - a are parallel across e.
  void add_edges(const Local& l) {
    const Batch zero(0.f), one(1.f);
    for (int axis = 0; axis < 3; ++axis) {
      const int j = (axis + 1) % 3, k = (axis + 2) % 3;
      for (int corner = 0; corner < 4; ++corner) {
        const float aj = corner & 1 ? 1.f : -1.f, ak = corner & 2 ? 1.f : -1.f;
        const Batch pj(l.p[j] - aj), pk(l.p[k] - ak);
        const Batch t = ((l.o[k] - Batch(ak)) * pj - (l.o[j] - Batch(aj)) * pk) /
                        (l.d[j] * pk - l.d[k] * pj);
        const Batch xj = l.o[j] + t * l.d[j], xk = l.o[k] + t * l.d[k],
                    x = l.o[axis] + t * l.d[axis];
        const Batch uj = Batch(l.p[j]) - xj, uk = Batch(l.p[k]) - xk;
        const Batch part =
            ((Batch(aj) - xj) * uj + (Batch(ak) - xk) * uk) / (uj * uj + uk * uk);
        const Batch s = x + part * (Batch(l.p[axis]) - x);
        put(t, (part >= zero) & (part <= one) & (abs(s) <= one));
      }
    }
  }

  // Where the way to the lamp touches the unit ball before the lamp: |x cross p|^2 =
  // |p - x|^2, quadratic in t.
  void add_tangents(const Local& l) {
    Batch c0[3], c1[3], u0[3];
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      c0[i] = l.o[j] * Batch(l.p[k]) - l.o[k] * Batch(l.p[j]);
      c1[i] = l.d[j] * Batch(l.p[k]) - l.d[k] * Batch(l.p[j]);
      u0[i] = Batch(l.p[i]) - l.o[i];
    }
    const Batch a = dot(c1, c1) - dot(l.d, l.d), b = dot(c0, c1) + dot(u0, l.d),
                c = dot(c0, c0) - dot(u0, u0);
    const Batch root = sqrt(max(b * b - a * c, Batch(0.f)));
    const Batch q = select(b < Batch(0.f), root - b, -(root + b));
    for (const Batch t : {q / a, c / q}) {
      Batch xu(0.f), uu(0.f);
      for (int i = 0; i < 3; ++i) {
        const Batch x = l.o[i] + t * l.d[i], u = Batch(l.p[i]) - x;
        xu += x * u;
        uu += u * u;
      }
      put(t, (-xu >= Batch(0.f)) & (-xu <= uu) & (b * b >= a * c));
    }
  }

  BRUME_INLINE void put(Batch t, Mask there) {
    const auto here = there & (t > begin_) & (t < end_);
    if (any(here)) at_[count_++] = select(here, t, Batch(kFar));
  }

  Batch begin_, end_, at_[kMost];
  int count_ = 0;
};

}  // namespace brume::air::inline BRUME_ISA_NS
