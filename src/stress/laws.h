#pragma once
// The laws over one group: internal to src/stress.

#include "stress/group.h"

namespace brume::stress {

/// Takes in what is found; `by` parts of what is allowed.
struct Findings {
  std::array<Finding, kLaws> of{};

  /// |got - wanted| <= allowed? NaN breaks it.
  void near(Law, std::uint64_t number, int channel, double got, double wanted,
            double allowed);
  /// got <= wanted + allowed?
  void at_most(Law, std::uint64_t number, int channel, double got, double wanted,
               double allowed);
  void holds(Law, std::uint64_t number, int channel, double got, double wanted, bool);
  void add(const Findings&);

 private:
  void take(Law, std::uint64_t number, int channel, double got, double wanted,
            double allowed, double by);
};

/// All but the truth, over all rays.
void check_laws(Group&, const Options&, Findings&);

/// Ray i against the truth, if there is one: not of a sky, and not where it does not
/// converge within its evaluations.
enum class Verdict { none, given, undecided };
Verdict check_truth(const Group&, const Options&, int i, Findings&);

}  // namespace brume::stress
