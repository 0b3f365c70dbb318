#include "oracle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "num/random.h"

namespace brume::sky::oracle {
namespace {

struct Vec {
  double x, y, z;
  friend Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec operator*(double s, Vec a) { return {s * a.x, s * a.y, s * a.z}; }
  friend double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
};
double length(Vec a) { return std::sqrt(dot(a, a)); }

// One wavelength of the atmosphere.
struct Air {
  double R, top, H_R, H_M, O_mid, O_half, s_R, s_M, e_M, a_O, E, albedo, g;

  double altitude(Vec p) const { return length(p) - R; }
  double rayleigh(double h) const { return s_R * std::exp(-h / H_R); }
  double mie(double h) const { return s_M * std::exp(-h / H_M); }
  double extinction(double h) const {
    return rayleigh(h) + e_M * std::exp(-h / H_M) +
           a_O * std::max(0., 1 - std::abs(h - O_mid) / O_half);
  }
  static double phase_R(double c) { return 3 / (16 * M_PI) * (1 + c * c); }
  double phase_M(double c) const {
    return 3 / (8 * M_PI) * (1 - g * g) / (2 + g * g) * (1 + c * c) /
           std::pow(1 + g * g - 2 * g * c, 1.5);
  }
};

Air air_of(const Atmosphere& a, int k) {
  return {a.planet_radius,
          a.atmosphere_height,
          a.rayleigh_scale_height,
          a.mie_scale_height,
          a.ozone_altitude,
          a.ozone_half_width,
          a.rayleigh_scattering[k],
          a.mie_scattering[k],
          a.mie_extinction[k],
          a.ozone_absorption[k],
          a.solar_irradiance[k],
          a.ground_albedo[k],
          a.mie_g};
}

// Where the half-line from p along d meets the sphere of radius r, as [near, far]; far <
// 0: not at all.
std::array<double, 2> sphere(Vec p, Vec d, double r) {
  const double b = dot(p, d), disc = b * b - (dot(p, p) - r * r);
  if (disc < 0) return {1, -1};
  return {-b - std::sqrt(disc), -b + std::sqrt(disc)};
}

struct Span {
  double t0, t1;
  bool ground;
};
// The ray's part within the air. The eye counts as above ground.
Span in_air(const Air& a, Vec p, Vec d, double distance) {
  const auto top = sphere(p, d, a.R + a.top);
  if (top[1] <= 0) return {0, 0, false};
  Span s{std::max(top[0], 0.), top[1], false};
  const double R = std::min(a.R, length(p) - 1e-6);
  const auto ground = sphere(p, d, R);
  if (ground[1] > 0 && ground[0] > 0) s.t1 = ground[0], s.ground = true;
  if (distance < s.t1) s.t1 = distance, s.ground = false;
  if (s.t1 < s.t0) s.t1 = s.t0;
  return s;
}

// Optical depth over [t0, t1]: Simpson's rule, panels spaced by the square from the end
// that lies lower.
double optical_depth(const Air& a, Vec p, Vec d, double t0, double t1, int panels) {
  const double lowest = std::clamp(-dot(p, d), t0, t1);
  double tau = 0;
  for (double end : {t0, t1}) {
    const double U = end - lowest;
    if (U == 0) continue;
    double sum = 0;
    for (int i = 0; i <= 2 * panels; ++i) {
      const double x = double(i) / (2 * panels);
      const double w = i == 0 || i == 2 * panels ? 1 : i % 2 ? 4 : 2;
      sum += w * 2 * x * a.extinction(a.altitude(p + (lowest + U * x * x) * d));
    }
    tau += std::abs(U) * sum / (6 * panels);
  }
  return tau;
}

bool hides(const Air& a, Vec p, Vec to) {
  const auto ground = sphere(p, to, a.R);
  return ground[1] > 0 && ground[0] > 0;
}
double through(const Air& a, Vec p, Vec to, int panels) {
  const auto top = sphere(p, to, a.R + a.top);
  if (top[1] <= 0) return 1;
  return std::exp(-optical_depth(a, p, to, std::max(top[0], 0.), top[1], panels));
}

// Sunlight at p: of the disc, in level strips, those that the ground does not hide,
// dimmed as in their middle.
double sunlight(const Air& a, Vec p, Vec sun, int panels = 24) {
  constexpr double kRadius = .2665 * M_PI / 180;
  constexpr int kStrips = 64;
  const Vec up = 1 / length(p) * p;
  Vec across = sun + (-dot(sun, up)) * up;  // level, toward the sun
  if (length(across) > 0) across = 1 / length(across) * across;
  const double e = std::atan2(dot(sun, up), dot(sun, across));
  const auto toward = [&](double y) {
    return std::cos(e + y) * across + std::sin(e + y) * up;
  };
  const auto hidden = [&](double y) { return hides(a, p, toward(y)); };
  if (!hidden(-kRadius)) return through(a, p, sun, panels);
  if (hidden(kRadius)) return 0;
  double area = 0, moment = 0;  // of strips at y = -cos(v), sin^2(v) dv wide
  for (int i = 0; i < kStrips; ++i) {
    const double v = M_PI * (i + .5) / kStrips, y = -kRadius * std::cos(v);
    if (hidden(y)) continue;
    const double w = 2. / kStrips * std::sin(v) * std::sin(v);
    area += w, moment += w * y;
  }
  return area > 0 ? area * through(a, p, toward(moment / area), panels) : 0;
}

// A direction at angle arccos(c) from d, turned by phi.
Vec turn(Vec d, double c, double phi) {
  const double s = std::sqrt(std::max(0., 1 - c * c));
  const Vec other = std::abs(d.z) < .9 ? Vec{0, 0, 1} : Vec{1, 0, 0};
  Vec u{d.y * other.z - d.z * other.y, d.z * other.x - d.x * other.z,
        d.x * other.y - d.y * other.x};
  u = 1 / length(u) * u;
  const Vec v{d.y * u.z - d.z * u.y, d.z * u.x - d.x * u.z, d.x * u.y - d.y * u.x};
  Vec out = c * d + s * std::cos(phi) * u + s * std::sin(phi) * v;
  return 1 / length(out) * out;
}

// Cosines distributed by the phase functions: 1 + c^2 by rejection; Cornette-Shanks as
// Henyey-Greenstein, its inverse in closed form, and rejection by (1 + c^2)/2.
double sample_rayleigh(Random& random) {
  for (;;) {
    const double c = 2 * random.uniform() - 1;
    if (2 * random.uniform() <= 1 + c * c) return c;
  }
}
double sample_mie(double g, Random& random) {
  for (;;) {
    const double xi = random.uniform();
    double c = 2 * xi - 1;
    if (std::abs(g) > 1e-3) {
      const double q = (1 - g * g) / (1 - g + 2 * g * xi);
      c = std::clamp((1 + g * g - q * q) / (2 * g), -1., 1.);
    }
    if (2 * random.uniform() <= 1 + c * c) return c;
  }
}

// Distance to the next collision by delta tracking (Woodcock 1965) within [0, t1]; beyond
// t1: none. The majorant holds for a step and is taken where the step lies lowest, with
// ozone's maximum.
double fly(const Air& a, Vec p, Vec d, double t1, Random& random) {
  double t = 0;
  while (t < t1) {
    const double h = a.altitude(p + t * d),
                 step = std::min(t1 - t, 1000 + .5 * std::max(h, 0.));
    const double lowest = std::clamp(-dot(p, d), t, t + step),
                 low = a.altitude(p + lowest * d);
    const double most = a.rayleigh(low) + a.e_M * std::exp(-low / a.H_M) +
                        (low + step > a.O_mid - a.O_half ? a.a_O : 0) + 1e-30;
    double s = 0;
    for (;;) {
      s -= std::log(1 - random.uniform()) / most;
      if (s >= step) break;
      if (random.uniform() * most < a.extinction(a.altitude(p + (t + s) * d)))
        return t + s;
    }
    t += step;
  }
  return t1 * (1 + 1e-12) + 1;
}

// Light that reaches p from direction d (against the photon), scattered at least once;
// with `weight` its importance.
struct Walker {
  const Air& a;
  Vec sun;
  Random& random;

  // p, where a photon arrives travelling along -d after being scattered with `weight`;
  // adds up next-event estimates.
  double walk(Vec p, Vec d, double weight) {
    double sum = 0;
    for (int order = 0; order < 1000; ++order) {
      const Span s = in_air(a, p, d, INFINITY);
      const double t =
          s.t1 > s.t0 ? s.t0 + fly(a, p + s.t0 * d, d, s.t1 - s.t0, random) : INFINITY;
      if (t > s.t1) {
        if (!s.ground) return sum;
        const Vec q = p + s.t1 * d, up = 1 / length(q) * q;
        p = (a.R + 1e-3) * up;
        weight *= a.albedo;
        sum += weight / M_PI * std::max(dot(up, sun), 0.) * a.E *
               (dot(up, sun) > 0 ? sunlight(a, p, sun) : 0);
        const double c2 = random.uniform();
        d = turn(up, std::sqrt(c2), 2 * M_PI * random.uniform());
      } else {
        p = p + t * d;
        scatter(p, d, weight, sum);
      }
      if (weight < .1) {  // Russian roulette
        if (random.uniform() < .5) return sum;
        weight *= 2;
      }
      if (weight == 0) return sum;
    }
    return sum;
  }

  // A collision at p: adds sunlight scattered into -d, then goes on in a new direction.
  void scatter(Vec p, Vec& d, double& weight, double& sum) {
    const double h = a.altitude(p), r = a.rayleigh(h), m = a.mie(h), e = a.extinction(h),
                 c = dot(d, sun);
    weight *= (r + m) / e;
    if (!(r + m > 0)) {
      weight = 0;
      return;
    }
    sum += weight * (r * Air::phase_R(c) + m * a.phase_M(c)) / (r + m) * a.E *
           sunlight(a, p, sun);
    turn_at(h, d);
  }
  void turn_at(double h, Vec& d) {
    const double r = a.rayleigh(h), m = a.mie(h);
    const double c = random.uniform() * (r + m) < r ? sample_rayleigh(random)
                                                    : sample_mie(a.g, random);
    d = turn(d, c, 2 * M_PI * random.uniform());
  }
};

}  // namespace

double to_space(const Atmosphere& atmosphere, int k, double h, double mu) {
  const Air a = air_of(atmosphere, k);
  const Vec p{0, 0, a.R + h}, to{std::sqrt(1 - mu * mu), 0, mu};
  return hides(a, p, to) ? 0 : through(a, p, to, 2000);
}

Answer see(const Atmosphere& atmosphere, int k, const Ray& ray, int panels, int paths,
           std::uint64_t seed) {
  const Air a = air_of(atmosphere, k);
  // Eye on the z axis, sun in the xz plane.
  const Vec eye{0, 0, a.R + ray.h};
  const double ss = std::sqrt(std::max(0., 1 - ray.mu_s * ray.mu_s)),
               sv = std::sqrt(std::max(0., 1 - ray.mu * ray.mu));
  const Vec sun{ss, 0, ray.mu_s};
  double x = ss > 0 ? (ray.nu - ray.mu * ray.mu_s) / ss : 0;
  x = std::clamp(x, -sv, sv);
  const Vec d{x, std::sqrt(std::max(0., sv * sv - x * x)), ray.mu};

  // Nodes along the ray: midpoints, spaced by the square from the lowest point, each with
  // its transmittance.
  const Span s = in_air(a, eye, d, ray.distance);
  Answer out;
  if (!(s.t1 > s.t0)) return out;
  struct Point {
    double t, dt, weight;
  };
  std::vector<Point> points;
  const double lowest = std::clamp(-dot(eye, d), s.t0, s.t1);
  for (int i = panels; i-- > 0;) {
    const double U = s.t0 - lowest, x1 = (i + 1.) / panels, x0 = double(i) / panels;
    if (U != 0)
      points.push_back(
          {lowest + U * .25 * (x0 + x1) * (x0 + x1), -U * (x1 * x1 - x0 * x0), 0});
  }
  for (int i = 0; i < panels; ++i) {
    const double U = s.t1 - lowest, x1 = (i + 1.) / panels, x0 = double(i) / panels;
    if (U != 0)
      points.push_back(
          {lowest + U * .25 * (x0 + x1) * (x0 + x1), U * (x1 * x1 - x0 * x0), 0});
  }
  double tau = 0;
  std::vector<double> cdf;
  double total = 0;
  for (Point& p : points) {
    const Vec q = eye + p.t * d;
    const double h = a.altitude(q), e = a.extinction(h) * p.dt, r = a.rayleigh(h),
                 m = a.mie(h);
    const double seen = std::exp(-tau) * (e > 1e-9 ? -std::expm1(-e) / e : 1) * p.dt;
    out.single += seen * (r * Air::phase_R(ray.nu) + m * a.phase_M(ray.nu)) * a.E *
                  sunlight(a, q, sun, 200);
    p.weight = seen * (r + m);
    cdf.push_back(total += p.weight);
    tau += e;
  }
  out.T = std::exp(-tau);
  out.L = out.single;
  if (paths == 0 || !(total > 0)) return out;

  // What is scattered again: the last scattering at a point of the ray drawn by its
  // weight, stratified.
  Random random(seed);
  double sum = 0, squares = 0;
  constexpr int kBatch = 16;
  double batch[kBatch] = {};
  for (int i = 0; i < paths; ++i) {
    const double u = (i + random.uniform()) / paths * total;
    const std::size_t j = std::min<std::size_t>(
        std::lower_bound(cdf.begin(), cdf.end(), u) - cdf.begin(), points.size() - 1);
    const Vec p = eye + (points[j].t + (random.uniform() - .5) * points[j].dt) * d;
    Vec to = d;
    Walker w{a, sun, random};
    w.turn_at(a.altitude(p), to);
    const double light = total * w.walk(p, to, 1);
    batch[i % kBatch] += light * kBatch / paths;
  }
  for (double b : batch) sum += b / kBatch;
  for (double b : batch) squares += (b - sum) * (b - sum);
  out.L += sum;
  out.error = std::sqrt(squares / (kBatch * (kBatch - 1)));
  return out;
}

}  // namespace brume::sky::oracle
