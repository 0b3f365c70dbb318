#pragma once
// Light through media that say nothing of their detail, such as noise: what is asked is
// not the depth at each point, which may need a thousand evaluations for each of a
// thousand points, but the light of the whole ray.

#include <array>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "truth/way.h"

namespace brume::truth {

/// Optical depth from a light to the points of a view ray as polynomials of degree 4 in
/// v, on panels that are halved where the light that arrives from them still changes by
/// that. Until a panel has ways its light is not dimmed, and all of it error.
class WaysThroughDetail {
 public:
  explicit WaysThroughDetail(const Ways& ways) : ways_(&ways) {}

  /// The depth to t as it is known by now.
  Rgb at(double t) const;

  /// Light that reaches the eye from about t, where nothing dims it on its way there.
  /// What the ray's light is made of: begins with none.
  void forget_light();
  void add_light(double t, const Rgb& light);

  /// What the light from a panel may be off by, by channel.
  struct Off {
    Rgb change{};    ///< made by halving it
    Rgb unknown{};   ///< of panels without ways
    Rgb squares{};   ///< of changes
    Rgb arriving{};  ///< the light itself, dimmed
    void add(const Off&);
    /// Changes of panels of which none sees its detail are random to each other: their
    /// sum, or twice the root of the sum of their squares.
    Rgb all() const;
  };
  /// Gives the light to panels: those there are, or new ones.
  void settle();
  Off off() const;

  struct Panel;
  using Panels = std::map<double, Panel>;  ///< by where they begin, in v
  /// The panel whose change is most beside `goal`, and how many times that is.
  std::pair<Panels::iterator, double> worst(const Rgb& goal);
  /// More ways for it: its first, finer ones, or those of its halves. `tolerance` of the
  /// depth's pieces.
  void work(Panels::iterator, double tolerance);

 private:
  std::pair<std::size_t, int> root_of(double v) const;
  Panels::const_iterator find(double v) const;
  struct Light {
    double v;
    Rgb light;
  };
  void new_roots();

  const Ways* ways_;
  Panels panels_;
  std::vector<Light> homeless_;
};

/// A fourth degree polynomial by its values at five even places; at least 0.
class Quartic {
 public:
  Quartic() = default;
  Quartic(double begin, double end, const std::array<Rgb, 5>& values);
  Rgb at(double v) const;

 private:
  double begin_ = 0, end_ = 1;
  std::array<Rgb, 5> newton_{};  ///< divided differences over 0, 1, 2, 3, 4
};

struct WaysThroughDetail::Panel {
  double end = 0;
  std::pair<std::size_t, int> root;  ///< edges passed, and which of even width
  bool known = false, finest = false;
  std::array<Rgb, 5> depth{};     ///< of its ways
  std::array<double, 5> error{};  ///< and what they may be off by
  Quartic now, before;            ///< before: until it was halved
  std::vector<Light> lights;
  Off off;
  double by_ways = 0;  ///< of its change, what its ways make, at most 1

  void weigh();
};

/// Works on the panels of all lights, the worst first, until what all are off by is no
/// more than `goal`, or the evaluations in `budget` are spent: they are taken from it.
/// Whether anything changed.
bool refine(std::span<WaysThroughDetail* const>, const Rgb& goal, const Ways&,
            long& budget);

}  // namespace brume::truth
