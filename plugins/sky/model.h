#pragma once
// The physical model of the sky, ready to be asked along any ray: an atmosphere, its
// tables of diffuse light by groups of wavelengths, and the kernels of this machine.

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "solve.h"

namespace brume::sky {

/// All orders; what is scattered once; that in 32 steps, with a point for a sun.
enum class Method { scattering, single, nishita93 };

/// How much work: harmonics (2, 4, 6, 10), the solver's resolution, panels per monotone
/// piece of a view ray.
struct Quality {
  Method method = Method::scattering;
  int harmonics = 10;
  Resolution resolution;
  int panels = 6;

  static Quality fast();
};

/// Everything that a Model depends on, as text.
std::string key_of(const Atmosphere&, const Quality&);

class Model {
 public:
  /// Takes tables from the store, or solves and keeps them there (store.h). Throws Error
  /// for an atmosphere that check() refuses.
  Model(const Atmosphere&, const Quality&);

  /// Radiance [W m^-2 sr^-1 nm^-1] and transmittance along a ray, one per wavelength.
  /// Total and thread-safe. Nothing beyond: not the sun's disc, not the ground that a ray
  /// ends on. `detail` multiplies the panels, here and below.
  void see(const Ray&, double* L, double* T, double detail = 1) const noexcept;
  /// The part of L that was scattered once.
  void see_single(const Ray&, double* L) const noexcept;

  /// Along a ray up to each of `distances` (ascending, at most kMaxDistances) and, last,
  /// all of it: the parts of light [count + 1][6][size()] (view.h) and T [count +
  /// 1][size()].
  void along(const Ray&, const double* distances, int count, double* parts, double* T,
             double detail = 1) const noexcept;

  /// At one place, h within the air: light added along the ray per unit of optical depth,
  /// and extinction [1/m].
  void source(const Ray&, double* J, double* extinction) const noexcept;

  /// Transmittance toward the sun at altitude h, sun zenith cosine mu_s; 0 in the
  /// planet's shadow.
  void sunlight(double h, double mu_s, double* T) const noexcept;

  /// Does the planet lie on the ray, whatever its length?
  bool hidden(const Ray&) const noexcept;
  /// Altitude of the ground before which surfaces are seen: below the planet's own.
  double deepest_ground() const noexcept;
  /// Of the ground that an eye at altitude h sees where there is no surface: 0, and the
  /// deepest from below that (by more than rounding).
  double ground(double h) const noexcept {
    return h < -kGrain * atmosphere_.planet_radius ? deepest_ground() : std::min(h, 0.);
  }

  Method method() const { return quality_.method; }
  const Forward<float>& forward() const { return groups_.front()->forward; }
  Shape<float> shape() const;
  const Atmosphere& atmosphere() const { return atmosphere_; }
  int size() const { return atmosphere_.size(); }

 private:
  int panels(double detail) const noexcept;
  Seen<float> group(std::size_t, const Trace&, const Ray&, int panels) const noexcept;
  Trace path(const Ray&) const noexcept;
  bool has_ozone() const noexcept;

  Atmosphere atmosphere_;
  Quality quality_;
  const Kernels<float>* kernels_;
  std::vector<std::unique_ptr<Light<float>>> groups_;
  double corners_[3];
};

}  // namespace brume::sky
