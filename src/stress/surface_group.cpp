#include "stress/surface_group.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "stress/draw.h"
#include "stress/scenery.h"

namespace brume::stress {
namespace {

constexpr double kEps = std::numeric_limits<float>::epsilon();
constexpr double kInf = std::numeric_limits<double>::infinity();

template <class F>
void each(const Pixels& p, F&& f) {
  for (int i = 0; i < p.size(); ++i)
    for (int c = 0; c < 3; ++c) f(i, c, p.at(i));
}

// Light of a sun that comes through the first 1e30 m of an endless level way, which is as
// far as the product goes, through air so thin that only what lies beyond ends it.
double beyond_floats(const World& w, const glm::dvec3& x, const glm::dvec3& way) {
  constexpr double kFar = 1e30;
  double most = 0;
  for (const auto& p : w.media) {
    const brume_medium& m = p.what;
    if (m.shape != BRUME_EVERYWHERE && m.shape != BRUME_HALF_SPACE) continue;
    double up = 0, slope = 0;
    if (m.profile == BRUME_EXPONENTIAL)
      for (int i = 0; i < 3; ++i) {
        up += m.falloff * m.direction[i] * (x[i] + w.eye[i] - m.origin[i]);
        slope += m.falloff * m.direction[i] * way[i];
      }
    if (std::abs(slope) * kFar > 1) continue;
    for (const double extinction : m.extinction)
      if (extinction > 0)
        most = std::max(most, std::exp(-extinction * std::exp(-up) * kFar));
  }
  return most;
}

glm::dvec3 vec(const std::vector<float> (&v)[3], std::size_t k) {
  if (v[0].empty()) return {0, 0, 0};
  return {v[0][k], v[1][k], v[2][k]};
}

}  // namespace

AirOptions SurfaceGroup::air_options() const {
  AirOptions o;
  o.tolerance = options.tolerance;
  o.white = options.white;
  o.stages = 1;
  return o;
}

Pixels SurfaceGroup::run(const PixelStage& with, const World& there, Pixels p) const {
  const Shown around(there, air_options());
  run_on(with, p, &around.fast());
  return p;
}

bool SurfaceGroup::is_surface(int i) const {
  const std::size_t k = in.at(i);
  return in.alpha[k] > 0 && in.t[k] > 0 && in.t[k] < 1e30f;
}

double SurfaceGroup::ray_spacing(int i) const {
  constexpr int kBeside[][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
  const int x = i % in.width, y = i / in.width;
  const glm::dvec3 own = vec(in.d, in.at(i));
  double least = kInf;
  for (const auto& [dx, dy] : kBeside)
    if (x + dx >= 0 && x + dx < in.width && y + dy >= 0 && y + dy < in.height)
      least = std::min(least, glm::length(vec(in.d, in.at(x + dx, y + dy)) - own));
  return least;
}

bool SurfaceGroup::has_vectors() const {
  return std::any_of(stage.needs.channels.begin(), stage.needs.channels.end(),
                     [](const std::string& name) { return name.ends_with(".X"); });
}

SurfaceGroup::Bound SurfaceGroup::bound(int i, bool same) const {
  Bound b;
  if (!is_surface(i)) return b;
  const std::size_t k = in.at(i);
  const double t = double(in.t[k]), a = std::min(double(in.alpha[k]), 1.);
  const glm::dvec3 o = vec(in.o, k), x = o + t * vec(in.d, k);
  // Directions are floats: over the angle between two that is what a normal may be off
  // by. It is the pixel's own: far off a perspective's axis pixels are narrow.
  const double width = frame.orthographic() ? frame.pixel_footprint / std::max(t, 1e-30)
                                            : ray_spacing(i),
               tilt = has_vectors() ? 8 * kEps
                      : same        ? 64 * kEps
                                    : 64 * kEps / width * (1 + glm::length(o) / t);
  for (const auto& p : shown->world().lights) {
    const brume_light& l = p.what;
    const bool lamp = l.kind == BRUME_POINT || l.kind == BRUME_SPOT;
    double part = 1, off = 16 * kEps + tilt, legs = 0;
    glm::dvec3 way(l.direction[0], l.direction[1], l.direction[2]);
    double far = kInf;
    if (l.kind == BRUME_SKY_LIGHT) part = M_PI;
    if (lamp) {
      way = glm::dvec3(l.position[0], l.position[1], l.position[2]) - shown->world().eye -
            x;
      const double away = 8 * kEps * (glm::length(x) + glm::length(x + way) + t);
      far = glm::length(way);
      const double near = std::max({far - away, l.radius, 1e-15});
      part = 1 / (near * near);
      const double turn = away / std::max(far, 1e-30);
      off += std::min(2 * turn + 2 * away / near, 4.);
      if (l.kind == BRUME_SPOT) {
        const double theta = std::acos(std::clamp(
            -glm::dot(way, glm::dvec3(l.direction[0], l.direction[1], l.direction[2])) /
                std::max(far, 1e-30),
            -1., 1.));
        const double soft = l.cone_falloff ? std::max(theta, 1e-12) : l.cone_soft;
        const double slip = turn + 8 * kEps;
        off += soft > 0 ? std::min(1.5 * slip / soft, 1.)
                        : double(std::abs(theta - l.cone) <= 4 * slip);
      }
      way /= std::max(far, 1e-30);
    }
    if (l.attenuated && l.kind != BRUME_SKY_LIGHT) {
      const Slack s = slack_of(shown->world(), x, way, far, options.tolerance);
      legs = s.of_opacity(1) + 8 * kEps;
      if (!lamp) legs += beyond_floats(shown->world(), x, way);
      legs = std::min(legs, 1.);
    }
    for (int c = 0; c < 3; ++c) {
      const double most = a / M_PI * l.power[c] * part;
      b.most[c] += most;
      b.off[c] += most * (off + legs);
    }
  }
  return b;
}

double SurfaceGroup::allowed(const Bound& b, int c, std::size_t k, double value,
                             double times) const {
  const double own = std::isfinite(in.rgb[c][k]) ? std::abs(double(in.rgb[c][k])) : 0;
  return times * (0.1 * options.tolerance * options.white + b.off[c] +
                  8 * kEps * (own + std::abs(value)));
}

namespace {

void check_values(const SurfaceGroup& g, Findings& found) {
  each(g.in, [&](int i, int c, std::size_t k) {
    const float x = g.in.rgb[c][k], y = g.out.rgb[c][k];
    const std::uint64_t n = g.case_of(i);
    if (std::isfinite(x)) found.holds(Law::finite, n, c, y, x, std::isfinite(y));
    if (c == 0 && !g.stage.needs.changes_alpha)
      found.same(Law::alpha, n, c, g.out.alpha[k], g.in.alpha[k]);
    if (x >= 0 && std::isfinite(x)) found.holds(Law::positive, n, c, y, 0, y >= 0);
    if (!g.lights) return;
    if (std::isfinite(x)) found.holds(Law::positive, n, c, y, x, y >= x);
    if (!g.is_surface(i)) found.same(Law::dark, n, c, y, x);
    const SurfaceGroup::Bound b = g.bound(i);
    if (std::isfinite(x))
      found.at_most(Law::energy, n, c, double(y) - double(x), b.most[c] * (1 + 1e-5),
                    8 * kEps * std::abs(double(x)));
  });
}

// In other tiles, elsewhere in memory; beside pixels that hold no numbers.
void check_cuts(SurfaceGroup& g, Findings& found) {
  const int w = g.in.width, h = g.in.height;
  Pixels cut = g.in.moved(1 + integer(g.random, 15));
  const int x = integer(g.random, w), y = integer(g.random, h);
  for (const Window& part : {Window{0, 0, x, h}, {x, 0, w - x, y}, {x, y, w - x, h - y}})
    if (!part.empty()) run_on(g.stage, cut, part, &g.shown->fast());
  each(g.in, [&](int i, int c, std::size_t k) {
    found.same(Law::lanes, g.case_of(i), c, cut.rgb[c][cut.at(i)], g.out.rgb[c][k]);
  });

  // All of one column, and the colours of some others.
  Pixels bad = g.in;
  const int column = integer(g.random, w);
  const auto lost = [&](int i) { return i % w == column || i % 5 == 2; };
  for (int i = 0; i < bad.size(); ++i) {
    const std::size_t k = bad.at(i);
    if (!lost(i)) continue;
    for (auto& plane : bad.rgb) plane[k] = draw_bad(g.random);
    bad.alpha[k] = draw_bad(g.random);
    if (i % w != column) continue;
    bad.t[k] = draw_bad(g.random);
    for (auto& plane : bad.channels)
      if (!plane.empty()) plane[k] = draw_bad(g.random);
  }
  bad.replicate();
  run_on(g.stage, bad, &g.shown->fast());
  const int around = std::max(g.stage.needs.columns_around, 0);
  each(g.in, [&](int i, int c, std::size_t k) {
    if (!lost(i) && std::abs(i % w - column) > around)
      found.same(Law::neighbours, g.case_of(i), c, bad.rgb[c][k], g.out.rgb[c][k]);
  });
}

// Nothing without lights; with two parts of them the sum of each; in another order the
// same.
void check_lights(SurfaceGroup& g, Findings& found) {
  std::vector<std::size_t> parts[2];
  const std::size_t n = g.world.lights.size();
  for (std::size_t k = 0; k < n; ++k) parts[integer(g.random, 2)].push_back(k);
  const Pixels none = g.run(g.stage, with_lights(g.world, {}), g.in),
               a = g.run(g.stage, with_lights(g.world, parts[0]), g.in),
               b = g.run(g.stage, with_lights(g.world, parts[1]), g.in);
  World mixed = g.world;
  std::reverse(mixed.lights.begin(), mixed.lights.end());
  std::reverse(mixed.media.begin(), mixed.media.end());
  const Pixels other = g.run(g.stage, mixed, g.in);
  each(g.in, [&](int i, int c, std::size_t k) {
    const double x = double(g.in.rgb[c][k]);
    found.same(Law::order, g.case_of(i), c, other.rgb[c][k], g.out.rgb[c][k]);
    found.same(Law::dark, g.case_of(i), c, none.rgb[c][k], g.in.rgb[c][k]);
    if (!std::isfinite(x)) return;
    const double sum = double(a.rgb[c][k]) + double(b.rgb[c][k]) - x;
    // Alone each part may leave out what is too weak; of rounding there is none but that
    // of adding up.
    found.near(Law::additive, g.case_of(i), c, double(g.out.rgb[c][k]), sum,
               0.3 * g.options.tolerance * g.options.white +
                   8 * kEps * (std::abs(sum) + std::abs(x)));
  });
}

// The stage and the light on it on lower instruction sets.
void check_isas(SurfaceGroup& g, Findings& found) {
  for (const PixelStage::Lower& lower : g.stage.lower) {
    AirOptions o = g.air_options();
    o.isa = lower.isa;
    const Shown shown(g.world, o);
    PixelStage there = g.stage;
    there.run = lower.run;
    Pixels p = g.in;
    run_on(there, p, &shown.fast());
    each(g.in, [&](int i, int c, std::size_t at) {
      // Where faces meet, the last bit decides which is which.
      if (!std::isfinite(g.in.rgb[c][at]) || (!g.smooth && !g.has_vectors())) return;
      const double want = double(g.out.rgb[c][at]);
      found.near(Law::isa, g.case_of(i), c, double(p.rgb[c][at]), want,
                 g.allowed(g.bound(i, true), c, at, want, 2));
    });
  }
}

// The same in other units, and turned about the eye.
void check_scale(SurfaceGroup& g, Findings& found) {
  const double k = log_uniform(g.random, 1e-6, 1e6);
  const auto normal = [](double x) { return x == 0 || (x > 1e-30 && x < 1e30); };
  for (const auto& m : g.world.media)
    for (const double x : m.what.extinction)
      if (!normal(x) || !normal(x / k)) return;
  FrameInfo frame = g.frame;
  frame.eye *= k;
  if (frame.orthographic()) frame.pixel_footprint *= k;
  Pixels p = g.in;
  for (float& t : p.t) t = float(double(t) * k);
  for (auto& plane : p.o)
    for (float& x : plane) x = float(double(x) * k);
  const Pixels there = g.run(g.subject.at(frame), scaled(g.world, k), p);
  each(g.in, [&](int i, int c, std::size_t at) {
    const double t = double(g.in.t[at]);
    if (!g.is_surface(i) || !std::isfinite(g.in.rgb[c][at]) || !normal(t) ||
        !normal(t * k))
      return;
    if (!g.smooth && !g.has_vectors()) return;  // edges are decided by the last bit
    const SurfaceGroup::Bound b = g.bound(i);
    found.near(Law::scale, g.case_of(i), c, double(there.rgb[c][at]),
               double(g.out.rgb[c][at]),
               g.allowed(b, c, at, double(g.out.rgb[c][at]), 3));
  });
}

void check_turn(SurfaceGroup& g, Findings& found) {
  if (g.has_vectors() || !g.smooth) return;
  const glm::dvec3 a = draw_direction(g.random, {0, 0, 1});
  const glm::dvec3 b = glm::normalize(
      glm::cross(a, std::abs(a.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
  const glm::dmat3 R(a, b, glm::cross(a, b));
  FrameInfo frame = g.frame;
  frame.forward = R * frame.forward, frame.up = R * frame.up;
  frame.camera_right = R * frame.camera_right, frame.camera_up = R * frame.camera_up;
  if (frame.sun) frame.sun->to = R * frame.sun->to;
  Pixels p = g.in;
  for (auto* three : {p.d, p.o})
    for (std::size_t k = 0; k < three[0].size(); ++k) {
      const glm::dvec3 v =
          R * glm::dvec3(double(three[0][k]), double(three[1][k]), double(three[2][k]));
      for (int c = 0; c < 3; ++c) three[c][k] = float(v[c]);
    }
  const Pixels there = g.run(g.subject.at(frame), turned(g.world, R), p);
  each(g.in, [&](int i, int c, std::size_t at) {
    if (!std::isfinite(g.in.rgb[c][at])) return;
    found.near(Law::turn, g.case_of(i), c, double(there.rgb[c][at]),
               double(g.out.rgb[c][at]),
               g.allowed(g.bound(i), c, at, double(g.out.rgb[c][at]), 3));
  });
}

}  // namespace

void SurfaceGroup::check_laws(Findings& found) {
  check_values(*this, found);
  check_cuts(*this, found);
  check_isas(*this, found);
  if (!lights) return;
  check_lights(*this, found);
  check_scale(*this, found);
  check_turn(*this, found);
}

Verdict SurfaceGroup::check_truth(int i, Findings& found) {
  // Where faces meet, the last bit decides which is which.
  if (!stage.truth || (!smooth && !has_vectors())) return Verdict::none;
  const std::array<double, 3> want = truth_of(stage, in, i, &shown->truth());
  const Bound b = bound(i, true);
  for (int c = 0; c < 3; ++c) {
    const double x = want[std::size_t(c)];
    if (!std::isfinite(x)) continue;
    found.near(Law::truth, case_of(i), c, double(out.rgb[c][in.at(i)]), x,
               allowed(b, c, in.at(i), x, 1));
  }
  return Verdict::given;
}

std::string SurfaceGroup::describe(int i) {
  const std::size_t k = in.at(i);
  const auto text = [](const auto& v) {
    return fmt::format("[{}, {}, {}]", v[0], v[1], v[2]);
  };
  std::string there;
  for (const auto& l : world.lights)
    there += fmt::format(
        "# light {} at {}, toward {}, power {}, radius {}, cone {} soft {} falloff "
        "{}{}\n",
        int(l.what.kind), text(l.what.position), text(l.what.direction),
        text(l.what.power), l.what.radius, l.what.cone, l.what.cone_soft,
        l.what.cone_falloff, l.what.attenuated ? ", dimmed" : "");
  for (const auto& m : world.media)
    there += fmt::format("# fog: shape {}, extinction {}, falloff {}\n",
                         int(m.what.shape), text(m.what.extinction), m.what.falloff);
  std::string channels;
  for (std::size_t j = 0; j < in.channels.size(); ++j)
    if (!in.channels[j].empty()) channels += fmt::format(" {}", in.channels[j][k]);
  return there + fmt::format(
                     "# {} x {} pixels of {} {}, eye {}, forward {}\n"
                     "# pixel ({}, {}): {} m along {} from {}, alpha {}, channels{}\n"
                     "# colour {} {} {}, out {} {} {}\n",
                     in.width, in.height, frame.pixel_footprint,
                     frame.orthographic() ? "m" : "rad", text(frame.eye),
                     text(frame.forward), i % in.width, i / in.width, in.t[k],
                     text(vec(in.d, k)), text(vec(in.o, k)), in.alpha[k], channels,
                     in.rgb[0][k], in.rgb[1][k], in.rgb[2][k], out.rgb[0][k],
                     out.rgb[1][k], out.rgb[2][k]);
}

std::unique_ptr<Group> make_surface_group(const Setting& setting, const Options& options,
                                          std::uint64_t number, Random random) {
  auto g = std::make_unique<SurfaceGroup>(number);
  g->options = options;
  g->random = random;
  g->frame = setting.frame;
  g->subject = setting.subject;
  g->lights = setting.subject.step == BRUME_LIGHT_STEP;
  draw_surfaces(*g);
  g->shown = std::make_unique<Shown>(g->world, g->air_options());
  g->out = g->in;
  run_on(g->stage, g->out, &g->shown->fast());
  return g;
}

}  // namespace brume::stress
