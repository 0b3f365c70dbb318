#pragma once
// The density of noise fog at a point, for Batch, float and double. README eq. 1 to 4.
//
//   rho      density [1]; extinction = density parameter x rho [1/m]
//   q        position in cells of an octave, counted from the lattice point below the eye
//   c        amplitude of an octave in log rho [1]
//   s2       variance of the filter [m^2]: pixel, blur, step
//
// Positions are relative to the eye: what must keep digits far from the world's origin,
// the eye's own place in the lattice, comes as an integer and a fraction (place.h).

#include <array>
#include <cstdint>

#include "num/math.h"
#include "num/noise.h"

namespace brume::noise_fog {

constexpr int kMostOctaves = 12;
constexpr int kStepTable = 64;
constexpr float kCleared = 0.001f;  ///< of the density, at the camera's height

struct Octave {
  float per_cell = 1;  ///< cells per metre
  float c = 0;         ///< amplitude in log rho
  float blur = 0;      ///< 10 / cell^2 [1/m^2], README eq. 3
  int period = 0;      ///< in cells; 0: none
  std::uint32_t seed = 0;
  std::array<std::uint32_t, 3> lattice{};  ///< the eye's lattice point
  float fraction[3] = {};                  ///< and what is left
};

/// What kernels see of the fog at one frame.
struct Fog {
  int octaves = 0;
  Octave octave[kMostOctaves];
  float log_rho0 = 0;       ///< of the smooth fog at the eye
  float log_rho_most = 80;  ///< denser than that is opaque anyway, and no float
  double thins[3] = {};     ///< falloff x up [1/m]
  double clearing[3] = {};  ///< up / clearing height [1/m]; 0: none
  // Filter variance [m^2]: blur2, and of pixels |x|^2 (pixel[0] + pixel[1] c + pixel[2]
  // c^2), c = max((axis . x)^2 / |x|^2, least) (stage/footprint.h).
  float blur2 = 0, pixel[3] = {}, axis[3] = {}, least = 0;
  float narrowest = 0;  ///< of that per |x|^2, in any direction
  bool clears = false;
  float start = 0;  ///< no ray from the eye is asked about nearer than this [m]

  // What the steps along a ray follow (steps.h, README section "Steps").
  std::uint64_t id = 0;  ///< of the stage object: no two have the same
  float sigma[3] = {}, sigma_most = 0, sigma_least = 0;  ///< extinction where rho is 1
  float log_rho_least = 0;           ///< thinner smooth fog is taken at its mean
  float black = 30;                  ///< optical depth behind which nothing is seen
  float contrast = 0, per_size = 0;  ///< deviation of ln rho, 1 / coarsest cell [1/m]
  float first_log_V = 0, per_log_V = 0;
  float per_finest = 0, coarsens = 0;  ///< steps of wide pixels: 1 / finest cell, power
  float log_step[kStepTable] = {};
};

}  // namespace brume::noise_fog

namespace brume::noise_fog::inline BRUME_ISA_NS {

using namespace brume::BRUME_ISA_NS;

// ln E[e^(c n)], n gradient noise, over all places and gradients: what an octave's
// exponential adds to the mean density (README eq. 2).
//   c^2 times a polynomial in c^2/32 - 1, fitted to the exact mean: at a place, the
//   product over the eight corners of the mean over twelve gradients; over the cell by
//   Gauss-Legendre 12^3.
//   Domain |c| <= 8; absolute error 5e-8, in float 4e-7. (It is a bias of the density.)
template <Real T>
BRUME_INLINE T log_mean_of(T c) {
  using S = Scalar_t<T>;
  constexpr S p[] = {S(0.03376426518),   S(-0.002245666139), S(0.0003604165188),
                     S(-6.97085673e-05), S(1.501805488e-05), S(-3.61727288e-06),
                     S(7.1645904e-07)};
  const T y = c * c, u = y * T(S(1. / 32)) - T(1);
  T q(p[6]);
  for (int k = 5; k >= 0; --k) q = q * u + T(p[k]);
  return y * q;
}

// How much of an octave steps of h cells can follow: all of it up to 3/4 of a cell, none
// from 3/2 on (README, "Steps").
template <Real T>
BRUME_INLINE T followed(T h) {
  using S = Scalar_t<T>;
  const T u = clamp((h - T(S(0.75))) * T(S(1 / 0.75)), T(0), T(1));
  return T(1) - u * u * (T(3) - T(2) * u);
}

// Whether steps of h cells resolve an octave many times over: up to 1/20 of a cell, not
// from 1/8 on.
template <Real T>
BRUME_INLINE T resolved(T h) {
  using S = Scalar_t<T>;
  const T u = clamp((h - T(S(0.05))) * T(S(1 / 0.075)), T(0), T(1));
  return T(1) - u * u * (T(3) - T(2) * u);
}

// ln of the noise's factor at x (relative to the eye), seen through a filter of variance
// s2 and followed in steps of h metres: the sum over octaves of c W n - ln E[e^(c W n)],
// W = e^(-10 s2 / cell^2) followed(h / cell). An octave with W below 1e-3 is not there.
// In `banks`, if asked for, the part of octaves that such steps resolve many times over.
template <Real T>
BRUME_INLINE T log_factor(const Fog& fog, const T x[3], T s2, T h, T* banks = nullptr) {
  using S = Scalar_t<T>;
  T sum(0), coarse(0);
  for (int k = 0; k < fog.octaves; ++k) {
    const Octave& o = fog.octave[k];
    const T W = exp(-T(S(o.blur)) * s2) * followed(h * T(S(o.per_cell)));
    const auto seen = W > T(S(1e-3));
    if (none(seen)) break;  // finer ones are seen less
    T q[3];
    for (int i = 0; i < 3; ++i) q[i] = x[i] * T(S(o.per_cell)) + T(S(o.fraction[i]));
    const T c = T(S(o.c)) * W;
    const T n = noise(q[0], q[1], q[2], o.seed, o.period, o.lattice);
    const T f = select(seen, c * n - log_mean_of(c), T(0));
    sum += f;
    if (banks != nullptr) coarse += resolved(h * T(S(o.per_cell))) * f;
  }
  if (banks != nullptr) *banks = coarse;
  return sum;
}

/// A point on a ray, relative to the eye.
template <Real T>
struct Ray {
  T o[3], d[3];
};

/// What the smooth fog is along a ray, by distance t: a - b t is ln rho, u0 + u1 t the
/// height over the eye's in heights of the clearing. Both go by lines, and not by places:
/// at a place far along a nearly level ray the height is a difference of large numbers.
template <Real T>
struct Slopes {
  T a, b, u0, u1;
  BRUME_INLINE T cleared_height(T t) const {
    using S = Scalar_t<T>;
    return clamp(u0 + u1 * t, T(S(-1e9)), T(S(1e9)));
  }
};

// The part that is no noise, at t: e^(-falloff (z - height)), cleared about the eye's
// height.
// Clearing (Intel 2008): n dY^2/2 + 0.001, here ending at 1 instead of growing for ever:
// u^2/2 / (1 + u^2/2) in its place, u = dY / clearing.
template <Real T>
BRUME_INLINE T smooth_density(const Fog& fog, const Slopes<T>& slopes, T t,
                              T log_factor_) {
  using S = Scalar_t<T>;
  const T e = slopes.a - slopes.b * t + log_factor_;
  T rho = exp(min(e, T(S(fog.log_rho_most))));
  if (fog.clears) {
    const T u = slopes.cleared_height(t);
    const T half = T(S(0.5)) * u * u;
    rho = rho * (T(S(kCleared)) + T(S(1 - kCleared)) * half / (T(1) + half));
  }
  return rho;
}

// Variance of the filter that a pixel is at x, of those that fan out from the eye.
template <Real T>
BRUME_INLINE T pixel_filter(const Fog& fog, const T x[3]) {
  using S = Scalar_t<T>;
  const T r2 = min(x[0] * x[0] + x[1] * x[1] + x[2] * x[2], T(S(1e30))),
          z = T(S(fog.axis[0])) * x[0] + T(S(fog.axis[1])) * x[1] +
              T(S(fog.axis[2])) * x[2];
  const T c = max(min(z * z, r2) / max(r2, T(S(1e-30))), T(S(fog.least)));
  return r2 * (T(S(fog.pixel[0])) + c * (T(S(fog.pixel[1])) + c * T(S(fog.pixel[2]))));
}

// Mean over the way from u0 to u1 of what clearing leaves, k + (1 - k) u^2/2 / (1 +
// u^2/2) = 1 - (1 - k) / (1 + u^2/2), by the arctangent's difference, which is one
// arctangent.
//   Domain |u| <= 1e9. Absolute error 2e-7, and exact where both are 0.
template <Real T>
BRUME_INLINE T mean_cleared(T u0, T u1) {
  using S = Scalar_t<T>;
  const T x = abs(u1 - u0) * T(S(0.7071067811865476)), q = T(1) + T(S(0.5)) * u0 * u1;
  const T mean = select(x > T(S(1e-20)), atan2(x, q) / max(x, T(S(1e-20))), T(1) / q);
  return T(S(kCleared)) + T(S(1 - kCleared)) * (T(1) - mean);
}

// Variance of the filter that the pixel and the blur are, at x.
template <Real T>
BRUME_INLINE T filter(const Fog& fog, const T x[3]) {
  return pixel_filter(fog, x) + T(Scalar_t<T>(fog.blur2));
}

/// rho at t on a ray, x that place, as steps of h metres see it (0: all of it).
template <Real T>
BRUME_INLINE T density(const Fog& fog, const Slopes<T>& slopes, T t, const T x[3],
                       T h = T(0), T* banks = nullptr) {
  return smooth_density(fog, slopes, t, log_factor(fog, x, filter(fog, x), h, banks));
}

}  // namespace brume::noise_fog
