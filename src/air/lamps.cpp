#include "air/lamps.h"

#include "air/lit.h"
#include "air/on_ray.h"

// One lamp at a time, by quadrature along the view ray in the angle under which the lamp
// sees it (Kulla & Fajardo 2012, "equi-angular"): with x the distance from the foot of
// the perpendicular and h its length, x = h / tan psi, dx / r^2 = dpsi / h, so that the
// peak of 1/r^2 is flat. psi is taken from the far end on either side of the foot, where
// it is small and keeps its digits. Pieces end at the foot, at every boundary of a medium
// and at the edges of a spotlight's cone, and are no deeper than a rule can see; each is
// a Kronrod rule whose error its embedded Gauss rule tells.

namespace brume::air::inline BRUME_ISA_NS {
namespace {

using B = Batch;

constexpr int kPieces = 600;
constexpr float kDeep = 20;      // optical depth of a piece at most
constexpr float kFirstDeep = 1;  // and that before its first node: what none sees
constexpr float kBlack = 40;

// Gauss 7, Kronrod 15 on [-1, 1] (Kronrod 1965; Piessens et al. 1983, QUADPACK qk15).
constexpr int kNodes = 15;
constexpr float kNode[kNodes] = {
    -9.914553711e-01f, -9.491079123e-01f, -8.648644234e-01f, -7.415311856e-01f,
    -5.860872355e-01f, -4.058451514e-01f, -2.077849550e-01f, 0.f,
    2.077849550e-01f,  4.058451514e-01f,  5.860872355e-01f,  7.415311856e-01f,
    8.648644234e-01f,  9.491079123e-01f,  9.914553711e-01f};
constexpr float kKronrod[kNodes] = {2.293532201e-02f, 6.309209263e-02f, 1.047900103e-01f,
                                    1.406532597e-01f, 1.690047266e-01f, 1.903505781e-01f,
                                    2.044329401e-01f, 2.094821411e-01f, 2.044329401e-01f,
                                    1.903505781e-01f, 1.690047266e-01f, 1.406532597e-01f,
                                    1.047900103e-01f, 6.309209263e-02f, 2.293532201e-02f};
constexpr float kGauss[kNodes] = {0.f, 1.294849662e-01f, 0.f, 2.797053915e-01f,
                                  0.f, 3.818300505e-01f, 0.f, 4.179591837e-01f,
                                  0.f, 3.818300505e-01f, 0.f, 2.797053915e-01f,
                                  0.f, 1.294849662e-01f, 0.f};

struct Lit : OnRay {
  Batch piece[3];  // what the lamp at hand makes of it on the piece at hand
};

/// A lamp as a batch of rays sees it: t of the foot, the vector from there to the lamp.
struct Foot {
  Batch t, to[3], h2, width;  // width: h, or what stands for it very near the lamp

  BRUME_INLINE Batch psi(Batch x) const { return atan2pos(width, abs(x)); }
  BRUME_INLINE Batch x(Batch psi, Batch side) const {
    const auto sc = sincos(psi);
    return min(width * sc.cos / max(sc.sin, B(1e-30f)), B(1e18f)) * side;
  }
};

Foot foot_of(const Light& lamp, const Ray<Batch>& ray) {
  Foot f;
  Batch c[3];
  for (int i = 0; i < 3; ++i) c[i] = B(lamp.position[i]) - ray.o[i];
  f.t = dot(c, ray.d);
  for (int i = 0; i < 3; ++i) f.to[i] = c[i] - f.t * ray.d[i];
  f.h2 = dot(f.to, f.to);
  f.width = max(max(sqrt(f.h2), B(0.5f) * sqrt(B(lamp.radius2))),
                B(1e-6f) * (abs(f.t) + B(1e-3f)));
  return f;
}

// Where the ray crosses the cone of half angle acos(mu): (v.a)^2 = mu^2 |v|^2 with
// v = x d - to; the mirror cone's crossings come along and do no harm.
void cone_crossings(const Light& lamp, const Foot& f, const Ray<Batch>& ray, float mu,
                    Batch t[2]) {
  const Batch a[3] = {lamp.direction[0], lamp.direction[1], lamp.direction[2]};
  const Batch da = dot(ray.d, a), pa = dot(f.to, a), C(mu * mu);
  const Batch A = da * da - C, b = -da * pa, c = pa * pa - C * f.h2;
  const Batch disc = C * (da * da * f.h2 + pa * pa - C * f.h2);
  const Batch root = sqrt(max(disc, B(0.f)));
  const Batch q = select(b < B(0.f), root - b, -(root + b));
  const auto crosses = disc > B(0.f);
  t[0] = select(crosses, f.t + q / A, B(kFar));
  t[1] = select(crosses, f.t + c / q, B(kFar));
}

// tau += optical depth of everything from the ray's origin to t.
void add_depth_to(const Lit* on, int k, const Ray<Batch>& ray, Batch t, Batch tau[3]) {
  for (int j = 0; j < k; ++j) {
    const Lit& r = on[j];
    const Medium& m = *r.m;
    if (!m.absorbs || none(r.in.lo < t)) continue;
    const Batch D = depth_to(m, r.p, ray, r.weight, r.in, t);
    for (int c = 0; c < 3; ++c) tau[c] += min(B(m.sigma[c]) * D, B(kFar));
  }
}

void whole_depth_to(const Lit* on, int k, const Ray<Batch>& ray, Batch t, Batch tau[3]) {
  for (int c = 0; c < 3; ++c) tau[c] = B(0.f);
  add_depth_to(on, k, ray, t, tau);
}

/// From a point at distance x from the foot to the lamp. Distance and direction are the
/// foot's, not a difference of positions.
struct Leg {
  Batch to[3], r, fall;
};

BRUME_INLINE Leg leg_from(const Light& lamp, const Foot& f, const Ray<Batch>& ray,
                          Batch x) {
  Leg leg;
  const Batch r2 = max(x * x + f.h2, B(1e-30f)), inv = B(1.f) / sqrt(r2);
  leg.r = sqrt(r2);
  for (int i = 0; i < 3; ++i) leg.to[i] = (f.to[i] - x * ray.d[i]) * inv;
  leg.fall = B(1.f) / max(r2, B(lamp.radius2));
  const Batch axis[3] = {lamp.direction[0], lamp.direction[1], lamp.direction[2]};
  if (lamp.kind == BRUME_SPOT) leg.fall = leg.fall * cone_edge(lamp, -dot(axis, leg.to));
  return leg;
}

// tau += what dims the lamp on this leg.
BRUME_INLINE void add_leg(const Compiled& world, const Light& lamp, const Foot& f,
                          const Ray<Batch>& ray, Batch x, const Leg& leg, Batch tau[3]) {
  if (!lamp.attenuated) return;
  Batch at[3];
  point_at(ray, f.t + x, at);
  const Ray<Batch> along_leg = {
      {at[0], at[1], at[2]}, {leg.to[0], leg.to[1], leg.to[2]}, false};
  add_optical_depth(world, along_leg, leg.r, tau);
}

struct Sums {
  Batch kronrod[3], gauss[3];
  Batch first[3];  // optical depth up to the first node
};

// The rule on the piece between psi_a and psi_b on one side of the foot.
Sums rule(const Compiled& world, const Light& lamp, Lit* on, int k, const Ray<Batch>& ray,
          const Foot& f, Batch side, Batch psi_a, Batch psi_b, Mask going) {
  Sums s;
  for (int c = 0; c < 3; ++c) s.kronrod[c] = s.gauss[c] = B(0.f);
  for (int j = 0; j < k; ++j)
    for (int c = 0; c < 3; ++c) on[j].piece[c] = B(0.f);
  const Batch half = B(0.5f) * (psi_b - psi_a), middle = B(0.5f) * (psi_b + psi_a);
  for (int n = 0; n < kNodes; ++n) {
    const Batch x = f.x(middle + half * B(kNode[n]), side);
    const Batch t = f.t + x;
    const Batch dt = abs(half) * (x * x + f.width * f.width) / f.width;
    const Leg leg = leg_from(lamp, f, ray, x);
    const auto lit = going & (leg.fall > B(0.f)) & (t >= B(0.f));
    if (n > 0 && none(lit)) continue;
    // Both legs together: one exponential, and only one where all is grey.
    Batch tau[3] = {B(0.f), B(0.f), B(0.f)}, T[3], through;
    add_depth_to(on, k, ray, t, tau);
    if (n == 0)
      for (int c = 0; c < 3; ++c) s.first[c] = tau[c];
    add_leg(world, lamp, f, ray, x, leg, tau);
    for (int c = 0; c < 3; ++c) {
      if (c == 0 || any(tau[c] != tau[c - 1])) through = exp(-tau[c]);
      T[c] = select(lit, through * (leg.fall * dt) * B(lamp.power[c]), B(0.f));
    }
    const Batch mu = -x / leg.r;
    for (int j = 0; j < k; ++j) {
      const Medium& m = *on[j].m;
      if (!m.glows_by_lamp) continue;
      const auto here = on[j].at(t);
      if (none(here)) continue;
      const Batch rho = density(m, on[j].p, ray, t) * on[j].weight;
      const Batch rate =
          select(here, min(rho * phase(m.phase, mu, m.g), B(kFar)), B(0.f));
      for (int c = 0; c < 3; ++c) {
        const Batch L = rate * (B(m.sigma[c] * m.albedo[c]) * T[c]);
        on[j].piece[c] += B(kKronrod[n]) * L;
        s.kronrod[c] += B(kKronrod[n]) * L;
        s.gauss[c] += B(kGauss[n]) * L;
      }
    }
  }
  return s;
}

// A piece as short as floats allow, from t on, and still of optical depth: no node of a
// rule would be where the light is. What the lamp makes of the medium there, spent on the
// whole depth: L = S (e^-tau_a - e^-tau_b), S = Sum of media's glow / extinction at t.
[[gnu::noinline]] void spend(const Compiled& world, const Light& lamp, Lit* on, int k,
                             const Ray<Batch>& ray, const Foot& f, Batch t,
                             const Batch tau_a[3], const Batch tau_b[3], Mask lanes,
                             Sums& s) {
  const Batch x = t - f.t;
  const Leg leg = leg_from(lamp, f, ray, x);
  Batch tau[3] = {B(0.f), B(0.f), B(0.f)}, sigma[3] = {B(0.f), B(0.f), B(0.f)};
  add_leg(world, lamp, f, ray, x, leg, tau);
  const auto rho_of = [&](const Lit& r) {  // two products of these stay floats
    const Batch rho = clamp(density(*r.m, r.p, ray, t) * r.weight, B(0.f), B(1e20f));
    return select(r.at(t), rho, B(0.f));
  };
  for (int j = 0; j < k; ++j)
    for (int c = 0; c < 3; ++c) sigma[c] += rho_of(on[j]) * B(on[j].m->sigma[c]);
  for (int c = 0; c < 3; ++c) s.kronrod[c] = select(lanes, B(0.f), s.kronrod[c]);
  for (int j = 0; j < k; ++j) {
    const Medium& m = *on[j].m;
    const Batch p = phase(m.phase, -x / leg.r, m.g);
    for (int c = 0; c < 3; ++c) {
      const Batch part =
          rho_of(on[j]) * B(m.sigma[c]) / max(sigma[c], B(1e-30f)) * B(m.albedo[c]);
      const Batch spent = exp(-tau_a[c]) * (B(1.f) - exp(tau_a[c] - tau_b[c]));
      const Batch L = part * p * (exp(-tau[c]) * leg.fall * B(lamp.power[c])) * spent;
      on[j].piece[c] = select(lanes, L, on[j].piece[c]);
      s.kronrod[c] += select(lanes, L, B(0.f));
    }
  }
}

// The next boundary after t: of a medium, the foot, the cone.
Batch next_boundary(const Lit* on, int k, const Foot& f, const Batch* cone, int cones,
                    Batch t, Batch end) {
  Next next(t, end);
  next.consider(f.t);
  for (int j = 0; j < k; ++j) next.consider(on[j].in);
  for (int j = 0; j < cones; ++j) next.consider(cone[j]);
  return next.next;
}

void add_lamp(const Compiled& world, const Light& lamp, Lit* on, int k,
              const Ray<Batch>& ray, Batch L[3]) {
  const Batch zero(0.f);
  const Foot f = foot_of(lamp, ray);
  Batch cone[4];
  int cones = 0;
  if (lamp.kind == BRUME_SPOT) {
    cone_crossings(lamp, f, ray, lamp.cos_cone, cone);
    cone_crossings(lamp, f, ray, lamp.cos_inner, cone + 2);
    cones = 4;
  }
  Batch t(kFar), end(0.f);
  for (int j = 0; j < k; ++j) {
    if (!on[j].m->glows_by_lamp) continue;
    const auto there = on[j].in.lo < on[j].in.hi;
    t = min(t, on[j].in.lo);
    end = max(end, select(there, on[j].in.hi, zero));
  }
  // The most radiance that a point 1 m from the lamp can scatter.
  float brightest = 0;
  for (int j = 0; j < k; ++j) {
    const Medium& m = *on[j].m;
    const float g = m.g < 0 ? -m.g : m.g;
    for (int c = 0; c < 3; ++c)
      brightest =
          max(brightest, m.albedo[c] * lamp.power[c] * (1 + g) / ((1 - g) * (1 - g)));
  }
  Batch H(2.f), tau_a[3], tau_b[3];
  const Batch before[3] = {L[0], L[1], L[2]};
  whole_depth_to(on, k, ray, t, tau_a);

  for (int step = 0; step < kPieces; ++step) {
    const Batch thinnest = min(tau_a[0], min(tau_a[1], tau_a[2]));
    auto going = (t < end) & (thinnest < B(kBlack));
    // Beyond the foot the lamp only fades: what is still to come is at most brightest /
    // r^2 seen through what lies before, since Int sigma e^-tau <= 1.
    const Batch x = t - f.t;
    const Batch rest = exp(-thinnest) * B(brightest) / max(x * x + f.h2, B(lamp.radius2));
    const Batch known = min(L[0] - before[0], min(L[1] - before[1], L[2] - before[2]));
    const Batch little = B(0.02f * world.tolerance) * max(known, B(0.1f * world.scale));
    going = going & !((x >= zero) & (rest <= little));
    if (none(going)) return;
    // The piece [t, b], on one side of the foot.
    const Batch next = next_boundary(on, k, f, cone, cones, t, end);
    const Batch side = select(t < f.t, B(-1.f), B(1.f));
    const Batch psi_a = f.psi(t - f.t);
    const Batch psi_n = select(next >= B(kMaxLength), zero, f.psi(next - f.t));
    const Batch span = psi_n - psi_a;
    const auto whole = abs(span) <= H;
    const Batch psi_b = select(whole, psi_n, psi_a + select(span < zero, -H, H));
    // However it rounds, a piece goes on by what a float can tell at the lamp's distance.
    const Batch least = max(B(2.4e-7f) * t, B(1e-7f) * (abs(x) + f.width));
    const Batch step_on = max(f.t + f.x(psi_b, side), t + least);
    const Batch b = select(going, select(whole, next, min(step_on, next)), t);

    whole_depth_to(on, k, ray, b, tau_b);
    Sums s = rule(world, lamp, on, k, ray, f, side, psi_a, psi_b, going);

    Batch worst(1e-30f), deepest(1e-30f), unseen(1e-30f);
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
    }
    const Batch width = abs(psi_b - psi_a);
    const auto tiny = (width <= B(1e-6f)) | (b - t <= B(1e-6f) * abs(t));
    const auto deep = (deepest > B(kDeep)) | (unseen > B(kFirstDeep));
    const auto accept =
        going & (((worst <= B(1.f)) & !(deep)) | tiny | Mask(step > kPieces - 100));
    const auto at_once = accept & tiny & (deepest > B(0.1f));
    if (any(at_once)) spend(world, lamp, on, k, ray, f, t, tau_a, tau_b, at_once, s);
    for (int c = 0; c < 3; ++c) {
      // Nothing comes through what is black, wherever the nodes are rounded to.
      const auto seen = accept & (tau_a[c] < B(kBlack));
      L[c] += select(seen, s.kronrod[c], zero);
      tau_a[c] = select(accept, tau_b[c], tau_a[c]);
      for (int j = 0; j < k; ++j) on[j].share[c] += select(seen, on[j].piece[c], zero);
    }
    const Batch factor = clamp(exp(B(-0.1f) * log(worst)), B(0.2f), B(3.f));
    const Batch thinner = min(B(0.8f * kDeep) / deepest, B(0.5f * kFirstDeep) / unseen);
    const Batch shorter = min(B(0.5f), select(deep, max(thinner, B(1e-5f)), factor));
    H = select(accept, max(select(whole, H, zero), width * max(factor, B(1.f))),
               width * shorter);
    t = select(accept, b, t);
  }
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
    for (int j = 0; j < n; ++j) glows = glows || on[j].m->glows_by_lamp;
    if (!glows) continue;
    Batch sum[3] = {0.f, 0.f, 0.f};
    for (const Light& lamp : world.lamps) add_lamp(world, lamp, on, n, ray, sum);
    for (int c = 0; c < 3; ++c) store(L[c] + i, load<Batch>(L[c] + i) + sum[c]);
    if (share) put_shares(on, n, k, media, share, i, true);
  }
}

}  // namespace

const LampKernels lamp_kernels = {add, scratch_bytes};

}  // namespace brume::air::inline BRUME_ISA_NS
