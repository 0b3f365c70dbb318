#pragma once
// Text in messages and in TOML: whatever the user wrote, on one line.

#include <span>
#include <string>
#include <string_view>

#include "params/params.h"
#include "params/toml.h"

namespace brume::detail {

/// Text for a message: control characters and broken UTF-8 as '?', cut after 60 bytes.
std::string shown(std::string_view);

bool valid_utf8(std::string_view);

/// A number with the fewest digits that read back to the same bits; "inf", "-inf".
std::string number_text(double);

/// As a TOML (and, infinities aside, JSON) float: number_text with a point or exponent.
std::string float_text(double);

/// As a TOML basic string (and JSON string), in quotes.
std::string quoted(std::string_view);

/// "a, b, c".
std::string joined(std::span<const std::string>);

/// "did you mean density?", else "known: density, falloff".
std::string hint_for(std::string_view wrong, std::span<const std::string> names);

/// A node as the user may have written it, for messages.
std::string shown(const toml_tree::Node&);

/// Throws Error "<where>: owner.name: no such parameter; did you mean ...?".
[[noreturn]] void no_such_parameter(std::string_view owner, std::string_view name,
                                    std::span<const ParamSpec>, const Location&);

/// A setting from TOML: a value or keyframes. Checked.
Setting read_setting(const ParamSpec&, const toml_tree::Node&, const std::string& source,
                     std::string_view owner);

}  // namespace brume::detail
