#include "truth/truth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "truth/detail.h"
#include "truth/geometry.h"
#include "truth/march.h"
#include "truth/physics.h"
#include "truth/segments.h"
#include "truth/way.h"

namespace brume::truth {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

bool any(const Rgb& c) { return c[0] != 0 || c[1] != 0 || c[2] != 0; }

Ray ray_of(const World& w, const glm::dvec3& origin, const glm::dvec3& direction,
           double end) {
  // Scaled first: the square of a direction's length may be beyond double.
  const glm::dvec3 a = glm::abs(direction);
  return {origin - w.eye, glm::normalize(direction / std::max({a.x, a.y, a.z})), end};
}

/// Light on its way to points of the ray.
struct Lights {
  const World& world;
  const Ray& ray;
  double share;  ///< error that the ways to each light may make in L
  Obstacles obstacles;
  std::vector<Ways> ways;  ///< by light
  mutable std::vector<WaysToLight> smooth;
  std::vector<std::optional<WaysThroughDetail>> detailed;
  std::vector<Place> places;  ///< kinks and peaks of what they send

  Lights(const World& w, const Ray& r, const Options& o, Cost& cost)
      : world(w), ray(r), share(kError * o.tolerance * o.white), obstacles(w) {
    ways.reserve(w.lights.size());
    for (const auto& l : w.lights) {
      ways.emplace_back(w, obstacles, l.what, r, cost);
      smooth.emplace_back(ways.back());
      detailed.emplace_back();
      if (ways.back().through_detail()) {
        detailed.back().emplace(ways.back());
        through_detail.push_back(&ways.back());
      }
      add_lamp(w, l.what, r, places);
      for (const double v : ways.back().edges())
        places.push_back({ways.back().t_of(v), 0});
    }
    share /= double(std::max<std::ptrdiff_t>(
        1, std::ranges::count_if(w.lights,
                                 [](const auto& l) { return l.what.attenuated; })));
  }

  /// Irradiance from light k at t, dimmed. Of the light S E, with S the part scattered
  /// per metre toward the ray's origin, `through` arrives there, and `sigma` ends it.
  Rgb dimmed(std::size_t k, const Incident& in, double t, const Rgb& S, double through,
             const Rgb& sigma) const {
    Rgb tau, E = in.E;
    if (detailed[k]) {
      sent.push_back({t, k, {S[0] * E[0], S[1] * E[1], S[2] * E[2]}});
      tau = detailed[k]->at(t);
    } else {
      // What it may be worth in the picture: a lamp shines like this about as far along
      // the ray as it is away. So much the less its way need be known.
      double worth = 0;
      for (std::size_t c = 0; c < 3; ++c)
        if (S[c] > 0)
          worth = std::max(
              worth, through * S[c] * in.E[c] * std::min(in.distance, 1 / sigma[c]));
      tau = smooth[k].at(t, share / (kScales * worth));
    }
    for (std::size_t c = 0; c < 3; ++c) E[c] *= std::exp(-tau[c]);
    return E;
  }
  /// Error that ways have made in L.
  double error() const {
    double sum = 0;
    for (const WaysToLight& way : smooth)
      if (way.asked()) sum += share * way.worst();
    return sum;
  }

  /// What a light sends to a point of the ray, scattered toward the eye, per metre.
  struct Sent {
    double t;
    std::size_t light;
    Rgb light_per_metre;
  };
  mutable std::vector<Sent> sent;
  std::vector<const Ways*> through_detail;

  void begin_march() {
    sent.clear();
    for (auto& d : detailed)
      if (d) d->forget_light();
  }
  /// The light of detailed ways at the nodes of what a march has taken, at the eye as if
  /// extinction were even in each piece. `factor` by lane; lane k is of colour k % 3.
  template <int N>
  void weigh(const std::vector<typename March<N>::Taken>& pieces,
             const std::array<double, N>& factor) {
    std::ranges::sort(sent, {}, &Sent::t);
    for (const auto& p : pieces)
      for (int k = 0; k < kNodes; ++k) {
        const double t = node(p.a, p.b, k), x = (1 + nodes().x[k]) / 2;
        Rgb arrives{};
        for (std::size_t lane = 0; lane < N; ++lane)
          arrives[lane % 3] += factor[lane] * (p.b - p.a) / 2 * nodes().w[k] *
                               std::exp(-(p.before[lane] + x * p.own[lane]));
        for (auto s = std::ranges::lower_bound(sent, t, {}, &Sent::t);
             s != sent.end() && s->t == t; ++s) {
          Rgb light;
          for (std::size_t c = 0; c < 3; ++c)
            light[c] = arrives[c] * s->light_per_metre[c];
          detailed[s->light]->add_light(t, light);
        }
      }
    sent.clear();
  }
  /// Asks for more ways through detail where L, with what it is now, needs them. Whether
  /// it has.
  bool refine_detail(const Rgb& L, const Options& o, long& budget) {
    std::vector<WaysThroughDetail*> all;
    for (auto& d : detailed)
      if (d) all.push_back(&*d);
    const double part = o.enough > 0 ? o.enough : kError * o.tolerance;
    Rgb goal;
    for (std::size_t c = 0; c < 3; ++c) goal[c] = part * (o.white + std::abs(L[c]));
    const bool more = refine(all, goal, *through_detail[0], budget);
    WaysThroughDetail::Off off;
    for (const WaysThroughDetail* d : all) off.add(d->off());
    detail_error = off.all();
    enough = true;
    for (std::size_t c = 0; c < 3; ++c) enough = enough && detail_error[c] <= goal[c];
    return more;
  }
  Rgb detail_error{};
  bool enough = true;

  /// Of the tolerance, what all ways together may make of it.
  static constexpr double kError = 0.5;
  /// Distances from a lamp, in powers of e, from which its light matters.
  static constexpr double kScales = 4;
};

/// What the media of three colours are at a point of the view ray.
struct ByColour {
  const World& world;
  const Ray& ray;
  const Options& options;
  mutable Lights lights;
  Cost& cost;

  bool detailed() const { return !lights.through_detail.empty(); }
  bool shines(const OnRay& on) const {
    return options.only_stage < 0 || on.stage == options.only_stage;
  }

  /// A medium that answers to lights.
  struct Answering {
    const brume_medium* medium;
    Rgb extinction;
  };
  /// What there is before lights come to it.
  struct Unlit {
    Local<3> own;
    std::vector<Answering> answering;
  };
  /// All media there but one. `through`: what part of light arrives, or more.
  Local<3> at(const Present& here, double t, double through,
              const OnRay* but = nullptr) const {
    thread_local Unlit there;
    look(here, t, but, there);
    Local<3> l = there.own;
    if (!there.answering.empty())
      for (std::size_t k = 0; k < world.lights.size(); ++k)
        add_light(k, t, there.answering, through, l);
    return l;
  }

  void look(const Present& here, double t, const OnRay* but, Unlit& there) const {
    Local<3>& l = there.own;
    l = {};
    l.e = here.glow(t);
    there.answering.clear();
    for (const OnRay* on : here.media) {
      if (on == but || (on->fades && !on->stays_at(t))) continue;
      const brume_medium& m = *on->medium;
      const AtPoint p = on->line.at(t);
      const double rho = on->weight * p.rho;
      if (rho == 0) continue;
      Rgb extinction{};
      const Rgb own = m.source == BRUME_SOURCE_COLOR
                          ? Rgb{m.color[0], m.color[1], m.color[2]}
                          : p.source;
      for (std::size_t c = 0; c < 3; ++c) {
        if (t > on->cap[c]) continue;
        extinction[c] = rho * m.extinction[c] * p.tint[c];
        l.sigma[c] += extinction[c];
        if (shines(*on)) l.e[c] += rho * m.emission[c] + extinction[c] * own[c];
      }
      if (shines(*on) && any(extinction)) there.answering.push_back({&m, extinction});
    }
  }

  void add_light(std::size_t k, double t, const std::vector<Answering>& answering,
                 double through, Local<3>& l) const {
    const brume_light& light = world.lights[k].what;
    const bool lamp = light.kind == BRUME_POINT || light.kind == BRUME_SPOT;
    Incident in = light_at(world, light, ray.at(t));
    if (!any(in.E)) return;
    Rgb S{};  // scattered toward the ray's origin, per metre
    for (const auto& [m, extinction] : answering) {
      const bool all = m->source == BRUME_SOURCE_SKY && !lamp;
      if (!all && m->albedo[0] == 0 && m->albedo[1] == 0 && m->albedo[2] == 0) continue;
      // The phase function's integral, for the sky's mean radiance.
      const double p = light.kind == BRUME_SKY_LIGHT ? 1 : phase(*m, in.to, ray.d);
      for (std::size_t c = 0; c < 3; ++c)
        S[c] += extinction[c] * (all ? 1 : m->albedo[c]) * p;
    }
    if (!any(S)) return;
    if (light.attenuated && light.kind != BRUME_SKY_LIGHT)
      in.E = lights.dimmed(k, in, t, S, through, l.sigma);
    for (std::size_t c = 0; c < 3; ++c) l.e[c] += S[c] * in.E[c];
  }
};

/// What a march knew when its cost was spent. From there on nothing dims the lights, so
/// that what it adds is no less than what is true, and counts as error.
template <int N>
struct Known {
  std::optional<typename March<N>::Lanes> L;

  void look(const March<N>& march, const Cost& cost) {
    if (!L && cost.spent()) L = march.L;
  }
  void end(March<N>& march) const {
    if (L) march.converged = false;
    for (std::size_t c = 0; L && c < N; ++c) {
      march.L_error[c] += march.L[c] - (*L)[c];
      if (march.stopped) march.L_error[c] = march.tau_error[c] = kInf;
    }
  }
};

void march_colours(const ByColour& by, const Media& media, double begin, Answer& a) {
  March<3> march(by.options.tolerance, by.options.white, by.cost);
  std::vector<March<3>::Taken> taken;
  if (by.detailed()) march.taken = &taken;
  Known<3> known;
  walk<3>(
      media, by.ray, march,
      [&](const Present& here, double t) {
        known.look(march, by.cost);
        return by.at(here, t, march.through());
      },
      {by.lights.places}, begin);
  known.end(march);
  if (by.detailed()) by.lights.weigh<3>(taken, {1, 1, 1});
  a.L = march.L;
  a.L_error = march.L_error;
  for (std::size_t c = 0; c < 3; ++c) {
    a.T[c] = std::exp(-march.tau[c]);
    a.T_error[c] = a.T[c] * std::min(march.tau_error[c], 1.);
  }
  a.converged = march.converged;
}

// Wavelength i of `spectral` under colour c is a lane: extinction of the wavelength and
// of the colour of all other media; a share of that colour's light,
//   L_c = Sum_i Int e^{-tau_i - tau_c} (R_ic e_i + T_ic e_c),  T_c = Sum_i T_ic
//   e^{-tau_i - tau_c},
// with the medium's weights R and T.
void march_wavelengths(const ByColour& by, const Media& media, const brume_medium& m,
                       double begin, Answer& a) {
  const std::size_t count = std::size_t(m.wavelengths);
  a.T = {};
  std::vector<double> extinction(count), source(count);
  for (std::size_t first = 0; first < count; first += kTogether) {
    const auto wavelength = [&](std::size_t k) { return std::min(first + k, count - 1); };
    const auto counts = [&](std::size_t k) { return first + k < count ? 1. : 0.; };
    March<kSpectral> march(by.options.tolerance, by.options.white / double(count),
                           by.cost);
    std::vector<March<kSpectral>::Taken> taken;
    if (by.detailed()) march.taken = &taken;
    Known<kSpectral> known;
    walk<kSpectral>(
        media, by.ray, march,
        [&](const Present& here, double t) {
          known.look(march, by.cost);
          const OnRay* spectral = nullptr;
          for (const OnRay* on : here.media)
            if (on->medium == &m) spectral = on;
          const Local<3> colours = by.at(here, t, march.through(), spectral);
          if (spectral) {
            const glm::dvec3 x = by.world.eye + by.ray.at(t), d = by.ray.d;
            const double position[3] = {x.x, x.y, x.z}, direction[3] = {d.x, d.y, d.z};
            m.spectral_point(m.self, position, direction, extinction.data(),
                             source.data());
          }
          Local<kSpectral> l;
          for (std::size_t k = 0; k < kTogether; ++k)
            for (std::size_t c = 0; c < 3; ++c) {
              const std::size_t i = wavelength(k), lane = 3 * k + c;
              l.sigma[lane] = colours.sigma[c];
              l.e[lane] = counts(k) * m.spectral_transmittance[3 * i + c] * colours.e[c];
              if (!spectral || t > spectral->cap[c]) continue;
              const double sigma = spectral->weight * extinction[i];
              l.sigma[lane] += sigma;
              if (by.shines(*spectral))
                l.e[lane] +=
                    counts(k) * m.spectral_radiance[3 * i + c] * sigma * source[i];
            }
          return l;
        },
        {by.lights.places}, begin);
    known.end(march);
    if (by.detailed()) {
      std::array<double, kSpectral> factor;
      for (std::size_t lane = 0; lane < kSpectral; ++lane)
        factor[lane] = counts(lane / 3) *
                       m.spectral_transmittance[3 * wavelength(lane / 3) + lane % 3];
      by.lights.weigh<kSpectral>(taken, factor);
    }
    for (std::size_t k = 0; k < kTogether; ++k)
      for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t lane = 3 * k + c;
        const double T = counts(k) * m.spectral_transmittance[3 * wavelength(k) + c] *
                         std::exp(-march.tau[lane]);
        a.L[c] += march.L[lane];
        a.L_error[c] += march.L_error[lane];
        a.T[c] += T;
        a.T_error[c] += T * std::min(march.tau_error[lane], 1.);
      }
    a.converged = a.converged && march.converged;
  }
}

// How often the ray is marched with what is known of its ways of light by then.
constexpr int kRounds = 4;

Answer stretch(const World& w, const Ray& ray, double begin, const Options& o) {
  Cost cost{o.evaluations};
  const Media media = media_on(w, ray, o, cost);
  const ByColour by{w, ray, o, {w, ray, o, cost}, cost};
  const auto spectral = std::ranges::find_if(
      media, [](const OnRay& on) { return on.medium->wavelengths > 0; });
  long budget = std::min(o.ways, o.evaluations / 2);
  Answer a;
  for (int round = 0; round < kRounds; ++round) {
    a = {};
    by.lights.begin_march();
    if (spectral == media.end())
      march_colours(by, media, begin, a);
    else
      march_wavelengths(by, media, *spectral->medium, begin, a);
    if (!by.detailed()) break;
    if (round + 1 == kRounds) budget = 0;
    if (!by.lights.refine_detail(a.L, o, budget)) break;
  }
  for (const OnRay& on : media) a.converged = a.converged && on.converged;
  a.converged = a.converged && by.lights.enough;
  for (std::size_t c = 0; c < 3; ++c)
    a.L_error[c] += by.lights.error() + by.lights.detail_error[c];
  a.evaluations = cost.so_far;
  return a;
}

struct Hit {
  double t = kInf, R = 0;
  glm::dvec3 normal{0};
};
Hit first_hit(const World& w, const Ray& ray) {
  Hit first;
  const float o[3] = {float(ray.o.x), float(ray.o.y), float(ray.o.z)};
  const float d[3] = {float(ray.d.x), float(ray.d.y), float(ray.d.z)};
  const brume_rays one = {1, o, o + 1, o + 2, d, d + 1, d + 2};
  for (const auto& f : w.interfaces) {
    float t, n[3], R;
    f.what.hit(f.what.self, &one, &t, n, n + 1, n + 2, &R);
    if (t > 0 && t < ray.end && t < first.t)
      first = {t, std::clamp(double(R), 0., 1.), {n[0], n[1], n[2]}};
  }
  return first;
}

}  // namespace

Answer along(const World& w, const glm::dvec3& origin, const glm::dvec3& direction,
             double t_end, const Options& o) {
  const Ray ray = ray_of(w, origin, direction, t_end);
  const Hit hit = first_hit(w, ray);
  if (hit.t == kInf) return stretch(w, ray, 0, o);

  // L + T (R of what the mirrored ray sees, 1 - R of what lies behind).
  Ray near = ray;
  near.end = hit.t;
  const glm::dvec3 d = ray.d - 2 * glm::dot(ray.d, hit.normal) * hit.normal;
  const Ray mirrored{ray.at(hit.t), glm::normalize(d), kInf};
  Answer a = stretch(w, near, 0, o);
  const Answer behind = stretch(w, ray, hit.t, o), seen = stretch(w, mirrored, 0, o);
  const Rgb beyond = o.only_stage < 0 ? background(w, w.eye + mirrored.o, d) : Rgb{};
  for (int c = 0; c < 3; ++c) {
    const double T = a.T[c], through = T * (1 - hit.R), back = T * hit.R;
    const double reflected = seen.L[c] + (seen.T[c] > 0 ? seen.T[c] * beyond[c] : 0);
    a.L[c] += back * reflected + through * behind.L[c];
    a.L_error[c] += back * (seen.L_error[c] + seen.T_error[c] * beyond[c]) +
                    through * behind.L_error[c] +
                    a.T_error[c] * std::max(std::abs(reflected), std::abs(behind.L[c]));
    a.T_error[c] = a.T_error[c] * behind.T[c] + through * behind.T_error[c];
    a.T[c] = through * behind.T[c];
  }
  a.evaluations += behind.evaluations + seen.evaluations;
  a.converged = a.converged && behind.converged && seen.converged;
  return a;
}

Rgb optical_depth(const World& w, const glm::dvec3& origin, const glm::dvec3& direction,
                  double t_end, double tolerance) {
  Cost cost;
  return Obstacles(w).depth(ray_of(w, origin, direction, t_end), tolerance, cost).tau;
}

Rgb background(const World& w, const glm::dvec3& origin, const glm::dvec3& direction) {
  const Ray ray = ray_of(w, origin, direction, 0);
  const float o[3] = {float(ray.o.x), float(ray.o.y), float(ray.o.z)};
  const float d[3] = {float(ray.d.x), float(ray.d.y), float(ray.d.z)};
  const brume_rays one = {1, o, o + 1, o + 2, d, d + 1, d + 2};
  Rgb sum{};
  for (const auto& b : w.backgrounds) {
    float rgb[3];
    b.what.radiance(b.what.self, &one, rgb, rgb + 1, rgb + 2);
    for (int c = 0; c < 3; ++c) sum[c] += rgb[c];
  }
  return sum;
}

}  // namespace brume::truth
