#include "truth/truth.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "truth/geometry.h"
#include "truth/lights.h"
#include "truth/marches.h"

namespace brume::truth {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

Ray ray_of(const World& w, const glm::dvec3& origin, const glm::dvec3& direction,
           double end) {
  // Scaled first: the square of a direction's length may be beyond double.
  const glm::dvec3 a = glm::abs(direction);
  return {origin - w.eye, glm::normalize(direction / std::max({a.x, a.y, a.z})), end};
}

// How often the ray is marched with what is known of its ways of light by then.
constexpr int kRounds = 4;

Answer stretch(const World& w, const Ray& ray, double begin, const Options& o) {
  Cost cost{o.evaluations};
  const Media media = media_on(w, ray, o, cost);
  Lights lights(w, ray, o, cost);
  long budget = std::min(o.ways, o.evaluations / 2);
  Answer a;
  for (int round = 0; round < kRounds; ++round) {
    lights.begin_march();
    a = march({w, ray, o, media, begin, lights, cost});
    if (!lights.detailed()) break;
    if (round + 1 == kRounds) budget = 0;
    if (!lights.refine_detail(a.L, o, budget)) break;
  }
  for (const OnRay& on : media) a.converged = a.converged && on.converged;
  a.converged = a.converged && lights.enough();
  for (std::size_t c = 0; c < 3; ++c)
    a.L_error[c] += lights.error() + lights.detail_error()[c];
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
