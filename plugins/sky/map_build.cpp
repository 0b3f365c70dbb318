#include "map_build.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "column.h"

namespace brume::sky {
namespace {

Shape<double> shape_of(const Atmosphere& a) {
  return {a.planet_radius,    a.atmosphere_height, a.rayleigh_scale_height,
          a.mie_scale_height, a.ozone_altitude,    a.ozone_half_width};
}

constexpr double kInf = std::numeric_limits<double>::infinity();

constexpr int kRefine = 5;
constexpr int refined(int azimuths) { return kRefine * (azimuths - 1) + 1; }

struct Build {
  const Model& model;
  const Colors& colors;
  const double* scale;
  double h, ground, mu_s, weight, horizon, limb;
  int azimuths;
  double detail, whole_detail;
  SkyPlace place;

  // parts [distances + 1][kMapParts], light over its growth up to each distance from
  // where the path begins; the last is its end.
  void direction(double zenith, double azimuth, const std::vector<double>& distances,
                 double begin, double end, float* parts) const {
    const int n = static_cast<int>(distances.size());  // before the end
    const double mu = std::cos(zenith), s = std::sin(zenith),
                 ss = std::sqrt(std::max(1 - mu_s * mu_s, 0.));
    const Ray ray{
        h,   mu,     mu_s,  std::clamp(mu * mu_s + s * ss * std::cos(azimuth), -1., 1.),
        end, ground, weight};
    std::vector<double> spectral(std::size_t(n + 1) * 6 * kMapWavelengths),
        T(std::size_t(n + 1) * kMapWavelengths);
    const Atmosphere& a = model.atmosphere();
    const double R = a.planet_radius, top = a.atmosphere_height;
    const Shape<double> shape = shape_of(a);
    const double shape_h = std::min(h, top),
                 mu_begin = h > top
                                ? std::clamp(((R + h) * mu + begin) / (R + top), -1., 0.)
                                : mu;
    model.along(ray, distances.data(), n, spectral.data(), T.data(),
                n > 0 ? detail : whole_detail);
    for (int k = 0; k <= n; ++k) {
      auto columns =
          columns_between(shape, shape_h, mu_begin, (k < n ? distances[k] : end) - begin);
      columns.R *= weight, columns.M *= weight;
      float* to = parts + k * kMapParts;
      std::fill(to, to + kMapParts, 0.f);
      constexpr int kept[] = {0, 1, 2, 3, 5};
      for (int c = 0; c < 3; ++c) {
        const double growth =
            growth_over<double>(columns, place.grow_R[c], place.grow_M[c]);
        if (!(growth > 0)) continue;
        for (int i = 0; i < model.size(); ++i) {
          for (int p = 0; p < 5; ++p)
            to[3 * p + c] += float(
                colors.radiance[i][c] * scale[c] *
                spectral[(std::size_t(k) * 6 + kept[p]) * model.size() + i] / growth);
        }
      }
    }
  }

  void fill(bool under, int elevations, int slices, double bend,
            std::vector<float>& parts, HalfMap& half) const {
    const bool whole = slices == 1;
    const int row = whole ? 1 : slices + 2;  // with ghosts
    const std::size_t line = std::size_t(row) * kMapParts,
                      ring = line * std::size_t(refined(azimuths));
    std::vector<float> coarse(line * std::size_t(azimuths));
    parts.assign(ring * (elevations + 2), 0.f);
    const Atmosphere& a = model.atmosphere();
    for (int e = 0; e < elevations; ++e) {
      // The horizon itself belongs to both sides; a hair off it, the path is that side's
      // own.
      const double v = std::clamp(double(e) / (elevations - 1), 1e-5, 1 - 1e-5);
      const double crowd = under ? kCrowdBelow : kCrowdAbove,
                   turned = v * v * (crowd + (1 - crowd) * v * v);
      const double zenith = horizon + turned * (under ? M_PI - horizon : limb - horizon);
      const Trace path = trace(a.planet_radius, a.atmosphere_height,
                               {h, std::cos(zenith), 0, 0, kInf, ground}, {});
      const double begin = path.t_begin, end = std::max(path.t_end, begin + 1e-3);
      std::vector<double> distances;
      for (int k = 0; k + 1 < slices; ++k) {
        const double x = std::max(double(k), .01) / (slices - 1);
        distances.push_back(begin + (end - begin) * ((1 - bend) * x + bend * x * x));
      }
      // Light is smooth in distance; one node before the first lies at so many of the
      // first's distances.
      const double first = 1. / (slices - 1),
                   before = (bend * first - (1 - bend)) / (bend * first + (1 - bend));
      for (int j = 0; j < azimuths; ++j) {
        float* p = &coarse[std::size_t(j) * line];
        direction(zenith, M_PI * j / (azimuths - 1), distances, begin, end,
                  p + (whole ? 0 : kMapParts));
        if (whole) continue;
        ghosts(p, kMapParts, slices);
        for (std::size_t i = 0; i < kMapParts; ++i)
          p[i] = p[kMapParts + i] +
                 float(before) * (p[2 * kMapParts + i] - p[kMapParts + i]);
      }
      refine(coarse.data(), azimuths, line, &parts[std::size_t(e + 1) * ring]);
    }
    ghosts(parts.data(), ring, elevations);
    half = {elevations, slices, float(bend), parts.data()};
  }

  // Rows between each two of n, by the polynomial through the eight about them; what lies
  // beyond an end is its mirror image, as azimuths are even.
  static void refine(const float* rows, int n, std::size_t size, float* out) {
    constexpr int K = 8;
    const auto row = [&](int i) {
      const int last = n - 1, k = std::abs(i);
      return rows + std::size_t(k > last ? 2 * last - k : k) * size;
    };
    for (int i = 0; i < refined(n); ++i, out += size) {
      const int first = i / kRefine - K / 2 + 1;
      const double t = double(i) / kRefine - first;
      for (int k = 0; k < K; ++k) {
        double w = 1;
        for (int j = 0; j < K; ++j) w *= j == k ? 1 : (t - j) / (k - j);
        const float* from = row(first + k);
        for (std::size_t x = 0; w != 0 && x < size; ++x) out[x] += float(w) * from[x];
      }
    }
  }

  // Straight on at both ends of n rows.
  static void ghosts(float* rows, std::size_t size, int n) {
    float* last = rows + (n + 1) * size;
    for (std::size_t i = 0; i < size; ++i) {
      rows[i] = 2 * rows[size + i] - rows[2 * size + i];
      last[i] = 2 * (last - size)[i] - (last - 2 * size)[i];
    }
  }
};

}  // namespace

MapSize map_size(const Model& model, double h, double ground, double mu_s,
                 double detail) {
  MapSize out;
  const Atmosphere& a = model.atmosphere();
  const double R = a.planet_radius, elevation = std::asin(mu_s),
               dip = std::acos(R / (R + std::max(h, 0.)));
  const bool twilight = elevation > -dip - .07 && elevation < dip + .02;
  if (twilight) {
    out.azimuths = h > 2.5 * a.rayleigh_scale_height ? 64 : 36;
    out.above = 64, out.slices = 45, out.sky = 192, out.whole_detail = 4;
  }
  if (h > a.atmosphere_height) out.azimuths = 64;
  // Long rays through dense air, below the ground and past bulges of it.
  if (ground < 0) out.slices = 60, out.above = 64;
  // Rays to surfaces only.
  if (ground < model.ground(h)) out.sky = 0;
  for (int* n : {&out.above, &out.below, &out.azimuths, &out.slices, &out.sky})
    if (*n > 0) *n = std::max(4, static_cast<int>(std::lround(*n * detail)));
  out.slices = std::min(out.slices, kMaxDistances);
  out.detail = detail;
  return out;
}

void build_map(const Model& model, double h, double ground, double mu_s, double weight,
               const Colors& colors, const double scale[3], const MapSize& size,
               MapTables& out) {
  const Atmosphere& a = model.atmosphere();
  const double R = a.planet_radius, top = a.atmosphere_height;
  const auto above = [&](double z) { return (h - z) * (2 * R + h + z); };
  const double c = above(ground);
  const double horizon = M_PI / 2 + std::atan2(std::sqrt(c), R + ground);
  out.map = {};
  out.map.mu_s = float(mu_s),
  out.map.sin_s = float(std::sqrt(std::max(1 - mu_s * mu_s, 0.)));
  out.map.r = float(R + h), out.map.c = float(c),
  out.map.to_deep = float(above(model.deepest_ground())), out.map.q = float(-above(top));
  const double beyond = above(top);  // > 0 outside
  double limb = beyond > 0 ? M_PI / 2 + std::atan2(std::sqrt(beyond), R + top) : 0;
  // What lies beyond the ground is seen below its horizon only; some nodes more.
  if (const double own = model.ground(h); ground < own)
    limb = M_PI / 2 + std::atan2(std::sqrt(above(own)), R + own) - .004;
  out.map.horizon = float(horizon), out.map.limb = float(limb),
  out.map.r_top = float(R + top), out.map.g = float(a.mie_g);
  out.map.azimuths = refined(size.azimuths);
  out.map.forward = model.forward();
  out.map.h = float(std::min(h, top)), out.map.weight = float(weight);
  const Build build{model,
                    colors,
                    scale,
                    h,
                    ground,
                    mu_s,
                    weight,
                    horizon,
                    limb,
                    size.azimuths,
                    size.detail,
                    size.detail * size.whole_detail,
                    place_of(model, colors)};
  // Where the air below the eye is thin, what counts lies far from it.
  const double bend = std::clamp(1 - 1.8 * (h - 2e3) / 10e3, -.8, 1.);
  build.fill(false, size.above, size.slices, 1, out.memory[0], out.map.above);
  build.fill(true, size.below, size.slices, bend, out.memory[1], out.map.below);
  if (size.sky > 0) build.fill(false, size.sky, 1, 1, out.memory[2], out.map.sky);
}

std::shared_ptr<const MapTables> Maps::get(const Model& model, double h, double ground,
                                           double mu_s, double weight,
                                           const Colors& colors,
                                           const std::array<double, 3>& scale,
                                           double detail) const {
  std::vector<double> key{h, ground, mu_s, weight, detail};
  key.insert(key.end(), scale.begin(), scale.end());
  for (const auto& rgb : colors.radiance) key.insert(key.end(), rgb.begin(), rgb.end());
  const std::lock_guard lock(mutex_);
  for (const Entry& e : entries_)
    if (e.key == key) return e.tables;
  auto made = std::make_shared<MapTables>();
  build_map(model, h, ground, mu_s, weight, colors, scale.data(),
            map_size(model, h, ground, mu_s, detail), *made);
  constexpr std::size_t kMost = 4;  // of 18 MB: stereo, frames in flight
  if (entries_.size() == kMost) entries_.erase(entries_.begin());
  entries_.push_back({std::move(key), made});
  return made;
}

SkyPlace place_of(const Model& model, const Colors& colors) {
  const Atmosphere& a = model.atmosphere();
  SkyPlace out{};
  out.shape = model.shape();
  for (int i = 0; i < std::min(model.size(), kMapWavelengths); ++i) {
    const int k = out.wavelengths;
    float seen = 0;
    for (int c = 0; c < 3; ++c)
      seen += out.weight[c][k] = float(colors.transmittance[i][c]);
    out.extinct_R[k] = float(a.rayleigh_scattering[i]),
    out.extinct_M[k] = float(a.mie_extinction[i]);
    out.absorb_O[k] = float(a.ozone_absorption[i]);
    if (seen > 0) ++out.wavelengths;
    for (int c = 0; c < 3; ++c) {
      const float w = float(colors.transmittance[i][c]);
      out.grow_R[c] += w * float(a.rayleigh_scattering[i]);
      out.grow_M[c] += w * float(a.mie_extinction[i]);
    }
  }
  return out;
}

}  // namespace brume::sky
