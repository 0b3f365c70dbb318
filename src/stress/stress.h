#pragma once
// Stiff and extreme cases against laws that hold whatever the medium, and against the
// truth: `brume stress`.
//
// A case is one ray through one world. Cases come in groups of kGroup rays that share a
// world (several groups one where worlds are dear), drawn from (seed, group) alone: case
// number n is ray n % kGroup of group n / kGroup, on every machine, in every order.

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "num/random.h"
#include "scene/world.h"
#include "stage/instance.h"

namespace brume::stress {

inline constexpr int kGroup = 128;

enum class Law {
  finite,      ///< T and L are numbers
  range,       ///< 0 <= T <= 1
  positive,    ///< L >= 0
  energy,      ///< L <= largest source x (1 - T), for sources that are constant
  split,       ///< T(a,c) = T(a,b) T(b,c), the second from a moved origin
  split_L,     ///< L(a,c) = L(a,b) + T(a,b) L(b,c)
  monotone,    ///< farther: T no larger, L no smaller
  scale,       ///< lengths x k, densities / k: the same
  weight,      ///< weight w: T^w; weight 0: exactly nothing
  lanes,       ///< the same bits alone, in any run of rays, at any address
  neighbours,  ///< NaN and inf in other rays change no bit
  isa,         ///< instruction sets agree
  truth_T,
  truth_L,
};
inline constexpr int kLaws = 14;
const char* name(Law);
const char* meaning(Law);

/// What was found of one law. `worst` is the deviation in parts of what is allowed: above
/// 1 the law is broken.
struct Finding {
  std::uint64_t checked = 0, broken = 0;
  double worst = 0;
  std::uint64_t worst_case = 0;  ///< the first of the worst
  int channel = 0;
  double got = 0, wanted = 0, allowed = 0;  ///< there
};

struct Report {
  std::string stage;
  std::uint64_t seed = 0;
  std::uint64_t cases = 0;      ///< against laws
  std::uint64_t truths = 0;     ///< of them against the truth
  std::uint64_t undecided = 0;  ///< more whose truth did not converge
  std::uint64_t idle = 0;       ///< groups whose stage had nothing to do
  std::uint64_t refused = 0;    ///< groups whose values the stage refused
  std::string refusal;          ///< the first reason given
  double seconds = 0;
  std::array<Finding, kLaws> findings{};

  const Finding& of(Law law) const { return findings[std::size_t(law)]; }
  bool ok() const;
};

/// A world under test. `keep` holds what its functions point into.
struct Subject {
  World world;
  std::shared_ptr<void> keep;
  std::string text;  ///< the values it was made with, as TOML
};

/// Makes the world of a group around the eye of the frame; nothing when there is nothing
/// to do. Throws Error when the values make no sense together. Called by several threads.
using Maker = std::function<std::optional<Subject>(Random&, const FrameInfo&)>;

struct Options {
  std::uint64_t cases = 1'000'000, seed = 1;
  double seconds = 60;  ///< ends earlier than `cases`, never later; a quarter is truth's
  double tolerance = 1e-3, white = 1;
  std::optional<std::uint64_t> only = {};  ///< this case alone, truth included
};

/// Random and corner values of all parameters of an air stage, through the product's own
/// path. `type` and `cache` must outlive what it makes.
Maker maker_of(const StageType& type, StageCache& cache);

/// All cores. Deterministic but for the number of cases when time ends it.
Report run(const std::string& stage, const Maker&, const Options&);

/// World and ray of a case, for a person.
std::string describe(const Maker&, const Options&, std::uint64_t number);

}  // namespace brume::stress
