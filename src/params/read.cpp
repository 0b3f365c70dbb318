// From TOML, or from the text of --set, to a checked Setting.

#include <algorithm>
#include <charconv>
#include <cmath>

#include "params/params.h"
#include "params/text.h"

namespace brume {
namespace {

using toml_tree::Node;
using Is = Node::Is;

struct Reader {
  const ParamSpec& spec;
  const std::string& source;
  std::string_view owner;

  Location at(const Node& n) const { return {source, n.line, n.column}; }

  std::string name() const {
    return std::string(owner) + (owner.empty() ? "" : ".") + spec.name;
  }

  [[noreturn]] void fail(const Node& n, const std::string& what,
                         const std::string& hint) const {
    throw Error(at(n).text(), what, hint);
  }

  std::string wanted() const {
    switch (spec.kind) {
      case Kind::number:
        return "must be a number";
      case Kind::integer:
        return "must be a whole number";
      case Kind::flag:
        return "must be true or false";
      case Kind::rgb: {
        std::vector<std::string> words;
        for (const std::string& w : spec.words) words.push_back(detail::quoted(w));
        return std::string("must be a number or [r, g, b]") +
               (words.empty() ? "" : " or " + detail::joined(words));
      }
      case Kind::vec3:
        return "must be three numbers [x, y, z]";
      case Kind::numbers:
        return "must be a list of numbers";
      case Kind::matrix:
        return "must be 16 numbers, row by row";
      case Kind::texts:
        return "must be a list of texts in quotes";
      case Kind::text:
      case Kind::choice:
        break;
    }
    return "must be text in quotes";
  }

  [[noreturn]] void wrong_kind(const Node& n) const {
    fail(n, name() + " = " + detail::shown(n), wanted());
  }

  void append_numbers(const Node& list, Value& v) const {
    for (const Node& item : list.items) {
      // A matrix may come as four rows.
      if (spec.kind == Kind::matrix && item.is == Is::list && item.items.size() == 4)
        append_numbers(item, v);
      else if (item.is_number())
        v.numbers.push_back(item.number);
      else
        wrong_kind(item);
    }
  }

  // The value in the form its kind asks for; counts and ranges are check's.
  Value form(const Node& n) const {
    const bool scalar = n.is_number();
    switch (spec.kind) {
      case Kind::number:
        if (scalar) return {.numbers = {n.number}};
        break;
      case Kind::integer:
        if (n.is == Is::integer) return {.numbers = {n.number}};
        break;
      case Kind::flag:
        if (n.is == Is::flag) return {.numbers = {n.number}};
        break;
      case Kind::text:
      case Kind::choice:
        if (n.is == Is::text) return {.text = n.text};
        break;
      case Kind::rgb:
        if (n.is == Is::text) return {.text = n.text};
        if (scalar) return {.numbers = {n.number, n.number, n.number}};
        [[fallthrough]];
      case Kind::vec3:
      case Kind::matrix:
      case Kind::numbers:
        if (scalar && spec.kind == Kind::numbers) return {.numbers = {n.number}};
        if (n.is == Is::list) {
          Value v;
          append_numbers(n, v);
          // An empty colour must not pass for a word.
          if (v.numbers.empty() && spec.kind != Kind::numbers) break;
          return v;
        }
        break;
      case Kind::texts:
        if (n.is == Is::text) return {.texts = {n.text}};
        if (n.is == Is::list) {
          Value v;
          for (const Node& item : n.items) {
            if (item.is != Is::text) wrong_kind(item);
            v.texts.push_back(item.text);
          }
          return v;
        }
        break;
    }
    wrong_kind(n);
  }

  Value value(const Node& n) const {
    Value v = form(n);
    // The offending one of several numbers stands at its own place.
    if (n.is == Is::list && v.numbers.size() == n.items.size()) {
      ParamSpec one = spec;
      one.kind = Kind::number;
      for (const Node& item : n.items)
        check(one, {.numbers = {item.number}}, at(item), owner);
    }
    check(spec, v, at(n), owner);
    return v;
  }

  bool interpolable(const Value& v) const {
    switch (spec.kind) {
      case Kind::number:
      case Kind::vec3:
      case Kind::matrix:
      case Kind::numbers:
        return true;
      case Kind::rgb:
        return v.text.empty();
      default:
        return false;
    }
  }

  Setting keyframes(const Node& n) const {
    if (!spec.animatable) fail(n, name() + " has keyframes", "it cannot be animated");
    for (const Node& item : n.items)
      if (item.key != "frames" && item.key != "values" && item.key != "interpolation") {
        const std::vector<std::string> known{"frames", "values", "interpolation"};
        throw Error(Location{source, item.key_line, item.key_column}.text(),
                    name() + ": keyframes have no \"" + detail::shown(item.key) + "\"",
                    detail::hint_for(item.key, known));
      }
    const Node* frames = n.find("frames");
    const Node* values = n.find("values");
    if (!frames || !values || frames->is != Is::list || values->is != Is::list)
      fail(n, name() + ": keyframes",
           "write { frames = [1001, 1024], values = [.., ..] }");
    if (frames->items.empty()) fail(*frames, name() + ": keyframes without frames", "");
    if (frames->items.size() != values->items.size())
      fail(*values,
           name() + ": " + std::to_string(frames->items.size()) + " frames and " +
               std::to_string(values->items.size()) + " values",
           "one value for each frame");
    Setting out;
    for (std::size_t i = 0; i < frames->items.size(); ++i) {
      const Node& f = frames->items[i];
      if (!f.is_number() || !(std::fabs(f.number) <= 1e9))
        fail(f, name() + ": frame " + detail::shown(f), "must be a finite number");
      if (!out.keys.empty() && !(f.number > out.keys.back().frame))
        fail(f, name() + ": frame " + detail::shown(f), "frames must ascend");
      const Node& v = values->items[i];
      out.keys.push_back({f.number, value(v)});
      const Value &first = out.keys.front().value, &now = out.keys.back().value;
      if (interpolable(first) != interpolable(now))
        fail(v, name() + ": words and numbers in one list of keyframes", "use one kind");
      if (first.numbers.size() != now.numbers.size())
        fail(v, name() + ": keyframes of different lengths", "use one length");
    }
    const bool smoothable = interpolable(out.keys.front().value);
    out.interpolation = smoothable ? Interpolation::linear : Interpolation::step;
    if (const Node* way = n.find("interpolation"))
      out.interpolation = interpolation(*way, smoothable);
    return out;
  }

  Interpolation interpolation(const Node& way, bool smoothable) const {
    if (way.is != Is::text ||
        (way.text != "linear" && way.text != "smooth" && way.text != "step"))
      fail(way, name() + ": interpolation = " + detail::shown(way),
           "allowed: \"linear\", \"smooth\", \"step\"");
    if (!smoothable && way.text != "step")
      fail(way, name() + ": interpolation = " + detail::shown(way),
           "only numbers and colours go between; allowed: \"step\"");
    return way.text == "step"     ? Interpolation::step
           : way.text == "smooth" ? Interpolation::smooth
                                  : Interpolation::linear;
  }
};

std::string_view trimmed(std::string_view s) {
  const std::size_t a = s.find_first_not_of(" \t\r\n");
  if (a == std::string_view::npos) return {};
  return s.substr(a, s.find_last_not_of(" \t\r\n") - a + 1);
}

// One number as people write it; false when it is none.
bool to_number(std::string_view s, double& out) {
  s = trimmed(s);
  if (!s.empty() && s[0] == '+') s.remove_prefix(1);
  const auto [end, error] = std::from_chars(s.data(), s.data() + s.size(), out);
  return error == std::errc() && end == s.data() + s.size() && !s.empty();
}

// Text of the command line as a node of TOML: bare words need no quotes there.
Node node_of(const ParamSpec& spec, std::string_view text, const std::string& source) {
  Node n;
  const bool words = spec.kind == Kind::text || spec.kind == Kind::choice;
  const char first = text.empty() ? ' ' : text[0];
  if (first == '{' || first == '"' || (first == '[' && !words)) {
    n = toml_tree::parse("v = " + std::string(text), source);
    if (n.items.size() == 1) return n.items[0];
    throw Error(source, "\"" + detail::shown(text) + "\"", "must be one value");
  }
  n.is = Is::text;
  n.text = std::string(text);
  if (words) return n;
  if (spec.kind == Kind::flag && (text == "true" || text == "false")) {
    n.is = Is::flag;
    n.number = text == "true";
    return n;
  }
  // Lists by commas, of texts or of numbers.
  Node list;
  list.is = Is::list;
  for (std::string_view rest = text; !text.empty();) {
    const std::size_t comma = rest.find(',');
    Node item;
    item.is = Is::text;
    item.text = std::string(trimmed(rest.substr(0, comma)));
    if (spec.kind != Kind::texts) {
      if (!to_number(item.text, item.number)) return n;
      item.is = item.number == std::floor(item.number) && std::fabs(item.number) < 1e15
                    ? Is::integer
                    : Is::number;
      item.integer = item.is == Is::integer ? std::int64_t(item.number) : 0;
    }
    list.items.push_back(std::move(item));
    if (comma == std::string_view::npos) break;
    rest.remove_prefix(comma + 1);
  }
  if (list.items.size() == 1 && spec.kind != Kind::texts) return list.items[0];
  if (spec.kind == Kind::texts || !list.items.empty()) return list;
  return n;
}

// Nodes of the command line carry no place in a file.
void forget_places(Node& n) {
  n.line = n.column = n.key_line = n.key_column = 0;
  for (Node& item : n.items) forget_places(item);
}

}  // namespace

namespace detail {

Setting read_setting(const ParamSpec& spec, const Node& n, const std::string& source,
                     std::string_view owner) {
  const Reader reader{spec, source, owner};
  Setting out;
  if (n.is == Is::table)
    out = reader.keyframes(n);
  else
    out.keys.push_back({0, reader.value(n)});
  out.where = reader.at(n);
  out.is_default = false;
  return out;
}

}  // namespace detail

void Settings::set(std::string_view name, std::string_view text, const Location& where,
                   std::string_view owner) {
  const int i = find(name);
  if (i < 0) detail::no_such_parameter(owner, name, specs, where);
  Node n;
  try {
    n = node_of(specs[i], trimmed(text), where.source);
  } catch (const Error& e) {
    throw Error(where.source,
                std::string(owner) + (owner.empty() ? "" : ".") + specs[i].name + ": " +
                    e.what_found,
                e.hint);
  }
  forget_places(n);
  Setting s = detail::read_setting(specs[i], n, where.source, owner);
  s.where = where;
  values[i] = std::move(s);
}

}  // namespace brume
