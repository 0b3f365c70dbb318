#pragma once
// Stiff and extreme cases against laws that hold whatever the stage, and against the
// truth: `brume stress`.
//
// A case is one ray through one world, or one pixel of one frame. Cases come in groups of
// up to kGroup that share it (several groups one where worlds are dear), drawn from
// (seed, group) alone: case number n is ray n % kGroup of group n / kGroup, on every
// machine, in every order.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "air/air.h"
#include "num/isa.h"
#include "num/random.h"
#include "stage/instance.h"
#include "stress/findings.h"

namespace brume::stress {

inline constexpr int kGroup = 128;

struct Report {
  std::string stage;
  std::uint64_t seed = 0;
  std::uint64_t cases = 0;           ///< against laws
  std::uint64_t truths = 0;          ///< of them against the truth
  std::uint64_t undecided = 0;       ///< more whose truth did not converge
  std::uint64_t idle = 0;            ///< groups whose stage had nothing to do
  std::uint64_t refused = 0;         ///< groups whose values the stage refused
  std::string refusal;               ///< the first reason given
  std::uint64_t given_up = 0;        ///< groups that took more than Options::most_of_time
  std::uint64_t first_given_up = 0;  ///< a case of the first
  double seconds = 0;
  std::array<Finding, kLaws> findings{};

  const Finding& of(Law law) const { return findings[std::size_t(law)]; }
  bool ok() const;
};

/// A surface or lens stage made ready for one frame.
struct PixelStage {
  StageNeeds needs;
  std::function<void(const brume_tile&)> run;
  /// StageInstance::truth; empty: it has none.
  std::function<void(const brume_tile&, std::span<const int>, double*)> truth;
  World world;  ///< what it publishes itself
  /// `run` on lower instruction sets.
  struct Lower {
    Isa isa;
    std::function<void(const brume_tile&)> run;
  };
  std::vector<Lower> lower = {};
};

/// What is under test. `keep` holds what its functions point into.
struct Subject {
  brume_role role = BRUME_AIR;
  std::string text;  ///< the values it was made with, as TOML
  std::shared_ptr<void> keep = {};

  /// Air: the world that it makes, and how worlds become air (tests break that).
  World world = {};
  std::function<Air(const World&, const AirOptions&)> compile = Air::compile;

  /// Surface and lens: the stage at a frame, the same values each time. Throws Error.
  std::function<PixelStage(const FrameInfo&)> at = {};
  brume_surface_step step = BRUME_BACKGROUND_STEP;
};

/// Makes what is under test for a frame; nothing when there is nothing to do. Throws
/// Error when the values make no sense together. Called by several threads.
using Maker = std::function<std::optional<Subject>(Random&, const FrameInfo&)>;

struct Options {
  std::uint64_t cases = 1'000'000, seed = 1;
  double seconds = 60;  ///< ends earlier than `cases`, never later; a quarter is truth's
  double tolerance = 1e-3, white = 1;
  double most_of_time = 0.1;  ///< for one group; it is given up then, and counted
  std::optional<std::uint64_t> only = {};  ///< this case alone, truth included
};

/// Random and corner values of all parameters of a stage, through the product's own
/// path. `type`, `cache` and `lower` must outlive what it makes.
class LowerIsas;
Maker maker_of(const StageType& type, StageCache& cache,
               const LowerIsas* lower = nullptr);

/// All cores. Deterministic but for the number of cases when time ends it, or a group.
Report run(const std::string& stage, const Maker&, const Options&);

/// World and ray, or frame and pixel, of a case, for a person.
std::string describe(const Maker&, const Options&, std::uint64_t number);

}  // namespace brume::stress
