#include "model.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "column.h"
#include "harmonics.h"
#include "nishita.h"
#include "run.h"
#include "store.h"

namespace brume::sky {

Quality Quality::fast() {
  Quality q;
  q.harmonics = 6;
  q.resolution = {.altitudes = 16,
                  .suns = 30,
                  .first = {7, 5, 10, 2},
                  .next = {5, 3, 5, 2},
                  .orders = 2};
  q.panels = 4;
  return q;
}

std::string key_of(const Atmosphere& a, const Quality& q) {
  std::string key = q.method == Method::nishita93 ? "sky nishita93"
                    : q.method == Method::single  ? "sky single"
                                                  : "sky";
  const auto add = [&](double x) {
    char text[40];
    std::snprintf(text, sizeof text, " %.17g", x);
    key += text;
  };
  const Resolution& r = q.resolution;
  for (int n : {q.harmonics, q.panels, r.altitudes, r.suns, r.orders}) add(n);
  for (const Directions& d : {r.first, r.next})
    for (int n : {d.up, d.down, d.around, d.panels}) add(n);
  for (double x : {a.planet_radius, a.atmosphere_height, a.rayleigh_scale_height,
                   a.mie_scale_height, a.mie_g, a.ozone_altitude, a.ozone_half_width})
    add(x);
  for (const auto* list :
       {&a.wavelengths, &a.solar_irradiance, &a.rayleigh_scattering, &a.mie_scattering,
        &a.mie_extinction, &a.ozone_absorption, &a.ground_albedo}) {
    key += ";";
    for (double x : *list) add(x);
  }
  return key;
}

Model::Model(const Atmosphere& a, const Quality& q) : atmosphere_(a), quality_(q) {
  check(a);
  // Above e^-45 of it there is none to spend nodes on.
  const double thickest = std::max(a.rayleigh_scale_height, a.mie_scale_height);
  if (!has_ozone())
    atmosphere_.atmosphere_height = std::min(a.atmosphere_height, 45 * thickest);
  const int N = a.size() <= 4 ? 4 : 8;
  kernels_ = &kernels(N, q.harmonics);
  for (int i = 0; q.method != Method::nishita93 && i < a.size(); i += N) {
    Light<float>& light = *groups_.emplace_back(std::make_unique<Light<float>>());
    lay_out(atmosphere_, i, q.resolution, *kernels_, light);
    if (q.method == Method::single) continue;  // tables of nothing
    // Bits differ from one version of the solver and instruction set to another.
    const std::string key = std::string(BRUME_SKY_SOLVER " ") + name(isa()) +
                            " from wavelength " + std::to_string(i) + " " + key_of(a, q);
    if (recall(key, light.tables())) continue;
    solve(atmosphere_, i, q.resolution, *kernels_, light);
    keep(key, light.tables());
  }
  corners_[0] = a.ozone_altitude - a.ozone_half_width;
  corners_[1] = a.ozone_altitude;
  corners_[2] = a.ozone_altitude + a.ozone_half_width;
}

bool Model::has_ozone() const noexcept {
  return std::any_of(atmosphere_.ozone_absorption.begin(),
                     atmosphere_.ozone_absorption.end(), [](double x) { return x > 0; });
}

Trace Model::path(const Ray& ray) const noexcept {
  return trace(atmosphere_.planet_radius, atmosphere_.atmosphere_height, ray,
               {true, corners_, has_ozone() ? 3 : 0});
}

int Model::panels(double detail) const noexcept {
  return static_cast<int>(std::clamp(quality_.panels * detail, 1., double(kMaxPanels)));
}

Seen<float> Model::group(std::size_t i, const Trace& trace, const Ray& ray,
                         int panels) const noexcept {
  Seen<float> seen;
  const Light<float>& g = *groups_[i];
  kernels_->see(g.air, g.forward, g.table, trace, ray, panels, seen);
  return seen;
}

void Model::see(const Ray& ray, double* L, double* T, double detail) const noexcept {
  if (method() == Method::nishita93) {
    std::vector<double> mie(size());
    nishita(atmosphere_, ray, L, mie.data(), T);
    for (int i = 0; i < size(); ++i)
      L[i] =
          L[i] * phase_rayleigh(ray.nu) + mie[i] * phase_mie(ray.nu, atmosphere_.mie_g);
    return;
  }
  const Trace t = path(ray);
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    const Seen<float> s = group(i, t, ray, panels(detail));
    for (int k = 0, n = int(i) * kernels_->N; k < kernels_->N && n < size(); ++k, ++n)
      L[n] = s.L[k], T[n] = s.T[k];
  }
}

void Model::see_single(const Ray& ray, double* L) const noexcept {
  const Trace t = path(ray);
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    const Seen<float> s = group(i, t, ray, panels(1));
    for (int k = 0, n = int(i) * kernels_->N; k < kernels_->N && n < size(); ++k, ++n)
      L[n] = s.single[k];
  }
}

void Model::along(const Ray& ray, const double* distances, int count, double* parts,
                  double* T, double detail) const noexcept {
  Cuts cuts{true, corners_, has_ozone() ? 3 : 0};
  cuts.distances = distances, cuts.distance_count = count;
  const Trace t =
      trace(atmosphere_.planet_radius, atmosphere_.atmosphere_height, ray, cuts);
  const int N = kernels_->N;
  float p[(kMaxDistances + 1) * 6 * kMaxN], through[(kMaxDistances + 1) * kMaxN];
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    const Light<float>& g = *groups_[i];
    // Distances that are never reached keep what empty space shows.
    for (int k = 0; k <= count; ++k)
      for (int n = 0; n < N; ++n) {
        for (int j = 0; j < 6; ++j) p[(k * 6 + j) * N + n] = 0;
        through[k * N + n] = 1;
      }
    kernels_->along(g.air, g.forward, g.table, t, ray, panels(detail), count, p, through);
    for (int k = 0; k <= count; ++k)
      for (int m = 0, n = int(i) * N; m < N && n < size(); ++m, ++n) {
        for (int j = 0; j < 6; ++j)
          parts[(std::size_t(k) * 6 + j) * size() + n] = p[(k * 6 + j) * N + m];
        T[std::size_t(k) * size() + n] = through[k * N + m];
      }
  }
}

Shape<float> Model::shape() const {
  const Atmosphere& a = atmosphere_;
  return {float(a.planet_radius),         float(a.atmosphere_height),
          float(a.rayleigh_scale_height), float(a.mie_scale_height),
          float(a.ozone_altitude),        float(a.ozone_half_width)};
}

void Model::source(const Ray& ray, double* J, double* extinction) const noexcept {
  if (method() == Method::nishita93) {
    const Atmosphere& a = atmosphere_;
    const double R = std::exp(-ray.h / a.rayleigh_scale_height),
                 M = std::exp(-ray.h / a.mie_scale_height);
    const double O =
        std::max(0., 1 - std::abs(ray.h - a.ozone_altitude) / a.ozone_half_width);
    sunlight(ray.h, ray.mu_s, J);
    for (int i = 0; i < size(); ++i) {
      extinction[i] = a.rayleigh_scattering[i] * R + a.mie_extinction[i] * M +
                      a.ozone_absorption[i] * O;
      J[i] *= a.solar_irradiance[i] *
              (a.rayleigh_scattering[i] * R * phase_rayleigh(ray.nu) +
               a.mie_scattering[i] * M * phase_mie(ray.nu, a.mie_g)) /
              std::max(extinction[i], 1e-300);
    }
    return;
  }
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    Seen<float> s;
    const Light<float>& g = *groups_[i];
    kernels_->source(g.air, g.forward, g.table, ray, s);
    for (int k = 0, n = int(i) * kernels_->N; k < kernels_->N && n < size(); ++k, ++n)
      J[n] = s.L[k], extinction[n] = s.T[k];
  }
}

bool Model::hidden(const Ray& ray) const noexcept {
  const double R = atmosphere_.planet_radius;
  return ray.mu < 0 &&
         trace(R, atmosphere_.atmosphere_height,
               {ray.h, ray.mu, 0, 0, std::numeric_limits<double>::infinity(), ray.ground},
               {})
             .hits_ground;
}

double Model::deepest_ground() const noexcept {
  return -kDeep * atmosphere_.mie_scale_height;
}

void Model::sunlight(double h, double mu_s, double* T) const noexcept {
  const Atmosphere& a = atmosphere_;
  const Shape<double> shape{a.planet_radius,         a.atmosphere_height,
                            a.rayleigh_scale_height, a.mie_scale_height,
                            a.ozone_altitude,        a.ozone_half_width};
  // From outside, begin where the ray enters the air.
  if (h > a.atmosphere_height) {
    const double r = a.planet_radius + h, top = a.planet_radius + a.atmosphere_height;
    const double p = r * std::sqrt(std::max(1 - mu_s * mu_s, 0.));
    const bool meets = mu_s < 0 && p < top;
    if (!meets) {
      std::fill(T, T + size(), 1.);
      return;
    }
    h = a.atmosphere_height;
    mu_s = -std::sqrt(1 - p * p / (top * top));
  }
  Shown<double> sun = shown_sun(shape, std::max(h, 0.), mu_s);
  // In 1993 it was a point.
  if (method() == Method::nishita93) sun = {sees_space(shape, h, mu_s) ? 1. : 0., mu_s};
  if (!(sun.part > 0)) {
    std::fill(T, T + size(), 0.);
    return;
  }
  const auto c = columns_to_space(shape, h, sun.mu);
  for (int i = 0; i < size(); ++i)
    T[i] =
        sun.part * std::exp(-(a.rayleigh_scattering[i] * c.R + a.mie_extinction[i] * c.M +
                              a.ozone_absorption[i] * c.O));
}

}  // namespace brume::sky
