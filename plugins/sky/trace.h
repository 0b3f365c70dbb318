#pragma once
// Where a ray runs through the air: entry, lowest point, shadow, ground, exit.

#include <limits>

namespace brume::sky {

/// Where a ray is and how it sees the sun: all that a spherically symmetric atmosphere
/// can depend on.
struct Ray {
  double h;     // altitude of the eye [m], any
  double mu;    // cosine of the view zenith angle
  double mu_s;  // cosine of the sun zenith angle, at the eye
  double nu;    // cosine of the angle between view and sun
  double distance = std::numeric_limits<double>::infinity();  // [m]
  double ground = 0;  // altitude of the ground, <= 0: lower where a surface is seen below
  double weight = 1;  // of the air on the way to the eye; what lights it is all there
};

/// Half the angle that the sun is seen under from the earth [rad]: the planet's shadow
/// has a soft edge.
constexpr double kSunRadius = .2665 * 3.14159265358979323846 / 180;

constexpr int kMaxDistances = 64, kMaxStretches = kMaxDistances + 14;

/// A stretch whose altitude is monotone; u >= 0 is the distance from the lower end of its
/// piece.
struct Stretch {
  double c_low, b_low;  // at the lower end: r^2 - R^2 [m^2], r times cosine of zenith
                        // angle, >= 0 [m]
  double t_low;         // distance of the lower end from the eye [m]
  double sign;          // +1 climbing, -1 descending
  double u_begin, u_end, U;  // in order of travel; U the length of the whole piece
  int mark;                  // ends at this one of Cuts::distances; -1: at none
};

/// The part of a ray within the air and above ground (which sinks to the eye where that
/// lies below h = 0).
struct Trace {
  Stretch stretches[kMaxStretches];
  int count = 0;
  bool hits_ground = false;
  double t_begin = 0, t_end = 0;
};

/// Where a path is to be cut so that everything along a stretch is smooth.
struct Cuts {
  bool shadow = false;  // at the edge of the planet's shadow
  const double* corners =
      nullptr;           // at these altitudes [m], where a density has a corner
  int corner_count = 0;  // at most 3
  const double* distances =
      nullptr;             // from the eye [m], ascending, where light is wanted
  int distance_count = 0;  // at most kMaxDistances
};

/// Double throughout: radii squared leave float no digits.
Trace trace(double R, double top, const Ray& ray, const Cuts& cuts) noexcept;

}  // namespace brume::sky
