#pragma once
// The integrator: light through all media of the World together. DESIGN "Air is one
// integral", METHODS section O.
//
//   C' = T C + L,  T = exp(-tau),  L = Int_0^t T(s) e(s) ds,  e = Sum_i rho_i (emission_i
//   + extinction_i (source_i + albedo_i lights))
//
// One medium on a ray: its closed form, one evaluation. Several: the ray is split at all
// their boundaries; optical depths are exact on every piece; the source is a parabola in
// optical depth through its end values and its exact mean (never gains energy), refined
// from the eye outward until the tolerance is met. SIMD across rays: each lane refines by
// its own error only, so that a pixel's bits do not depend on its neighbours.

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "num/isa.h"
#include "scene/world.h"

namespace brume {

/// n rays as spans: origins relative to World::eye (null: at the eye), unit directions,
/// and how far each goes [m] (inf: forever).
struct RaySpans {
  int n = 0;
  const float *ox = nullptr, *oy = nullptr, *oz = nullptr;
  const float *dx = nullptr, *dy = nullptr, *dz = nullptr;
  const float* t_end = nullptr;
};

/// Where the answers go: n floats each. `stage_L[k]` (optional): the share of stage k,
/// three planes; they add up to L.
struct AirOut {
  float* T[3];
  float* L[3];
  std::span<float* const> stage_L;  ///< 3 planes per stage, r g b, or empty
  std::span<float* const> stage_T;  ///< likewise; they multiply to T
};

/// A lamp's light grows no more, as if its radius were that, where it is this near [m] or
/// its irradiance is this much: floats end at 3e38.
inline constexpr double kLeastDistance = 1e-15, kMostIrradiance = 1e30;

struct AirOptions {
  double tolerance = 1e-3, white = 1;  ///< |dL| <= tolerance (white + |L|)
  int stages = 0;          ///< how many stages publish (for shares and weights)
  std::optional<Isa> isa;  ///< for tests; otherwise the one in use
};

/// The one medium of a world that has no other: everywhere, uniform or exponential, grey,
/// with one source colour, from the eye on without end. Common enough that pixels take it
/// in one pass (pipeline/sole.h).
struct SoleMedium {
  float log_rho0 = 0;  ///< log of the density at the eye (exponential)
  float rho0 = 0;      ///< its exponential, 0 where that is no normal number
  float grad[3] = {};  ///< falloff x direction [1/m]
  float sigma = 0;     ///< [1/m] at density 1
  float color[3] = {};
};

/// The World made ready for kernels: eye-relative, media that cannot matter dropped, the
/// closed form chosen. Immutable; every function may be called from several threads at
/// once.
class Air {
 public:
  Air();
  ~Air();
  Air(Air&&) noexcept;
  Air& operator=(Air&&) noexcept;

  /// Throws Error for a medium that makes no sense (non-finite numbers, albedo outside
  /// 0..1, a custom profile without its functions).
  static Air compile(const World&, const AirOptions&);

  /// No medium, light-emitting or not, is left: every ray gives T = 1, L = 0.
  bool empty() const;

  /// Transmittance and in-scattered radiance of rays. `weights[k]` (n floats in 0..1, or
  /// null = 1) scales extinction and emission of stage k along that whole ray (mask x
  /// mix). T in [0, 1], L >= 0 for sources >= 0, T = 1 and L = 0 exactly where nothing is
  /// on the ray. n is limited only by the caller's cache: 256 is good. Lanes are
  /// independent.
  void integrate(const RaySpans&, std::span<const float* const> weights,
                 const AirOut&) const noexcept;

  /// Transmittance alone: closed forms, no refinement.
  void transmittance(const RaySpans&, std::span<const float* const> weights,
                     float* const T[3]) const noexcept;

  /// Irradiance from light `k` (index into World::lights) on planes at points `o` with
  /// unit normals `d` (RaySpans fields), attenuated by the media between; finite, 0 on
  /// what faces away. Exact but for float: 4e-7 of the light's distance from the eye is
  /// what positions are known to. A sky light with a radiance counts by the hemisphere
  /// about the normal (sky_light.h), as it is at the eye, unattenuated; without one as pi
  /// x its mean.
  void irradiance(int light, const RaySpans&, float* const E[3]) const noexcept;

  /// Radiance from beyond the air, rgb (sun disc, stars); zero without a background.
  void background(const RaySpans&, float* const B[3]) const noexcept;
  bool has_background() const;

  /// The medium that is alone in this world, if it is of that kind.
  std::optional<SoleMedium> sole() const;

  /// How each medium is integrated, one line each: "height_fog: exponential, constant
  /// source: closed form"; those that follow one another and are alike in one line.
  std::vector<std::string> describe() const;

  struct Impl;
  /// What kernels see, for those who integrate it otherwise (src/study).
  const Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace brume
