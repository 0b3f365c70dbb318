#include "nishita.h"

#include <algorithm>
#include <cmath>

#include "column.h"
#include "harmonics.h"

namespace brume::sky {

void nishita(const Atmosphere& a, const Ray& ray, double* rayleigh, double* mie,
             double* T) {
  const Shape<double> shape{a.planet_radius,         a.atmosphere_height,
                            a.rayleigh_scale_height, a.mie_scale_height,
                            a.ozone_altitude,        a.ozone_half_width};
  const int n = a.size();
  for (int i = 0; i < n; ++i) rayleigh[i] = mie[i] = 0, T[i] = 1;
  const Trace path = trace(a.planet_radius, a.atmosphere_height, ray, {});
  const double ds = (path.t_end - path.t_begin) / kNishitaSteps,
               air = ray.weight * ds,  // of it that there is
      r = a.planet_radius + ray.h;
  std::vector<double> tau(n, 0.);
  for (int s = 0; s < kNishitaSteps && ds > 0; ++s) {
    const double t = path.t_begin + (s + .5) * ds, b = r * ray.mu;
    const double h = altitude(ray.h * (2 * a.planet_radius + ray.h) + t * (2 * b + t),
                              a.planet_radius);
    const double mu_s =
        std::clamp((r * ray.mu_s + t * ray.nu) / (a.planet_radius + h), -1., 1.);
    const double R = std::exp(-h / a.rayleigh_scale_height),
                 M = std::exp(-h / a.mie_scale_height);
    const double O = ozone_density(shape, h);
    const bool lit = sees_space(shape, std::max(h, 0.), mu_s);
    const auto sun =
        columns_to_space(shape, std::clamp(h, 0., a.atmosphere_height), mu_s);
    for (int i = 0; i < n; ++i) {
      const double step = (a.rayleigh_scattering[i] * R + a.mie_extinction[i] * M +
                           a.ozone_absorption[i] * O) *
                          air;
      if (lit) {
        const double to_sun = a.rayleigh_scattering[i] * sun.R +
                              a.mie_extinction[i] * sun.M + a.ozone_absorption[i] * sun.O;
        const double light =
            a.solar_irradiance[i] * std::exp(-to_sun - tau[i] - .5 * step) * air;
        rayleigh[i] += a.rayleigh_scattering[i] * R * light;
        mie[i] += a.mie_scattering[i] * M * light;
      }
      tau[i] += step;
    }
  }
  for (int i = 0; i < n; ++i) T[i] = std::exp(-tau[i]);
}

NishitaTable::NishitaTable(const Atmosphere& a, double h, double mu_s,
                           const Colors& colors, const std::array<double, 3>& scale)
    : mu_s_(mu_s), g_(a.mie_g), texels_(kNishitaAround * kNishitaUp) {
  const int n = a.size();
  std::vector<double> R(n), M(n), T(n);
  const double s_sun = std::sqrt(std::max(1 - mu_s * mu_s, 0.));
  for (int j = 0; j < kNishitaUp; ++j)
    for (int k = 0; k < kNishitaAround; ++k) {
      const double elevation = M_PI / 2 * j / (kNishitaUp - 1),
                   azimuth = 2 * M_PI * k / kNishitaAround;
      const double mu = std::sin(elevation),
                   nu = mu * mu_s + std::cos(elevation) * s_sun * std::cos(azimuth);
      nishita(a, {h, mu, mu_s, std::clamp(nu, -1., 1.)}, R.data(), M.data(), T.data());
      auto& texel = texels_[j * kNishitaAround + k];
      texel = {};
      for (int i = 0; i < n; ++i)
        for (int c = 0; c < 3; ++c) {
          texel[c] += colors.radiance[i][c] * scale[c] * R[i];
          texel[3 + c] += colors.radiance[i][c] * scale[c] * M[i];
        }
    }
}

std::array<double, 3> NishitaTable::look(double mu, double nu) const noexcept {
  if (mu < 0) return {};
  const double s = std::sqrt(std::max((1 - mu * mu) * (1 - mu_s_ * mu_s_), 1e-12));
  const double azimuth = std::acos(std::clamp((nu - mu * mu_s_) / s, -1., 1.));
  const double y = std::asin(std::min(mu, 1.)) / (M_PI / 2) * (kNishitaUp - 1);
  const double x = azimuth / (2 * M_PI) * kNishitaAround;
  const int j = std::min(static_cast<int>(y), kNishitaUp - 2), k = static_cast<int>(x),
            k1 = (k + 1) % kNishitaAround;
  const double fy = y - j, fx = x - k, p_R = phase_rayleigh(nu), p_M = phase_mie(nu, g_);
  std::array<double, 3> out;
  for (int c = 0; c < 3; ++c) {
    const auto at = [&](int part) {
      const auto row = [&](int r) {
        return texels_[r * kNishitaAround + k][part] * (1 - fx) +
               texels_[r * kNishitaAround + k1][part] * fx;
      };
      return row(j) * (1 - fy) + row(j + 1) * fy;
    };
    out[c] = std::max(at(c) * p_R + at(3 + c) * p_M, 0.);
  }
  return out;
}

}  // namespace brume::sky
