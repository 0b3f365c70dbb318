#pragma once
// A lamp's glow by quadrature. Pieces end at the foot, at every boundary of a medium, at
// the lamp's own sphere, at the edges of a spotlight's cone and of shadows, and are no
// deeper than a rule can see; each is a Kronrod rule whose error its embedded Gauss rule
// tells, and what no node sees the depths between them.

#include "air/lamp_shadows.h"
#include "air/lamp_spend.h"

namespace brume::air::inline BRUME_ISA_NS {

using B = Batch;

constexpr int kPieces = 600;  // and one for each shadow's edge
constexpr float kDeep = 20;   // optical depth of a piece at most
constexpr float kBlack =
    85;  // what no lamp shines through: e^-85 is about the least float

/// Where pieces end, apart from where the rule wants them to.
struct Cuts {
  Batch begin = B(kFar), end = B(0.f);  // of all that glows
  Batch edge[6];                        // of its sphere, of its cone
  int edges = 0;

  explicit Cuts(const LampRays& g) {
    for (int j = 0; j < g.k; ++j) {
      const Inside& in = g.on[j].in;
      if (!g.on[j].m->glows_by_lamp) continue;
      begin = min(begin, in.lo);
      end = max(end, select(in.lo < in.hi, in.hi, B(0.f)));
    }
    const auto enters = g.f.h2 < B(g.lamp.radius2);
    if (any(enters)) {
      const Batch half = sqrt(max(B(g.lamp.radius2) - g.f.h2, B(0.f)));
      edge[edges++] = select(enters, g.f.t - half, B(kFar));
      edge[edges++] = select(enters, g.f.t + half, B(kFar));
    }
    if (g.lamp.kind != BRUME_SPOT) return;
    cone_crossings(g.lamp, g.f, g.ray, g.lamp.sin2_cone, edge + edges);
    cone_crossings(g.lamp, g.f, g.ray, g.lamp.sin2_inner, edge + edges + 2);
    edges += 4;
  }
  BRUME_INLINE Batch after(const LampRays& g, const LampShadows& shadows, Batch t) const {
    Next next(t, end);
    next.consider(g.f.t);
    shadows.put_into(next);
    for (int j = 0; j < g.k; ++j) next.consider(g.on[j].in);
    for (int j = 0; j < edges; ++j) next.consider(edge[j]);
    return next.next;
  }
};

// The most radiance that a point 1 m from the lamp can scatter, of the media on a ray.
inline Batch brightest(const LampRays& g) {
  Batch most(0.f);
  for (int j = 0; j < g.k; ++j) {
    const Medium& m = *g.on[j].m;
    const float a = m.g < 0 ? -m.g : m.g;
    float own = 0;
    for (int c = 0; c < 3; ++c)
      own = max(own, m.albedo[c] * g.lamp.power[c] * (1 + a) / ((1 - a) * (1 - a)));
    most = select(g.on[j].in.lo < g.on[j].in.hi, max(most, B(own)), most);
  }
  return most;
}

/// How a piece came out, over what is allowed: its error, and what no node saw.
struct Judged {
  B error = B(1e-30f), unseen = B(1e-30f);

  Judged(const LampRays& g, const LampPiece& piece, const Sums& s, const B L[3],
         const B before[3]) {
    for (int c = 0; c < 3; ++c) {
      const B K = s.kronrod[c], delta = abs(K - s.gauss[c]);
      // Gauss's error is ~ q^14, Kronrod's ~ q^23.
      const B off = delta * min(B(1.f), B(20.f) * delta / max(abs(K), B(1e-30f)));
      const B seen =
          max(abs(K), max(B(0.3f) * abs(L[c] - before[c]), B(0.1f * g.world.scale)));
      const B allowed = max(B(0.25f * g.world.tolerance) * seen, B(1e-30f));
      const auto lit = piece.tau_a[c] < B(kBlack);
      error = max(error, select(lit, off / allowed, B(0.f)));
      unseen = max(unseen, select(lit, s.unseen[c] / allowed, B(0.f)));
    }
  }
};

/// The lamp's light on the rays of `open`, piece by piece from the eye outward.
class ByAngle {
 public:
  ByAngle(const LampRays& g, Mask open, B L[3])
      : g_(g),
        by_(g.f),
        cuts_(g),
        shadows_(g, cuts_.begin, cuts_.end),
        end_(select(open, cuts_.end, B(0.f))),
        most_(brightest(g)),
        before_{L[0], L[1], L[2]},
        L_(L) {}

  void add() {
    piece_.within = Mask(false);
    begin_at(cuts_.begin);
    const int most_pieces = kPieces + shadows_.count();
    for (int step = 0; step < most_pieces; ++step) {
      skip_dark();
      const auto going = still_to_come();
      if (none(going)) return;
      find_end(going);
      for (int j = 0; j < g_.k; ++j) g_.on[j].here = g_.on[j].at(piece_.a);
      take(going, rule(g_, by_, piece_, going), step > most_pieces - 100);
    }
  }

 private:
  void begin_at(B t) {
    piece_.a = t;
    g_.depth_before(t, piece_.tau_a);
    for (int j = 0; j < g_.k; ++j) g_.on[j].D_a = g_.on[j].D_b;
  }

  BRUME_INLINE B w(B t) const {
    return select(t >= B(kMaxLength), B(0.f), by_.w(t - g_.f.t));
  }

  // From a to b, all of it on one side of every cut.
  LampPiece between(B a, B b) const {
    LampPiece p = {a, b, w(a), w(b), select(a < g_.f.t, B(-1.f), B(1.f)), {}, {}, {}};
    const B x = a + B(0.5f) * (b - a) - g_.f.t;
    p.within = x * x + g_.f.h2 < B(g_.lamp.radius2);
    return p;
  }

  // A piece that a spotlight does not reach in its middle it reaches nowhere.
  void skip_dark() {
    if (g_.lamp.kind != BRUME_SPOT) return;
    Mask moved(false);
    B t = piece_.a;
    for (int i = 0; i < 12; ++i) {
      const LampPiece p = between(t, cuts_.after(g_, shadows_, t));
      const B x = p.middle(g_.f, by_) - g_.f.t;
      const auto dark = (t < end_) & (leg_from(g_.lamp, g_.f, g_.ray, x).fall <= B(0.f));
      if (none(dark)) break;
      t = select(dark, p.b, t);
      moved = moved | dark;
    }
    if (any(moved)) begin_at(t);
  }

  // What is still to come is at most the brightest there is, at the least distance from
  // the lamp, seen through what lies before, since Int sigma e^-tau <= 1.
  Mask still_to_come() const {
    const B thinnest = min(piece_.tau_a[0], min(piece_.tau_a[1], piece_.tau_a[2]));
    const B x = max(piece_.a - g_.f.t, B(0.f));
    const B rest = exp(-thinnest) * most_ / max(x * x + g_.f.h2, B(g_.lamp.near2));
    const B known = min(L_[0] - before_[0], min(L_[1] - before_[1], L_[2] - before_[2]));
    const B little = B(0.02f * g_.world.tolerance) * max(known, B(0.1f * g_.world.scale));
    return (piece_.a < end_) & (thinnest < B(kBlack)) & (rest > little);
  }

  // Of the piece, as H_, in what the rule goes by.
  BRUME_INLINE B size() const {
    return abs(piece_.to_q(piece_.w_b) - piece_.to_q(piece_.w_a));
  }

  // The piece is no longer than what was found good, and no deeper than a rule can see.
  void find_end(Mask going) {
    const B t = piece_.a, zero(0.f), next = cuts_.after(g_, shadows_, t);
    const LampPiece to_cut = between(t, next);
    const auto other =
        (to_cut.within & !piece_.within) | (piece_.within & !to_cut.within);
    H_ = select(other, B(kFar), H_);
    piece_.within = to_cut.within, piece_.side = to_cut.side, piece_.w_a = to_cut.w_a;
    const B q_a = to_cut.to_q(to_cut.w_a), span = to_cut.to_q(to_cut.w_b) - q_a;
    // However it rounds, a piece goes on by what a float can tell at the lamp's distance,
    // and ends where the next begins.
    const B least = max(B(2.4e-7f) * t, B(1e-7f) * (abs(t - g_.f.t) + by_.width));
    for (int again = 0; again < 100; ++again) {
      whole_ = abs(span) <= H_;
      const B w_to = piece_.to_w(q_a + select(span < zero, -H_, H_));
      const B on = max(g_.f.t + by_.x(w_to, piece_.side), t + least);
      piece_.b = select(going, select(whole_, next, min(on, next)), t);
      piece_.w_b = select(piece_.b < next, w(piece_.b), to_cut.w_b);
      g_.depth_before(piece_.b, piece_.tau_b);
      B deepest(1e-30f);
      for (int c = 0; c < 3; ++c)
        deepest = max(deepest, select(piece_.tau_a[c] < B(kBlack),
                                      piece_.tau_b[c] - piece_.tau_a[c], zero));
      tiny_ = tiny(B(1.1f) * least);
      const auto deep = going & (deepest > B(kDeep)) & !tiny_;
      if (none(deep)) return;
      const B shorter = clamp(B(0.8f * kDeep) / deepest, B(1e-5f), B(0.5f));
      H_ = select(deep, size() * shorter, H_);
    }
  }

  // An angle is small as the lamp is far: by itself it says nothing. A logarithm of 30 is
  // known to 2e-6.
  BRUME_INLINE Mask tiny(B least) const {
    const B angle = select(piece_.within, B(1e-5f), B(1e-6f));
    return (abs(piece_.w_b - piece_.w_a) <= angle * max(piece_.w_a, piece_.w_b)) |
           (piece_.b - piece_.a <= max(B(1e-6f) * piece_.a, least));
  }

  // Taken, or tried again shorter; the last ones as they are, each twice as long as the
  // one before.
  void take(Mask going, Sums s, bool last) {
    const B zero(0.f), width = size();
    const Judged j(g_, piece_, s, L_, before_);
    B deepest(0.f);
    for (int c = 0; c < 3; ++c) deepest = max(deepest, piece_.tau_b[c] - piece_.tau_a[c]);
    const auto good = (j.error <= B(1.f)) & (j.unseen <= B(1.f));
    const auto accept = going & (good | tiny_ | Mask(last));
    // Where the rule is no good any more, or its nodes are rounded to where no light is.
    const auto at_once =
        accept & tiny_ & ((deepest > B(1.f)) | ((deepest > B(0.1f)) & !good));
    if (any(at_once)) spend(g_, piece_.a, piece_.tau_a, piece_.tau_b, at_once, s);
    for (int c = 0; c < 3; ++c) {
      // Nothing comes through what is black, wherever the nodes are rounded to.
      const auto seen = accept & (piece_.tau_a[c] < B(kBlack));
      L_[c] += select(seen, s.kronrod[c], zero);
      piece_.tau_a[c] = select(accept, piece_.tau_b[c], piece_.tau_a[c]);
      for (int i = 0; i < g_.k; ++i)
        g_.on[i].share[c] += select(seen, g_.on[i].piece[c], zero);
    }
    for (int i = 0; i < g_.k; ++i)
      g_.on[i].D_a = select(accept, g_.on[i].D_b, g_.on[i].D_a);
    const B factor = clamp(exp(B(-0.1f) * log(j.error)), B(0.2f), B(3.f));
    const B shorter = min(B(0.5f), select(j.unseen > B(1.f), B(0.25f), factor));
    H_ = select(accept,
                max(select(whole_, H_, zero), width * max(factor, B(last ? 2.f : 1.f))),
                width * shorter);
    piece_.a = select(accept, piece_.b, piece_.a);
  }

  const LampRays& g_;
  const HalfAngle by_;
  const Cuts cuts_;
  const LampShadows shadows_;
  const B end_, most_, before_[3];
  B* const L_;
  LampPiece piece_;
  B H_ = B(kFar);
  Mask whole_ = Mask(false), tiny_ = Mask(false);
};

}  // namespace brume::air::inline BRUME_ISA_NS
