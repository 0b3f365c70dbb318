#include "run.h"

#include "num/tail.h"

namespace noise_fog::inline BRUME_ISA_NS {
namespace {

constexpr int W = Batch::W;

Ray<Batch> ray_at(const brume_rays& r, int i, int n) {
  const float* const o[3] = {r.ox, r.oy, r.oz};
  const float* const d[3] = {r.dx, r.dy, r.dz};
  Ray<Batch> ray;
  for (int k = 0; k < 3; ++k) {
    ray.o[k] = o[k] ? load_some(o[k], i, n) : Batch(0.f);
    ray.d[k] = load_some(d[k], i, n);
  }
  return ray;
}

bool same(const Track& track, const Fog& fog, const Ray<Batch>& ray, Batch grade) {
  if (track.id != fog.id || !all(load<Batch>(track.grade) == grade)) return false;
  for (int k = 0; k < 3; ++k)
    if (!all(load<Batch>(track.ray[k]) == ray.o[k]) ||
        !all(load<Batch>(track.ray[3 + k]) == ray.d[k]))
      return false;
  return true;
}

// The track of these rays, begun where there is none; the longest unused makes room.
Steps steps_of(const Fog& fog, Tracks& tracks, const Ray<Batch>& ray, Batch a, Batch b,
               Batch grade) {
  int at = 0;
  bool found = false;
  for (int k = 0; k < Tracks::kSlots && !found; ++k) {
    found = same(tracks.slot[k], fog, ray, grade);
    if (found || tracks.used[k] < tracks.used[at]) at = k;
  }
  Track& track = tracks.slot[at];
  tracks.used[at] = ++tracks.clock;
  Steps s = {fog, track, ray, a, b};
  if (found) return s;
  track.id = fog.id;
  for (int k = 0; k < 3; ++k) {
    store(track.ray[k], ray.o[k]);
    store(track.ray[3 + k], ray.d[k]);
  }
  store(track.grade, grade);
  s.begin();
  return s;
}

// How closely a stretch that ends behind the optical depth tau must be known, G the
// integral of the root of the smooth density over it: README, "Steps", eq. 7.
Batch grade_of(const Fog& fog, Batch tau, Batch G) {
  const Batch T = exp(-tau);
  const Batch counts =
      max(T * Batch(1 + 1 / kBright) / (T + Batch(1 / kBright)), Batch(1e-3f));
  const Batch K = counts * counts * min(Batch(fog.sigma_most) * G, Batch(1e9f));
  const Batch grade = floor(log(max(K, Batch(1e-9f))) * Batch(-1 / kLogGrade));
  return clamp(select(grade == grade, grade, 0.f), Batch(-6.f), Batch(12.f));
}

// The grade is first that of the smooth fog; where the fog turns out to be clearer than
// its grade allowed for, again.
Batch integral_along(const Fog& fog, Tracks& tracks, const Ray<Batch>& ray, Batch t0,
                     Batch t1) {
  const Batch a = Batch(fog.log_rho0) - dot(fog.thins, ray.o), b = dot(fog.thins, ray.d);
  const Batch sigma(fog.sigma_least), zero(0.f), half(0.5f);
  const Batch G = smooth_integral(half * a, half * b, zero, t1);
  Batch grade = grade_of(fog, sigma * smooth_integral(a, b, zero, t1), G), D(0.f);
  for (int round = 0; round < 12; ++round) {
    Batch from_origin;
    D = steps_of(fog, tracks, ray, a, b, grade).integral(t0, t1, from_origin);
    const Batch finer = min(grade, grade_of(fog, sigma * from_origin, G));
    if (all(finer == grade)) break;
    grade = finer;
  }
  return D;
}

void integral(const Fog& fog, Tracks& tracks, const brume_rays& rays, const float* t0,
              const float* t1, float* D) noexcept {
  const int n = int(rays.n);
  for (int i = 0; i < n; i += W)
    store_some(D, i, n,
               integral_along(fog, tracks, ray_at(rays, i, n), load_some(t0, i, n),
                              load_some(t1, i, n)));
}

void density_at(const Fog& fog, const brume_rays& rays, const float* t,
                float* rho) noexcept {
  const int n = int(rays.n);
  for (int i = 0; i < n; i += W) {
    const auto ray = ray_at(rays, i, n);
    const Batch at = min(load_some(t, i, n), Batch(kLongest));
    Batch x[3];
    for (int k = 0; k < 3; ++k) x[k] = ray.o[k] + at * ray.d[k];
    store_some(rho, i, n, density(fog, x));
  }
}

}  // namespace

const Kernels kernels = {integral, density_at};

}  // namespace noise_fog::inline BRUME_ISA_NS
