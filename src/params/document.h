#pragma once
// Documentation that a program can write: parameter tables, and the places in a README
// that hold them.

#include <span>
#include <string>
#include <string_view>

#include "params/params.h"

namespace brume {

/// A Markdown table, one row per parameter: name, default, allowed, what it is. Ends with
/// a newline.
std::string markdown_table(std::span<const ParamSpec>);

/// The same for a terminal: aligned columns, docs wrapped to `width` characters.
std::string text_table(std::span<const ParamSpec>, int width = 100);

/// `file` with the lines between `<!-- generated: NAME -->` and the next `<!-- end -->`
/// replaced by `text`, as often as NAME occurs; equal to `file` when nothing was stale.
/// Throws Error when the marker is missing or has no end.
std::string replace_generated(std::string_view file, std::string_view name,
                              std::string_view text);

}  // namespace brume
