#pragma once
// The sky of one frame: a Model placed in the world, with eye, sun and colours; and the
// functions that are published of it.

#include <array>
#include <memory>
#include <mutex>
#include <vector>

#include "color.h"
#include "map_build.h"
#include "model.h"
#include "nishita.h"
#include "plugin.h"

namespace brume::sky {

inline double dot(const double* a, const double* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Where things are: world metres, unit vectors.
struct Placing {
  std::array<double, 3> eye, up, to_sun;
  double sea_level = 0;
};

/// How light becomes colour.
struct Look {
  Colors colors;
  std::array<double, 3> scale{1, 1,
                              1};  // exposure, times white balance to [sun] irradiance
  double sun_radius = 0;           // angular [rad]
};

class FrameSky {
 public:
  /// `tables`: rays from the eye, if they have this `weight`, are looked up in a SkyMap
  /// of that detail (map_size), made when the first of them comes.
  FrameSky(const Model&, const Maps&, const Placing&, const Look&, bool tables,
           double detail, float weight);

  brume_medium medium() const;
  std::vector<brume_light> lights() const;
  brume_background background() const;

  /// Irradiance of the sun at the eye, rgb, before `scale`.
  static std::array<double, 3> sun_at_eye(const Model&, const Placing&, const Colors&);

  /// A ray as the atmosphere sees it; position relative to the eye, direction a unit
  /// vector.
  Ray ray(const double position[3], const double direction[3]) const noexcept;
  /// How far such a ray goes before it is out of the deepest ground; 0 where it begins
  /// above that.
  double out_of_core(const double position[3], const double direction[3]) const noexcept;

 private:
  using Rgb = std::array<double, 3>;
  void see(const brume_rays&, std::size_t i, double weight, double t0, double t1, Rgb& L,
           Rgb& T) const noexcept;
  void see_into(const brume_rays&, std::size_t i, double weight, double t0, double t1,
                float* const L[3], float* const T[3]) const noexcept;
  Rgb radiance(const double* spectrum) const noexcept;
  Rgb transmittance(const double* spectrum) const noexcept;
  void source(const double position[3], const double direction[3], Rgb& J,
              Rgb& extinction) const noexcept;
  void lift_eye();
  void light_from_everywhere();
  Rgb disc(const double direction[3]) const noexcept;
  void alone(const brume_rays&, const float* weights, const float* t0, const float* t1,
             float* const L[3], float* const T[3]) const;
  void optical_depth(const brume_rays&, const float* t0, const float* t1, float* D) const;
  Rgb extinction(double h) const noexcept;  // [1/m]
  void look_up(const brume_rays&, const float* t1, float* const L[3],
               float* const T[3]) const;
  const NishitaTable& hemisphere() const;

  const Model& model_;
  const Maps& maps_;
  Placing at_;
  Look look_;
  std::array<double, 3>
      centre_;  // of the ground below the world's origin, relative to the eye
  std::vector<double> spectral_radiance_, spectral_transmittance_;  // of brume_medium
  Rgb sun_, sky_mean_{};
  SkyPlace place_;
  bool tables_;
  // A part of the sun's disc shows somewhere in sight: light changes within metres of
  // altitude there, as the root of that from where a path leaves h = 0. Tables of what is
  // below the ground do not know it; panels of a path, more of them, do.
  bool sun_sets_;
  double detail_;
  float weight_;
  // Made when a ray first asks: to the ground, and to surfaces beyond it.
  struct Table {
    mutable std::once_flag made;
    mutable std::shared_ptr<const MapTables> memory;
    mutable SkyMap map;
    const SkyMap& of(const FrameSky&, double ground) const;
  };
  Table map_, deep_;
  mutable std::once_flag hemisphere_made_;
  mutable std::unique_ptr<NishitaTable> hemisphere_;
};

}  // namespace brume::sky
