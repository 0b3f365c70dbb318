#pragma once
// Cases that share what they are asked of: internal to src/stress.

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "stress/stress.h"

namespace brume::stress {

/// What is under test, and what is still to be drawn.
struct Setting {
  std::uint64_t number = 0;
  FrameInfo frame;
  Subject subject;
  Random random{0};
};

enum class Verdict { none, given, undecided };

/// Up to kGroup cases: rays through one world, or pixels of one frame.
class Group {
 public:
  explicit Group(std::uint64_t number_) : number(number_) {}
  virtual ~Group() = default;
  Group(const Group&) = delete;
  Group& operator=(const Group&) = delete;

  const std::uint64_t number;
  virtual int size() const = 0;
  /// All laws over all cases but the truth. Throws Error where the stage fails.
  virtual void check_laws(Findings&) = 0;
  /// Case i < size() against the truth, if there is one and it converges.
  virtual Verdict check_truth(int i, Findings&) = 0;
  virtual std::string describe(int i) = 0;
  /// It took longer than it may: what was found since it was made counts for nothing.
  virtual bool given_up() const { return false; }

  std::uint64_t case_of(int i) const { return number * kGroup + std::uint64_t(i); }
};

/// Nothing where the stage is idle. Throws Error where it refuses.
std::optional<Setting> make_setting(const Maker&, const Options&, std::uint64_t number);

/// How many groups share a setting: more than one where it is dear (the world of a sky
/// takes tenths of a second, so does a lens' pattern). By the first that is not idle.
std::uint64_t groups_per_setting(const Maker&, const Options&);

using Clock = std::chrono::steady_clock;

/// Group `number`, of setting number / share. Air whose media have functions of their own
/// is given up soon after `until`.
std::unique_ptr<Group> make_group(const Setting&, const Options&, std::uint64_t share,
                                  std::uint64_t number,
                                  Clock::time_point until = Clock::time_point::max());

// One kind of stage each; `random` is what the group draws from.
std::unique_ptr<Group> make_air_group(const Setting&, const Options&,
                                      std::uint64_t number, Random random,
                                      Clock::time_point until);
std::unique_ptr<Group> make_surface_group(const Setting&, const Options&,
                                          std::uint64_t number, Random random);
std::unique_ptr<Group> make_lens_group(const Setting&, const Options&,
                                       std::uint64_t number, Random random);

}  // namespace brume::stress
