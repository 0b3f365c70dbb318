#include "frame_sky.h"

#include <algorithm>
#include <cmath>

namespace brume::sky {
namespace {

const FrameSky& self(const void* p) { return *static_cast<const FrameSky*>(p); }

}  // namespace

FrameSky::FrameSky(const Model& model, const Maps& maps, const Placing& at,
                   const Look& look, bool tables, double detail, float weight)
    : model_(model), maps_(maps), at_(at), look_(look), detail_(detail), weight_(weight) {
  for (int i = 0; i < 3; ++i) centre_[i] = at.eye[i] - at.sea_level * at.up[i];
  lift_eye();
  const double here[3] = {};
  // Farther out the air is a small disc with the whole day on it.
  const double R = model.atmosphere().planet_radius;
  const Ray eye = ray(here, at_.up.data());
  const double dip = std::acos(R / (R + std::max(eye.h, 0.))),
               elevation = std::asin(eye.mu_s);
  sun_sets_ = elevation > -dip - 2 * kSunRadius && elevation < 2 * kSunRadius;
  tables_ = tables && eye.h < .1 * R && !(sun_sets_ && eye.ground < 0);
  place_ = place_of(model, look.colors);
  for (int i = 0; i < 3; ++i)
    place_.ground[i] = float(centre_[i]), place_.up[i] = float(at.up[i]);
  for (int i = 0; i < model.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      spectral_radiance_.push_back(look.colors.radiance[std::size_t(i)][std::size_t(k)] *
                                   look.scale[std::size_t(k)]);
      spectral_transmittance_.push_back(
          look.colors.transmittance[std::size_t(i)][std::size_t(k)]);
    }
  sun_ = sun_at_eye(model, at, look.colors);
  for (int k = 0; k < 3; ++k) sun_[k] = std::max(sun_[k] * look.scale[k], 0.);
  light_from_everywhere();
}

// The planet sinks with an eye that is deep in it.
void FrameSky::lift_eye() {
  const Atmosphere& a = model_.atmosphere();
  double p[3];
  for (int i = 0; i < 3; ++i) p[i] = centre_[i] + a.planet_radius * at_.up[i];
  const double r = std::sqrt(dot(p, p)),
               least = a.planet_radius - kDeepestEye * a.mie_scale_height;
  if (!(r < least)) return;
  for (int i = 0; i < 3; ++i) centre_[i] += (least - r) * (r > 0 ? p[i] / r : at_.up[i]);
}

Ray FrameSky::ray(const double o[3], const double d[3]) const noexcept {
  // r^2 - R^2 without the square of R.
  const double R = model_.atmosphere().planet_radius;
  double q[3], p[3];
  for (int i = 0; i < 3; ++i) q[i] = centre_[i] + o[i], p[i] = q[i] + R * at_.up[i];
  const double c = dot(q, q) + 2 * R * dot(q, at_.up.data());
  // A point deep in the ground is as one just below it, where the air still is finite.
  const double h = std::max(model_.deepest_ground(),
                            c / (R + std::sqrt(std::max(R * R + c, 0.)))),
               r = R + h;
  const auto cosine = [](double x) { return std::clamp(x, -1., 1.); };
  Ray out{h, cosine(dot(p, d) / r), cosine(dot(p, at_.to_sun.data()) / r),
          cosine(dot(d, at_.to_sun.data()))};
  out.ground = model_.ground(h);
  return out;
}

double FrameSky::out_of_core(const double o[3], const double d[3]) const noexcept {
  const double R = model_.atmosphere().planet_radius, deep = model_.deepest_ground();
  double q[3], p[3];
  for (int i = 0; i < 3; ++i) q[i] = centre_[i] + o[i], p[i] = q[i] + R * at_.up[i];
  const double c = dot(q, q) + 2 * R * dot(q, at_.up.data()) - deep * (2 * R + deep);
  if (!(c < 0)) return 0;
  const double b = dot(p, d), root = std::sqrt(b * b - c);
  return b > 0 ? -c / (b + root) : root - b;
}

void FrameSky::optical_depth(const brume_rays& rays, const float* t0, const float* t1,
                             float* D) const {
  static const MapKernels& kernel = BRUME_ISA_SELECT(map_kernels);
  constexpr std::size_t kRun = 256;
  float planes[3][kRun];
  float* const T[3] = {planes[0], planes[1], planes[2]};
  for (std::size_t i = 0; i < rays.n; i += kRun) {
    const std::size_t n = std::min(kRun, rays.n - i);
    const auto from = [i](const float* p) { return p ? p + i : nullptr; };
    const float* const o[3] = {from(rays.ox), from(rays.oy), from(rays.oz)};
    const float* const d[3] = {rays.dx + i, rays.dy + i, rays.dz + i};
    kernel.through(place_, static_cast<int>(n), o, d, t0 + i, t1 + i, T);
    for (std::size_t k = 0; k < n; ++k) D[i + k] = -std::log(std::max(T[1][k], 1e-37f));
  }
}

auto FrameSky::extinction(double h) const noexcept -> Rgb {
  const Atmosphere& a = model_.atmosphere();
  if (h > a.atmosphere_height) return {};
  const double R = std::exp(-h / a.rayleigh_scale_height),
               M = std::exp(-h / a.mie_scale_height);
  const double O = std::max(0., 1 - std::abs(h - a.ozone_altitude) / a.ozone_half_width);
  Rgb out{};
  for (int i = 0; i < model_.size(); ++i)
    for (int k = 0; k < 3; ++k)
      out[k] += look_.colors.transmittance[i][k] *
                (a.rayleigh_scattering[i] * R + a.mie_extinction[i] * M +
                 a.ozone_absorption[i] * O);
  return out;
}

void FrameSky::alone(const brume_rays& rays, const float* weights, const float* t0,
                     const float* t1, float* const L[3], float* const T[3]) const {
  const bool in_steps = model_.method() == Method::nishita93;
  const auto weight = [&](std::size_t i) { return weights ? weights[i] : 1.f; };
  bool all = tables_ && !in_steps && !rays.ox, some = false;
  for (std::size_t i = 0; all && i < rays.n; ++i) {
    all = t0[i] == 0;
    some = some || weight(i) == weight_;
  }
  const bool looked_up = all && some;
  if (looked_up) look_up(rays, t1, L, T);
  for (std::size_t i = 0; i < rays.n; ++i) {
    if (looked_up && weight(i) == weight_) continue;
    see_into(rays, i, double(weight(i)), double(t0[i]), double(t1[i]), L, T);
    // The hemisphere's table instead of the ray: what a frame of 1993 looked up.
    if (tables_ && in_steps && !rays.ox && t0[i] == 0 && std::isinf(t1[i]) &&
        weight(i) == 1) {
      const double d[3] = {rays.dx[i], rays.dy[i], rays.dz[i]}, here[3] = {};
      const Ray r = ray(here, d);
      if (!(r.mu >= 0)) continue;
      const Rgb l = hemisphere().look(r.mu, r.nu);
      for (int k = 0; k < 3; ++k) L[k][i] = float(l[k]);
    }
  }
}

auto FrameSky::radiance(const double* L) const noexcept -> Rgb {
  Rgb out{};
  for (int i = 0; i < model_.size(); ++i)
    for (int k = 0; k < 3; ++k) out[k] += look_.colors.radiance[i][k] * L[i];
  for (int k = 0; k < 3; ++k) out[k] = std::max(out[k] * look_.scale[k], 0.);
  return out;
}

auto FrameSky::transmittance(const double* T) const noexcept -> Rgb {
  Rgb out{};
  for (int i = 0; i < model_.size(); ++i)
    for (int k = 0; k < 3; ++k) out[k] += look_.colors.transmittance[i][k] * T[i];
  for (double& x : out) x = std::clamp(x, 0., 1.);
  return out;
}

void FrameSky::see_into(const brume_rays& rays, std::size_t i, double weight, double t0,
                        double t1, float* const L[3], float* const T[3]) const noexcept {
  Rgb l, t;
  see(rays, i, weight, t0, t1, l, t);
  for (int k = 0; k < 3; ++k) L[k][i] = float(l[k]), T[k][i] = float(t[k]);
}

void FrameSky::see(const brume_rays& rays, std::size_t i, double weight, double t0,
                   double t1, Rgb& L, Rgb& T) const noexcept {
  const double d[3] = {rays.dx[i], rays.dy[i], rays.dz[i]};
  double o[3] = {};
  if (rays.ox) o[0] = rays.ox[i], o[1] = rays.oy[i], o[2] = rays.oz[i];
  L = {}, T = {1, 1, 1};
  if (!(t1 > t0)) return;
  for (int k = 0; k < 3; ++k) o[k] += t0 * d[k];
  const double below = out_of_core(o, d);
  if (!(t1 - t0 > below)) return;
  for (int k = 0; k < 3; ++k) o[k] += below * d[k];
  t0 += below;
  Ray r = ray(o, d);
  r.distance = t1 - t0, r.weight = weight;
  // A surface has air before it, below the planet's own too.
  if (std::isfinite(t1)) r.ground = model_.deepest_ground();
  double spectral_L[kMapWavelengths], spectral_T[kMapWavelengths];
  const double finer = !sun_sets_ ? 1 : r.h < 0 ? 4 : 2;
  model_.see(r, spectral_L, spectral_T, finer * detail_);
  L = radiance(spectral_L), T = transmittance(spectral_T);
}

void FrameSky::source(const double o[3], const double d[3], Rgb& J,
                      Rgb& extinction) const noexcept {
  double spectral_J[kMapWavelengths], spectral_e[kMapWavelengths];
  const Ray r = ray(o, d);
  J = extinction = {};
  if (!(r.h <= model_.atmosphere().atmosphere_height)) return;
  model_.source(r, spectral_J, spectral_e);
  extinction = Rgb{};
  for (int i = 0; i < model_.size(); ++i) {
    spectral_J[i] *= spectral_e[i];
    for (int k = 0; k < 3; ++k)
      extinction[k] += look_.colors.transmittance[i][k] * spectral_e[i];
  }
  J = radiance(spectral_J);
  for (int k = 0; k < 3; ++k) J[k] = extinction[k] > 0 ? J[k] / extinction[k] : 0;
}

brume_medium FrameSky::medium() const {
  brume_medium m{};
  m.size = sizeof m;
  m.name = "";
  m.shape = BRUME_EVERYWHERE;
  m.local_from_world[0] = m.local_from_world[5] = m.local_from_world[10] = 1;
  m.profile = BRUME_CUSTOM;
  m.direction[2] = 1;
  m.max_opacity = 1;
  for (double& x : m.extinction) x = 1;
  m.source = BRUME_SOURCE_CUSTOM;
  m.self = this;
  const double R = model_.atmosphere().planet_radius;
  for (int i = 0; i < 3; ++i) m.ground[i] = at_.eye[i] - (centre_[i] + R * at_.up[i]);
  m.ground[3] = R, m.core = R + model_.deepest_ground();
  m.is_sky = 1;
  m.integral = [](const void* p, const brume_rays* rays, const float* t0, const float* t1,
                  float* D) { self(p).optical_depth(*rays, t0, t1, D); };
  const auto place = [](const brume_rays& r, std::size_t i, double t, double o[3],
                        double d[3]) {
    d[0] = r.dx[i], d[1] = r.dy[i], d[2] = r.dz[i];
    for (int k = 0; k < 3; ++k) o[k] = t * d[k];
    if (r.ox) o[0] += r.ox[i], o[1] += r.oy[i], o[2] += r.oz[i];
  };
  static_assert(std::is_empty_v<decltype(place)>);
  m.density = [](const void* p, const brume_rays* rays, const float* t, float* density) {
    for (std::size_t i = 0; i < rays->n; ++i) {
      double o[3], d[3];
      decltype(place){}(*rays, i, t[i], o, d);
      density[i] = float(self(p).extinction(self(p).ray(o, d).h)[1]);
    }
  };
  m.source_at = [](const void* p, const brume_rays* rays, const float* t, float* r,
                   float* g, float* b) {
    for (std::size_t i = 0; i < rays->n; ++i) {
      double o[3], d[3];
      decltype(place){}(*rays, i, t[i], o, d);
      Rgb J, e;
      self(p).source(o, d, J, e);
      r[i] = float(J[0]), g[i] = float(J[1]), b[i] = float(J[2]);
    }
  };
  m.alone = [](const void* p, const brume_rays* rays, const float* weights,
               const float* t0, const float* t1, float* const L[3],
               float* const T[3]) { self(p).alone(*rays, weights, t0, t1, L, T); };
  m.point = [](const void* p, const double position[3], const double direction[3],
               double* density, double out[3]) {
    const FrameSky& s = self(p);
    double o[3];
    for (int k = 0; k < 3; ++k) o[k] = position[k] - s.at_.eye[k];
    Rgb J, e;
    s.source(o, direction, J, e);
    *density = e[1];
    for (int k = 0; k < 3; ++k) out[k] = J[k];
  };
  m.tint = [](const void* p, const double position[3], double rgb[3]) {
    const FrameSky& s = self(p);
    double o[3];
    for (int k = 0; k < 3; ++k) o[k] = position[k] - s.at_.eye[k];
    const Rgb e = s.extinction(s.ray(o, s.at_.up.data()).h);
    for (int k = 0; k < 3; ++k) rgb[k] = e[1] > 0 ? e[k] / e[1] : 1;
  };
  m.wavelengths = model_.size();
  m.spectral_radiance = spectral_radiance_.data();
  m.spectral_transmittance = spectral_transmittance_.data();
  m.spectral_point = [](const void* p, const double position[3],
                        const double direction[3], double* extinction, double* J) {
    const FrameSky& s = self(p);
    double o[3];
    for (int k = 0; k < 3; ++k) o[k] = position[k] - s.at_.eye[k];
    const Ray r = s.ray(o, direction);
    if (r.h <= s.model_.atmosphere().atmosphere_height)
      return s.model_.source(r, J, extinction);
    std::fill_n(extinction, s.model_.size(), 0.);
    std::fill_n(J, s.model_.size(), 0.);
  };
  return m;
}

}  // namespace brume::sky
