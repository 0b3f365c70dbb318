#pragma once
// The one error a user can cause. Thrown anywhere, caught once at the border (the command
// line's main, the C ABI, the node), printed on one line: "<where>: <what>; <hint>".

#include <stdexcept>
#include <string>
#include <utility>

namespace brume {

struct Error : std::runtime_error {
  /// `where` names file and place ("scene.toml:12:9", "shot.1001.exr", "--frames"),
  /// `what` what was found there, `hint` what is allowed or what to do (may be empty).
  Error(std::string where_, std::string what_, std::string hint_ = {})
      : std::runtime_error(where_ + ": " + what_ + (hint_.empty() ? "" : "; " + hint_)),
        where(std::move(where_)),
        what_found(std::move(what_)),
        hint(std::move(hint_)) {}

  std::string where, what_found, hint;
};

}  // namespace brume
