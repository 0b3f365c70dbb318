// What a value may be, and what is said when it is not.

#include <algorithm>
#include <cctype>
#include <cmath>

#include "params/params.h"
#include "params/text.h"

namespace brume {
namespace {

using detail::shown;

std::string lower(std::string_view s) {
  std::string out(s);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return out;
}

// Edits (insert, delete, replace, swap of neighbours) from a to b: optimal string
// alignment, Damerau 1964.
std::size_t edits(std::string_view a, std::string_view b) {
  const std::size_t w = b.size() + 1;
  std::vector<std::size_t> d((a.size() + 1) * w);
  for (std::size_t i = 0; i <= a.size(); ++i)
    for (std::size_t j = 0; j <= b.size(); ++j) {
      std::size_t& here = d[i * w + j];
      if (i == 0 || j == 0) {
        here = i + j;
        continue;
      }
      here = std::min({d[(i - 1) * w + j] + 1, d[i * w + j - 1] + 1,
                       d[(i - 1) * w + j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        here = std::min(here, d[(i - 2) * w + j - 2] + 1);
    }
  return d.back();
}

std::string unit_text(const std::string& unit) {
  if (unit.empty()) return "";
  return unit.rfind("1/", 0) == 0 ? " per " + unit.substr(2) : " " + unit;
}

// How many numbers a kind takes; 0: any count.
std::size_t count_of(Kind k) {
  switch (k) {
    case Kind::number:
    case Kind::integer:
    case Kind::flag:
      return 1;
    case Kind::rgb:
    case Kind::vec3:
      return 3;
    case Kind::matrix:
      return 16;
    default:
      return 0;
  }
}

std::string allowed(const ParamSpec& s) {
  const std::string range = range_text(s);
  return range.empty() ? "allowed: finite numbers" : "allowed " + range;
}

}  // namespace

std::string range_text(const ParamSpec& s) {
  const bool low = std::isfinite(s.minimum), high = std::isfinite(s.maximum);
  std::string out;
  if (low && high)
    out = detail::number_text(s.minimum) + " to " + detail::number_text(s.maximum);
  else if (low)
    out = "at least " + detail::number_text(s.minimum);
  else if (high)
    out = "at most " + detail::number_text(s.maximum);
  else
    return "";
  return out + unit_text(s.unit);
}

std::string nearest_name(std::string_view wrong, std::span<const std::string> names) {
  const std::string asked = lower(wrong);
  std::string best;
  std::size_t best_distance = std::string::npos;
  if (asked.size() < 2) return best;  // a single letter is near to nothing
  for (const std::string& name : names) {
    const std::string known = lower(name);
    // One edit in three letters.
    const std::size_t most =
        std::max<std::size_t>(1, std::max(asked.size(), known.size()) / 3);
    std::size_t distance = most + 1;
    if (asked.size() >= 3 && known.rfind(asked, 0) == 0)
      distance = 1;  // the beginning of the name
    else if (asked.size() <= known.size() + most && known.size() <= asked.size() + most)
      distance = edits(asked, known);
    if (distance <= most && distance < best_distance) {
      best = name;
      best_distance = distance;
    }
  }
  return best;
}

void check(const ParamSpec& s, const Value& v, const Location& where,
           std::string_view owner) {
  const std::string name = std::string(owner) + (owner.empty() ? "" : ".") + s.name;
  const auto fail = [&](const std::string& what, const std::string& hint) {
    throw Error(where.text(), name + what, hint);
  };
  // Texts and words.
  const auto refuse_garbage = [&](const std::string& t) {
    if (!detail::valid_utf8(t) || t.find('\0') != std::string::npos)
      fail(" = \"" + shown(t) + "\"", "must be text in UTF-8");
  };
  refuse_garbage(v.text);
  for (const std::string& t : v.texts) refuse_garbage(t);
  if (s.kind == Kind::texts || s.kind == Kind::text) {
    if (!v.numbers.empty() || (s.kind == Kind::text ? !v.texts.empty() : !v.text.empty()))
      fail(" has numbers", "must be text");
    return;
  }
  if (!v.texts.empty()) fail(" is a list of texts", "must be one value");
  const bool word = s.kind == Kind::choice || (s.kind == Kind::rgb && v.numbers.empty());
  if (word) {
    if (!v.numbers.empty()) fail(" has numbers", "must be a word");
    if (std::find(s.words.begin(), s.words.end(), v.text) == s.words.end()) {
      const std::string near = nearest_name(v.text, s.words);
      std::vector<std::string> words;
      for (const std::string& w : s.words) words.push_back(detail::quoted(w));
      std::string hint = near.empty() ? "" : "did you mean " + near + "? ";
      if (s.kind == Kind::rgb)
        hint += words.empty() ? "must be a colour"
                              : "must be a colour or " + detail::joined(words);
      else
        hint += "allowed: " + detail::joined(words);
      fail(" = \"" + shown(v.text) + "\"", hint);
    }
    return;
  }
  if (!v.text.empty()) fail(" = \"" + shown(v.text) + "\"", "must be numbers");
  // Numbers: how many, then each one.
  const std::size_t n = count_of(s.kind);
  if (n != 0 && v.numbers.size() != n)
    fail(" has " + std::to_string(v.numbers.size()) + " numbers",
         "needs " + std::to_string(n));
  const bool infinite =
      s.infinite || std::any_of(s.default_numbers.begin(), s.default_numbers.end(),
                                [](double d) { return std::isinf(d); });
  // A whole number must fit an int whatever the range says.
  const double low = s.kind == Kind::integer ? std::max(s.minimum, -2147483648.0)
                     : s.kind == Kind::flag  ? 0
                                             : s.minimum;
  const double high = s.kind == Kind::integer ? std::min(s.maximum, 2147483647.0)
                      : s.kind == Kind::flag  ? 1
                                              : s.maximum;
  for (const double x : v.numbers) {
    const bool whole = s.kind != Kind::integer && s.kind != Kind::flag;
    if (!(x >= low && x <= high) || (std::isinf(x) && !infinite) ||
        (!whole && x != std::floor(x))) {
      // A grey is said as people write it; one number stands for all three.
      const bool grey = s.kind == Kind::rgb && v.numbers[0] == v.numbers[1] &&
                        v.numbers[1] == v.numbers[2];
      const std::size_t said = grey ? 1 : std::min<std::size_t>(v.numbers.size(), 4);
      std::string list;
      for (std::size_t i = 0; i < said; ++i)
        list += (i ? ", " : "") + detail::number_text(v.numbers[i]);
      if (v.numbers.size() > 4) list += ", ...";
      ParamSpec range = s;
      range.minimum = low;
      range.maximum = high;
      fail(" = " + (said == 1 ? list : "[" + list + "]"), allowed(range));
    }
  }
}

}  // namespace brume
