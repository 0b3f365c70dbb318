#pragma once
// TOML as a small tree of our own, so that one file of the house meets the parser.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "params/params.h"

namespace brume::toml_tree {

/// A value with the place it stands at. Dates and times become text as ISO 8601 writes
/// them.
struct Node {
  enum class Is { flag, integer, number, text, list, table };
  Is is = Is::table;
  double number = 0;  ///< also of an integer; a flag is 0 or 1
  std::int64_t integer = 0;
  std::string text;
  std::vector<Node> items;  ///< of a list; of a table, in the order of the text
  std::string key;          ///< this node's name in its table
  int line = 0, column = 0, key_line = 0, key_column = 0;  ///< from 1, in characters

  bool is_number() const { return is == Is::integer || is == Is::number; }
  const Node* find(std::string_view name) const;  ///< in a table; null when absent
};

/// Longest text and deepest nesting that is read; beyond, Error. Scenes are a few
/// kilobytes; the bounds keep garbage from taking memory and stack.
inline constexpr std::size_t kLongest = 4u << 20;
inline constexpr int kDeepest = 32;

/// Parses a document; `source` stands in errors: Error "valley.toml:3:7: ...".
Node parse(std::string_view text, const std::string& source);

}  // namespace brume::toml_tree
