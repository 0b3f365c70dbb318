#include "truth/marches.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "truth/geometry.h"
#include "truth/physics.h"

namespace brume::truth {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

bool any(const Rgb& c) { return c[0] != 0 || c[1] != 0 || c[2] != 0; }

/// What the media of three colours are at a point of the view ray.
struct ByColour : Marched {
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

void march_colours(const ByColour& by, Answer& a) {
  March<3> march(by.options.tolerance, by.options.white, by.cost);
  std::vector<March<3>::Taken> taken;
  if (by.lights.detailed()) march.taken = &taken;
  Known<3> known;
  walk<3>(
      by.media, by.ray, march,
      [&](const Present& here, double t) {
        known.look(march, by.cost);
        return by.at(here, t, march.through());
      },
      {by.lights.places()}, by.begin);
  known.end(march);
  if (by.lights.detailed()) by.lights.weigh<3>(taken, {1, 1, 1});
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
void march_wavelengths(const ByColour& by, const brume_medium& m, Answer& a) {
  const std::size_t count = std::size_t(m.wavelengths);
  a.T = {};
  std::vector<double> extinction(count), source(count);
  for (std::size_t first = 0; first < count; first += kTogether) {
    const auto wavelength = [&](std::size_t k) { return std::min(first + k, count - 1); };
    const auto counts = [&](std::size_t k) { return first + k < count ? 1. : 0.; };
    March<kSpectral> march(by.options.tolerance, by.options.white / double(count),
                           by.cost);
    std::vector<March<kSpectral>::Taken> taken;
    if (by.lights.detailed()) march.taken = &taken;
    Known<kSpectral> known;
    walk<kSpectral>(
        by.media, by.ray, march,
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
        {by.lights.places()}, by.begin);
    known.end(march);
    if (by.lights.detailed()) {
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
  // Light beyond what the primaries can show.
  for (double& L : a.L) L = std::max(L, 0.);
}

}  // namespace

Answer march(const Marched& of) {
  const ByColour by{of};
  const auto spectral = std::ranges::find_if(
      by.media, [](const OnRay& on) { return on.medium->wavelengths > 0; });
  Answer a;
  if (spectral == by.media.end())
    march_colours(by, a);
  else
    march_wavelengths(by, *spectral->medium, a);
  return a;
}

}  // namespace brume::truth
