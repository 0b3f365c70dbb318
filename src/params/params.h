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
  texts,    ///< a list of texts of any length
};

/// What a parameter is. SI units; the unit stands here and not in the name.
struct ParamSpec {
  std::string name = {};
  Kind kind = Kind::number;
  std::string unit = {};  ///< "m", "1/m", "degrees", "" for pure numbers
  std::string doc = {};   ///< one sentence for a compositor
  double minimum =
      -std::numeric_limits<double>::infinity();  ///< inclusive, per component
  double maximum = std::numeric_limits<double>::infinity();
  std::vector<double> default_numbers = {};
  std::string default_text = {};
  std::vector<std::string> words = {};  ///< choice: what is allowed; rgb: words allowed
                                        ///< in place of numbers, e.g. "sky"
  bool knob = false;  ///< the stage's accuracy knob, set from `tolerance` unless given
  bool animatable = true;  ///< may be keyframed
  std::vector<std::string> default_texts = {};
  bool infinite = false;  ///< inf may be given (where the range reaches it)
  /// Of a knob: value, error, value, error, ...: what each value promises, cheapest
  /// first, errors falling (brume_param.curve).
  std::vector<double> curve = {};

  bool operator==(const ParamSpec&) const = default;
};

/// A parameter's value at one frame. `numbers` for everything of numbers (a flag is 0 or
/// 1); `text` for text and choice, and for an rgb given as a word (`numbers` is empty
/// then); `texts` for texts.
struct Value {
  std::vector<double> numbers = {};
  std::string text = {};
  std::vector<std::string> texts = {};
  bool operator==(const Value&) const = default;
};

/// The value of a parameter that nobody set.
Value default_value(const ParamSpec&);

/// Where in a scene file (or on the command line) something was said.
struct Location {
  std::string source;  ///< "valley.toml" or "--set"
  int line = 0, column = 0;
  std::string text() const;  ///< "valley.toml:12:9"; without a line, the source alone
};

enum class Interpolation { linear, smooth, step };

/// A parameter's value over frames: one value, or keys. Outside the keys the nearest
/// holds. `smooth` is a monotone cubic (no overshoot) through the keys, per component
/// (Fritsch and Carlson 1980); with two keys it is the straight line. Words, texts, flags
/// and whole numbers know only `step`. At a key the key's value comes back, bit for bit,
/// and nothing between two keys leaves their interval.
struct Setting {
  struct Key {
    double frame;
    Value value;
  };
  std::vector<Key> keys;  ///< ascending in frame; one key = constant
  Interpolation interpolation = Interpolation::linear;
  Location where;
  bool is_default = true;  ///< nobody said anything: a knob follows `tolerance`

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
  /// "sky", "true", "[0.1, 0.2, 0.3]", "{ frames = [1, 9], values = [0, 1] }"), checked
  /// like the scene file. Throws Error "--set height_fog.densty: no such parameter; did
  /// you mean density?".
  void set(std::string_view name, std::string_view text, const Location&,
           std::string_view owner);
};

/// Checks kind, count, range and word; throws Error{where, "height_fog.density = -3",
/// "allowed 0 to 10 per m"}. NaN is never allowed, inf only where the spec says
/// `infinite` or its default is inf.
void check(const ParamSpec&, const Value&, const Location&, std::string_view owner);

/// The nearest of `names` by edit distance (a prefix counts as near), or "" when none is
/// near.
std::string nearest_name(std::string_view wrong, std::span<const std::string> names);

std::string print(const ParamSpec&,
                  const Value&);  ///< as TOML; parses back to the same bits
std::string print(const ParamSpec&, const Setting&);  ///< keyframes too

/// The range of a spec in words, "0 to 10 per m"; empty where everything goes.
std::string range_text(const ParamSpec&);

/// JSON schema (draft 2020-12) of a table with these parameters, keyframes included. The
/// document's "title" is the owner.
std::string json_schema(std::string_view owner, std::span<const ParamSpec>);

// ---- the declaration -----------------------------------------------------------------
// A struct declares its parameters once, in one visitor:
//
//   struct HeightFog {
//     Rgb density{0.002, 0.002, 0.002};
//     double falloff = 0.01;
//     template <class V>
//     void describe(V& v) {
//       v("density", density, {.unit = "1/m", .doc = "Extinction at `height`.",
//                              .minimum = 0, .maximum = 10});
//       v("falloff", falloff, {.unit = "1/m", ...});
//     }
//   };
//
// Members may be double, int, bool, Rgb, Vec3, RgbOr (rgb or a word),
// std::vector<double>, std::vector<std::string>, Matrix4, std::string (text, or choice
// when `words` is given). See params/describe.h: specs_of<T>(), assign(T&, span<const
// Value>).

}  // namespace brume
