#pragma once
// Laws, and what was found of them.

#include <array>
#include <cstdint>

namespace brume::stress {

enum class Law {
  finite,      ///< T and L, or colours, are numbers
  range,       ///< 0 <= T <= 1
  positive,    ///< L >= 0; of pixels: light gives light, surfaces lose none
  energy,      ///< L <= largest source x (1 - T), for sources that are constant; what a
               ///< surface sends back <= what all lights send there unhindered
  split,       ///< T(a,c) = T(a,b) T(b,c), the second from a moved origin
  split_L,     ///< L(a,c) = L(a,b) + T(a,b) L(b,c)
  monotone,    ///< farther: T no larger, L no smaller
  scale,       ///< lengths x k, densities / k: the same
  weight,      ///< weight w: T^w; weight 0: exactly nothing
  lanes,       ///< the same bits alone, in any run of rays or tile, at any address
  neighbours,  ///< NaN and inf in other rays or pixels change no bit
  isa,         ///< instruction sets agree
  additive,    ///< two sets of lights: the sum of each set's light
  dark,        ///< nothing where no light is; lights leave T alone, to the bit
  order,       ///< the order of stages changes no bit
  turn,        ///< a turned world looks the same to a turned camera
  alpha,       ///< coverage stays as it is
  linear,      ///< a lens that says so: out(a I + b J) = a out(I) + b out(J)
  exposure,    ///< the same: out(k I) = k out(I), k from 1e-6 to 1e6
  keeps,       ///< a lens that says so: the frame's light grows no larger
  step,        ///< what is off changes from one ray to the next by a tenth of the
               ///< tolerance at most
  jump,        ///< so it does between the nearest rays that floats know
  truth_T,
  truth_L,
  truth,  ///< of pixels: the colour
};
inline constexpr int kLaws = 25;
const char* name(Law);
const char* meaning(Law);

/// What was found of one law. `worst` is the deviation in parts of what is allowed: above
/// 1 the law is broken.
struct Finding {
  std::uint64_t checked = 0, broken = 0;
  std::uint64_t undecided = 0;  ///< not checked: the truth that it asks did not converge
  double worst = 0;
  std::uint64_t worst_case = 0;  ///< the first of the worst
  int channel = 0;
  double got = 0, wanted = 0, allowed = 0;  ///< there
};

/// Takes in what is found; deviations are in parts of what is allowed.
struct Findings {
  std::array<Finding, kLaws> of{};

  /// |got - wanted| <= allowed? NaN breaks it.
  void near(Law, std::uint64_t number, int channel, double got, double wanted,
            double allowed);
  /// got <= wanted + allowed?
  void at_most(Law, std::uint64_t number, int channel, double got, double wanted,
               double allowed);
  void holds(Law, std::uint64_t number, int channel, double got, double wanted, bool);
  /// The same float, bit for bit?
  void same(Law, std::uint64_t number, int channel, float got, float wanted);
  void undecided(Law law) { ++of[std::size_t(law)].undecided; }
  void add(const Findings&);

 private:
  void take(Law, std::uint64_t number, int channel, double got, double wanted,
            double allowed, double by);
};

}  // namespace brume::stress
