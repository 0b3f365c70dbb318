// What shines in a frame's sky: the sun as it arrives at the eye, the sky by direction
// and on the mean, the sun's disc.

#include <algorithm>
#include <cmath>
#include <limits>

#include "frame_sky.h"

namespace brume::sky {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

const FrameSky& self(const void* p) { return *static_cast<const FrameSky*>(p); }

// Limb darkening of the sun at 550 nm, of its centre; mu = cosine on the sun. Pierce and
// Slaughter 1977 by Hestroffer and Magnan 1998: I = mu^a, a = .52 at 550 nm; its mean
// over the disc is 2/(2 + a).
double limb(double mu) { return std::pow(mu, .52) * (2 + .52) / 2; }

}  // namespace

std::array<double, 3> FrameSky::sun_at_eye(const Model& model, const Placing& at,
                                           const Colors& colors) {
  double T[kMapWavelengths];
  double eye[3];
  for (int i = 0; i < 3; ++i) eye[i] = at.eye[i] - at.sea_level * at.up[i];
  const Atmosphere& a = model.atmosphere();
  const double R = a.planet_radius, c = dot(eye, eye) + 2 * R * dot(eye, at.up.data());
  const double h = std::max(c / (R + std::sqrt(std::max(R * R + c, 0.))),
                            -kDeepestEye * a.mie_scale_height);
  double mu = 0;
  for (int i = 0; i < 3; ++i) mu += (eye[i] + R * at.up[i]) * at.to_sun[i];
  model.sunlight(h, std::clamp(mu / (R + h), -1., 1.), T);
  std::array<double, 3> out{};
  for (int i = 0; i < model.size(); ++i)
    for (int k = 0; k < 3; ++k)
      out[k] += colors.radiance[i][k] * a.solar_irradiance[i] * T[i];
  return out;
}

// Mean radiance over the sphere, what the ground reflects included: light of a fog whose
// phase function is even.
void FrameSky::light_from_everywhere() {
  constexpr int kRows = 12, kColumns = 12;
  const double here[3] = {};
  Rgb ground{}, up{};    // albedo; irradiance over pi
  double shown[3] = {};  // part of the sphere where the ground shows, by colour
  const Atmosphere& a = model_.atmosphere();
  for (int i = 0; i < kRows; ++i)
    for (int j = 0; j < kColumns; ++j) {
      // Around the vertical.
      const double z = -1 + 2 * (i + .5) / kRows, phi = 2 * M_PI * (j + .5) / kColumns,
                   s = std::sqrt(1 - z * z);
      const auto& v = at_.up;
      const int least = std::abs(v[0]) < .6 ? 0 : 1;
      double x[3] = {}, y[3];
      x[least] = 1;
      for (int k = 0; k < 3; ++k) x[k] -= v[least] * v[k];
      const double length = std::sqrt(dot(x, x));
      for (double& k : x) k /= length;
      for (int k = 0; k < 3; ++k)
        y[k] = v[(k + 1) % 3] * x[(k + 2) % 3] - v[(k + 2) % 3] * x[(k + 1) % 3];
      float d[3];
      for (int k = 0; k < 3; ++k)
        d[k] = float(s * std::cos(phi) * x[k] + s * std::sin(phi) * y[k] + z * v[k]);
      const brume_rays one{1, nullptr, nullptr, nullptr, d, d + 1, d + 2};
      Rgb L, T;
      see(one, 0, 1, 0, kInf, L, T);
      const double wide[3] = {d[0], d[1], d[2]};
      const bool hidden = model_.hidden(ray(here, wide));
      constexpr double part = 1. / (kRows * kColumns);
      for (int k = 0; k < 3; ++k) {
        sky_mean_[k] += L[k] * part;
        if (z > 0) up[k] += 4 * L[k] * z * part;
        if (hidden) shown[k] += T[k] * part;
      }
    }
  const double mu_s = std::max(ray(here, at_.up.data()).mu_s, 0.);
  for (int i = 0; i < model_.size(); ++i)
    for (int k = 0; k < 3; ++k)
      ground[k] += look_.colors.transmittance[i][k] * a.ground_albedo[i];
  for (int k = 0; k < 3; ++k)
    sky_mean_[k] += shown[k] * ground[k] * (sun_[k] * mu_s / M_PI + up[k]);
}

std::vector<brume_light> FrameSky::lights() const {
  brume_light sun{};
  sun.size = sizeof sun;
  sun.name = "sun";
  sun.kind = BRUME_SUN;
  for (int k = 0; k < 3; ++k) sun.direction[k] = at_.to_sun[k], sun.power[k] = sun_[k];
  sun.radius = look_.sun_radius;
  sun.attenuated = 0;  // `power` is what arrives at the eye
  brume_light sky{};
  sky.size = sizeof sky;
  sky.name = "sky";
  sky.kind = BRUME_SKY_LIGHT;
  sky.direction[2] = 1;
  for (int k = 0; k < 3; ++k) sky.power[k] = sky_mean_[k];
  sky.self = this;
  sky.radiance = [](const void* p, const brume_rays* rays, float* r, float* g, float* b) {
    for (std::size_t i = 0; i < rays->n; ++i) {
      Rgb L, T;
      self(p).see(*rays, i, 1, 0, kInf, L, T);
      r[i] = float(L[0]), g[i] = float(L[1]), b[i] = float(L[2]);
    }
  };
  return {sun, sky};
}

auto FrameSky::disc(const double d[3]) const noexcept -> Rgb {
  const double radius = look_.sun_radius;
  if (!(radius > 0)) return {};
  // 1 - cos without cancellation.
  double half = 0;
  for (int k = 0; k < 3; ++k) half += (d[k] - at_.to_sun[k]) * (d[k] - at_.to_sun[k]);
  const double s = std::sqrt(half) / (2 * std::sin(radius / 2));  // of the disc's radius
  if (s >= 1) return {};
  const Atmosphere& a = model_.atmosphere();
  const double solid_angle = 4 * M_PI * std::pow(std::sin(radius / 2), 2);
  double L[kMapWavelengths];
  for (int i = 0; i < model_.size(); ++i)
    L[i] = a.solar_irradiance[i] / solid_angle * limb(std::sqrt(1 - s * s));
  return radiance(L);
}

brume_background FrameSky::background() const {
  brume_background b{};
  b.size = sizeof b;
  b.name = "sun";
  b.self = this;
  b.radiance = [](const void* p, const brume_rays* rays, float* r, float* g, float* bl) {
    const FrameSky& s = self(p);
    for (std::size_t i = 0; i < rays->n; ++i) {
      const double d[3] = {rays->dx[i], rays->dy[i], rays->dz[i]};
      const Rgb c = s.disc(d);
      // The planet hides it.
      Rgb out = c;
      if (c[0] + c[1] + c[2] > 0) {
        double o[3] = {};
        if (rays->ox) o[0] = rays->ox[i], o[1] = rays->oy[i], o[2] = rays->oz[i];
        if (s.model_.hidden(s.ray(o, d))) out = {};
      }
      r[i] = float(out[0]), g[i] = float(out[1]), bl[i] = float(out[2]);
    }
  };
  return b;
}

}  // namespace brume::sky
