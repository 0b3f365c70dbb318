#include "truth/truth.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "truth/geometry.h"
#include "truth/march.h"
#include "truth/physics.h"
#include "truth/segments.h"

namespace brume::truth {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

Ray ray_of(const World& w, const glm::dvec3& origin, const glm::dvec3& direction,
           double end) {
  // Scaled first: the square of a direction's length may be beyond double.
  const glm::dvec3 a = glm::abs(direction);
  return {origin - w.eye, glm::normalize(direction / std::max({a.x, a.y, a.z})), end};
}

// What light meets on its way; nested in the view ray's march, so asked for more closely.
Rgb depth_toward(const World& w, const Ray& ray, double tolerance, long& evaluations) {
  const Media media = media_on(w, ray, {}, tolerance);
  March march(tolerance, 1);
  walk(
      w, media, ray, march,
      [&](const Present& here, double t) {
        Local l;
        for (const OnRay* m : here) {
          const AtPoint p = medium_at(w, *m->medium, ray.at(t), ray.d);
          for (int c = 0; c < 3; ++c)
            if (t <= m->cap[c])
              l.sigma[c] += p.rho * p.tint[c] * m->medium->extinction[c];
        }
        return l;
      },
      false);
  evaluations += march.evaluations;
  Rgb tau = march.tau;
  const float o[3] = {float(ray.o.x), float(ray.o.y), float(ray.o.z)};
  const float d[3] = {float(ray.d.x), float(ray.d.y), float(ray.d.z)};
  const brume_rays one = {1, o, o + 1, o + 2, d, d + 1, d + 2};
  const float end = float(ray.end);
  for (const auto& s : w.shadowers) {
    float rgb[3];
    s.what.optical_depth(s.what.self, &one, &end, rgb, rgb + 1, rgb + 2);
    for (int c = 0; c < 3; ++c) tau[c] += rgb[c] > 0 ? rgb[c] : 0;
  }
  return tau;
}

/// Source radiance per unit extinction toward the ray's origin.
struct Sources {
  const World& world;
  const Ray& ray;
  double tolerance;
  long& evaluations;

  Rgb at(const brume_medium& m, const Rgb& own, const glm::dvec3& x) const {
    const bool sky = m.source == BRUME_SOURCE_SKY;
    Rgb S = own;
    if (m.source == BRUME_SOURCE_COLOR) S = {m.color[0], m.color[1], m.color[2]};
    for (const auto& l : world.lights) {
      const bool lamp = l.what.kind == BRUME_POINT || l.what.kind == BRUME_SPOT;
      Rgb answer;
      for (int c = 0; c < 3; ++c) answer[c] = sky && !lamp ? 1 : m.albedo[c];
      if (answer == Rgb{}) continue;
      Incident in = light_at(world, l.what, x);
      if (in.E == Rgb{}) continue;
      double p = 1;  // the phase function's integral, for the sky's mean radiance
      if (l.what.kind != BRUME_SKY_LIGHT) {
        p = phase(m, in.to, ray.d);
        if (l.what.attenuated) {
          const Rgb tau =
              depth_toward(world, {x, in.to, in.distance}, tolerance, evaluations);
          for (int c = 0; c < 3; ++c) in.E[c] *= std::exp(-tau[c]);
        }
      }
      for (int c = 0; c < 3; ++c) S[c] += answer[c] * p * in.E[c];
    }
    return S;
  }
};

Answer stretch(const World& w, const Ray& ray, double begin, const Options& o) {
  const Media media = media_on(w, ray, o.weights, o.tolerance * 1e-2);
  Answer a;
  March march(o.tolerance, o.white);
  const Sources sources{w, ray, o.tolerance * 0.1, a.evaluations};
  const auto at = [&](const Present& here, double t) {
    Local l;
    const glm::dvec3 x = ray.at(t);
    for (const OnRay* on : here) {
      const brume_medium& m = *on->medium;
      const AtPoint p = medium_at(w, m, x, ray.d);
      const double rho = on->weight * p.rho;
      if (rho == 0) continue;
      const bool shines = o.only_stage < 0 || on->stage == o.only_stage;
      Rgb S{};
      if (shines && on->scatters) S = sources.at(m, p.source, x);
      for (int c = 0; c < 3; ++c) {
        if (t > on->cap[c]) continue;
        const double sigma = m.extinction[c] * p.tint[c];
        l.sigma[c] += rho * sigma;
        if (shines) l.e[c] += rho * (m.emission[c] + sigma * S[c]);
      }
    }
    return l;
  };
  walk(w, media, ray, march, at, true, begin);
  a.L = march.L;
  a.L_error = march.L_error;
  for (int c = 0; c < 3; ++c) {
    a.T[c] = std::exp(-march.tau[c]);
    a.T_error[c] = a.T[c] * march.tau_error[c];
  }
  a.converged = march.converged;
  for (const OnRay& on : media) a.converged = a.converged && on.converged;
  a.evaluations += march.evaluations;
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
  long evaluations = 0;
  return depth_toward(w, ray_of(w, origin, direction, t_end), tolerance, evaluations);
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
