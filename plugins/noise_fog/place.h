#pragma once
// From parameters to what kernels see: the lattice under the eye, amplitudes, and the
// table of steps. Host code, double.

#include <algorithm>
#include <array>
#include <cmath>

#include "kernel.h"
#include "num/random.h"
#include "stage/footprint.h"

namespace brume::noise_fog {

/// Noise fog at one frame, as the user set it.
struct Look {
  double size = 100;  ///< of the coarsest cells [m]
  int octaves = 4;
  double gain = 0.5, contrast = 0.7;
  int seed = 0, period = 0;
  double shift[3] = {};  ///< how far the pattern has moved [m]
  double height = 0, falloff = 0, clearing = 0;
  double up[3] = {0, 0, 1}, eye[3] = {};
  int smoothing = 0;
  brume::FootprintMean pixel = {};
  double sigma[3] = {};
  double start = 0;         ///< nearer to the eye there is no fog [m]
  double tolerance = 1e-3;  ///< of the transmittance
};

constexpr double kNoiseVariance = 0.0729190;  ///< of gradient noise, exact to the digits

inline double cell_of(const Look& s, int k) { return s.size / std::exp2(k); }

// Every octave's amplitude in log rho, before any filter: so that the variances of the
// terms c n add up to contrast^2.
inline double amplitude(const Look& s, int k) {
  double sum = 0;
  for (int j = 0; j < s.octaves; ++j) sum += std::pow(s.gain, 2 * j);
  return s.contrast * std::pow(s.gain, k) / std::sqrt(sum * kNoiseVariance);
}

// An octave's lattice stands apart from the others': all noise is 0 at its lattice
// points.
inline std::array<double, 3> stagger(const Look& s, int k) {
  const auto h = brume::hash(std::uint32_t(s.seed), std::uint32_t(k), 0x6e6f6973u, 0u);
  return {brume::uniform<double>(h.x), brume::uniform<double>(h.y),
          brume::uniform<double>(h.z)};
}

// Row n of Pascal's triangle, spaced by half the finest cell, has variance n
// (cell/2)^2/4.
inline double blur_variance(const Look& s) {
  const double spacing = cell_of(s, s.octaves - 1) / 2;
  return s.smoothing * spacing * spacing / 4;
}
// A pixel's filter: a Gaussian whose standard deviation is half a pixel.
inline double pixel_variance(double width2) { return width2 / 4; }
// Of what filters alike everywhere.
inline double even_variance(const Look& s) {
  return blur_variance(s) + pixel_variance(s.pixel.even2);
}

// Variance of an integral's error per length of ray, in units of (variance of the octave)
// x cell, for steps of h cells: measured over 400 random rays of 24 cells
// (test NoiseFogSteps.ErrorOfAStepIsAsTheTableSays). At 1.5 and beyond the octave is left
// out and this is the variance of its own integral.
struct StepError {
  double h, e2;
};
constexpr StepError kStepError[] = {
    {0.05, 7.8e-13}, {0.1, 1.9e-10}, {0.15, 5.0e-9}, {0.2, 4.8e-8}, {0.25, 3.0e-7},
    {0.3, 1.7e-6},   {0.35, 4.4e-6}, {0.4, 2.7e-5},  {0.5, 1.7e-4}, {0.6, 1.3e-3},
    {0.7, 5.5e-3},   {0.8, 1.1e-2},  {0.9, 3.0e-2},  {1.0, 0.090},  {1.1, 0.21},
    {1.2, 0.37},     {1.3, 0.56},    {1.5, 0.80}};
constexpr std::size_t kStepErrors = std::size(kStepError);
inline double step_error(double h) {
  const auto* e = std::begin(kStepError);
  if (h <= e->h) return e->e2 * std::pow(h / e->h, 8);
  for (; e + 1 != std::end(kStepError); ++e)
    if (h <= e[1].h) {
      const double u = std::log(h / e->h) / std::log(e[1].h / e->h);
      return e->e2 * std::pow(e[1].e2 / e->e2, u);
    }
  return e->e2;
}

// Variance of tau per metre and squared visibility, for steps of h metres.
inline double step_variance(const Look& s, const Fog& fog, double h) {
  double A = 0;
  for (int k = 0; k < fog.octaves; ++k) {
    const double c = fog.octave[k].c * std::exp(-fog.octave[k].blur * even_variance(s));
    // The exponential of strong noise has waves of its own, shorter than a cell.
    const double harsh = std::max(1., 0.4 + 0.6 * c * c);
    A += std::expm1(c * c * kNoiseVariance) * cell_of(s, k) *
         std::min(harsh * step_error(h / cell_of(s, k)), kStepError[kStepErrors - 1].e2);
  }
  return A;
}

/// Of the tolerance, what the standard deviation of the integration's error may be.
constexpr double kShare = 1. / 4;

// V A(h) = E^2: with that much visibility a step may be that long (README, "Steps").
inline void fill_steps(const Look& s, Fog& fog) {
  // Where the fog is dense the finer octaves count for more than in the mean.
  const double E2 =
      std::pow(kShare * s.tolerance, 2) * std::exp(-s.contrast * s.contrast / 2);
  const double finest = cell_of(s, s.octaves - 1), longest = 1.5 * s.size;
  const double least = std::log(E2 / step_variance(s, fog, longest)),
               most = std::log(E2 / step_variance(s, fog, 0.02 * finest));
  fog.first_log_V = float(least);
  fog.per_log_V = float((kStepTable - 1) / (most - least));
  double lo = 0.02 * finest, hi = longest;
  for (int i = 0; i < kStepTable; ++i) {
    const double log_V = least + (most - least) * i / (kStepTable - 1);
    double a = std::log(lo), b = std::log(hi);
    for (int step = 0; step < 50; ++step) {
      const double mid = (a + b) / 2;
      (std::log(E2 / step_variance(s, fog, std::exp(mid))) > log_V ? a : b) = mid;
    }
    fog.log_step[i] = float((a + b) / 2);
  }
  // What is cleared has no mean in closed form: all of it is stepped through.
  fog.log_rho_least =
      float(least - std::log(double(fog.sigma_most)) - (s.clearing > 0 ? 90 : 0));
  // A pixel of q finest cells leaves of an octave of y pixels W^2 = e^(-5/y^2), eq. 3.
  // With a^2 ~ (1/gain)^(2 log2 l) and e^2 ~ (h/l)^9, all octaves are seen to as well as
  // the finest is in steps h where h is (2 q)^(1 - n/9) times longer, n = 1 + 2
  // log2(1/gain).
  const double n = 1 + 2 * std::log2(1 / std::max(s.gain, 0.05));
  // A blur of deviation s leaves as little of cells of 2.6 s.
  fog.per_finest = float(1 / std::max(finest, 2.6 * std::sqrt(even_variance(s))));
  fog.coarsens = float(std::max(1 - n / 9, 0.));
}

inline Fog fog_of(const Look& s, std::uint64_t id) {
  Fog fog;
  fog.id = id;
  fog.octaves = s.contrast > 1e-6 ? s.octaves : 0;  // less than floats tell
  double up_eye = 0;
  for (int i = 0; i < 3; ++i) up_eye += s.up[i] * s.eye[i];
  for (int k = 0; k < s.octaves; ++k) {
    Octave& o = fog.octave[k];
    const double cell = cell_of(s, k);
    o.per_cell = float(1 / cell);
    o.c = float(amplitude(s, k));
    o.blur = float(10 / (cell * cell));
    o.period = s.period > 0 ? s.period << k : 0;
    o.seed = std::uint32_t(s.seed) * 16 + std::uint32_t(k);
    const auto apart = stagger(s, k);
    const double wraps = o.period > 0 ? o.period : 0x1p32;
    for (std::size_t i = 0; i < 3; ++i) {
      const double q = (s.eye[i] - s.shift[i]) / cell + apart[i];
      const double lower = std::floor(q), turn = std::fmod(lower, wraps);
      o.lattice[i] = std::uint32_t(turn < 0 ? turn + wraps : turn);
      o.fraction[i] = float(q - lower);
    }
  }
  for (int i = 0; i < 3; ++i) {
    fog.thins[i] = s.falloff * s.up[i];
    fog.clearing[i] = s.clearing > 0 ? s.up[i] / s.clearing : 0;
  }
  fog.clears = s.clearing > 0;
  fog.start = float(s.start);
  fog.log_rho0 = float(-s.falloff * (up_eye - s.height));
  for (std::size_t i = 0; i < 3; ++i) {
    fog.pixel[i] = float(pixel_variance(s.pixel.p[i]));
    fog.axis[i] = float(s.pixel.axis[i]);
  }
  fog.least = float(s.pixel.least);
  fog.narrowest = float(pixel_variance(s.pixel.narrowest()));
  fog.blur2 = float(even_variance(s));
  fog.black = float(std::clamp(std::log(64 / s.tolerance), 4., 30.));
  fog.contrast = float(s.contrast);
  fog.per_size = float(1 / s.size);
  for (int c = 0; c < 3; ++c) fog.sigma[c] = float(s.sigma[c]);
  fog.sigma_most = std::ranges::max(fog.sigma);
  fog.sigma_least = fog.sigma_most;  // of the colours that see it at all
  for (const float x : fog.sigma)
    if (x > 0) fog.sigma_least = std::min(fog.sigma_least, x);
  fog.log_rho_most = float(70 - std::max(std::log(double(fog.sigma_most)), 0.));
  if (step_variance(s, fog, 1.5 * s.size) < 1e-20) fog.octaves = 0;  // floats see none
  if (fog.octaves > 0) {
    fill_steps(s, fog);
  } else {  // nothing but the clearing to follow
    std::fill(std::begin(fog.log_step), std::end(fog.log_step), 69.f);
    fog.log_rho_least = s.clearing > 0 ? -60.f : 3e38f;
  }
  return fog;
}

}  // namespace brume::noise_fog
