// Values as text: in TOML (and back to the same bits), in messages.

#include <fmt/format.h>

#include <cmath>

#include "params/params.h"
#include "params/text.h"

namespace brume {
namespace detail {

namespace {

// Bytes of the UTF-8 character at s[i], 0 where there is none (RFC 3629: no overlong
// forms, no surrogates, nothing above U+10FFFF).
std::size_t utf8_length(std::string_view s, std::size_t i) {
  const auto byte = [&](std::size_t k) {
    return i + k < s.size() ? static_cast<unsigned char>(s[i + k]) : 0u;
  };
  const auto tail = [&](std::size_t k) { return (byte(k) & 0xC0u) == 0x80u; };
  const unsigned a = byte(0), b = byte(1);
  if (a < 0x80) return 1;
  if (a >= 0xC2 && a <= 0xDF) return tail(1) ? 2 : 0;
  if (a >= 0xE0 && a <= 0xEF) {
    if (!tail(1) || !tail(2) || (a == 0xE0 && b < 0xA0) || (a == 0xED && b > 0x9F))
      return 0;
    return 3;
  }
  if (a >= 0xF0 && a <= 0xF4) {
    if (!tail(1) || !tail(2) || !tail(3) || (a == 0xF0 && b < 0x90) ||
        (a == 0xF4 && b > 0x8F))
      return 0;
    return 4;
  }
  return 0;
}

}  // namespace

std::string shown(std::string_view s) {
  std::string out;
  for (std::size_t i = 0; i < s.size();) {
    if (out.size() >= 60) return out + "...";
    const std::size_t n = utf8_length(s, i);
    const auto c = static_cast<unsigned char>(s[i]);
    if (n == 0 || c < 0x20 || c == 0x7F)
      out += '?';
    else
      out += s.substr(i, n);
    i += n == 0 ? 1 : n;
  }
  return out;
}

bool valid_utf8(std::string_view s) {
  for (std::size_t i = 0; i < s.size();) {
    const std::size_t n = utf8_length(s, i);
    if (n == 0) return false;
    i += n;
  }
  return true;
}

std::string number_text(double x) {
  if (std::isnan(x)) return "nan";
  if (std::isinf(x)) return x < 0 ? "-inf" : "inf";
  return fmt::format("{}", x);  // shortest digits that round-trip
}

std::string float_text(double x) {
  std::string s = number_text(x);
  if (s.find_first_of(".en") == std::string::npos) s += ".0";
  return s;
}

std::string quoted(std::string_view s) {
  std::string out = "\"";
  for (const char ch : s) {
    const auto c = static_cast<unsigned char>(ch);
    if (c == '"' || c == '\\')
      (out += '\\') += ch;
    else if (c < 0x20 || c == 0x7F)
      out += fmt::format("\\u{:04X}", unsigned(c));
    else
      out += ch;
  }
  return out + "\"";
}

std::string joined(std::span<const std::string> names) {
  std::string out;
  for (const std::string& n : names) out += (out.empty() ? "" : ", ") + n;
  return out;
}

std::string hint_for(std::string_view wrong, std::span<const std::string> names) {
  const std::string near = nearest_name(wrong, names);
  if (!near.empty()) return "did you mean " + near + "?";
  return names.empty() ? "it has none" : "known: " + joined(names);
}

std::string shown(const toml_tree::Node& n) {
  using Is = toml_tree::Node::Is;
  switch (n.is) {
    case Is::flag:
      return n.number != 0 ? "true" : "false";
    case Is::integer:
      return std::to_string(n.integer);
    case Is::number:
      return number_text(n.number);
    case Is::text:
      return "\"" + shown(n.text) + "\"";
    case Is::table:
      return "{ ... }";
    case Is::list:
      break;
  }
  std::string out;
  for (std::size_t i = 0; i < n.items.size() && out.size() < 60; ++i)
    out += (i ? ", " : "") +
           (n.items[i].is == Is::list ? std::string("[...]") : shown(n.items[i]));
  return "[" + out + (out.size() < 60 ? "]" : ", ...]");
}

void no_such_parameter(std::string_view owner, std::string_view name,
                       std::span<const ParamSpec> specs, const Location& where) {
  std::vector<std::string> names;
  for (const ParamSpec& s : specs) names.push_back(s.name);
  const std::string full = std::string(owner) + (owner.empty() ? "" : ".") + shown(name);
  const std::string hint = hint_for(name, names);
  if (where.line <= 0) throw Error(where.source + " " + full, "no such parameter", hint);
  throw Error(where.text(), full + ": no such parameter", hint);
}

}  // namespace detail

std::string print(const ParamSpec& s, const Value& v) {
  if (s.kind == Kind::texts) {
    std::string out;
    for (const std::string& t : v.texts)
      out += (out.empty() ? "" : ", ") + detail::quoted(t);
    return "[" + out + "]";
  }
  const bool word = s.kind == Kind::text || s.kind == Kind::choice ||
                    (s.kind == Kind::rgb && v.numbers.empty());
  if (word) return detail::quoted(v.text);
  if (s.kind == Kind::flag) return v.numbers[0] != 0 ? "true" : "false";
  if (s.kind == Kind::integer) return fmt::format("{}", std::int64_t(v.numbers[0]));
  if (s.kind == Kind::number) return detail::float_text(v.numbers[0]);
  std::string out;
  for (std::size_t i = 0; i < v.numbers.size(); ++i)
    out += (i ? ", " : "") + detail::float_text(v.numbers[i]);
  return "[" + out + "]";
}

std::string print(const ParamSpec& spec, const Setting& s) {
  if (!s.animated()) return print(spec, s.keys.front().value);
  std::string frames, values;
  for (const Setting::Key& k : s.keys) {
    const char* comma = frames.empty() ? "" : ", ";
    frames += comma + detail::number_text(k.frame);
    values += comma + print(spec, k.value);
  }
  const char* way = s.interpolation == Interpolation::linear   ? "linear"
                    : s.interpolation == Interpolation::smooth ? "smooth"
                                                               : "step";
  return "{ frames = [" + frames + "], values = [" + values + "], interpolation = \"" +
         way + "\" }";
}

}  // namespace brume
