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

/// The ways from a light to the points of a view ray. Points go by v, t = foot + h sinh
/// v, with h the lamp's distance from the foot, in which a way's length is h cosh v,
/// however near the lamp.
class Ways {
 public:
  Ways(const World&, const Obstacles&, const brume_light&, const Ray&, Cost&);

  double v_of(double t) const;
  double t_of(double v) const;
  /// Optical depth on the way to t, each piece held to `tolerance`.
  Obstacles::Depth depth(double t, double tolerance) const;
  /// Whether media that say nothing of their detail may stand on them.
  bool through_detail() const { return detail_; }
  /// Between these the depth is smooth where media are: places where the way begins or
  /// ends to meet a boundary (add_shadow_edges). In v, ascending.
  const std::vector<double>& edges() const { return edges_; }
  bool spent() const { return cost_.spent(); }
  long so_far() const { return cost_.so_far; }

 private:
  const World& world_;
  const brume_light& light_;
  const Ray& ray_;
  Obstacles obstacles_;
  Cost& cost_;
  double foot_ = 0, h_ = 1;
  bool detail_ = false;
  std::vector<double> edges_;
};

/// Optical depth from a light to the points of a view ray, through media that are smooth
/// between the edges. It is kept as polynomials in v, on intervals that are halved until
/// the polynomial through kNodes ways agrees with others between; where that does not
/// come soon, each point has its own way. So have the first: polynomials are tried for as
/// many ways as points have been asked for, so that they cost at most as much again where
/// they fail.
class WaysToLight {
 public:
  explicit WaysToLight(const Ways&);

  /// The depth to t, so that e^-depth is right to `tolerance` times worst(); 0 where
  /// tolerance is kNothing or more.
  Rgb at(double t, double tolerance);
  static constexpr double kNothing = 10;
  /// How many times its tolerance the error of a way may have been, 1 or more.
  double worst() const { return worst_; }
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

  const Ways* ways_;
  long credit_;  ///< ways for polynomials
  mutable double worst_ = 1;
  bool asked_ = false;
  std::map<std::pair<std::size_t, int>, Interval> roots_;  ///< by edges passed and root
};

}  // namespace brume::truth
