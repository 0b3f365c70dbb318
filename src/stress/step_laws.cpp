// No step between neighbouring pixels or frames beyond the truth's own: what the product
// is off by may not change from one to the next by more than a tenth of the tolerance.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "stress/air_group.h"
#include "stress/draw.h"
#include "truth/truth.h"

namespace brume::stress {
namespace {

constexpr double kEps = std::numeric_limits<float>::epsilon();
constexpr double kShare = 0.1;  // of the tolerance
constexpr long kEvaluations = 100'000;

/// From a ray of a group to one beside it.
struct Way {
  glm::dvec3 o, d;        ///< where it begins, relative to the eye; unit
  double t;               ///< [m]
  glm::dvec3 move, turn;  ///< turn: in radians, across d
  double longer;          ///< t exp(longer)

  /// Rays at parts [from, to] of the way, both ends included.
  Rays rays(double from, double to, int count) const {
    Rays r;
    for (int k = 0; k < count; ++k) {
      const double s = from + (to - from) * k / (count - 1);
      const glm::dvec3 a = o + s * move, b = glm::normalize(d + s * turn);
      for (int c = 0; c < 3; ++c) {
        if (moves()) r.o[c].push_back(float(a[c]));
        r.d[c].push_back(float(b[c]));
      }
      r.t.push_back(float(t * std::exp(s * longer)));
    }
    return r;
  }
  bool moves() const { return o != glm::dvec3(0) || move != glm::dvec3(0); }
};

// Turned, longer, moved: by `most` at most.
Way draw_way(const AirGroup& g, int i, std::uint64_t salt, double most) {
  Random r(g.options.seed ^ salt, g.case_of(i));
  const auto amount = [&] { return log_uniform(r, 1e-3 * most, most); };
  Way w{g.rays.origin(i), glm::normalize(g.rays.direction(i)), 0, {}, {}, 0};
  w.t = double(g.rays.t[std::size_t(i)]);
  const int kind = integer(r, 4);  // the last: all together
  if (kind == 0 || kind == 3) {
    const glm::dvec3 any = draw_direction(r, g.frame.up);
    w.turn = amount() * (any - glm::dot(any, w.d) * w.d);
  }
  if (kind == 1 || kind == 3) w.longer = amount();
  if (kind >= 2)
    w.move = amount() * std::min(w.t, log_uniform(r, 1e-2, 1e3)) *
             draw_direction(r, g.frame.up);
  return w;
}

// Beyond this a float has no room for the way: what is there may count, in part.
constexpr double kRoom = 1e29;

// Both ends, in the product and in truth.
struct Pair {
  Rays rays;
  Answers made;
  std::optional<World> later = {};  ///< the second's, of the next frame
  truth::Answer want[2] = {};       ///< all the way,
  truth::Answer near[2] = {};       ///< and as far as kRoom

  const World& world(const AirGroup& g, int k) const {
    return k == 1 && later ? *later : g.world();
  }
};

// False where the truth does not converge.
bool ask_truth(const AirGroup& g, Pair& p) {
  const long media = long(g.world().media.size());
  for (int k = 0; k < 2; ++k) {
    const World& w = p.world(g, k);
    const auto until = [&](double t) {
      return truth::along(w, w.eye + p.rays.origin(k), p.rays.direction(k), t,
                          {.tolerance = g.truth_tolerance(),
                           .white = g.options.white,
                           .weights = {},
                           .evaluations = kEvaluations / (1 + media / 32)});
    };
    const double t = double(p.rays.t[std::size_t(k)]);
    p.want[k] = until(t);
    p.near[k] = t > kRoom ? until(kRoom) : p.want[k];
    if (!p.want[k].converged || !p.near[k].converged) return false;
  }
  return true;
}

// What a number may be, and how it may change from one such to the next.
struct Range {
  double lo, hi;

  Range(double a, double b) : lo(std::min(a, b)), hi(std::max(a, b)) {}
  static double change(const Range& a, const Range& b, double made) {
    return std::clamp(made, b.lo - a.hi, b.hi - a.lo);
  }
};

// Whether floats do not tell on which side of an edge of the world a ray is.
bool at_an_edge(const AirGroup& g, const Pair& p) {
  return at_the_ground(p.world(g, 0), p.rays.origin(0), p.rays.direction(0)) ||
         at_the_ground(p.world(g, 1), p.rays.origin(1), p.rays.direction(1));
}

Slack slack_between(const AirGroup& g, const Pair& p) {
  const Rays& r = p.rays;
  Slack s;
  for (int k = 0; k < 2; ++k)
    s += slack_of(p.world(g, k), r.origin(k), r.direction(k), double(r.t[std::size_t(k)]),
                  kShare * g.options.tolerance);
  s.rel += 4 * kEps;
  return s;
}

// Rounding may move both; what else differs is held to its share.
void judge_pair(const AirGroup& g, Law law, int i, const Pair& p, Findings& found) {
  const Slack s = slack_between(g, p);
  const std::optional<Air> whole = g.without_cones();
  const Answers uncut = whole ? ask(*whole, p.rays, {0, 2}) : p.made;
  const double share = kShare * g.options.tolerance;
  const auto &a = p.want[0], &b = p.want[1], &a0 = p.near[0], &b0 = p.near[1];
  double most = 0;
  for (const auto& L : p.made.L)
    if (!std::isfinite(L[0] - L[1])) return;  // what shines without end
  for (const auto& L : p.made.L) most = std::max(most, double(std::max(L[0], L[1])));
  for (std::size_t c = 0; c < 3; ++c) {
    const auto change = [](const std::vector<float>& x) {
      return double(x[1]) - double(x[0]);
    };
    const auto off = [&](auto error) {
      return (a.*error)[c] + (b.*error)[c] + (a0.*error)[c] + (b0.*error)[c];
    };
    const Range Ta(a.T[c], a0.T[c]), Tb(b.T[c], b0.T[c]);
    const Range La(a.L[c], a0.L[c]), Lb(b.L[c], b0.L[c]);
    const double T = std::min(Ta.lo, Tb.lo), L = std::max(La.hi, Lb.hi);
    const double dT = change(p.made.T[c]), dL = change(p.made.L[c]);
    found.near(law, g.case_of(i), int(c), dT, Range::change(Ta, Tb, dT),
               g.allowed_T(s, T, 1) + off(&truth::Answer::T_error));
    const double opacity = g.source[c] > 0 ? std::min(L / g.source[c], 1.) : 0;
    const double lit = double(std::max(uncut.L[c][0], uncut.L[c][1]));
    found.near(law, g.case_of(i), int(c), dL, Range::change(La, Lb, dL),
               2 * g.rounding_L(s, int(c), L, std::max(opacity, 1 - T), lit) +
                   share * (g.options.white + most) + off(&truth::Answer::L_error));
  }
}

// ---- jumps ----

// Whether rays k and k + 1 are the same floats.
bool same(const Rays& r, std::size_t k) {
  for (int c = 0; c < 3; ++c)
    if (r.d[c][k] != r.d[c][k + 1] || (!r.from_eye() && r.o[c][k] != r.o[c][k + 1]))
      return false;
  return r.t[k] == r.t[k + 1];
}

// The step from one ray to the next that is larger than those beside it by most, of what
// is allowed; nothing where none is by all of it.
std::optional<std::size_t> largest_step(const AirGroup& g, const Answers& a, int rays) {
  double largest = 1;
  std::optional<std::size_t> at;
  const auto look = [&](const std::vector<float>& x, double allowed) {
    const auto step = [&](int k) {
      const auto i = std::size_t(k);
      return k < 0 || k + 1 >= rays ? 0 : std::abs(double(x[i + 1]) - double(x[i]));
    };
    for (int k = 0; k + 1 < rays; ++k) {
      const double by = step(k) - std::max(step(k - 1), step(k + 1));
      if (by > largest * allowed) largest = by / allowed, at = std::size_t(k);
    }
  };
  for (int c = 0; c < 3; ++c) {
    const double most = double(*std::max_element(a.L[c].begin(), a.L[c].end()));
    look(a.L[c], kShare * g.options.tolerance * (g.options.white + most));
    look(a.T[c], 64 * kEps);
  }
  return at;
}

// Two rays on the way, neighbours among the floats, with such a step between them: each
// round looks closer at where the largest is.
std::optional<Pair> find_jump(const AirGroup& g, const Way& way, int few) {
  double from = 0, to = 1;
  for (int round = 0; round < 64; ++round) {
    const Rays rays = way.rays(from, to, few);
    const auto at = largest_step(g, ask(g.air(), rays, {0, few}), few);
    if (!at) return {};
    int different = 0;
    for (int k = 0; k + 1 < few; ++k) different += !same(rays, std::size_t(k));
    const double width = (to - from) / (few - 1);
    from += width * double(*at), to = from + width;
    if (different > 1) continue;
    Pair p;
    p.rays = way.rays(from, to, 2);
    p.made = ask(g.air(), p.rays, {0, 2});
    return p;
  }
  return {};
}

std::optional<Pair> jump_from(const AirGroup& g, int i) {
  return find_jump(g, draw_way(g, i, 0x3e77, 1), g.own ? 16 : 64);
}
Pair step_from(const AirGroup& g, int i) {
  Way way = draw_way(g, i, 0x57e9, 1e-2);
  Pair p;
  // Of two frames it is the eye that moves; what has functions of its own has been told
  // where the eye is.
  const bool frames = !g.own && way.move != glm::dvec3(0) && i % 2 == 0;
  if (frames) {
    p.later = g.world();
    p.later->eye += way.move;
    way.move = {};
  }
  p.rays = way.rays(0, 1, 2);
  p.made = ask(g.air(), p.rays, {0, 2});
  if (frames) {
    const Answers then = ask(g.compile(*p.later, g.isas.back()), p.rays, {0, 2});
    for (std::size_t c = 0; c < 3; ++c)
      p.made.T[c][1] = then.T[c][1], p.made.L[c][1] = then.L[c][1];
  }
  return p;
}

std::string print(const char* what, const Pair& p) {
  std::string text;
  for (const std::size_t k : {0, 1}) {
    const auto o = p.rays.origin(int(k)), d = p.rays.direction(int(k));
    const auto rgb = [&](const std::vector<float> v[3]) {
      return fmt::format("{} {} {}", v[0][k], v[1][k], v[2][k]);
    };
    text += fmt::format(
        "# {} {}: [{}, {}, {}] from the eye, along [{}, {}, {}], {} m: T {}, L {}\n",
        what, k ? "to" : "from", o.x, o.y, o.z, d.x, d.y, d.z, p.rays.t[k], rgb(p.made.T),
        rgb(p.made.L));
  }
  return text;
}

}  // namespace

void check_jumps(AirGroup& g, Findings& found) {
  for (int k = 0; k < (g.own ? 1 : 2); ++k) {
    Random r(g.options.seed ^ 0x1a3b, 2 * g.number + std::uint64_t(k));
    const int i = g.part.begin + integer(r, g.part.count);
    const auto p = jump_from(g, i);
    if (!p || at_an_edge(g, *p))
      found.holds(Law::jump, g.case_of(i), 0, 0, 0, true);
    else if (Pair q = *p; ask_truth(g, q))
      judge_pair(g, Law::jump, i, q, found);
    else
      found.undecided(Law::jump);
  }
}

void check_step(const AirGroup& g, int i, Findings& found) {
  Pair p = step_from(g, i);
  if (at_an_edge(g, p)) return;
  if (ask_truth(g, p))
    judge_pair(g, Law::step, i, p, found);
  else
    found.undecided(Law::step);
}

std::string describe_steps(const AirGroup& g, int i) {
  std::string text = print("step", step_from(g, i));
  if (const auto p = jump_from(g, i)) text += print("jump", *p);
  return text;
}

}  // namespace brume::stress
