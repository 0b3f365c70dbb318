#include "stress/air_group.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "pipeline/knobs.h"
#include "stress/draw.h"
#include "stress/scenery.h"

namespace brume::stress {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

// Where sources have functions of their own: what is far is dear, in fog of small cells
// above all, and ways to lamps are many. An eighth of the groups have rays of any length,
// the others none (but to places) longer than one drawn for the group.
bool goes_far(const AirGroup& g) { return !g.own || g.number % 8 == 0; }

// Every eighth world has lamps beside what is there; of sources with functions of their
// own every 28th, and of those whose rays go far every 32nd.
bool has_lamps(const AirGroup& g) {
  if (!g.own) return g.number % 8 == 5;
  return g.number % 32 == 5 || g.number % 256 == 24;
}

// Lights show only in something. Returns how far away they are, about.
double furnish(AirGroup& g) {
  World& w = g.subject.world;
  Random& r = g.random;
  double away = log_uniform(r, 1, 1e3);
  for (const auto& l : w.lights)
    if (l.what.kind == BRUME_POINT || l.what.kind == BRUME_SPOT) {
      const glm::dvec3 at(l.what.position[0], l.what.position[1], l.what.position[2]);
      away = std::clamp(glm::length(at - w.eye), 1e-3, 1e7);
    }
  const bool only_lights = w.media.empty() && !w.lights.empty();
  for (int k = only_lights ? 1 + integer(r, 4) / 3 : 0; k > 0; --k)
    w.media.push_back({draw_fog(r, g.frame, away), 0, k == 1 ? "fog" : "more fog"});
  if (!has_lamps(g) && !(only_lights && integer(r, 4) == 0)) return away;
  for (int k = 1 + integer(r, 3); k > 0; --k)
    w.lights.push_back(
        {integer(r, 6) ? draw_lamp(r, g.frame, away) : draw_sun(r, g.frame), 0, "lamp"});
  return away;
}

// Places that rays should go through: lamps, and the middles of what has bounds.
std::vector<glm::dvec3> places(const World& w) {
  std::vector<glm::dvec3> out;
  for (const auto& l : w.lights)
    if (l.what.kind == BRUME_POINT || l.what.kind == BRUME_SPOT)
      out.emplace_back(l.what.position[0], l.what.position[1], l.what.position[2]);
  for (const auto& p : w.media) {
    const double* a = p.what.local_from_world;
    if (p.what.profile == BRUME_LORENTZIAN)
      out.emplace_back(p.what.origin[0], p.what.origin[1], p.what.origin[2]);
    if (p.what.shape != BRUME_BOX && p.what.shape != BRUME_ELLIPSOID) continue;
    const glm::dmat3 A(a[0], a[4], a[8], a[1], a[5], a[9], a[2], a[6], a[10]);
    out.push_back(glm::inverse(A) * -glm::dvec3(a[3], a[7], a[11]));
  }
  return out;
}

void look_at(AirGroup& g) {
  const World& w = g.world();
  g.own = !w.shadowers.empty() || !w.interfaces.empty();
  g.constant = w.interfaces.empty();
  for (const auto& l : w.lights) g.own = g.own || l.what.radiance;
  for (const auto& p : w.media) {
    const brume_medium& m = p.what;
    const bool custom = m.profile == BRUME_CUSTOM || m.source == BRUME_SOURCE_CUSTOM;
    g.own = g.own || custom || m.alone;
    g.capped = g.capped || m.max_opacity < 1;
    g.sky = g.sky || m.is_sky;
    g.spectral = g.spectral || m.wavelengths > 0;
    const bool lit = !w.lights.empty() && (m.source == BRUME_SOURCE_SKY || m.albedo[0] ||
                                           m.albedo[1] || m.albedo[2]);
    if (m.source == BRUME_SOURCE_CUSTOM || lit) g.constant = false;
    for (int c = 0; c < 3; ++c) {
      g.dims = g.dims || m.extinction[c] > 0;
      if (m.emission[c] != 0) g.constant = false, g.emits = true;
      if (m.emission[c] != 0 && m.extinction[c] == 0) g.glows = true;
      if (m.extinction[c] > 0 && m.source == BRUME_SOURCE_COLOR)
        g.source[c] = std::max(g.source[c], m.color[c]);
    }
  }
  g.one_form = g.constant && w.media.size() == 1 && !w.media[0].what.alone;
}

// Distances at which the air is neither clear nor opaque: bisection of the logarithm for
// an optical depth drawn per ray.
void aim(AirGroup& g, const std::vector<char>& aimed) {
  const int n = g.rays.size();
  std::vector<float> wanted(static_cast<std::size_t>(n));
  std::vector<double> lo, hi;
  lo.assign(wanted.size(), std::log(1e-20));
  hi.assign(wanted.size(), std::log(1e20));
  for (float& x : wanted) x = float(std::exp(-log_uniform(g.random, 1e-4, 20)));
  Rays trial = g.rays;
  for (int step = 0; step < 14; ++step) {
    for (std::size_t i = 0; i < wanted.size(); ++i)
      trial.t[i] = float(std::exp((lo[i] + hi[i]) / 2));
    std::vector<float> T[3] = {wanted, wanted, wanted};
    float* const to[3] = {T[0].data(), T[1].data(), T[2].data()};
    const bool eye = trial.from_eye();
    const auto plane = [&](const std::vector<float>& v) { return v.data(); };
    g.air().transmittance(
        {n, eye ? nullptr : plane(trial.o[0]), eye ? nullptr : plane(trial.o[1]),
         eye ? nullptr : plane(trial.o[2]), plane(trial.d[0]), plane(trial.d[1]),
         plane(trial.d[2]), plane(trial.t)},
        {}, to);
    for (std::size_t i = 0; i < wanted.size(); ++i)
      (T[0][i] > wanted[i] ? lo : hi)[i] = (lo[i] + hi[i]) / 2;
  }
  for (std::size_t i = 0; i < wanted.size(); ++i)
    if (aimed[i]) g.rays.t[i] = trial.t[i];
}

void by_distance(Rays& rays) {
  std::vector<std::size_t> order(rays.t.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return rays.t[a] < rays.t[b]; });
  const Rays as_drawn = rays;
  const auto arrange = [&](std::vector<float>& to, const std::vector<float>& from) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = from[order[i]];
  };
  for (int c = 0; c < 3; ++c)
    arrange(rays.o[c], as_drawn.o[c]), arrange(rays.d[c], as_drawn.d[c]);
  arrange(rays.t, as_drawn.t);
}

void draw_rays(AirGroup& g, double away) {
  Random& r = g.random;
  const double longest = goes_far(g)                 ? kInf
                         : !g.world().lights.empty() ? away * log_uniform(r, 1, 100)
                                                     : log_uniform(r, 1e-2, 1e4);
  const bool around = g.number % 4 == 3;
  const double reach = log_uniform(r, 1e-3, 1e6);
  const std::vector<glm::dvec3> through = places(g.world());
  std::vector<char> aimed;
  for (int i = 0; i < kGroup; ++i) {
    if (around)
      for (auto& o : g.rays.o) o.push_back(float(r.uniform(-reach, reach)));
    glm::dvec3 d = draw_direction(r, g.frame.up);
    double t = draw_distance(r);
    if (t > longest) t = longest * r.uniform();
    aimed.push_back(i % 2 == 0);
    if (!through.empty() && i % 4 != 3) {
      // Through it, past it, away from it; to it, before it, beyond.
      const auto k = std::size_t(integer(r, int(through.size())));
      const glm::dvec3 to = through[k] - g.world().eye - g.rays.origin(i);
      const double far = glm::length(to), miss = integer(r, 3);
      if (far > 0 && far < 1e30) {
        glm::dvec3 way = to / far;
        if (miss > 0) way += log_uniform(r, 1e-7, 1) * d;
        d = (integer(r, 8) ? 1. : -1.) * glm::normalize(way);
        const int end = integer(r, 4);
        if (end < 3) t = far * (end == 0 ? 1 : log_uniform(r, 0.5, 2));
        aimed.back() = aimed.back() && end == 3;
      }
    }
    for (int c = 0; c < 3; ++c) g.rays.d[c].push_back(float(d[c]));
    g.rays.t.push_back(float(t));
  }
  // Sources with functions of their own are dear; theirs are as drawn. In seven
  // groups of eight rays that go as far are neighbours, so that few wait for one that
  // goes farther.
  if (g.number % 8 != 2 && g.own) by_distance(g.rays);
  if (!g.own && g.dims) aim(g, aimed);
}

}  // namespace

void Rays::place() {
  if (from_eye())
    for (auto& x : o) x.assign(t.size(), 0.f);
}

Answers ask(const Air& air, const Rays& rays, Part part, const float* weight, int shift) {
  const auto first = std::size_t(part.begin), count = std::size_t(part.count),
             off = std::size_t(shift);
  std::vector<float> in(8 * (count + off) + off);
  const float* at[8];
  const float* const planes[8] = {
      rays.o[0].data(), rays.o[1].data(), rays.o[2].data(), rays.d[0].data(),
      rays.d[1].data(), rays.d[2].data(), rays.t.data(),    weight};
  for (std::size_t k = 0; k < 8; ++k) {
    at[k] = nullptr;
    if (!planes[k] || (k < 3 && rays.from_eye())) continue;
    float* to = in.data() + k * (count + off) + off;
    std::copy_n(planes[k] + first, count, to);
    at[k] = to;
  }
  std::vector<float> out(6 * (count + off) + off, -7.f);
  float* to[6];
  for (std::size_t k = 0; k < 6; ++k) to[k] = out.data() + k * (count + off) + off;
  const float* const weights[1] = {at[7]};
  air.integrate(
      {part.count, at[0], at[1], at[2], at[3], at[4], at[5], at[6]},
      weight ? std::span<const float* const>(weights) : std::span<const float* const>(),
      {{to[0], to[1], to[2]}, {to[3], to[4], to[5]}, {}, {}});
  Answers a;
  for (std::size_t c = 0; c < 3; ++c) {
    a.T[c].resize(first + count);
    a.L[c].resize(first + count);
    std::copy_n(to[c], count, a.T[c].begin() + part.begin);
    std::copy_n(to[3 + c], count, a.L[c].begin() + part.begin);
  }
  return a;
}

namespace {

// The integrator's tolerance that promises this error, as the pipeline chooses it.
std::string bounds(const brume_medium& m) {
  const char* names[] = {"everywhere", "half space", "box", "ellipsoid"};
  std::string text = names[m.shape];
  if (m.shape == BRUME_EVERYWHERE) return text;
  text += " by [";
  for (int i = 0; i < 12; ++i)
    text += fmt::format("{}{}", i ? ", " : "", m.local_from_world[i]);
  return text + "]";
}

double knob_for(double error) {
  const std::span<const double> curve = air_curve();  // value, error, value, error, ...
  for (std::size_t k = 0; k + 1 < curve.size(); k += 2)
    if (curve[k + 1] <= error) return curve[k];
  return error;
}

}  // namespace

Air AirGroup::compile(const World& world, Isa isa) const {
  return subject.compile(world, {.tolerance = knob_for(options.tolerance),
                                 .white = options.white,
                                 .stages = 1,
                                 .isa = isa});
}

void AirGroup::judge(Part which, const Answers& light) {
  for (int i = which.begin; i < which.begin + which.count; ++i) {
    const auto k = std::size_t(i);
    const float most = std::max({light.L[0][k], light.L[1][k], light.L[2][k]});
    brightest[k] = std::isfinite(most) ? most : 0;
  }
  const std::optional<Air> whole = without_cones();
  if (!whole) return;
  const Part lit = which.count == kGroup ? part : which;
  const Answers a = ask(*whole, rays, lit);
  for (int c = 0; c < 3; ++c)
    std::copy_n(a.L[c].begin() + lit.begin, lit.count, uncut[c].begin() + lit.begin);
}

std::optional<Air> AirGroup::without_cones() const {
  World whole = world();
  bool spots = false;
  for (auto& l : whole.lights)
    if (l.what.kind == BRUME_SPOT) spots = true, l.what.kind = BRUME_POINT;
  if (!spots) return {};
  return compile(whole, isas.back());
}

std::string AirGroup::describe(int i) {
  const auto k = std::size_t(i);
  const glm::dvec3 e = frame.eye, u = frame.up, p = e + rays.origin(i),
                   d = rays.direction(i);
  const auto vec = [](const auto& v) {
    return fmt::format("[{}, {}, {}]", v[0], v[1], v[2]);
  };
  std::string there;
  for (const auto& l : world().lights)
    there += fmt::format(
        "# {} at {}, toward {}, power {}, radius {}, cone {} soft {}{}\n",
        l.what.kind == BRUME_SPOT    ? "spotlight"
        : l.what.kind == BRUME_POINT ? "lamp"
                                     : "sun or sky",
        vec(l.what.position), vec(l.what.direction), vec(l.what.power), l.what.radius,
        l.what.cone, l.what.cone_soft, l.what.attenuated ? ", dimmed" : "");
  for (const auto& m : world().media)
    if (!world().lights.empty())
      there += fmt::format(
          "# {}: {}, profile {}, extinction {}, albedo {}, g {}, falloff {}\n", m.name,
          bounds(m.what), int(m.what.profile), vec(m.what.extinction), vec(m.what.albedo),
          m.what.g, m.what.falloff);
  const Answers a = ask(air(), rays, {i, 1});
  return there +
         fmt::format(
             "# eye {}, up {}\n# ray from {} along {}, {} m\n# T {} {} {}, L {} {} {}\n",
             vec(e), vec(u), vec(p), vec(d), rays.t[k], a.T[0][k], a.T[1][k], a.T[2][k],
             a.L[0][k], a.L[1][k], a.L[2][k]) +
         describe_steps(*this, i);
}

std::unique_ptr<Group> make_air_group(const Setting& setting, const Options& options,
                                      std::uint64_t number, Random random,
                                      Clock::time_point until) {
  auto group = std::make_unique<AirGroup>(number);
  AirGroup& g = *group;
  g.options = options;
  g.random = random;
  g.frame = setting.frame;
  g.subject = setting.subject;
  look_at(g);
  const double away = furnish(g);
  look_at(g);
  // A frame is exposed for its sky: one of a million whites has that for its white.
  for (const auto& l : g.world().lights)
    if (g.sky && l.what.kind == BRUME_SKY_LIGHT)
      for (const double x : l.what.power) g.options.white = std::max(g.options.white, x);
  if (g.own && until != Clock::time_point::max())
    g.patience = std::make_unique<Patience>(g.subject.world, until);
  if (g.own) g.part = {16 * int((number + number / 8) % 8), 16};
  for (const Isa isa : {Isa::v2, Isa::v3, Isa::v4})
    if (isa <= best_isa()) {
      g.isas.push_back(isa);
      g.airs.push_back(g.compile(g.world(), isa));
    }
  draw_rays(g, away);
  for (auto* of : {&g.uncut[0], &g.uncut[1], &g.uncut[2], &g.brightest})
    of->resize(std::size_t(kGroup));
  return group;
}

}  // namespace brume::stress
