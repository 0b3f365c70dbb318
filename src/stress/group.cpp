#include "stress/group.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "num/error.h"
#include "stress/draw.h"

namespace brume::stress {
namespace {

// Every eighth world has a lamp near the eye.
void add_lamp(World& w, Random& r) {
  brume_light lamp = {};
  lamp.size = sizeof lamp;
  lamp.name = "";
  lamp.kind = BRUME_POINT;
  for (int i = 0; i < 3; ++i) {
    lamp.position[i] = w.eye[i] + r.uniform(-30, 30);
    lamp.power[i] = log_uniform(r, 1e-2, 1e3);
  }
  lamp.direction[2] = -1;
  lamp.radius = log_uniform(r, 1e-2, 1);
  lamp.attenuated = r.uniform() < 0.25;
  w.lights.push_back({lamp, 0, "lamp"});
}

void look_at(Group& g) {
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
    const bool lit = !w.lights.empty() && (m.source == BRUME_SOURCE_SKY || m.albedo[0] ||
                                           m.albedo[1] || m.albedo[2]);
    if (m.source == BRUME_SOURCE_CUSTOM || lit) g.constant = false;
    for (int c = 0; c < 3; ++c) {
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
void aim(Group& g, const std::vector<char>& aimed) {
  const int n = g.rays.size();
  std::vector<float> wanted(static_cast<std::size_t>(n));
  std::vector<double> lo(wanted.size(), std::log(1e-20)),
      hi(wanted.size(), std::log(1e20));
  for (float& x : wanted) x = float(std::exp(-log_uniform(g.random, 1e-4, 20)));
  Rays trial = g.rays;
  for (int step = 0; step < 14; ++step) {
    for (std::size_t i = 0; i < wanted.size(); ++i)
      trial.t[i] = float(std::exp((lo[i] + hi[i]) / 2));
    const Answers a = ask(g.air(), trial);
    for (std::size_t i = 0; i < wanted.size(); ++i)
      (a.T[0][i] > wanted[i] ? lo : hi)[i] = (lo[i] + hi[i]) / 2;
  }
  for (std::size_t i = 0; i < wanted.size(); ++i)
    if (aimed[i]) g.rays.t[i] = trial.t[i];
}

void draw_rays(Group& g) {
  Random& r = g.random;
  const bool around = g.number % 4 == 3;
  const double reach = log_uniform(r, 1e-3, 1e6);
  std::vector<char> aimed;
  for (int i = 0; i < kGroup; ++i) {
    const glm::dvec3 d = draw_direction(r, g.frame.up);
    for (int c = 0; c < 3; ++c) g.rays.d[c].push_back(float(d[c]));
    g.rays.t.push_back(float(draw_distance(r)));
    if (around)
      for (auto& o : g.rays.o) o.push_back(float(r.uniform(-reach, reach)));
    aimed.push_back(i % 2 == 0);
  }
  // Sources with functions of their own are dear; theirs are as drawn.
  if (!g.own) aim(g, aimed);
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

Air compile(const World& world, const Options& o, Isa isa) {
  return Air::compile(
      world, {.tolerance = o.tolerance, .white = o.white, .stages = 1, .isa = isa});
}

std::optional<Setting> make_setting(const Maker& maker, const Options& options,
                                    std::uint64_t number) {
  Setting s;
  s.number = number;
  s.random = Random(options.seed, number);
  s.frame = draw_frame(s.random);
  auto subject = maker(s.random, s.frame);
  if (!subject) return {};
  s.subject = std::move(*subject);
  return s;
}

std::uint64_t groups_per_world(const Maker& maker, const Options& options) {
  for (std::uint64_t number = 0; number < 64; ++number) {
    std::optional<Setting> s;
    try {
      s = make_setting(maker, options, number);
    } catch (const Error&) {
      continue;
    }
    if (!s) continue;
    const auto& media = s->subject.world.media;
    const bool sky =
        std::any_of(media.begin(), media.end(), [](auto& m) { return m.what.is_sky; });
    return sky ? 64 : 1;
  }
  return 1;
}

Group make_group(const Setting& setting, const Options& options, std::uint64_t share,
                 std::uint64_t number) {
  Group g;
  g.number = number;
  g.random = share == 1 ? setting.random : Random(~options.seed, number);
  g.frame = setting.frame;
  g.subject = setting.subject;
  if (number % 8 == 5) add_lamp(g.subject.world, g.random);
  look_at(g);
  if (g.own) g.part = {16 * int(number % 8), 16};
  for (const Isa isa : {Isa::v2, Isa::v3, Isa::v4})
    if (isa <= best_isa()) {
      g.isas.push_back(isa);
      g.airs.push_back(compile(g.world(), options, isa));
    }
  draw_rays(g);
  return g;
}

}  // namespace brume::stress
