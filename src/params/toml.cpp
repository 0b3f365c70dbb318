// The one file that meets toml++. Linked, not header-only: the header-only parser is
// built with our options and its assertions abort on malformed input.

#include "params/toml.h"

#include <toml++/toml.h>
#include <algorithm>
#include <sstream>
#include <utility>

#include "params/text.h"

namespace brume::toml_tree {
namespace {

// Depth of brackets and of dotted keys, before the parser sees the text: it follows
// dotted keys to any depth and would take the stack down with it when the tree is freed.
// Strings and comments are stepped over; broken ones are left to the parser, which stops
// at them.
class DepthGuard {
 public:
  DepthGuard(std::string_view text, const std::string& source)
      : text_(text), source_(source) {}

  void run() {
    while (i_ < text_.size()) {
      const char c = text_[i_];
      if (c == '#')
        i_ = std::min(text_.find('\n', i_), text_.size());
      else if (c == '"' || c == '\'')
        skip_string(c);
      else
        step(c);
    }
  }

 private:
  void step(char c) {
    ++i_;
    if (c == '[' || c == '{') {
      dots_ = 0;
      if (++brackets_ > kDeepest) too_deep();
    } else if (c == '.') {
      if (++dots_ > kDeepest) too_deep();
    } else if (c == ']' || c == '}' || c == '=' || c == ',' || c == '\n') {
      dots_ = 0;
      if (c == ']' || c == '}') brackets_ = std::max(0, brackets_ - 1);
    }
  }

  void skip_string(char quote) {
    const std::string three(3, quote);
    const bool multiline = text_.substr(i_, 3) == three;
    i_ += multiline ? 3 : 1;
    while (i_ < text_.size()) {
      if (multiline ? text_.substr(i_, 3) == three : text_[i_] == quote) break;
      if (!multiline && text_[i_] == '\n') return;
      if (quote == '"' && text_[i_] == '\\') ++i_;
      ++i_;
    }
    i_ = std::min(i_ + (multiline ? 3 : 1), text_.size());
  }

  [[noreturn]] void too_deep() const {
    const std::string_view before = text_.substr(0, i_ - 1);
    const std::size_t line_start = before.rfind('\n') + 1;  // npos + 1 is 0
    const Location at{source_, int(std::count(before.begin(), before.end(), '\n')) + 1,
                      int(before.size() - line_start) + 1};
    throw Error(at.text(), "nested deeper than " + std::to_string(kDeepest),
                "a scene needs four levels");
  }

  std::string_view text_;
  const std::string& source_;
  std::size_t i_ = 0;
  int brackets_ = 0, dots_ = 0;
};

template <class T>
std::string iso(const T& date) {
  std::ostringstream s;
  s << date;
  return s.str();
}

Node converted(const toml::node& n);

Node scalar(const toml::node& n) {
  Node out;
  if (const auto* flag = n.as_boolean()) {
    out.is = Node::Is::flag;
    out.number = **flag ? 1 : 0;
  } else if (const auto* integer = n.as_integer()) {
    out.is = Node::Is::integer;
    out.integer = **integer;
    out.number = double(**integer);
  } else if (const auto* number = n.as_floating_point()) {
    out.is = Node::Is::number;
    out.number = **number;
  } else {
    out.is = Node::Is::text;
    if (const auto* text = n.as_string())
      out.text = **text;
    else if (const auto* date = n.as_date())
      out.text = iso(**date);
    else if (const auto* time = n.as_time())
      out.text = iso(**time);
    else if (const auto* both = n.as_date_time())
      out.text = iso(**both);
  }
  return out;
}

Node table(const toml::table& t) {
  Node out;
  out.is = Node::Is::table;
  out.items.reserve(t.size());
  for (const auto& [key, value] : t) {
    Node item = converted(value);
    item.key = std::string(key.str());
    item.key_line = int(key.source().begin.line);
    item.key_column = int(key.source().begin.column);
    out.items.push_back(std::move(item));
  }
  // Errors come in the order of the text, not of the alphabet.
  std::stable_sort(out.items.begin(), out.items.end(), [](const Node& a, const Node& b) {
    return std::pair(a.key_line, a.key_column) < std::pair(b.key_line, b.key_column);
  });
  return out;
}

Node converted(const toml::node& n) {
  Node out;
  if (const auto* t = n.as_table())
    out = table(*t);
  else if (const auto* list = n.as_array()) {
    out.is = Node::Is::list;
    out.items.reserve(list->size());
    for (const toml::node& item : *list) out.items.push_back(converted(item));
  } else
    out = scalar(n);
  out.line = int(n.source().begin.line);
  out.column = int(n.source().begin.column);
  return out;
}

}  // namespace

const Node* Node::find(std::string_view name) const {
  for (const Node& item : items)
    if (item.key == name) return &item;
  return nullptr;
}

Node parse(std::string_view text, const std::string& source) {
  if (text.size() > kLongest)
    throw Error(source, "longer than " + std::to_string(kLongest >> 20) + " MiB",
                "not a scene file?");
  DepthGuard(text, source).run();
  try {
    return converted(toml::parse(text));
  } catch (const toml::parse_error& e) {
    const Location at{source, int(e.source().begin.line), int(e.source().begin.column)};
    std::string what(e.description());
    if (what.size() > 200) what.resize(200);
    std::string line;
    for (std::size_t i = 0; i < what.size(); i += 60)
      line += detail::shown(std::string_view(what).substr(i, 60));
    throw Error(at.text(), "not TOML: " + line);
  }
}

}  // namespace brume::toml_tree
