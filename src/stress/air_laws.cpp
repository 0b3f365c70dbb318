#include "stress/air_group.h"

#include <algorithm>
#include <cmath>

#include "stress/draw.h"
#include "stress/scenery.h"
#include "truth/truth.h"

namespace brume::stress {

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kEps = std::numeric_limits<float>::epsilon();
constexpr double kTiny = std::numeric_limits<float>::min();
constexpr long kEvaluations = 200'000;  // of a truth: a tenth of a second, mostly

// How much of a source is seen: from T, or from L where a float T is too near 1 to tell.
double opacity_of(const AirGroup& g, int c, double T, double L) {
  return g.source[c] > 0 ? std::max(1 - T, std::min(L / g.source[c], 1.)) : 1 - T;
}

template <class F>
void each(Part part, F&& f) {
  for (int i = part.begin; i < part.begin + part.count; ++i)
    for (int c = 0; c < 3; ++c) f(i, c, std::size_t(i));
}

void check_values(const AirGroup& g, const Answers& a, Findings& found) {
  each({}, [&](int i, int c, std::size_t k) {
    const double T = a.T[c][k], L = a.L[c][k];
    const std::uint64_t n = g.case_of(i);
    const bool endless = g.glows && !std::isfinite(g.rays.t[k]);
    found.holds(Law::finite, n, c, std::isfinite(T) ? L : T, 0,
                std::isfinite(T) && (std::isfinite(L) || (endless && L > 0)));
    found.holds(Law::range, n, c, T, T < 0 ? 0 : 1, T >= 0 && T <= 1);
    found.holds(Law::positive, n, c, L, 0, L >= 0);
    // The float T is off by its own rounding and by that of its exponent's last bit.
    if (g.constant)
      found.at_most(Law::energy, n, c, L, g.source[c] * (1 - T),
                    g.source[c] * (4 * kEps + 8 * kEps * (1 - T) + kTiny) +
                        (g.one_form ? 0 : 1e-5 * g.source[c]));
  });
}

// The rays cut in two.
struct Cut {
  Rays near, far;
};
Cut cut_in_two(AirGroup& g) {
  Cut both{g.rays, g.rays};
  auto& [near, far] = both;
  far.place();
  for (std::size_t i = 0; i < near.t.size(); ++i) {
    const double t = g.rays.t[i];
    const double f =
        i % 8 == 7 ? 1 - log_uniform(g.random, 1e-6, 0.1) : g.random.uniform();
    const double cut = std::isfinite(t) ? f * t : log_uniform(g.random, 1e-3, 1e6);
    near.t[i] = float(cut);
    far.t[i] = std::isfinite(t) ? std::max(float(t) - near.t[i], 0.f) : float(kInf);
    for (auto axis : {0, 1, 2})
      far.o[axis][i] = float(double(far.o[axis][i]) + double(near.t[i]) * far.d[axis][i]);
  }
  return both;
}

// The whole rays and their nearer parts, few by few: what a source keeps of the rays that
// it was last asked about serves both.
void ask_both(const AirGroup& g, const Rays& near, Answers& of_whole, Answers& of_near) {
  constexpr int kFew = 64;
  for (int begin = 0; begin < kGroup; begin += kFew) {
    const Part part{begin, kFew};
    const Answers a = ask(g.air(), g.rays, part), b = ask(g.air(), near, part);
    for (int c = 0; c < 3; ++c) {
      const auto add = [&](std::vector<float>& to, const std::vector<float>& from) {
        to.insert(to.end(), from.begin() + begin, from.end());
      };
      add(of_whole.T[c], a.T[c]), add(of_whole.L[c], a.L[c]);
      add(of_near.T[c], b.T[c]), add(of_near.L[c], b.L[c]);
    }
  }
}

void check_monotone(const AirGroup& g, const Answers& whole, const Answers& near,
                    Findings& found) {
  each({}, [&](int i, int c, std::size_t k) {
    const std::uint64_t n = g.case_of(i);
    const double T = whole.T[c][k], T1 = near.T[c][k];
    const double L = whole.L[c][k], L1 = near.L[c][k];
    const Slack s = g.slack(i, g.rays.t[k]);
    found.at_most(Law::monotone, n, c, T, T1, g.allowed_T(s, T1, 2));
    if (g.constant)
      found.at_most(Law::monotone, n, c, L1, L,
                    g.allowed_L(s, i, c, std::max(L, L1), 1 - T, 2));
  });
}

void check_split(const AirGroup& g, const Answers& whole, const Answers& a,
                 const Cut& cut, Findings& found) {
  if (g.capped) return;
  const Answers b = ask(g.air(), cut.far, g.part);
  each(g.part, [&](int i, int c, std::size_t k) {
    const std::uint64_t n = g.case_of(i);
    const double T = whole.T[c][k], T1 = a.T[c][k], T2 = b.T[c][k];
    const double L = whole.L[c][k], L1 = a.L[c][k], L2 = b.L[c][k];
    const double t = g.rays.t[k], t1 = cut.near.t[k], t2 = cut.far.t[k];
    const glm::dvec3 o = g.rays.origin(i), d = g.rays.direction(i),
                     from = cut.far.origin(i);
    Slack s = g.slack(i, t);
    // The rest begins where floats allow: off by eps of the way there, times the density.
    s += slack_of(g.world(), from, d, t2, g.options.tolerance);
    if (std::abs(T1 * T2 - T) > g.allowed_T(s, T, 2))
      s.rel += doubt_of(g.world(), o, d, t, {}) + doubt_of(g.world(), o, d, t1, {}) +
               doubt_of(g.world(), from, d, t2, from - (o + t1 * d));
    found.near(Law::split, n, c, T1 * T2, T, g.allowed_T(s, T, 2));
    if (!g.own || g.constant)
      found.near(
          Law::split_L, n, c, L1 + T1 * L2, L,
          g.allowed_L(s, i, c, std::max(L1 + T1 * L2, L), opacity_of(g, c, T, L), 3) +
              4 * kEps * g.source[c]);
  });
}

void check_scale(AirGroup& g, Findings& found) {
  if (g.own) return;
  const double k = log_uniform(g.random, 1e-6, 1e6);
  const World w = scaled(g.world(), k);
  // Endless is 1e30 m in any unit: what is told apart is the same way, less than that.
  const double end = 0.99e30 * std::min(1., 1 / k);
  Rays there = g.rays, rays = g.rays;
  for (std::size_t i = 0; i < rays.t.size(); ++i) {
    there.t[i] = float(std::min(double(there.t[i]), end));
    rays.t[i] = float(there.t[i] * k);
  }
  for (auto& plane : rays.o)
    for (float& x : plane) x = float(x * k);
  // A unit is a choice only where the numbers stay normal floats.
  const auto normal = [](double x) { return x == 0 || (x > 1e-30 && x < 1e30); };
  for (const auto& p : w.media)
    for (int c = 0; c < 3; ++c)
      if (!normal(p.what.extinction[c]) || !normal(p.what.extinction[c] * k)) return;
  for (const auto& p : w.media)
    if (!normal(p.what.falloff) || !normal(p.what.falloff * k)) return;
  const Answers a = ask(g.compile(w, g.isas.back()), rays), whole = ask(g.air(), there);
  each({}, [&](int i, int c, std::size_t n) {
    const double t = there.t[n];
    if (!normal(t) || !normal(t * k)) return;
    Slack s = g.slack(i, t);
    const Slack other =
        slack_of(w, rays.origin(i), rays.direction(i), rays.t[n], g.options.tolerance);
    s.abs += other.abs;
    s.light_rel = std::max(s.light_rel, other.light_rel);
    // Scaled, log rho at an eye far away is another double: twice its rounding.
    found.near(Law::scale, g.case_of(i), c, a.T[c][n], whole.T[c][n],
               g.allowed_T(s, whole.T[c][n], 3));
    found.near(Law::scale, g.case_of(i), c, a.L[c][n], whole.L[c][n],
               g.allowed_L(s, i, c, whole.L[c][n],
                           opacity_of(g, c, whole.T[c][n], whole.L[c][n]), 3));
  });
}

void check_weight(AirGroup& g, const Answers& whole, Findings& found) {
  std::vector<float> w(g.rays.t.size());
  for (std::size_t i = 0; i < w.size(); ++i)
    w[i] = i % 3 ? float(g.random.uniform()) : i % 6 ? 0.f : 1.f;
  const Answers a = ask(g.air(), g.rays, g.part, w.data());
  each(g.part, [&](int i, int c, std::size_t k) {
    const std::uint64_t n = g.case_of(i);
    const double T = a.T[c][k];
    if (w[k] == 0)
      found.holds(Law::weight, n, c, T, 1, T == 1 && a.L[c][k] == 0);
    else if (w[k] == 1)
      found.near(Law::weight, n, c, T, whole.T[c][k],
                 g.allowed_T(g.slack(i, g.rays.t[k]), T, 2));
    else if (!g.capped &&
             !at_the_ground(g.world(), g.rays.origin(i), g.rays.direction(i))) {
      const double all = whole.T[c][k], power = std::pow(all, double(w[k]));
      // A colour of several wavelengths is their mean: between that of none of the
      // weight and the power of the mean (Jensen's inequality).
      found.near(Law::weight, n, c, T,
                 g.spectral ? std::clamp(T, all, std::max(all, power)) : power,
                 // T lost its digits where it is near 1 or below the normal floats.
                 g.allowed_T(g.slack(i, g.rays.t[k]), T, 2) +
                     (whole.T[c][k] < kTiny ? std::pow(kTiny, double(w[k])) : 0));
    }
  });
}

void same_bits(Law law, const AirGroup& g, const Answers& whole, const Answers& part,
               int i, Findings& found) {
  const auto k = std::size_t(i);
  for (int c = 0; c < 3; ++c) {
    found.same(law, g.case_of(i), c, part.T[c][k], whole.T[c][k]);
    found.same(law, g.case_of(i), c, part.L[c][k], whole.L[c][k]);
  }
}

void check_lanes(AirGroup& g, const Answers& whole, Findings& found) {
  const int begin = integer(g.random, g.part.count);
  const Part part{g.part.begin + begin, 1 + integer(g.random, g.part.count - begin)};
  const Answers a = ask(g.air(), g.rays, part, nullptr, integer(g.random, 16));
  for (int i = part.begin; i < part.begin + part.count; ++i)
    same_bits(Law::lanes, g, whole, a, i, found);
}

void check_neighbours(AirGroup& g, const Answers& whole, Findings& found) {
  const float bad[] = {std::numeric_limits<float>::quiet_NaN(), float(kInf),
                       float(-kInf)};
  Rays rays = g.rays;
  const auto spoilt = [](int i) { return i % 5 == 2; };
  for (int i = 0; i < rays.size(); ++i) {
    if (!spoilt(i)) continue;
    const auto k = std::size_t(i);
    const float value = bad[integer(g.random, 3)];
    const int what = integer(g.random, 7);
    if (what == 0) rays.t[k] = bad[0];
    if (what >= 1 && what < 4) rays.d[what - 1][k] = value;
    if (what >= 4 && !rays.from_eye()) rays.o[what - 4][k] = value;
    if (what >= 4 && rays.from_eye()) rays.d[0][k] = rays.d[1][k] = rays.d[2][k] = value;
  }
  const Answers a = ask(g.air(), rays, g.part);
  for (int i = g.part.begin; i < g.part.begin + g.part.count; ++i)
    if (!spoilt(i)) same_bits(Law::neighbours, g, whole, a, i, found);
}

void check_isas(const AirGroup& g, const Answers& whole, Findings& found) {
  for (std::size_t k = 0; k + 1 < g.airs.size(); ++k) {
    // Older ones are slower by as much as their batches are shorter.
    const Part few = g.own ? Part{g.part.begin, 4 << k} : g.part;
    const Answers a = ask(g.airs[k], g.rays, few);
    each(few, [&](int i, int c, std::size_t n) {
      const Slack s = g.slack(i, g.rays.t[n]);
      found.near(Law::isa, g.case_of(i), c, a.T[c][n], whole.T[c][n],
                 g.allowed_T(s, whole.T[c][n], 2));
      const double got = a.L[c][n], L = whole.L[c][n];
      found.near(
          Law::isa, g.case_of(i), c, got, L,
          g.allowed_L(s, i, c, std::max(got, L), opacity_of(g, c, whole.T[c][n], L), 2));
    });
  }
}

}  // namespace

bool at_the_ground(const World& w, const glm::dvec3& o, const glm::dvec3& d) {
  const auto at = [&](const double ball[4], double radius) {
    if (!(radius > 0)) return false;
    const glm::dvec3 p = w.eye + o - glm::dvec3(ball[0], ball[1], ball[2]);
    const double r = glm::length(p), q = (r - radius) * (r + radius);
    const bool grazes = std::abs(glm::dot(p, d) + std::sqrt(std::max(q, 0.))) <= 4e-7 * r;
    // Less than 1e-9 of the radius within counts as outside.
    const bool begins = std::abs(r - radius) <= 2e-9 * radius + kEps * glm::length(o);
    return grazes || (o != glm::dvec3(0) && begins);
  };
  return std::ranges::any_of(w.media, [&](const auto& m) {
    const brume_medium& sky = m.what;
    return at(sky.ground, sky.ground[3]) || at(sky.ground, sky.core);
  });
}

Slack AirGroup::slack(int i, double t) const {
  return slack_of(world(), rays.origin(i), rays.direction(i), t, options.tolerance);
}

double AirGroup::allowed_T(const Slack& s, double T, double times) {
  return times * (s.of_opacity(1 - T) + 4 * kEps);
}

double AirGroup::rounding_L(const Slack& s, int c, double L, double opacity,
                            double whole) const {
  const auto share = [](double error, double of) { return of > 0 ? error * of : 0; };
  double rounding = share(s.of_opacity(opacity) + kTiny, source[c]) +
                    16 * kEps * std::abs(L) + s.of_light(c, std::abs(L), whole);
  if (emits) rounding += share(s.rel < 0.5 ? s.rel : kInf, std::abs(L));
  return rounding;
}

double AirGroup::allowed_L(const Slack& s, int i, int c, double L, double opacity,
                           double times) const {
  const double rounding = rounding_L(s, c, L, opacity, double(uncut[c][std::size_t(i)]));
  if (one_form) return times * rounding;
  const double pixel = std::max(std::abs(L), double(brightest[std::size_t(i)]));
  return times * (rounding + options.tolerance * (options.white + pixel));
}

void AirGroup::check_laws(Findings& found) {
  const Cut cut = cut_in_two(*this);
  Answers whole, near;
  ask_both(*this, cut.near, whole, near);
  judge({}, whole);
  check_values(*this, whole, found);
  if (!sky) {
    check_monotone(*this, whole, near, found);
    check_split(*this, whole, near, cut, found);
  }
  check_scale(*this, found);
  check_weight(*this, whole, found);
  check_lanes(*this, whole, found);
  check_neighbours(*this, whole, found);
  check_isas(*this, whole, found);
  check_lights(*this, whole, found);
  check_jumps(*this, found);
}

Verdict AirGroup::check_truth(int i, Findings& found) {
  const AirGroup& g = *this;
  if (at_the_ground(world(), rays.origin(i), rays.direction(i))) return Verdict::none;
  const Options& o = options;
  const Answers a = ask(g.air(), g.rays, {i, 1});
  judge({i, 1}, a);
  const glm::dvec3 from = g.world().eye + g.rays.origin(i), d = g.rays.direction(i);
  const double t = g.rays.t[std::size_t(i)];
  // A look is one at every medium: of a bolt's hundreds there are fewer.
  const long media = long(g.world().media.size());
  const truth::Options asked{.tolerance = truth_tolerance(),
                             .white = o.white,
                             .weights = {},
                             .evaluations = kEvaluations / (1 + media / 32)};
  const truth::Answer want = truth::along(g.world(), from, d, t, asked);
  if (!want.converged) {
    for (const Law law : {Law::truth_T, Law::truth_L, Law::step}) found.undecided(law);
    return Verdict::undecided;
  }
  // Beyond 1e30 m a float has no room for the way: what is there may count, in part.
  const bool far = t > 1e29;
  const truth::Answer near = far ? truth::along(g.world(), from, d, 1e29, asked) : want;
  Slack s = g.slack(i, t);
  s.rel += 4 * kEps;  // a float direction is not quite a unit vector
  const std::uint64_t n = g.case_of(i);
  const auto k = std::size_t(i);
  for (std::size_t c = 0; c < 3; ++c) {
    const double T = a.T[c][k], L = a.L[c][k];
    const auto between = [](double x, double y, double z) {
      return std::clamp(x, std::min(y, z), std::max(y, z));
    };
    const double wanted_T = between(T, near.T[c], want.T[c]),
                 wanted_L = between(L, near.L[c], want.L[c]);
    found.near(Law::truth_T, n, int(c), T, wanted_T,
               g.allowed_T(s, wanted_T, 1) + want.T_error[c] + near.T_error[c]);
    const double opacity = g.source[c] > 0 ? wanted_L / g.source[c] : 1 - wanted_T;
    found.near(Law::truth_L, n, int(c), L, wanted_L,
               g.allowed_L(s, i, int(c), wanted_L, opacity, 1) + want.L_error[c] +
                   near.L_error[c] + kTiny);
  }
  check_step(g, i, found);
  return Verdict::given;
}

}  // namespace brume::stress
