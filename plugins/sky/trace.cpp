// Straight rays and spheres of planetary radius, in the factored forms that keep their
// digits.

#include <algorithm>
#include <cmath>

#include "trace.h"

namespace brume::sky {

Trace trace(double R, double top, const Ray& ray, const Cuts& at) noexcept {
  Trace out;
  const double r = R + ray.h,
               b = r * ray.mu;  // b: distance of the lowest point behind the eye
  const double c = ray.h * (2 * R + ray.h);  // r^2 - R^2
  const double c_top = top * (2 * R + top);
  const double in_disc = b * b - c + c_top;
  if (!(in_disc > 0)) return out;  // passes above the air
  const double root = std::sqrt(in_disc);
  double t0 = 0, t1 = b > 0 ? (c_top - c) / (b + root) : root - b;
  if (c > c_top) t0 = b < 0 ? (c - c_top) / (root - b) : t1;
  if (!(t1 > t0)) return out;

  // The ground, no higher than the eye.
  const double c_ground = std::min(c, ray.ground * (2 * R + ray.ground)),
               ground_disc = b * b - (c - c_ground);
  if (b < 0 && ground_disc > 0) {
    const double t_ground = (c - c_ground) / (std::sqrt(ground_disc) - b);
    if (t_ground <= ray.distance) out.hits_ground = true;
    t1 = std::min(t1, t_ground);
  }
  t1 = std::min(t1, ray.distance);
  if (!(t1 > t0)) return out;
  out.t_begin = t0, out.t_end = t1;

  // Where the path is cut: at its lowest point, at corners of a density, and where the
  // line crosses the cylinder of the planet's shadow, behind the terminator.
  struct Cut {
    double t;
    int mark;
  } cuts[kMaxStretches] = {{t0, -1}};
  int n_cuts = 1;
  const auto cut = [&](double t, int mark = -1) {
    if (t > t0 && t < t1) cuts[n_cuts++] = {t, mark};
  };
  const double t_low = std::clamp(-b, t0, t1);
  cut(t_low);
  const auto cut_at_altitude = [&](double z) {
    const double disc = b * b - c + z * (2 * R + z);
    if (disc > 0) cut(-b - std::sqrt(disc)), cut(-b + std::sqrt(disc));
  };
  for (int i = 0; i < at.corner_count; ++i) cut_at_altitude(at.corners[i]);
  // Below the ground the sun is as at it.
  if (at.shadow && ray.ground < 0) cut_at_altitude(0);
  if (at.shadow) {
    // Behind the planet, a along its shadow, its cone is R - k a wide, its penumbra's
    // R + k a: k the sun's radius. With p = r + t v and p . s = x + t nu the point there
    // is at p^2 - (p . s)^2 = (R - k (p . s))^2.
    const double x = r * ray.mu_s;  // of the eye, toward the sun
    for (const double k : {-kSunRadius, kSunRadius}) {
      const double wide = 1 + k * k, qa = 1 - wide * ray.nu * ray.nu,
                   qb = b - (wide * x - R * k) * ray.nu,
                   qc = c - (wide * x - 2 * R * k) * x, disc = qb * qb - qa * qc;
      if (!(qa > 1e-12 && disc > 0)) continue;
      for (double s : {-1., 1.}) {
        const double t = (-qb + s * std::sqrt(disc)) / qa;
        if (x + t * ray.nu < 0) cut(t);
      }
    }
  }
  for (int i = 0; i < at.distance_count; ++i) cut(at.distances[i], i);
  // Insertion: few, and mostly in order.
  for (int i = 1; i < n_cuts; ++i)
    for (int j = i; j > 1 && cuts[j].t < cuts[j - 1].t; --j)
      std::swap(cuts[j], cuts[j - 1]);

  for (int i = 0; i < n_cuts; ++i) {
    const bool last = i + 1 == n_cuts;
    const double a = cuts[i].t, e = last ? t1 : cuts[i + 1].t;
    // An empty stretch still says which distance was reached.
    if (!(e > a) && (last || cuts[i + 1].mark < 0)) continue;
    const bool falls = a < t_low;
    Stretch s;
    s.c_low = c + t_low * (2 * b + t_low);
    s.b_low = std::abs(b + t_low);
    s.t_low = t_low;
    s.sign = falls ? -1 : 1;
    s.u_begin = std::abs(a - t_low), s.u_end = std::abs(e - t_low);
    s.U = std::max(falls ? t_low - t0 : t1 - t_low, 1e-30);
    s.mark = last ? -1 : cuts[i + 1].mark;
    out.stretches[out.count++] = s;
  }
  return out;
}

}  // namespace brume::sky
