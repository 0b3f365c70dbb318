#pragma once
// What the tests of noise fog share: its kernels asked as the integrator asks, optical
// depths of the oracle's field, and fogs drawn at random.

#include <algorithm>
#include <cmath>
#include <memory>

#include "../../tests/stage/through_air.h"
#include "curve.h"
#include "num/random.h"
#include "oracle.h"
#include "run.h"

namespace brume::test {

using noise_fog::Look;
using noise_fog::Oracle;
using noise_fog::Point;

inline constexpr double kInf = std::numeric_limits<double>::infinity();
inline constexpr double kEps = std::numeric_limits<float>::epsilon();

inline Point unit(Random& r, double steepest = 1) {
  Point d;
  double n = 0;
  do {
    n = 0;
    for (std::size_t k = 0; k < 3; ++k)
      d[k] = r.uniform(-1, 1) * (k == 2 ? steepest : 1), n += d[k] * d[k];
  } while (n < 0.01 || n > 1);
  for (double& x : d) x /= std::sqrt(n);
  return d;
}
// As kernels see it. Out of line: of two of these side by side g++ 12.2 (-O2) drops the
// rounding.
[[gnu::noinline]] inline double rounded(double x) { return static_cast<float>(x); }
inline Point rounded(const Point& d) {
  return {rounded(d[0]), rounded(d[1]), rounded(d[2])};
}
inline Point at(const Point& o, const Point& d, double t) {
  return {o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]};
}
inline Point eye_of(const Look& s) { return {s.eye[0], s.eye[1], s.eye[2]}; }
inline Ray toward(const Point& d, double t) {
  return {{0, 0, 0}, {float(d[0]), float(d[1]), float(d[2])}, float(t)};
}

// Kernels of the best instruction set on one ray, asked as the integrator asks.
struct Kernel {
  std::unique_ptr<noise_fog::Tracks> tracks = noise_fog::new_tracks();

  static const noise_fog::Kernels& table(Isa isa) {
    return of_isa(isa, noise_fog::isa_v2::kernels, noise_fog::isa_v3::kernels,
                  noise_fog::isa_v4::kernels);
  }
  double density(const noise_fog::Fog& fog, const Point& o, const Point& d, double t,
                 Isa isa = best_isa()) const {
    const float v[7] = {float(o[0]), float(o[1]), float(o[2]), float(d[0]),
                        float(d[1]), float(d[2]), float(t)};
    const brume_rays ray = {1, v, v + 1, v + 2, v + 3, v + 4, v + 5};
    float rho;
    table(isa).density(fog, ray, v + 6, &rho);
    return rho;
  }
  double integral(const noise_fog::Fog& fog, const Point& d, double t0, double t1,
                  Isa isa = best_isa()) {
    const float v[5] = {float(d[0]), float(d[1]), float(d[2]), float(t0), float(t1)};
    const brume_rays ray = {1, nullptr, nullptr, nullptr, v, v + 1, v + 2};
    return integral(fog, ray, v + 3, isa);
  }
  double integral_from(const noise_fog::Fog& fog, const Point& o, const Point& d,
                       double t0, double t1) {
    const float v[8] = {float(o[0]), float(o[1]), float(o[2]), float(d[0]),
                        float(d[1]), float(d[2]), float(t0),   float(t1)};
    const brume_rays ray = {1, v, v + 1, v + 2, v + 3, v + 4, v + 5};
    return integral(fog, ray, v + 6, best_isa());
  }
  double integral(const noise_fog::Fog& fog, const brume_rays& ray, const float* t,
                  Isa isa) {
    float D;
    table(isa).integral(fog, *tracks, ray, t, t + 1, &D);
    return D;
  }
  // How often the noise has been looked at for stretches of the rays that are kept: for
  // the last one, asked of a new Kernel.
  int looks() const {
    int sum = 0;
    for (const noise_fog::Track& track : tracks->slot)
      sum += track.id > 0 ? track.looks : 0;
    return sum;
  }
};

// Optical depth of the oracle's field over [s.start, t], by midpoints an eighth of the
// finest cell apart (2000 at least): 1e-6 of it, against half of that step.
inline double true_depth(const Oracle& o, const Look& s, const Point& d, double t,
                         double sigma) {
  const double fine = noise_fog::cell_of(s, s.octaves - 1) / 8, way = t - s.start;
  const long n = std::max(2000L, long(way / fine));
  double sum = 0;
  for (long j = 0; j < n && sum * way / double(n) * sigma < 40; ++j)
    sum += o.density(at(eye_of(s), d, s.start + (double(j) + .5) * way / double(n)));
  return sum * way / double(n) * sigma;
}

// The same fog in all colours.
inline void grey(Look& s, double sigma) {
  for (double& x : s.sigma) x = sigma;
}

inline Look any_look(Random& r) {
  Look s;
  s.size = std::pow(10, r.uniform(1.5, 2.6));
  s.octaves = 3 + int(r.uniform() * 4);
  s.gain = r.uniform(.4, .6);
  s.contrast = r.uniform(.5, 1.1);
  s.falloff = std::pow(10, r.uniform(-2.5, -1.3));
  s.seed = int(r.uniform(0, 1e6));
  s.pixel = Footprint(6e-4).mean();
  for (double& x : s.eye) x = r.uniform(-1e4, 1e4);
  s.eye[2] = std::pow(10, r.uniform(.3, 2.3));
  grey(s, std::pow(10, r.uniform(-3, -1.7)));
  return s;
}

inline constexpr double kTolerance = 1e-3;  // the default
inline constexpr double kKnob = 1.5e-4;     // `error` that the curve has for it

// What the curve promises at a value of the knob.
inline double promised(double error) {
  double promise = 0;
  for (std::size_t i = 0; i < std::size(noise_fog::kCurve); i += 2)
    if (noise_fog::kCurve[i] >= error) promise = noise_fog::kCurve[i + 1];
  return promise;
}

// Error of the picture, |dC| / (1 + |C|), before the background that shows it most: none
// to 30 whites, as the curve has it; the fog has the colour 1.
inline double seen(double got, double T) {
  double worst = 0;
  for (const double S : {0., 30.})
    worst = std::max(worst, std::abs((S - 1) * (got - T)) / (2 - T + S * T));
  return worst;
}

// Cells of `size` m, pixels of 6e-4 rad, at the default tolerance.
inline Look look_of(double size, int octaves, double contrast, double sigma) {
  Look s;
  s.size = size;
  s.octaves = octaves;
  s.contrast = contrast;
  s.pixel = Footprint(6e-4).mean();
  s.tolerance = kKnob;
  grey(s, sigma);
  return s;
}

// Error of a ray of t metres: its kernel, asked for the first time, and the oracle.
inline double error_of(const noise_fog::Fog& fog, const Look& s, const Point& d,
                       double t) {
  Kernel kernel;
  const double sigma = s.sigma[0];
  return seen(std::exp(-sigma * kernel.integral(fog, d, s.start, t)),
              std::exp(-true_depth(Oracle(s), s, d, t, sigma)));
}

}  // namespace brume::test
