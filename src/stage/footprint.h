#pragma once
// How wide a pixel is at a place, from what brume_frame says of its rays. Header-only,
// double. Places are relative to the eye [m].
//
// Between neighbouring columns the place on the ray moves by y_x, between rows by y_y, at
// one distance from the eye. Along a unit direction n square to the ray the pixel is
//   w(n)^2 = (n . y_x)^2 + (n . y_y)^2 [m^2]
// wide: the ray differentials of Igehy 1999 as a covariance.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "plugin.h"

namespace brume {

/// w(n)^2 at every place whose ray is square to one direction n:
///   even2 + (linear . y)^2 + fan2 |y|^2 min(1, tilt2 |y|^2 / |y across the pole|^2)
/// with |y across the pole|^2 = (level[0] . y)^2 + (level[1] . y)^2; nowhere negative.
struct FootprintAcross {
  double even2 = 0;                              ///< [m^2]
  std::array<double, 3> linear{};                ///< [1]
  double fan2 = 0, tilt2 = 1;                    ///< [1]
  std::array<std::array<double, 3>, 2> level{};  ///< unit vectors, or 0: tilt2 counts not

  double operator()(const std::array<double, 3>& y) const {
    const auto along = [&](const std::array<double, 3>& v) {
      return v[0] * y[0] + v[1] * y[1] + v[2] * y[2];
    };
    const double to = along(linear), r2 = along(y);
    double fan = fan2 * r2;
    const double a = along(level[0]), b = along(level[1]), level2 = a * a + b * b;
    if (tilt2 * r2 < level2) fan *= tilt2 * r2 / level2;
    return even2 + to * to + fan;
  }
};

/// The mean of w(n)^2 over all n, in a form that kernels can take:
///   even2 + |y|^2 (p[0] + p[1] c + p[2] c^2),   c = max((axis . y)^2 / |y|^2, least)
/// `least` is c in the picture's corners: beyond them pixels are as wide as there. Of
/// perspective pixels that are not square the mean all around the axis.
struct FootprintMean {
  double even2 = 0;              ///< [m^2]
  std::array<double, 3> axis{};  ///< unit, or 0
  double p[3] = {}, least = 0;   ///< [1]

  double operator()(const std::array<double, 3>& y) const {
    const double r2 = y[0] * y[0] + y[1] * y[1] + y[2] * y[2];
    if (!(r2 > 0)) return even2;
    const double to = axis[0] * y[0] + axis[1] * y[1] + axis[2] * y[2];
    return even2 + r2 * at(std::max(to * to / r2, least));
  }
  double at(double c) const { return p[0] + c * (p[1] + c * p[2]); }
  /// Per |y|^2, in the direction in which it is least. (All of them rise or fall with c.)
  double narrowest() const { return std::min(at(least), at(1)); }
};

class Footprint {
 public:
  using Vec = std::array<double, 3>;

  /// Alike in all directions: `angle` [rad] between rays from the eye, and `width` [m]
  /// everywhere.
  explicit Footprint(double angle = 0, double width = 0) : angle_(angle), width_(width) {}

  /// That of a frame. Of a host that does not say where pixels look, or of a projection
  /// not known here, by pixel_footprint alone.
  explicit Footprint(const brume_frame& f) {
    // Older hosts know fewer fields.
    const bool told = f.size > offsetof(brume_frame, down);
    if (told && f.across[0] * f.across[0] + f.across[1] * f.across[1] +
                        f.across[2] * f.across[2] >
                    0)
      take(f);
    if (known_) return;
    const bool flat = f.size > offsetof(brume_frame, orthographic) && f.orthographic;
    (flat ? width_ : angle_) = f.pixel_footprint;
  }

  /// Rays do not fan out: all are parallel.
  bool parallel() const { return known_ && projection_ == BRUME_ORTHOGRAPHIC; }

  /// n: unit, square to the rays through the places that will be asked for.
  FootprintAcross across(const Vec& n) const {
    FootprintAcross w;
    w.even2 = width_ * width_;
    w.fan2 = angle_ * angle_;
    if (!known_) return w;
    switch (projection_) {
      case BRUME_PERSPECTIVE: {  // y = z p, z = ahead . y: the rest of y_x is along y
        const double k = std::hypot(dot(n, x_), dot(n, y_));
        for (std::size_t i = 0; i < 3; ++i) w.linear[i] = k * ahead_[i];
        break;
      }
      case BRUME_ORTHOGRAPHIC:
        w.even2 = dot(n, x_) * dot(n, x_) + dot(n, y_) * dot(n, y_);
        break;
      default: {
        // y_x = h pole x y. North is (pole - sin(e) d) / cos(e), and n . d = 0.
        const Vec turned = cross(n, pole_);
        for (std::size_t i = 0; i < 3; ++i) w.linear[i] = turn_[0] * turned[i];
        w.fan2 = turn_[1] * turn_[1];
        w.tilt2 = dot(n, pole_) * dot(n, pole_);
        w.level = {x_, y_};
      }
    }
    return w;
  }

  FootprintMean mean() const {
    FootprintMean w;
    w.even2 = width_ * width_;
    w.p[0] = angle_ * angle_;
    if (!known_) return w;
    switch (projection_) {
      case BRUME_PERSPECTIVE: {
        // Of a step g across the axis cos g is left toward its middle, cos^2 g away.
        const double slant2 = dot(ahead_, ahead_), g2 = (dot(x_, x_) + dot(y_, y_)) / 2;
        for (std::size_t i = 0; i < 3; ++i) w.axis[i] = ahead_[i] / std::sqrt(slant2);
        w.p[1] = w.p[2] = slant2 * g2 / 2;
        w.least = least_;
        break;
      }
      case BRUME_ORTHOGRAPHIC:
        w.even2 = (dot(x_, x_) + dot(y_, y_)) / 2;
        break;
      default:
        w.axis = pole_;
        w.p[0] = (turn_[0] * turn_[0] + turn_[1] * turn_[1]) / 2;
        w.p[1] = -turn_[0] * turn_[0] / 2;
    }
    return w;
  }

 private:
  static double dot(const Vec& a, const Vec& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }
  static Vec cross(const Vec& a, const Vec& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0]};
  }
  static Vec vec(const double v[3]) { return {v[0], v[1], v[2]}; }

  void take(const brume_frame& f) {
    projection_ = f.projection;
    if (projection_ == BRUME_LATLONG) {
      constexpr double kTurn = 6.283185307179586;
      turn_[0] = kTurn * f.across[0];
      turn_[1] = kTurn * f.down[1];
      pole_ = vec(f.camera_up);
      x_ = vec(f.camera_right);
      y_ = vec(f.forward);
      known_ = true;
    } else if (projection_ == BRUME_ORTHOGRAPHIC || projection_ == BRUME_PERSPECTIVE) {
      x_ = vec(f.across);
      y_ = vec(f.down);
      known_ = true;
      if (projection_ == BRUME_ORTHOGRAPHIC) return;
      const Vec corner = vec(f.corner), square = cross(x_, y_);
      const double away = dot(square, corner);
      known_ = away != 0;
      if (!known_) return;
      for (std::size_t i = 0; i < 3; ++i) ahead_[i] = square[i] / away;
      least_ = 1;
      for (const int k : {0, 1, 2, 3}) {
        const double x = f.display_x + (k & 1 ? f.display_width : 0),
                     y = f.display_y + (k & 2 ? f.display_height : 0);
        Vec p;
        for (std::size_t i = 0; i < 3; ++i) p[i] = corner[i] + x * x_[i] + y * y_[i];
        // ahead . p = 1
        least_ = std::min(least_, 1 / (dot(p, p) * dot(ahead_, ahead_)));
      }
    }
  }

  double angle_ = 0, width_ = 0;
  bool known_ = false;
  int projection_ = 0;
  Vec x_{}, y_{};         // steps to the next column and row; latlong: level axes
  Vec ahead_{}, pole_{};  // depth over that of the picture's plane; latlong: its axis
  double turn_[2] = {};   // latlong: between columns, between rows [rad]
  double least_ = 0;
};

}  // namespace brume
