// Random scenes: a printed scene parses back to the same bits; a damaged one is refused
// on one line.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include "scene/scene_file.h"
#include "zoo.h"

namespace brume {
namespace {

std::vector<ParamSpec> specs_for(const std::string& type, const Location& where) {
  if (type != "zoo") throw Error(where.text(), "no such stage");
  return specs_of<Zoo>();
}

class RandomScene {
 public:
  explicit RandomScene(unsigned seed) : rng_(seed) {}

  SceneFile scene() {
    SceneFile s = empty_scene();
    s.tolerance = number({.minimum = 1e-9, .maximum = 1});
    s.has_camera = coin();
    s.has_sun = coin();
    for (Settings* section : {&s.input, &s.time, &s.output}) fill(*section);
    if (s.has_sun) fill(s.sun);
    if (s.has_camera) {
      fill(s.camera);
      const int silent = s.camera.find(coin() ? "look_at" : "rotation");
      s.camera.values[silent] =
          Settings::defaults({s.camera.specs[silent]}).values.front();
    }
    for (unsigned n = rng_() % 4; n > 0; --n) {
      StageEntry stage;
      stage.type = "zoo";
      stage.name = "zoo" + std::to_string(n);
      stage.enabled = coin();
      stage.mask = text();
      const ParamSpec mix{.name = "mix", .minimum = 0, .maximum = 1};
      stage.mix = setting(mix);
      if (coin()) stage.first_frame = -5;
      if (coin()) stage.last_frame = 1e6;
      stage.params = Settings::defaults(specs_of<Zoo>());
      fill(stage.params);
      s.stages.push_back(std::move(stage));
    }
    return s;
  }

  std::mt19937_64& rng() { return rng_; }

 private:
  bool coin() { return rng_() % 2; }

  // Any bits that the range allows.
  double number(const ParamSpec& s) {
    for (int i = 0; i < 50; ++i) {
      const std::uint64_t bits = rng_();
      double x;
      std::memcpy(&x, &bits, 8);
      if (std::isfinite(x) && x >= s.minimum && x <= s.maximum) return x;
    }
    return s.minimum + std::ldexp(double(rng_() >> 11), -53) * (s.maximum - s.minimum);
  }

  std::string text() {
    static const char* const some[] = {
        "", "Z", "depth.####.exr:Z", "a \"b\" \\", "ü 雲", "\n\t\r", "#=[]{}"};
    return some[rng_() % 7];
  }

  Value value(const ParamSpec& s) {
    const auto numbers = [&](std::size_t n) {
      Value v;
      while (n-- > 0) v.numbers.push_back(number(s));
      return v;
    };
    switch (s.kind) {
      case Kind::number:
        return numbers(1);
      case Kind::integer: {
        const double low = std::max(s.minimum, -2147483648.0);
        const double high = std::min(s.maximum, 2147483647.0);
        return {.numbers = {low + double(rng_() % std::uint64_t(high - low + 1))}};
      }
      case Kind::flag:
        return {.numbers = {double(rng_() % 2)}};
      case Kind::rgb:
      case Kind::vec3:
        return numbers(3);
      case Kind::numbers:
        return numbers(rng_() % 5);
      case Kind::matrix:
        return numbers(16);
      case Kind::text:
        return {.text = text()};
      case Kind::choice:
        return {.text = s.words[rng_() % s.words.size()]};
      case Kind::texts: {
        Value v;
        for (unsigned n = rng_() % 4; n > 0; --n) v.texts.push_back(text());
        return v;
      }
    }
    return {};
  }

  Setting setting(const ParamSpec& s) {
    Setting out;
    out.is_default = false;
    const bool word = s.kind == Kind::rgb && !s.words.empty() && coin();
    const bool steps = word || s.kind == Kind::integer || s.kind == Kind::flag ||
                       s.kind == Kind::text || s.kind == Kind::choice ||
                       s.kind == Kind::texts;
    double frame = double(int(rng_() % 2000)) - 1000;
    const unsigned keys = s.animatable && coin() ? 1 + rng_() % 4 : 1;
    for (unsigned i = 0; i < keys; ++i) {
      Value v = word ? Value{.text = s.words[rng_() % s.words.size()]} : value(s);
      if (s.kind == Kind::numbers) v.numbers.resize(2, 1);
      out.keys.push_back({keys == 1 ? 0 : frame, std::move(v)});
      frame += std::ldexp(double(1 + rng_() % 1000), -3);
    }
    static const Interpolation ways[] = {Interpolation::linear, Interpolation::smooth,
                                         Interpolation::step};
    out.interpolation = steps ? Interpolation::step : ways[rng_() % 3];
    return out;
  }

  void fill(Settings& s) {
    for (std::size_t i = 0; i < s.specs.size(); ++i)
      if (rng_() % 4 != 0) s.values[i] = setting(s.specs[i]);
  }

  std::mt19937_64 rng_;
};

bool same(const Value& a, const Value& b) {
  return a.text == b.text && a.texts == b.texts && a.numbers.size() == b.numbers.size() &&
         (a.numbers.empty() ||
          std::memcmp(a.numbers.data(), b.numbers.data(), 8 * a.numbers.size()) == 0);
}

bool same(const Setting& a, const Setting& b) {
  if (a.keys.size() != b.keys.size()) return false;
  if (a.animated() && a.interpolation != b.interpolation) return false;
  for (std::size_t i = 0; i < a.keys.size(); ++i)
    if (!same(a.keys[i].value, b.keys[i].value) ||
        (a.animated() && a.keys[i].frame != b.keys[i].frame))
      return false;
  return true;
}

void expect_same(const Settings& a, const Settings& b, const std::string& which) {
  ASSERT_EQ(a.values.size(), b.values.size());
  for (std::size_t i = 0; i < a.values.size(); ++i)
    EXPECT_TRUE(same(a.values[i], b.values[i]))
        << which << "." << a.specs[i].name << ": " << print(a.specs[i], a.values[i])
        << " became " << print(b.specs[i], b.values[i]);
}

TEST(SceneFile, APrintedSceneParsesBackToTheSameBits) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    const SceneFile a = RandomScene(seed).scene();
    const std::string text = print(a);
    SceneFile b;
    try {
      b = parse_scene(text, "printed.toml", specs_for);
    } catch (const Error& e) {
      FAIL() << "seed " << seed << ": " << e.what() << "\n" << text;
    }
    const std::string which = "seed " + std::to_string(seed) + ": ";
    EXPECT_EQ(a.tolerance, b.tolerance) << which;
    EXPECT_EQ(a.has_camera, b.has_camera);
    EXPECT_EQ(a.has_sun, b.has_sun);
    expect_same(a.input, b.input, which + "input");
    expect_same(a.camera, b.camera, which + "camera");
    expect_same(a.sun, b.sun, which + "sun");
    expect_same(a.time, b.time, which + "time");
    expect_same(a.output, b.output, which + "output");
    ASSERT_EQ(a.stages.size(), b.stages.size());
    for (std::size_t i = 0; i < a.stages.size(); ++i) {
      const StageEntry &p = a.stages[i], &q = b.stages[i];
      EXPECT_EQ(p.name, q.name);
      EXPECT_EQ(p.type, q.type);
      EXPECT_EQ(p.enabled, q.enabled);
      EXPECT_EQ(p.mask, q.mask);
      EXPECT_TRUE(same(p.mix, q.mix)) << which;
      EXPECT_EQ(p.first_frame, q.first_frame);
      EXPECT_EQ(p.last_frame, q.last_frame);
      expect_same(p.params, q.params, which + p.name);
    }
    EXPECT_EQ(print(b), text) << which;
  }
}

TEST(SceneFile, ADamagedSceneIsReadOrRefusedOnOneLine) {
  int refused = 0, read = 0;
  for (unsigned seed = 0; seed < 1000; ++seed) {
    RandomScene random(seed % 50);
    std::string text = print(random.scene());
    std::mt19937_64 rng(seed);
    for (unsigned n = 1 + rng() % 2; n > 0; --n) {
      const std::size_t at = rng() % text.size();
      switch (rng() % 4) {
        case 0:
          text[at] = char(rng());
          break;
        case 1:
          text.erase(at, rng() % 20);
          break;
        case 2:
          text.insert(at, text.substr(rng() % text.size(), rng() % 20));
          break;
        default:
          text[at] = "[]{}=\",.#\n-e"[rng() % 12];
      }
    }
    try {
      const SceneFile s = parse_scene(text, "damaged.toml", specs_for);
      // What is read can be printed and read again.
      EXPECT_EQ(print(parse_scene(print(s), "again.toml", specs_for)), print(s));
      ++read;
    } catch (const Error& e) {
      const std::string said = e.what();
      EXPECT_EQ(said.rfind("damaged.toml:", 0), 0u) << "seed " << seed << ": " << said;
      EXPECT_EQ(said.find('\n'), said.npos) << "seed " << seed;
      ++refused;
    }
  }
  EXPECT_GT(refused, 200);
  EXPECT_GT(read, 30);  // both happen, or the test tests nothing
}

}  // namespace
}  // namespace brume
