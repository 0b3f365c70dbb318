#pragma once
// One declaration per parameter, many readers: scene file, --set, `brume stages`, README
// tables, the C ABI, the node, the JSON schema, the fuzzer, cache keys all read the same
// ParamSpec.

#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "num/error.h"

namespace brume {

enum class Kind {
  number,   ///< one number
  integer,  ///< one whole number
  flag,     ///< true or false
  rgb,      ///< three numbers, or one for all three; or a word of `words`
  vec3,     ///< three numbers
  numbers,  ///< a list of any length
  matrix,   ///< 16 numbers, row by row, acting on column vectors
  text,     ///< any text
  choice,   ///< a word of `words`
};

/// What a parameter is. SI units; the unit stands here and not in the name.
struct ParamSpec {
  std::string name;
  Kind kind = Kind::number;
  std::string unit;  ///< "m", "1/m", "degrees", "" for pure numbers
  std::string doc;   ///< one sentence for a compositor
  double minimum =
      -std::numeric_limits<double>::infinity();  ///< inclusive, per component
  double maximum = std::numeric_limits<double>::infinity();
  std::vector<double> default_numbers;
  std::string default_text;
  std::vector<std::string> words;  ///< choice: what is allowed; rgb: words allowed in
                                   ///< place of numbers, e.g. "sky"
  bool knob = false;  ///< the stage's accuracy knob, set from `tolerance` unless given
  bool animatable = true;  ///< may be keyframed
};

/// A parameter's value at one frame. `text` for text and choice, and for an rgb given as
/// a word.
struct Value {
  std::vector<double> numbers;
  std::string text;
  bool operator==(const Value&) const = default;
};

/// Where in a scene file (or on the command line) something was said.
struct Location {
  std::string source;  ///< "valley.toml" or "--set"
  int line = 0, column = 0;
  std::string text() const;  ///< "valley.toml:12:9"
};

enum class Interpolation { linear, smooth, step };

/// A parameter's value over frames: one value, or keys. Outside the keys the nearest
/// holds. `smooth` is a monotone cubic (no overshoot) through the keys, per component.
struct Setting {
  struct Key {
    double frame;
    Value value;
  };
  std::vector<Key> keys;  ///< ascending in frame; one key = constant
  Interpolation interpolation = Interpolation::linear;
  Location where;
  bool is_default = true;

  Value at(double frame) const;
  bool animated() const { return keys.size() > 1; }
};

/// The settings of one thing (a stage, or a section such as [output]): one Setting for
/// each of its specs, same order.
struct Settings {
  std::vector<ParamSpec> specs;
  std::vector<Setting> values;

  /// All at their defaults.
  static Settings defaults(std::vector<ParamSpec>);
  int find(std::string_view name) const;  ///< index or -1
  std::vector<Value> at(double frame) const;
  bool animated() const;

  /// Sets one parameter from text as written on the command line ("0.002", "0.1,0.2,0.3",
  /// "sky", "true"), checked like the scene file. Throws Error "--set height_fog.densty:
  /// no such parameter; did you mean density?".
  void set(std::string_view name, std::string_view text, const Location&,
           std::string_view owner);
};

/// Checks kind, count, range and word; throws Error{where, "height_fog.density = -3",
/// "allowed 0 to 10 per m"}.
void check(const ParamSpec&, const Value&, const Location&, std::string_view owner);

/// The nearest of `names` by edit distance, or "" when none is near.
std::string nearest_name(std::string_view wrong, std::span<const std::string> names);

std::string print(const ParamSpec&,
                  const Value&);  ///< as TOML; parses back to the same bits
std::string json_schema(std::string_view owner, std::span<const ParamSpec>);

// ---- the declaration
// ------------------------------------------------------------------------------------------------
// A struct declares its parameters once, in one visitor:
//
//   struct HeightFog {
//     Rgb density{0.002, 0.002, 0.002};
//     double falloff = 0.01;
//     template <class V> void describe(V& v) {
//       v("density", density, {.unit = "1/m", .minimum = 0, .maximum = 10, .doc =
//       "Extinction at `height`"}); v("falloff", falloff, {.unit = "1/m", ...});
//     }
//   };
// Members may be double, int, bool, Rgb, Vec3, RgbOr (rgb or a word),
// std::vector<double>, Matrix4, std::string (text, or choice when `words` is given). See
// params/describe.h: specs_of<T>(), assign(T&, span<const Value>).

}  // namespace brume
