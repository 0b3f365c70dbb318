#include "air/lamps.h"

#include "air/lamp_closed.h"
#include "air/lamp_shadows.h"
#include "air/lamp_spend.h"

// One lamp at a time: in closed form where there is one, else by quadrature. Pieces end
// at the foot, at every boundary of a medium, at the lamp's own sphere, at the edges of
// a spotlight's cone and of shadows, and are no deeper than a rule can see; each is a
// Kronrod rule whose error its embedded Gauss rule tells.

namespace brume::air::inline BRUME_ISA_NS {
namespace {

using B = Batch;

constexpr int kPieces = 600;     // and one for each shadow's edge
constexpr float kDeep = 20;      // optical depth of a piece at most
constexpr float kFirstDeep = 1;  // and that before its first node: what none sees
constexpr float kBlack = 40;

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
Batch brightest(const LampRays& g) {
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

/// How a piece came out: its error over what is allowed, its optical depth, and that
/// before its first node, or beyond its last where the lamp may still show.
struct Judged {
  Batch worst = B(1e-30f), deepest = B(1e-30f), unseen = B(1e-30f);

  Judged(const LampRays& g, Batch most, const Sums& s, const Batch L[3],
         const Batch before[3], const Batch tau_a[3], const Batch tau_b[3]) {
    const Compiled& world = g.world;
    const Batch beyond = most / max(s.last_r2, B(g.lamp.near2));
    const Batch zero(0.f);
    for (int c = 0; c < 3; ++c) {
      const Batch K = s.kronrod[c], delta = abs(K - s.gauss[c]);
      // Gauss's error is ~ q^14, Kronrod's ~ q^23.
      const Batch error = delta * min(B(1.f), B(20.f) * delta / max(abs(K), B(1e-30f)));
      const Batch seen =
          max(abs(K), max(B(0.3f) * abs(L[c] - before[c]), B(0.1f * world.scale)));
      const Batch allowed = B(0.25f * world.tolerance) * seen;
      const auto lit = tau_a[c] < B(kBlack);
      worst = max(worst, select(lit, error / max(allowed, B(1e-30f)), zero));
      deepest = max(deepest, select(lit, tau_b[c] - tau_a[c], zero));
      unseen = max(unseen, select(lit, s.first[c] - tau_a[c], zero));
      const auto shows = lit & (beyond * exp(-s.last[c]) > allowed);
      unseen = max(unseen, select(shows, tau_b[c] - s.last[c], zero));
    }
  }
};

// The lamp's light on the rays of `open`, piece by piece from the eye outward.
void add_by_angle(const LampRays& g, Mask open, Batch L[3]) {
  const Batch zero(0.f);
  const Foot& f = g.f;
  const Angle angle(g.lamp, f);
  const Cuts cuts(g);
  const LampShadows shadows(g, cuts.begin, cuts.end);
  const Batch end = select(open, cuts.end, zero);
  const B most = brightest(g);
  const Batch before[3] = {L[0], L[1], L[2]};
  Batch t = cuts.begin, H(2.f), tau_a[3], tau_b[3];
  g.depth_before(t, tau_a);

  const int most_pieces = kPieces + shadows.count();
  for (int step = 0; step < most_pieces; ++step) {
    const Batch thinnest = min(tau_a[0], min(tau_a[1], tau_a[2]));
    auto going = (t < end) & (thinnest < B(kBlack));
    // Beyond the foot the lamp only fades: what is still to come is at most brightest /
    // r^2 seen through what lies before, since Int sigma e^-tau <= 1.
    const Batch x = t - f.t;
    const Batch rest = exp(-thinnest) * most / max(x * x + f.h2, B(g.lamp.near2));
    const Batch known = min(L[0] - before[0], min(L[1] - before[1], L[2] - before[2]));
    const Batch little =
        B(0.02f * g.world.tolerance) * max(known, B(0.1f * g.world.scale));
    going = going & !((x >= zero) & (rest <= little));
    if (none(going)) return;

    // The piece [t, b], on one side of the foot.
    const Batch next = cuts.after(g, shadows, t);
    const Batch side = select(t < f.t, B(-1.f), B(1.f));
    const Batch psi_a = angle.psi(x);
    const Batch psi_n = select(next >= B(kMaxLength), zero, angle.psi(next - f.t));
    const Batch span = psi_n - psi_a;
    const auto whole = abs(span) <= H;
    const Batch psi_to = psi_a + select(span < zero, -H, H);
    // However it rounds, a piece goes on by what a float can tell at the lamp's distance,
    // and ends where the next begins.
    const Batch least = max(B(2.4e-7f) * t, B(1e-7f) * (abs(x) + angle.width));
    const Batch step_on = max(f.t + angle.x(psi_to, side), t + least);
    const Batch b = select(going, select(whole, next, min(step_on, next)), t);
    const Batch psi_b = select(b < next, angle.psi(b - f.t), psi_n);

    g.depth_before(b, tau_b);
    for (int i = 0; i < g.k; ++i) g.on[i].here = g.on[i].at(t);
    const LampPiece piece = {t, b, psi_a, psi_b, side};
    Sums s = rule(g, angle, piece, going);
    const Judged j(g, most, s, L, before, tau_a, tau_b);

    // Taken, or tried again shorter.
    const Batch width = piece.width();
    // An angle is small as the lamp is far: by itself it says nothing.
    const auto tiny =
        (width <= B(1e-6f) * max(psi_a, psi_b)) | (b - t <= B(1e-6f) * abs(t));
    const auto deep = (j.deepest > B(kDeep)) | (j.unseen > B(kFirstDeep));
    const auto accept =
        going & (((j.worst <= B(1.f)) & !(deep)) | tiny | Mask(step > most_pieces - 100));
    // Where the rule is no good any more; narrow pieces it tells well, however short.
    const auto at_once =
        accept & tiny & (j.deepest > B(0.1f)) & (deep | (j.worst > B(1.f)));
    if (any(at_once)) spend(g, t, tau_a, tau_b, at_once, s);
    for (int c = 0; c < 3; ++c) {
      // Nothing comes through what is black, wherever the nodes are rounded to.
      const auto seen = accept & (tau_a[c] < B(kBlack));
      L[c] += select(seen, s.kronrod[c], zero);
      tau_a[c] = select(accept, tau_b[c], tau_a[c]);
      for (int i = 0; i < g.k; ++i)
        g.on[i].share[c] += select(seen, g.on[i].piece[c], zero);
    }
    const Batch factor = clamp(exp(B(-0.1f) * log(j.worst)), B(0.2f), B(3.f));
    const Batch thinner =
        min(B(0.8f * kDeep) / j.deepest, B(0.5f * kFirstDeep) / j.unseen);
    const Batch shorter = min(B(0.5f), select(deep, max(thinner, B(1e-5f)), factor));
    H = select(accept, max(select(whole, H, zero), width * max(factor, B(1.f))),
               width * shorter);
    t = select(accept, b, t);
  }
}

void add_lamp(const LampRays& g, Batch L[3]) {
  const Mask closed = g.lamp.closed ? add_closed(g, L) : Mask(false);
  if (!all(closed)) add_by_angle(g, !closed, L);
}

unsigned long scratch_bytes(int k) { return sizeof(Lit) * static_cast<unsigned>(k) + 64; }

void add(const Compiled& world, int k, const Medium* const* media,
         const float* const* weights, const Rays& rays, float* const L[3],
         const Stretch* share, void* scratch) noexcept {
  Lit* on = static_cast<Lit*>(scratch);
  for (int i = 0; i < rays.n; i += Batch::W) {
    const auto ray = load_ray(rays, i);
    const int n = meet(k, media, weights, rays, i, ray, on);
    bool glows = false;
    for (int j = 0; j < n; ++j) {
      glows = glows || on[j].m->glows_by_lamp;
      const Inside& in = on[j].in;
      on[j].open = is_open(*on[j].m, ray);
      on[j].from_eye = (in.lo == Batch(0.f)) | (in.lo >= in.hi);
    }
    if (!glows) continue;
    Batch sum[3] = {0.f, 0.f, 0.f};
    for (const Light& lamp : world.lamps)
      add_lamp({world, lamp, on, n, ray, foot_of(lamp, ray)}, sum);
    for (int c = 0; c < 3; ++c) store(L[c] + i, load<Batch>(L[c] + i) + sum[c]);
    if (share) put_shares(on, n, k, media, share, i, true);
  }
}

}  // namespace

const LampKernels lamp_kernels = {add, scratch_bytes};

}  // namespace brume::air::inline BRUME_ISA_NS
