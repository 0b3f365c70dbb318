// What every stage does, whoever wrote it. What it leaves alone: conformance_bounds.cpp.

#include "conformance.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <thread>

#include "num/error.h"
#include "pipeline/frame_file.h"
#include "stress/isas.h"
#include "stress/stress.h"
#include "truth/check.h"

namespace brume::test {
namespace {

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
    return c.worst * c.promised;
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
  if (isa() > Isa::v2 && fs::is_regular_file(type().from)) {
    EXPECT_GT(r.of(stress::Law::isa).checked, 0u);
  }
}

BRUME_EVERY_STAGE(Conformance);

}  // namespace
}  // namespace brume::test
