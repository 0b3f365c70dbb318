#pragma once
// One adaptive march from the eye outward: optical depth and the light gathered under it,
// all media together, three colours at once.
//
// A piece is seen at the 12 nodes of Gauss-Legendre. Optical depth up to each node is the
// integral of the polynomial through the extinctions there, the light of the piece
// Sum w e exp(-tau). Then the piece is halved: where the halves, laid one behind the
// other, agree with the whole, they are taken; else each is halved again. A piece is
// never deeper than 8 while light still comes through, so stiffness costs halvings (some
// hundred from 1e30 m to 1e-6 m), not accuracy.

#include <functional>
#include <vector>

#include "truth/truth.h"

namespace brume::truth {

/// What there is at a point of a ray: extinction and light added, both per metre.
struct Local {
  Rgb sigma{}, e{};
};
using AlongRay = std::function<Local(double t)>;

class March {
 public:
  /// As in Options: accepted are changes of tau up to `tolerance`, and of L, as it
  /// arrives at the eye, up to tolerance (white + |L|).
  March(double tolerance, double white) : tolerance_(tolerance), white_(white) {}

  /// Goes on over [a, b], a < b finite, on which f is smooth or nearly so.
  void over(const AlongRay& f, double a, double b);

  /// Nothing behind can be seen.
  bool opaque() const;

  Rgb tau{}, L{}, tau_error{}, L_error{};
  bool converged = true;
  long evaluations = 0;

 private:
  struct Piece {
    double a, b;
    Rgb tau, L;
  };
  Piece look(const AlongRay& f, double a, double b);
  bool accepted(const Piece& whole, const Piece& near, const Piece& far);
  void take(const Piece&);

  double tolerance_, white_;
  int pieces_ = 0;
  std::vector<Piece> stack_;
};

}  // namespace brume::truth
