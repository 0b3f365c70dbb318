// What every stage does, whoever wrote it: the modules beside this program, and those
// named in BRUME_CONFORMANCE_PLUGINS (files, colons between them).

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "num/error.h"
#include "pipeline/frame_file.h"
#include "pipeline/frames.h"
#include "stress/isas.h"
#include "stress/stress.h"
#include "truth/check.h"

namespace brume::test {
namespace {

namespace fs = std::filesystem;

Registry::Options options() {
  Registry::Options o;
  if (const char* files = std::getenv("BRUME_CONFORMANCE_PLUGINS")) {
    std::istringstream list(files);
    for (std::string file; std::getline(list, file, ':');) o.files.emplace_back(file);
  }
  return o;
}

Registry& registry() {
  static Registry all(options());
  return all;
}

// A stage's example: the file of its folder that names it.
std::string example_of(const std::string& stage) {
  for (const auto& folder : fs::directory_iterator(BRUME_SOURCE_DIR "/plugins")) {
    std::ifstream in(folder.path() / "example.toml");
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    if (text.find("type = \"" + stage + "\"") != text.npos) return text;
  }
  return {};
}

// The example before a small frame, with camera and sun unless it brings its own.
std::string scene_before(std::string text) {
  std::string more;
  if (text.find("[camera]") == text.npos) more += kCamera;
  if (text.find("[sun]") == text.npos) more += "[sun]\nelevation = 20\nazimuth = 40\n";
  const auto at = text.find("[[stage]]");
  return text.insert(at == text.npos ? text.size() : at, more + "\n");
}

class Conformance : public testing::TestWithParam<std::string> {
 protected:
  const StageType& type() { return registry().find(GetParam()); }
  const Window display{0, 0, 61, 37};
  const Pixels pixels = make_pixels(61, 37);

  // What the stage's example makes of the frame; false where there is none to go by.
  bool prepare(const std::string& scene) {
    session_ = std::make_unique<Session>(scene_of(registry(), scene), registry());
    frame_ =
        std::make_unique<PreparedFrame>(session_->prepare(source_of(pixels, display)));
    return true;
  }
  bool from_frame() const {
    for (const InputChannel& c : frame_->inputs())
      if (!c.file.empty() || c.channel.size() != 1) return false;
    return true;
  }
  std::unique_ptr<Session> session_;
  std::unique_ptr<PreparedFrame> frame_;
};

void expect_same(const Result& a, const Result& b, const Window& part, int width) {
  for (std::size_t k = 0; k < b.planes.size(); ++k)
    for (int y = 0; y < part.height; ++y)
      for (int x = 0; x < part.width; ++x) {
        const float got = b.planes[k][std::size_t(y * part.width + x)];
        const float want = a.planes[k][std::size_t((y + part.y) * width + x + part.x)];
        ASSERT_EQ(std::bit_cast<std::uint32_t>(got), std::bit_cast<std::uint32_t>(want))
            << b.names[k] << " at " << x + part.x << ", " << y + part.y << ": " << got
            << ", in the whole frame " << want;
      }
}

TEST_P(Conformance, DefaultsLieWithinTheirOwnRanges) {
  for (const ParamSpec& spec : type().specs) {
    EXPECT_LE(spec.minimum, spec.maximum) << spec.name;
    EXPECT_NO_THROW(check(spec, default_value(spec), {}, GetParam())) << spec.name;
    EXPECT_FALSE(spec.doc.empty()) << spec.name;
  }
}

TEST_P(Conformance, ItsExampleParsesAndPrintsAndParsesBack) {
  const std::string text = example_of(GetParam());
  if (text.empty()) GTEST_SKIP() << "no example.toml names it";
  const std::string once = print(scene_of(registry(), text));
  EXPECT_EQ(print(scene_of(registry(), once)), once);
}

TEST_P(Conformance, ItsExampleRendersTheSameHoweverCut) {
  const std::string text = example_of(GetParam());
  if (text.empty()) GTEST_SKIP() << "no example.toml names it";
  prepare(scene_before(text));
  if (!from_frame()) GTEST_SKIP() << "wants channels of its own";
  const Result whole = apply_whole(*frame_, pixels, display);
  for (const auto& plane : whole.planes)
    for (const float x : plane) ASSERT_TRUE(std::isfinite(x));
  expect_same(whole, apply_whole(*frame_, pixels, display), display, display.width);
  if (frame_->plan().whole_frame) return;
  // Uneven tiles, two threads at once.
  const Window parts[] = {
      {0, 0, 61, 1}, {60, 0, 1, 37}, {3, 5, 17, 11}, {20, 16, 41, 21}};
  Result cut[4];
  std::thread other([&] {
    for (int k : {0, 1}) cut[k] = apply_whole(*frame_, pixels, parts[k]);
  });
  for (int k : {2, 3}) cut[k] = apply_whole(*frame_, pixels, parts[k]);
  other.join();
  for (int k = 0; k < 4; ++k) expect_same(whole, cut[k], parts[k], display.width);
}

TEST_P(Conformance, IdleMeansNoChange) {
  // At its defaults, or with each number in turn at its least.
  for (int at = -1; at < int(type().specs.size()); ++at) {
    std::string text = "version = 1\n[[stage]]\ntype = \"" + GetParam() + "\"\n";
    if (at >= 0) {
      const ParamSpec& spec = type().specs[std::size_t(at)];
      if ((spec.kind != Kind::number && spec.kind != Kind::rgb) || spec.minimum != 0)
        continue;
      text += spec.name + " = 0\n";
    }
    try {
      prepare(scene_before(text));
    } catch (const Error&) {
      continue;  // it asks for what this frame has not
    }
    if (frame_->plan().stages[0].runs || !from_frame()) continue;
    EXPECT_FALSE(frame_->plan().stages[0].reason.empty());
    EXPECT_TRUE(frame_->plan().changes_nothing) << text;
  }
}

TEST_P(Conformance, ChannelsItDidNotDeclareAreNotRead) {
  const std::string text = example_of(GetParam());
  if (text.empty()) GTEST_SKIP() << "no example.toml names it";
  session_ =
      std::make_unique<Session>(scene_of(registry(), scene_before(text)), registry());
  const PreparedFrame f = session_->prepare(
      source_of(pixels, display, {"A", "B", "G", "R", "Z", "junk.nan", "zz"}));
  for (const InputChannel& c : f.inputs()) {
    EXPECT_NE(c.channel, "junk.nan");
    EXPECT_NE(c.channel, "zz");
  }
}

// The sample, small, as a file.
const fs::path& small_frame() {
  static const fs::path file = [] {
    const fs::path out = fs::path(testing::TempDir()) / "conformance_60x34.exr";
    ApplyOptions options;
    options.proxy = 8;
    const Session nothing(scene_of(registry(), "version = 1\n"), registry());
    apply_frame(nothing, 0, BRUME_SOURCE_DIR "/data/valley_validation_480x270.exr", out,
                options);
    return out;
  }();
  return file;
}

TEST_P(Conformance, ItsKnobKeepsWhatItPromises) {
  const auto knob = std::ranges::find_if(
      type().specs, [](const ParamSpec& s) { return s.knob && !s.curve.empty(); });
  const std::string text = example_of(GetParam());
  if (knob == type().specs.end() || text.empty()) GTEST_SKIP() << "no knob with a curve";
  const auto specs = [](const std::string& name, const Location& where) {
    return registry().specs(name, where);
  };
  const auto worst = [&](double value) {
    SceneFile scene = scene_of(registry(), text);
    set(scene, fmt::format("{}.{}={}", GetParam(), knob->name, value), specs);
    const Session session(std::move(scene), registry());
    const truth::Check c = truth::check_frame(session, 0, small_frame(), 60);
    EXPECT_EQ(c.unconverged, 0) << value;
    return c.worst * c.tolerance;
  };
  const std::vector<double>& curve = knob->curve;  // value, error, value, error, ...
  std::vector<double> errors;
  for (const std::size_t k : {std::size_t(0), curve.size() / 4 * 2, curve.size() - 2}) {
    errors.push_back(worst(curve[k]));
    // The other half of the tolerance of 1e-3 is the integrator's.
    EXPECT_LE(errors.back(), curve[k + 1] + 5e-4) << knob->name << " = " << curve[k];
    std::printf("%s = %g: off by %.2g, promised %.2g\n", knob->name.c_str(), curve[k],
                errors.back(), curve[k + 1]);
  }
  EXPECT_LE(errors[2], errors[0]);  // it falls along the knob
}

// A short run of `brume stress`; the truth has its own, longer ones.
TEST_P(Conformance, KeepsTheLawsOfItsKind) {
  StageCache cache;
  const stress::LowerIsas lower(type());
  const stress::Report r =
      stress::run(GetParam(), stress::maker_of(type(), cache, &lower),
                  {.cases = 1280, .seed = 2, .seconds = 4});
  EXPECT_GT(r.cases, 0u);
  for (int k = 0; k < stress::kLaws; ++k) {
    const stress::Law law = stress::Law(k);
    if (law == stress::Law::truth_T || law == stress::Law::truth_L) continue;
    EXPECT_EQ(r.of(law).broken, 0u)
        << stress::name(law) << ", seed 2, case " << r.of(law).worst_case;
  }
  // On every instruction set that there is.
  if (isa() > Isa::v2 && fs::is_regular_file(type().from))
    EXPECT_GT(r.of(stress::Law::isa).checked, 0u);
}

std::vector<std::string> stages() {
  std::vector<std::string> names, broken;
  for (const StageType* type : registry().all(&broken)) names.push_back(type->name);
  for (const std::string& why : broken) ADD_FAILURE() << why;
  return names;
}

INSTANTIATE_TEST_SUITE_P(Stages, Conformance, testing::ValuesIn(stages()),
                         [](const auto& of) { return of.param; });

}  // namespace
}  // namespace brume::test
