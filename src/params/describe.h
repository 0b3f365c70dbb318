#pragma once
// The visitor that reads a struct's one declaration of its parameters (see the end of
// params.h). Header-only: a plugin module uses it without linking the library.

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "params/params.h"

namespace brume {

using Vec3 = std::array<double, 3>;
struct Rgb {
  double r = 0, g = 0, b = 0;
  bool operator==(const Rgb&) const = default;
};
/// A colour, or a word that stands for where it comes from ("sky"). `word` empty: the
/// colour holds.
struct RgbOr {
  Rgb rgb;
  std::string word;
};
using Matrix4 = std::array<double, 16>;  ///< row by row

/// What a declaration says beside name and member.
struct About {
  std::string unit = {}, doc = {};
  double minimum = -std::numeric_limits<double>::infinity();
  double maximum = std::numeric_limits<double>::infinity();
  std::vector<std::string> words = {};
  bool knob = false, animatable = true;
  bool infinite = false;           ///< inf may be given; also where the default is inf
  std::vector<double> curve = {};  ///< of a knob (ParamSpec::curve)
};

namespace detail {

template <class M>
constexpr Kind kind_of(bool has_words) {
  if constexpr (std::is_same_v<M, double>)
    return Kind::number;
  else if constexpr (std::is_same_v<M, bool>)
    return Kind::flag;
  else if constexpr (std::is_same_v<M, int>)
    return Kind::integer;
  else if constexpr (std::is_same_v<M, Rgb> || std::is_same_v<M, RgbOr>)
    return Kind::rgb;
  else if constexpr (std::is_same_v<M, Vec3>)
    return Kind::vec3;
  else if constexpr (std::is_same_v<M, Matrix4>)
    return Kind::matrix;
  else if constexpr (std::is_same_v<M, std::vector<double>>)
    return Kind::numbers;
  else if constexpr (std::is_same_v<M, std::vector<std::string>>)
    return Kind::texts;
  else {
    static_assert(std::is_same_v<M, std::string>, "not a type a parameter can have");
    return has_words ? Kind::choice : Kind::text;
  }
}

template <class M>
Value value_of(const M& m) {
  if constexpr (std::is_arithmetic_v<M>)
    return {.numbers = {double(m)}};
  else if constexpr (std::is_same_v<M, Rgb>)
    return {.numbers = {m.r, m.g, m.b}};
  else if constexpr (std::is_same_v<M, RgbOr>)
    return m.word.empty() ? value_of(m.rgb) : Value{.text = m.word};
  else if constexpr (std::is_same_v<M, std::string>)
    return {.text = m};
  else if constexpr (std::is_same_v<M, std::vector<std::string>>)
    return {.texts = m};
  else
    return {.numbers = {m.begin(), m.end()}};
}

template <class M>
void set_member(M& m, const Value& v) {
  if constexpr (std::is_same_v<M, bool>)
    m = v.numbers[0] != 0;
  else if constexpr (std::is_arithmetic_v<M>)
    m = M(v.numbers[0]);
  else if constexpr (std::is_same_v<M, Rgb>)
    m = {v.numbers[0], v.numbers[1], v.numbers[2]};
  else if constexpr (std::is_same_v<M, RgbOr>) {
    m.word = v.text;
    if (v.text.empty()) m.rgb = {v.numbers[0], v.numbers[1], v.numbers[2]};
  } else if constexpr (std::is_same_v<M, std::string>)
    m = v.text;
  else if constexpr (std::is_same_v<M, std::vector<double>>)
    m = v.numbers;
  else if constexpr (std::is_same_v<M, std::vector<std::string>>)
    m = v.texts;
  else
    for (std::size_t i = 0; i < m.size(); ++i) m[i] = v.numbers[i];
}

struct SpecVisitor {
  std::vector<ParamSpec> specs;
  template <class M>
  void operator()(const char* name, M& member, About a) {
    Value d = value_of(member);
    const Kind kind = kind_of<M>(!a.words.empty());
    specs.push_back({.name = name,
                     .kind = kind,
                     .unit = std::move(a.unit),
                     .doc = std::move(a.doc),
                     .minimum = a.minimum,
                     .maximum = a.maximum,
                     .default_numbers = std::move(d.numbers),
                     .default_text = std::move(d.text),
                     .words = std::move(a.words),
                     .knob = a.knob,
                     .animatable = a.animatable,
                     .default_texts = std::move(d.texts),
                     .infinite = a.infinite,
                     .curve = std::move(a.curve)});
  }
};

struct AssignVisitor {
  std::span<const Value> values;
  std::size_t next = 0;
  template <class M>
  void operator()(const char*, M& member, const About&) {
    set_member(member, values[next++]);
  }
};

}  // namespace detail

/// The specs of T's parameters, in the order of its declaration; defaults are the values
/// of a default-made T.
template <class T>
std::vector<ParamSpec> specs_of() {
  T t;
  detail::SpecVisitor v;
  t.describe(v);
  return std::move(v.specs);
}

/// Sets T's parameters from values in the order of its declaration (checked already, see
/// check in params.h; as many as there are parameters).
template <class T>
void assign(T& t, std::span<const Value> values) {
  detail::AssignVisitor v{values};
  t.describe(v);
}

}  // namespace brume
