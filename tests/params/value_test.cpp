// What a value may be, how it is said, and how it is printed.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "params/describe.h"
#include "zoo.h"

namespace brume {
namespace {

Settings zoo() { return Settings::defaults(specs_of<Zoo>()); }

Value set_to(const std::string& name, const std::string& text) {
  Settings s = zoo();
  s.set(name, text, {"--set"}, "zoo");
  EXPECT_FALSE(s.values[s.find(name)].is_default);
  return s.values[s.find(name)].at(0);
}

std::string refusal(const std::string& name, const std::string& text) {
  Settings s = zoo();
  try {
    s.set(name, text, {"--set"}, "zoo");
  } catch (const Error& e) {
    for (std::size_t i = 0; i < s.values.size(); ++i)
      EXPECT_TRUE(s.values[i].is_default) << "a refused value left its mark";
    return e.what();
  }
  return "accepted";
}

using Numbers = std::vector<double>;

TEST(Value, ADeclarationGivesItsDefaultsAndTakesValuesBack) {
  const Settings s = zoo();
  Zoo z;
  z.density = 0;
  z.layers.clear();
  z.note = "";
  z.source = {{1, 2, 3}, ""};
  assign(z, std::span<const Value>(s.at(0)));
  EXPECT_EQ(z.density, 0.002);
  EXPECT_EQ(z.layers, std::vector<std::string>{"T"});
  EXPECT_EQ(z.note, "plain");
  EXPECT_EQ(z.source.word, "sky");
  EXPECT_EQ(z.count, 3);
  EXPECT_EQ(z.end, std::numeric_limits<double>::infinity());
}

TEST(Value, TheCommandLineSaysValuesAsPeopleWriteThem) {
  EXPECT_EQ(set_to("density", "0.5").numbers, Numbers{0.5});
  EXPECT_EQ(set_to("density", " +5e-1 ").numbers, Numbers{0.5});
  EXPECT_EQ(set_to("tint", "0.5").numbers, (Numbers{0.5, 0.5, 0.5}));
  EXPECT_EQ(set_to("tint", "0.1, 0.2,0.3").numbers, (Numbers{0.1, 0.2, 0.3}));
  EXPECT_EQ(set_to("tint", "[0.1, 0.2, 0.3]").numbers, (Numbers{0.1, 0.2, 0.3}));
  EXPECT_EQ(set_to("color", "sky").text, "sky");
  EXPECT_EQ(set_to("color", "\"sun\"").text, "sun");
  EXPECT_EQ(set_to("source", "1,2,3").numbers, (Numbers{1, 2, 3}));
  EXPECT_EQ(set_to("source", "1,2,3").text, "");
  EXPECT_EQ(set_to("count", "7").numbers, Numbers{7});
  EXPECT_EQ(set_to("on", "false").numbers, Numbers{0});
  EXPECT_EQ(set_to("heights", "3").numbers, Numbers{3});
  EXPECT_EQ(set_to("heights", "[]").numbers, Numbers{});
  EXPECT_EQ(set_to("layers", "T, L,fog.L").texts,
            (std::vector<std::string>{"T", "L", "fog.L"}));
  EXPECT_EQ(set_to("layers", "").texts, std::vector<std::string>{});
  EXPECT_EQ(set_to("note", "a, b = [c]").text, "a, b = [c]");
  EXPECT_EQ(set_to("note", "[x]").text, "[x]");
  EXPECT_EQ(set_to("note", "\"a\\nb\"").text, "a\nb");
  EXPECT_EQ(set_to("shape", "ellipsoid").text, "ellipsoid");
  EXPECT_EQ(set_to("end", "inf").numbers[0], std::numeric_limits<double>::infinity());
  EXPECT_EQ(set_to("frame", "[[1,0,0,5],[0,1,0,6],[0,0,1,7],[0,0,0,1]]").numbers[7], 6);
}

TEST(Value, TheCommandLineTakesKeyframes) {
  Settings s = zoo();
  s.set("density", "{ frames = [1, 3], values = [0, 1], interpolation = \"step\" }",
        {"--set"}, "zoo");
  const Setting& density = s.values[s.find("density")];
  EXPECT_TRUE(density.animated());
  EXPECT_TRUE(s.animated());
  EXPECT_EQ(density.interpolation, Interpolation::step);
  EXPECT_EQ(density.at(2.9).numbers[0], 0);
  s.set("note", "{ frames = [1, 3], values = [\"a\", \"b\"] }", {"--set"}, "zoo");
  EXPECT_EQ(s.values[s.find("note")].at(2).text, "a");
}

struct Case {
  const char *name, *text, *message;
};

TEST(Value, ARefusalSaysWhatStandsThereAndWhatMay) {
  const Case cases[] = {
      {"densty", "1", "--set zoo.densty: no such parameter; did you mean density?"},
      {"DENSITY", "1", "--set zoo.DENSITY: no such parameter; did you mean density?"},
      {"dens", "1", "--set zoo.dens: no such parameter; did you mean density?"},
      {"density", "-3", "--set: zoo.density = -3; allowed 0 to 10 per m"},
      {"density", "nan", "--set: zoo.density = nan; allowed 0 to 10 per m"},
      {"density", "thick", "--set: zoo.density = \"thick\"; must be a number"},
      {"density", "1,2", "--set: zoo.density = [1, 2]; must be a number"},
      {"density", "", "--set: zoo.density = \"\"; must be a number"},
      {"tint", "-1", "--set: zoo.tint = -1; allowed at least 0"},
      {"tint", "0,-1,0", "--set: zoo.tint = -1; allowed at least 0"},
      {"tint", "inf", "--set: zoo.tint = inf; allowed at least 0"},
      {"tint", "1,2", "--set: zoo.tint has 2 numbers; needs 3"},
      {"tint", "[]", "--set: zoo.tint = []; must be a number or [r, g, b]"},
      {"tint", "sky", "--set: zoo.tint = \"sky\"; must be a colour"},
      {"color", "skyy",
       "--set: zoo.color = \"skyy\"; did you mean sky? must be a colour or \"sky\", "
       "\"sun\""},
      {"place", "1", "--set: zoo.place = 1; must be three numbers [x, y, z]"},
      {"place", "1,2,inf", "--set: zoo.place = inf; allowed: finite numbers"},
      {"count", "1.5", "--set: zoo.count = 1.5; must be a whole number"},
      {"count", "0", "--set: zoo.count = 0; allowed 1 to 100"},
      {"seed", "3000000000",
       "--set: zoo.seed = 3000000000; allowed -2147483648 to 2147483647"},
      {"on", "1", "--set: zoo.on = 1; must be true or false"},
      {"on", "yes", "--set: zoo.on = \"yes\"; must be true or false"},
      {"frame", "1,2,3", "--set: zoo.frame has 3 numbers; needs 16"},
      {"shape", "elipsoid",
       "--set: zoo.shape = \"elipsoid\"; did you mean ellipsoid? allowed: \"box\", "
       "\"ellipsoid\""},
      {"note", "\xff\xfe", "--set: zoo.note = \"??\"; must be text in UTF-8"},
      {"seed", "{ frames = [1], values = [1] }",
       "--set: zoo.seed has keyframes; it cannot be animated"},
      {"density", "{ frames = [], values = [] }",
       "--set: zoo.density: keyframes without frames"},
      {"density", "{ frames = [2, 1], values = [1, 2] }",
       "--set: zoo.density: frame 1; frames must ascend"},
      {"density", "{ frames = [1, 1], values = [1, 2] }",
       "--set: zoo.density: frame 1; frames must ascend"},
      {"density", "{ frames = [inf], values = [1] }",
       "--set: zoo.density: frame inf; must be a finite number"},
      {"density", "{ frames = [1], values = [1, 2] }",
       "--set: zoo.density: 1 frames and 2 values; one value for each frame"},
      {"density", "{ frames = [1, 2], values = [1, 11] }",
       "--set: zoo.density = 11; allowed 0 to 10 per m"},
      {"density", "{ frames = [1], vals = [1] }",
       "--set: zoo.density: keyframes have no \"vals\"; did you mean values?"},
      {"density", "{ frames = [1] }",
       "--set: zoo.density: keyframes; write { frames = [1001, 1024], values = [.., ..] "
       "}"},
      {"color", "{ frames = [1, 2], values = [\"sky\", 1] }",
       "--set: zoo.color: words and numbers in one list of keyframes; use one kind"},
      {"color",
       "{ frames = [1, 2], values = [\"sky\", \"sun\"], interpolation = \"linear\" }",
       "--set: zoo.color: interpolation = \"linear\"; only numbers and colours go "
       "between; allowed: \"step\""},
      {"count", "{ frames = [1, 2], values = [1, 2], interpolation = \"smooth\" }",
       "--set: zoo.count: interpolation = \"smooth\"; only numbers and colours go "
       "between; allowed: \"step\""},
      {"heights", "{ frames = [1, 2], values = [[1], [1, 2]] }",
       "--set: zoo.heights: keyframes of different lengths; use one length"},
  };
  for (const Case& c : cases) EXPECT_EQ(refusal(c.name, c.text), c.message);
}

TEST(Value, ARefusalIsOneLineWhateverWasTyped) {
  std::mt19937 rng(4);
  for (int i = 0; i < 5000; ++i) {
    std::string text, name;
    for (unsigned n = rng() % 12; n > 0; --n) text += char(rng());
    static const char* starts[] = {"", "{", "[", "\"", "{ frames = [1], values = ["};
    const Settings s = zoo();
    name = i % 4 == 0 ? text : s.specs[rng() % s.specs.size()].name;
    const std::string said = refusal(name, starts[rng() % 5] + text);
    EXPECT_EQ(said.find_first_of(std::string_view("\n\r\0", 3)), said.npos)
        << "seed 4, case " << i;
    EXPECT_LT(said.size(), 500u);
  }
}

TEST(Value, TheNearestNameIsFoundOrNone) {
  const std::vector<std::string> names{"density", "falloff", "height", "color"};
  EXPECT_EQ(nearest_name("densty", names), "density");
  EXPECT_EQ(nearest_name("dnesity", names), "density");
  EXPECT_EQ(nearest_name("colour", names), "color");
  EXPECT_EQ(nearest_name("Height", names), "height");
  EXPECT_EQ(nearest_name("fall", names), "falloff");
  EXPECT_EQ(nearest_name("wavelength", names), "");
  EXPECT_EQ(nearest_name("x", names), "");
  EXPECT_EQ(nearest_name("", names), "");
}

bool same_bits(const Value& a, const Value& b) {
  return a.text == b.text && a.texts == b.texts && a.numbers.size() == b.numbers.size() &&
         (a.numbers.empty() ||
          std::memcmp(a.numbers.data(), b.numbers.data(), 8 * a.numbers.size()) == 0);
}

TEST(Value, PrintedNumbersReadBackToTheSameBits) {
  std::mt19937_64 rng(5);
  const ParamSpec number{.name = "x", .default_numbers = {0}, .infinite = true};
  Settings s = Settings::defaults({number});
  std::vector<double> hard{0.0,
                           -0.0,
                           5e-324,
                           2.2250738585072014e-308,
                           1.7976931348623157e308,
                           1e16,
                           9007199254740993.0,
                           123456789012345680.0,
                           0.1,
                           1e22,
                           1e23,
                           std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity()};
  for (int i = 0; i < 5000; ++i) {
    const std::uint64_t bits = rng();
    double x;
    std::memcpy(&x, &bits, 8);
    if (!std::isnan(x)) hard.push_back(x);
  }
  for (const double x : hard) {
    const std::string text = print(number, Value{.numbers = {x}});
    s.set("x", "{ frames = [0], values = [" + text + "] }", {"--set"}, "");
    EXPECT_TRUE(same_bits(s.values[0].at(0), {.numbers = {x}})) << text << ", seed 5";
  }
}

TEST(Value, PrintedTextReadsBack) {
  const ParamSpec note{.name = "note", .kind = Kind::text};
  Settings s = Settings::defaults({note});
  for (const std::string text :
       {"", "\"quoted\"", "back\\slash", "line\nline\ttab\r\x01\x7f", "naïve 雲 🌫",
        "{ x }", "'", "\"\"\""}) {
    s.set("note", print(note, Value{.text = text}), {"--set"}, "");
    EXPECT_EQ(s.values[0].at(0).text, text);
  }
}

}  // namespace
}  // namespace brume
