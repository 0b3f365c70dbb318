#pragma once
// The ways that light takes to the points of a view ray: what stands on them.

#include <array>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "truth/march.h"
#include "truth/segments.h"

namespace brume::truth {

/// The media of a World as light meets them: without weights, caps counted from where it
/// arrives.
class Obstacles {
 public:
  explicit Obstacles(const World&);
  /// Those that ways from a light to points of `ray` can meet.
  Obstacles between(const brume_light&, const Ray& ray) const;

  /// Optical depth along a ray, shadowers too, and how far from converged it may be: each
  /// piece is held to `tolerance`. Where the cost is spent: of what has been seen by
  /// then, which is no more than all.
  struct Depth {
    Rgb tau{};
    double error = 0;
  };
  Depth depth(const Ray&, double tolerance, Cost&) const;
  /// Kinks of the depth on the way from a light to the points of `ray`.
  void add_edges(const brume_light&, const Ray& ray, std::vector<double>& t) const;
  /// Whether some say nothing of their detail.
  bool custom() const;

 private:
  const World& world_;
  using Chosen = std::vector<const Published<brume_medium>*>;
  template <int N>
  Depth of(const Chosen&, const Ray&, double tolerance, Cost&) const;

  Chosen open_;    ///< without a cap
  Chosen capped_;  ///< each ends where its own depth is enough
  bool grey_ = true;
};

/// Optical depth from a light to the points of a view ray. Along the ray it is smooth
/// between the places where the way begins or ends to meet a boundary
/// (add_shadow_edges), so it is kept as polynomials between them: in v, t = foot
/// + h sinh v, with h the lamp's distance from the foot (in which the way's length is
/// h cosh v, however near the lamp), on intervals that are halved until the polynomial
/// through kNodes ways agrees with others between; where that does not come soon, each
/// point has its own way. So have the first: polynomials are tried for as many ways as
/// points have been asked for, so that they cost at most as much again where they fail.
class WaysToLight {
 public:
  WaysToLight(const World&, const Obstacles&, const brume_light&, const Ray&, Cost&);

  /// The depth to t, so that e^-depth is right to `tolerance` times worst(); 0 where
  /// tolerance is kNothing or more.
  Rgb at(double t, double tolerance);
  static constexpr double kNothing = 10;
  /// How many times its tolerance the error of a way may have been, 1 or more.
  double worst() const { return worst_; }
  /// Where the depth has kinks along the ray, ascending.
  std::vector<double> edges() const;
  bool asked() const { return asked_; }

 private:
  static constexpr int kNodes = 12, kTried = 8;
  struct Interval {
    Interval(double from, double to) : begin(from), end(to) {}
    double begin, end;  ///< in v
    enum { fresh, smooth, halved, rough } state = fresh;
    double tolerance = 0;  ///< of what is smooth
    std::array<Rgb, kNodes> depth{};
    std::unique_ptr<Interval> half[2];
  };
  Rgb way(double t, double tolerance) const;
  Rgb interpolated(const Interval&, double v) const;
  bool fits(Interval&) const;

  const World& world_;
  const brume_light& light_;
  const Ray& ray_;
  Obstacles obstacles_;
  Cost& cost_;
  double foot_ = 0, h_ = 1;
  long credit_ = 0;  ///< ways for polynomials
  mutable double worst_ = 1;
  bool asked_ = false;
  std::vector<double> edges_;                              ///< kinks, in v, ascending
  std::map<std::pair<std::size_t, int>, Interval> roots_;  ///< by edges passed and root
};

}  // namespace brume::truth
