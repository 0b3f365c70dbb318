#include "run.h"

#include "num/tail.h"

namespace brume::noise_fog::inline BRUME_ISA_NS {
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

// In double: of a nearly level ray digits cancel.
Batch dot(const double a[3], const Batch b[3]) {
  alignas(64) float lanes[3][W], out[W];
  for (int k = 0; k < 3; ++k) store(lanes[k], b[k]);
  for (int i = 0; i < W; ++i)
    out[i] = float(a[0] * lanes[0][i] + a[1] * lanes[1][i] + a[2] * lanes[2][i]);
  return load<Batch>(out);
}

Slopes<Batch> slopes_of(const Fog& fog, const Ray<Batch>& ray) {
  Slopes<Batch> s = {Batch(fog.log_rho0) - dot(fog.thins, ray.o), dot(fog.thins, ray.d),
                     Batch(0.f), Batch(0.f)};
  if (fog.clears) s.u0 = dot(fog.clearing, ray.o), s.u1 = dot(fog.clearing, ray.d);
  return s;
}

// What the steps along a ray are made for.
struct Aim {
  Batch grade, longest;
};

bool same(const Track& track, const Fog& fog, const Ray<Batch>& ray, Batch begins,
          const Aim& aim) {
  if (track.id != fog.id || !all(load<Batch>(track.grade) == aim.grade) ||
      !all(load<Batch>(track.longest) == aim.longest) ||
      !all(load<Batch>(track.begins) == begins))
    return false;
  for (int k = 0; k < 3; ++k)
    if (!all(load<Batch>(track.ray[k]) == ray.o[k]) ||
        !all(load<Batch>(track.ray[3 + k]) == ray.d[k]))
      return false;
  return true;
}

// The track of these rays, begun where there is none; the longest unused makes room.
Steps steps_of(const Fog& fog, Tracks& tracks, const Ray<Batch>& ray,
               const Slopes<Batch>& slopes, Batch begins, const Aim& aim) {
  int at = 0;
  bool found = false;
  for (int k = 0; k < Tracks::kSlots && !found; ++k) {
    found = same(tracks.slot[k], fog, ray, begins, aim);
    if (found || tracks.used[k] < tracks.used[at]) at = k;
  }
  Track& track = tracks.slot[at];
  tracks.used[at] = ++tracks.clock;
  Steps s = {fog, track, ray, slopes, begins};
  if (found) return s;
  track.id = fog.id;
  for (int k = 0; k < 3; ++k) {
    store(track.ray[k], ray.o[k]);
    store(track.ray[3 + k], ray.d[k]);
  }
  store(track.grade, aim.grade);
  store(track.longest, aim.longest);
  store(track.begins, begins);
  s.begin();
  return s;
}

// Where a ray leaves the ball about the eye in which there is no fog, before rather than
// behind; 0 where it does not meet it.
//   b + s root with root^2 = r^2 - |o x d|^2, or -c / (b + root), as signs have it, in
//   units of the larger of r and |o|; known to `off`, which is all of it where it grazes.
[[gnu::noinline]] Batch leaves_start(const Fog& fog, const Ray<Batch>& ray) {
  const Batch zero(0.f), tiny(1e-37f);
  const Batch unit = max(max(Batch(fog.start), abs(ray.o[0])),
                         max(abs(ray.o[1]), max(abs(ray.o[2]), tiny)));
  const Batch r = Batch(fog.start) / unit;
  Batch o[3], b = zero, across = zero, away = zero;
  for (int k = 0; k < 3; ++k) o[k] = ray.o[k] / unit;
  for (int k = 0; k < 3; ++k) {
    const int j = (k + 1) % 3;
    const Batch x = o[k] * ray.d[j] - o[j] * ray.d[k];
    b += o[k] * ray.d[k];
    across += x * x;
    away += o[k] * o[k];
  }
  away = sqrt(away);
  const Batch root = sqrt(max(r * r - across, zero));
  const Batch far = select(b < zero, root - b, (r - away) * (r + away) / (root + b));
  const Batch off = Batch(4e-6f) / max(root, Batch(1e-6f));
  return max(far - off, zero) * unit;
}

// From where on fog counts in a stretch that begins at t0: behind the ball about the eye
// in which there is none, what lies before it neither hides it nor takes its steps.
Batch begin_of(const Fog& fog, const Ray<Batch>& ray, Batch t0) {
  const Batch zero(0.f);
  if (fog.start == 0) return zero;
  const auto from_eye = (ray.o[0] == zero) & (ray.o[1] == zero) & (ray.o[2] == zero);
  const Batch begins = all(from_eye)
                           ? Batch(fog.start)
                           : select(from_eye, Batch(fog.start), leaves_start(fog, ray));
  return select(t0 >= begins, begins, zero);
}

// How closely a stretch that ends behind the integral D must be known, G the integral of
// the root of the smooth density over it: README, "Steps". The colour counts in which an
// error is seen most: as 1e-5 at least, as opaque fog may have gaps, but where it is
// kBlack deep. There are none in that, and a colour of little extinction shows.
Batch grade_of(const Fog& fog, Batch D, Batch G) {
  constexpr float kBlack = 1e4f, kFinest = -6, kCoarsest = 24;
  const Batch least(1e-5f), zero(0.f), black(kBlack);
  Batch seen = zero;
  for (const float sigma : fog.sigma) {
    const Batch depth = min(Batch(sigma) * D, black), T = exp(-depth);
    const Batch counts = T * Batch(1 + 1 / kBright) / (T + Batch(1 / kBright));
    const Batch kept = select(depth < black, max(counts, least), zero);
    seen = max(seen, Batch(sigma / fog.sigma_most) * kept);
  }
  const Batch K = seen * seen * min(Batch(fog.sigma_most) * G, Batch(1e9f));
  const Batch grade = floor(log(max(K, Batch(1e-15f))) * Batch(-1 / kLogGrade));
  return clamp(select(grade == grade, grade, 0.f), Batch(kFinest), Batch(kCoarsest));
}

// Integral that a stretch may have, by what is known of it before a look at the noise: D
// its smooth fog's, so many of the coarsest cells long; a deviation clearer, and all of
// it cleared where any is.
Batch clearest(const Fog& fog, Batch D, Batch cells) {
  if (fog.clears) D *= Batch(kCleared);
  return D * exp(Batch(-fog.contrast) / sqrt(Batch(1.f) + Batch(0.5f) * cells));
}

// The longest step for a stretch that ends t1 after its fog begins, a power of 4: four of
// it to sixteen, as it is the difference of integrals that begin five steps before the
// ray does. A stretch that is no part of the smallest is as good with steps that do not
// depend on it.
Batch longest_step(const Fog& fog, Batch t1) {
  const Batch power =
      floor(log(max(t1, Batch(1e-30f))) * Batch(1 / kLogGrade)) + Batch(1.f);
  // What is cleared about the eye is the difference of much more that is not.
  const Batch h = Batch(fog.clears ? 0.25f : 4.f) * exp(power * Batch(kLogGrade));
  const auto short_of = (h * Batch(fog.per_size) < Batch(2.f)) | Mask(fog.clears);
  return min(select(short_of, h, Batch(kLongest)), Batch(kLongest));
}

// The grade is first that of the clearest fog that is likely; where the fog turns out to
// be clearer than its grade and one more allow for, again.
Batch integral_along(const Fog& fog, Tracks& tracks, const Ray<Batch>& ray, Batch t0,
                     Batch t1) {
  const auto slopes = slopes_of(fog, ray);
  const Batch half(0.5f), begins = begin_of(fog, ray, t0);
  const Batch G = smooth_integral(half * slopes.a, half * slopes.b, begins, t1);
  const Batch smooth = smooth_integral(slopes.a, slopes.b, begins, t1);
  const Batch cells = G * min(G / max(smooth, Batch(1e-30f)), Batch(kLongest));
  Batch grade = grade_of(fog, clearest(fog, smooth, cells * Batch(fog.per_size)), G);
  const Batch longest = longest_step(fog, t1 - begins);
  Batch D(0.f);
  for (int round = 0; round < 12; ++round) {
    Batch in_all;
    D = steps_of(fog, tracks, ray, slopes, begins, {grade, longest})
            .integral(t0, t1, in_all);
    const Batch needed = grade_of(fog, in_all, G);
    const auto again = needed < grade - Batch(1.f);
    if (none(again)) break;
    grade = select(again, needed, grade);
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
    store_some(rho, i, n, density(fog, slopes_of(fog, ray), at, x));
  }
}

}  // namespace

const Kernels kernels = {integral, density_at};

}  // namespace brume::noise_fog::inline BRUME_ISA_NS
