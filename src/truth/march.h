#pragma once
// One adaptive march from the eye outward: optical depth and the light gathered under it,
// all media together, several lanes (colours, wavelengths) at once.
//
// A piece is seen at the 12 nodes of Gauss-Legendre. Optical depth up to each node is the
// integral of the polynomial through the extinctions there, the light of the piece
// Sum w e exp(-tau). Then the piece is halved: where the halves, laid one behind the
// other, agree with the whole, they are taken; else each is halved again. A piece is
// never deeper than 8 while light still comes through, so stiffness costs halvings (some
// hundred from 1e30 m to 1e-6 m), not accuracy.

#include <array>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

namespace brume::truth {

/// What there is at a point of a ray, by lane: extinction and light added, both per
/// metre.
template <int N>
struct Local {
  std::array<double, N> sigma{}, e{};
};
template <int N>
using AlongRay = std::function<Local<N>(double t)>;

/// What a ray may cost, and what it has cost: all its marches count here.
struct Cost {
  long most = std::numeric_limits<long>::max();  ///< Options::evaluations
  long so_far = 0;

  /// No more for the ways of light to points.
  bool spent() const { return so_far >= most; }
  /// No more at all.
  bool twice_spent() const { return so_far / 2 >= most; }
};

inline constexpr int kNodes = 12;
/// Gauss-Legendre on [-1, 1], and `up_to[k][j]`: what node j adds to the integral from -1
/// to node k.
struct Nodes {
  double x[kNodes], w[kNodes], up_to[kNodes][kNodes];
};
const Nodes& nodes();
/// Where on [a, b] node k is: the same number whenever it is asked.
inline double node(double a, double b, int k) {
  return a + (b - a) / 2 * (1 + nodes().x[k]);
}

/// N is 1 (optical depth of a grey world), 3 (colours) or kSpectral.
template <int N>
class March {
 public:
  using Lanes = std::array<double, N>;
  struct Piece {
    double a, b;
    Lanes tau, L;
  };

  /// As in Options: accepted are changes of tau up to `tolerance`, and of L, as it
  /// arrives at the eye, up to tolerance (white + |L|), in each lane. `nested`: within
  /// another march, so that it ends with the first half of the cost.
  March(double tolerance, double white, Cost& cost, bool nested = false)
      : tolerance_(tolerance), white_(white), cost_(cost), nested_(nested) {}

  /// Goes on over [a, b], a < b finite, on which f is smooth or nearly so.
  void over(const AlongRay<N>& f, double a, double b);

  /// What part of light arrives from where it is, in the clearest lane.
  double through() const;

  /// Nothing behind can be seen, or nothing more may be asked.
  bool done() const;

  /// [a, b] alone, by its nodes.
  Piece look(const AlongRay<N>& f, double a, double b);

  Lanes tau{}, L{}, tau_error{}, L_error{};
  bool converged = true;
  bool stopped = false;  ///< by its cost: what lies behind is not known

  /// It also ends before the piece in which the first lane's depth comes to this.
  double until = std::numeric_limits<double>::infinity();
  std::optional<Piece> last;  ///< that piece

  /// What was taken, and the depth before it, where somebody wants to know.
  struct Taken {
    double a, b;
    Lanes before, own;
  };
  std::vector<Taken>* taken = nullptr;

 private:
  bool accepted(const Piece& whole, const Piece& near, const Piece& far);
  void take(const Piece&);

  double tolerance_, white_;
  Cost& cost_;
  bool nested_;
  std::vector<Piece> stack_;
};

/// Wavelengths marched together, and their lanes: each under three colours.
inline constexpr int kTogether = 8, kSpectral = 3 * kTogether;

}  // namespace brume::truth
