#pragma once
// The bright core of a bolt as media: one for each of its straight stretches. In double;
// README, "The core".

#include <vector>

#include "bolt.h"
#include "kernel.h"
#include "stage/footprint.h"

namespace lightning {

/// How the core is seen: from where, and in which pixels.
struct Sight {
  Vec3 eye{}, forward{0, 0, 1};
  bool parallel = false;  ///< rays are: all along forward
  brume::Footprint pixel;
};

/// One stretch: from `middle` - half axis to `middle` + half axis [world, m].
struct Core {
  Vec3 middle{}, axis{};
  double half = 0;
  double radius = 0, tapers = 0;  ///< deviation of the channel at u: radius + tapers u
  Vec3 eye{};
  brume::FootprintAcross pixel;  ///< deviation of what a pixel is, squared

  /// rho at a world point, for a ray that goes through it along the unit `direction`
  /// [1].
  double density(const double position[3], const double direction[3]) const;

  /// What kernels see.
  Channel channel() const;

  /// Whether its ends and what of it is nearest to the eye are equally wide, to a factor
  /// of two in s.
  bool even() const;
  /// What of it lies between two places u.
  Core part(double from, double to) const;

  /// 3 x 4, row by row: the box |x|, |y|, |z| <= 1 that holds it.
  void local_from_world(double matrix[12]) const;

 private:
  double deviation2(double u, double r) const;
  double widest2() const;
};

/// The stretches of a bolt, the trunk of deviation `radius`; a branch begins at 0.6 of
/// that and ends at nothing. Stretches without length are left out, those that are much
/// wider at one place than at another cut.
std::vector<Core> cores(const std::vector<std::vector<Vec3>>& lines, double radius,
                        const Sight&);

}  // namespace lightning
