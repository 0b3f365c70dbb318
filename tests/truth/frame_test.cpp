// A frame by the truth against formulas, and against the product on every kind of pixel.

#include "truth/frame.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "image/io.h"
#include "num/error.h"
#include "pipeline/frames.h"
#include "pipeline/impl.h"
#include "truth/check.h"

namespace brume {
namespace {

namespace fs = std::filesystem;
using test::kCamera;
using test::scene_of;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class TruthFrame : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::temp_directory_path() / ("brume_truth_" + std::to_string(getpid()));
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }

  // The pipeline's pixels (soft edges, background, edges without depth) as a file, with
  // a mask M, and depth as `depth` makes it of Z.
  template <class Depth>
  fs::path write(const Depth& depth, bool alpha = true) {
    test::Pixels p = test::make_pixels(25, 21, 3, 5);
    std::vector<std::string> names{"A", "B", "G", "M", "R", "Z"};
    if (!alpha) names.erase(names.begin());
    Image image;
    image.header = test::source_of(p, {0, 0, 32, 30}, names).header;
    for (Channel& c : image.header.channels) c.type = PixelType::float32;
    for (float& z : p.z) z = depth(z);
    std::vector<float> mask(p.z.size());
    for (std::size_t i = 0; i < mask.size(); ++i)
      mask[i] = i % 7 == 0 ? std::nanf("") : float(i % 5) / 3 - 0.2f;
    for (const Channel& c : image.header.channels)
      image.planes.push_back(c.name == "M" ? mask : test::plane_of(p, c.name));
    write_image(image, folder / "in.exr");
    return folder / "in.exr";
  }
  fs::path write() {
    return write([](float z) { return z; });
  }

  Session session(const std::string& toml) {
    return Session(scene_of(registry, toml), registry);
  }

  // Every pixel of every layer: |product - truth| <= tolerance (1 + |truth|).
  void expect_agreement(const std::string& toml, const fs::path& in,
                        double tolerance = 1e-3) {
    const Session s =
        session("tolerance = 1e-3\n[output]\naovs = [\"T\", \"L\"]\n" + toml);
    const truth::Frame frame(s, 1, in);
    const auto product = frame.product();
    const Window w = frame.window();
    const PreparedFrame::Impl& f = frame.prepared().impl();
    const auto near = [&](int plane, double want, const char* what, int x, int y) {
      const double got =
          double(product[std::size_t(plane)][std::size_t((y - w.y) * w.width + x - w.x)]);
      if (got == want) return;
      EXPECT_LE(std::abs(got - want), tolerance * (1 + std::abs(want)))
          << what << " at " << x << ", " << y;
    };
    for (int y = w.y; y < w.bottom(); ++y)
      for (int x = w.x; x < w.right(); ++x) {
        const truth::Pixel p = frame.pixel(x, y, {});
        EXPECT_TRUE(p.converged);
        for (int c = 0; c < 3; ++c) {
          near(f.color_out.first + c, p.C[c], "C", x, y);
          near(f.T_out.first + c, p.T[c], "T", x, y);
          near(f.L_out.first + c, p.L[c], "L", x, y);
        }
        if (f.alpha_out >= 0) near(f.alpha_out, p.alpha, "A", x, y);
      }
  }

  Registry registry;
  fs::path folder;
};

const std::string kEven = R"(
[[stage]]
type = "height_fog"
density = 0.002
falloff = 0
color = [0.2, 0.5, 3]
)";
// Two media that overlap: the general integrator.
const std::string kTwo = std::string(kEven) + R"(
[[stage]]
type = "height_fog"
name = "ground"
density = [0.001, 0.002, 0.004]
falloff = 0.02
color = 0.4
max_opacity = 0.9
start = 30
)";

TEST_F(TruthFrame, IsTheFormulaOfThePictureInEvenFog) {
  // Centre rows: T = e^{-0.002 d}; coverage a: C = T S + a (1 - T) c + (1 - a) c, as the
  // fog has no end.
  const Session s = session(kCamera + kEven);
  const truth::Frame frame(s, 1, write());
  const double color[3] = {0.2, 0.5, 3};
  const Window w = frame.window();
  int partial = 0;
  for (int y = w.y; y < w.bottom(); ++y)
    for (int x = w.x; x < w.right(); ++x) {
      const truth::Pixel p = frame.pixel(x, y, {});
      const double T = std::exp(-0.002 * p.distance);
      partial += p.coverage > 0 && p.coverage < 1 && p.distance < kInfinity;
      for (int c = 0; c < 3; ++c) {
        const double L = p.coverage * color[c] * (1 - T) + (1 - p.coverage) * color[c];
        EXPECT_NEAR(p.T[c], T, 1e-9);
        EXPECT_NEAR(p.L[c], L, 1e-8);
        EXPECT_NEAR(p.C[c], T * p.S[c] + L, 1e-8 + 1e-9 * p.S[c]);
      }
      EXPECT_NEAR(p.alpha, 1, 1e-12);  // endless fog fills the frame
    }
  EXPECT_GT(partial, 5);  // edges that the neighbour's depth was found for
}

TEST_F(TruthFrame, AgreesWithTheProductOnEdgesSkyAndNoise) {
  expect_agreement(kCamera + kTwo, write());
}

TEST_F(TruthFrame, AgreesUnderMaskAndMix) {
  expect_agreement(kCamera + kTwo + "mask = \"M\"\nmix = 0.7\n", write());
}

TEST_F(TruthFrame, AgreesBeforeAPlate) {
  expect_agreement(
      "[input]\nbackground = \"plate\"\nbackground_distance = 5000\n" + (kCamera + kTwo),
      write());
}

TEST_F(TruthFrame, AgreesWithoutCoverage) {
  expect_agreement(kCamera + kTwo, write([](float z) { return z; }, false));
}

TEST_F(TruthFrame, AgreesForEveryKindOfDepth) {
  expect_agreement(
      "[input]\ndepth_kind = \"distance\"\nmetres = 0.5\n" + (kCamera + kTwo), write());
  expect_agreement("[input]\ndepth_kind = \"inverse\"\n" + (kCamera + kTwo),
                   write([](float z) { return 1 / z; }));
  expect_agreement(
      "[input]\ndepth_kind = \"normalised\"\ndepth_near = 1\ndepth_far = 5000\n" +
          (kCamera + kTwo),
      write([](float z) { return (z - 1) / 4999; }));
}

TEST_F(TruthFrame, AgreesThroughOtherCameras) {
  expect_agreement(
      R"(
[camera]
projection = "orthographic"
position = [0, 0, 500]
look_at = [0, 1000, 0]
ortho_width = 800
)" + kTwo,
      write());
  expect_agreement(R"(
[camera]
projection = "latlong"
position = [0, 0, 50]
look_at = [0, 1000, 50]
)" + kTwo,
                   write());
}

TEST_F(TruthFrame, SharesOfStagesAddUpToTheWhole) {
  const Session s = session(kCamera + kTwo);
  const truth::Frame frame(s, 1, write());
  for (const auto& [x, y] : {std::pair{5, 22}, {20, 15}, {26, 20}}) {
    const truth::Pixel p = frame.pixel(x, y, {.stages = true});
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(p.stage_L[0][c] + p.stage_L[1][c], p.L[c], 1e-6);
      EXPECT_NEAR(p.stage_T[0][c] * p.stage_T[1][c], p.T[c], 1e-6);
    }
  }
}

TEST_F(TruthFrame, AFileHoldsWhatThePixelsAre) {
  const Session s =
      session("[output]\naovs = [\"T\", \"ground.L\"]\n" + (kCamera + kTwo));
  const fs::path in = write();
  ApplyOptions options;
  options.provenance_scene = "x";
  const truth::Rendered made =
      truth::apply_frame(s, 1, in, folder / "out.exr", options, {});
  EXPECT_LE(made.error, 1e-6);
  EXPECT_EQ(made.undecided, 0u);
  const Image out = read_image(folder / "out.exr");
  EXPECT_TRUE(out.header.attributes.contains("brume/scene"));
  const truth::Frame frame(s, 1, in);
  const Window w = frame.window();
  const auto value = [&](const char* channel, int x, int y) {
    return out.planes[std::size_t(out.header.find(channel))]
                     [std::size_t((y - w.y) * w.width + x - w.x)];
  };
  for (const auto& [x, y] : {std::pair{5, 22}, {20, 15}, {26, 20}}) {
    const truth::Pixel p = frame.pixel(x, y, {.stages = true});
    EXPECT_EQ(value("R", x, y), float(p.C[0]));
    EXPECT_EQ(value("T.G", x, y), float(p.T[1]));
    EXPECT_EQ(value("ground.L.B", x, y), float(p.stage_L[1][2]));
    EXPECT_EQ(value("A", x, y), float(p.alpha));
  }
}

TEST_F(TruthFrame, CheckKeepsWhatIsKept) {
  const Session s = session("tolerance = 1e-4\n" + (kCamera + kTwo));
  const truth::Check c = truth::check_frame(s, 1, write(), 300);
  EXPECT_TRUE(c.kept());
  EXPECT_GE(c.pixels, 250);
  EXPECT_LE(c.truth_error, 1e-2);
  EXPECT_EQ(c.unconverged, 0);
  std::vector<std::string> names;
  for (const auto& k : c.classes) names.push_back(k.name);
  for (const char* name : {"evenly", "horizon", "silhouettes", "far", "bright", "sky"})
    EXPECT_NE(std::ranges::find(names, name), names.end()) << name;
}

TEST_F(TruthFrame, CheckFindsAStageWhoseDepthIsAHundredthTooLarge) {
  // `thick` says to the product 1.01 x the density that it has at a point. Its fog is
  // black and S = 0.5 everywhere: |dC| = S (e^-tau - e^-1.01 tau), at most S 0.01 / e.
  Image image = read_image(write());
  for (const char* c : {"R", "G", "B", "A"})
    std::ranges::fill(image.planes[std::size_t(image.header.find(c))],
                      *c == 'A' ? 1 : 0.5f);
  auto& z = image.planes[std::size_t(image.header.find("Z"))];
  for (std::size_t i = 0; i < z.size(); ++i) z[i] = 10 + 2 * float(i);  // m
  write_image(image, folder / "flat.exr");
  const Session s =
      session("tolerance = 1e-3\n[[stage]]\ntype = \"thick\"\n" + std::string(kCamera));
  const truth::Check c = truth::check_frame(s, 1, folder / "flat.exr", 400);
  EXPECT_FALSE(c.kept());
  const double C = 0.5 * std::exp(-1.), most = 0.5 * 0.01 * std::exp(-1.);
  EXPECT_NEAR(c.worst, most / (1e-3 * (1 + C)), 0.02 * c.worst);
  for (const auto& k : c.classes) EXPECT_NEAR(k.dC, 0.5 * k.dT, 1e-6) << k.name;
}

TEST_F(TruthFrame, LensStagesAreLeftOutOfTheCheckAndRefusedByTheTruth) {
  const Session s = session(kCamera + kEven + "[[stage]]\ntype = \"grey\"\n");
  EXPECT_TRUE(truth::check_frame(s, 1, write(), 50).kept());
  EXPECT_THROW(truth::Frame(s, 1, write()), Error);
}

TEST_F(TruthFrame, SurfaceStagesCountWithTheirColourAndCoverage) {
  // `cover` paints 0.25 and covers everything that has a distance.
  const std::string toml = kCamera + kEven + "[[stage]]\ntype = \"cover\"\n";
  expect_agreement(toml, write());
  const Session s = session(toml);
  const truth::Frame frame(s, 1, write());
  int covered = 0;
  const Window w = frame.window();
  for (int y = w.y; y < w.bottom(); ++y)
    for (int x = w.x; x < w.right(); ++x) {
      const truth::Pixel p = frame.pixel(x, y, {});
      if (p.distance == kInfinity) continue;
      ++covered;
      EXPECT_EQ(p.coverage, 1);
      EXPECT_EQ(p.S[0], 0.25);
    }
  EXPECT_GT(covered, 100);
}

TEST_F(TruthFrame, SurfaceStagesFollowEachOtherUnderMaskAndMix) {
  // Light is added, then halved: S1 = C + w 0.001 d, S2 = S1 - 0.4 S1 / 2.
  const std::string toml = kCamera + kEven +
                           "[[stage]]\ntype = \"half\"\nmix = 0.4\n[[stage]]\ntype = "
                           "\"ramp\"\nmask = \"M\"\nmix = 0.7\n";
  const fs::path in = write();
  expect_agreement(toml, in);
  const Session s = session("[output]\naovs = [\"ramp\", \"half\"]\n" + toml);
  const truth::Frame frame(s, 1, in);
  EXPECT_TRUE(frame.unproven().empty());
  const Image file = read_image(in);
  const auto at = [&](const char* channel, std::size_t i) {
    return double(file.planes[std::size_t(file.header.find(channel))][i]);
  };
  const Window w = frame.window();
  int weighted = 0;
  for (std::size_t i = 0; i < std::size_t(w.pixels()); ++i) {
    const int x = w.x + int(i) % w.width, y = w.y + int(i) / w.width;
    const truth::Pixel p = frame.pixel(x, y, {});
    const double m = at("M", i), part = std::isnan(m) ? 0 : .7 * std::clamp(m, 0., 1.);
    const double more = p.distance < kInfinity ? part * 0.001 * p.distance : 0;
    weighted += more > 0;
    for (const auto& [c, name] : {std::pair{0, "R"}, {1, "G"}, {2, "B"}}) {
      const double C = at(name, i);
      if (!std::isfinite(C)) continue;
      EXPECT_NEAR(p.added[0][c], more, 1e-7 * (more + std::abs(C)));
      EXPECT_NEAR(p.added[1][c], -.2 * (C + more), 1e-7 * (more + std::abs(C)));
      EXPECT_NEAR(p.S[c], .8 * (C + more), 1e-7 * (more + std::abs(C)));
      // Half a bit of the distance, and of the colour from stage to stage.
      EXPECT_LE(p.S_error[c], 2e-7 * (more + std::abs(C)));
    }
  }
  EXPECT_GT(weighted, 100);
}

TEST_F(TruthFrame, WhatTheLastBitDecidesIsCountedAndNotHeld) {
  // Every third pixel lies at 100 m, where `step` begins; half a bit is 4e-6 m.
  Image image = read_image(write());
  auto& z = image.planes[std::size_t(image.header.find("Z"))];
  for (std::size_t i = 0; i < z.size(); ++i) z[i] = i % 3 == 0 ? 100.f : float(i);
  for (float& a : image.planes[std::size_t(image.header.find("A"))]) a = 1;
  write_image(image, folder / "steps.exr");
  const Session s = session(std::string("[input]\ndepth_kind = \"distance\"\n") +
                            kCamera + "[[stage]]\ntype = \"step\"\n");
  const truth::Frame frame(s, 1, folder / "steps.exr");
  const Window w = frame.window();
  for (std::size_t i = 0; i < z.size(); ++i) {
    const truth::Pixel p =
        frame.pixel(w.x + int(i) % w.width, w.y + int(i) / w.width, {});
    EXPECT_EQ(p.undecided(1e-3, 1), z[i] == 100.f) << i;
  }
  const truth::Check c = truth::check_frame(s, 1, folder / "steps.exr", 1 << 20);
  EXPECT_TRUE(c.kept());
  EXPECT_EQ(c.undecided, int(std::ranges::count(z, 100.f)));
  EXPECT_LE(c.truth_error, 1e-2);  // of the others
}

TEST_F(TruthFrame, AStageWithoutATruthIsNamed) {
  const Session s = session(kCamera + kEven + "[[stage]]\ntype = \"cover\"\n" +
                            "[[stage]]\ntype = \"ramp\"\n");
  EXPECT_EQ(truth::Frame(s, 1, write()).unproven(), std::vector<std::string>{"cover"});
  EXPECT_EQ(truth::check_frame(s, 1, write(), 50).unproven,
            std::vector<std::string>{"cover"});
}

TEST_F(TruthFrame, LayersOfSurfaceStagesAreInItsFile) {
  const Session s = session(std::string("[output]\naovs = [\"ramp\", \"T\"]\n") +
                            kCamera + kEven + "[[stage]]\ntype = \"ramp\"\nmix = 0.5\n");
  const fs::path in = write();
  truth::apply_frame(s, 1, in, folder / "out.exr", {}, {});
  const Image out = read_image(folder / "out.exr");
  const truth::Frame frame(s, 1, in);
  const Window w = frame.window();
  const auto& ramp = out.planes[std::size_t(out.header.find("ramp.G"))];
  for (const auto& [x, y] : {std::pair{5, 22}, {20, 15}, {26, 20}}) {
    const double d = frame.distance(x, y);
    const float got = ramp[std::size_t((y - w.y) * w.width + x - w.x)];
    EXPECT_NEAR(double(got), d < kInfinity ? .0005 * d : 0, 1e-6 * (1 + double(got)));
  }
}

}  // namespace
}  // namespace brume
