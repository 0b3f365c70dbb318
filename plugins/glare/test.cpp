// Facts about glare: its patterns, its convolution against direct sums, and the stage
// through the product's own path.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "../../tests/pipeline/frames.h"
#include "../../tests/stage/generated.h"
#include "convolve.h"
#include "image/io.h"
#include "oracle.h"
#include "spectrum.h"
#include "stage/instance.h"

namespace brume::glare {
namespace {

using test::Pixels;
constexpr unsigned kSeed = 19950806;

// A pattern image: a cross, off its middle on one side, so that nothing is symmetric.
std::string pattern_image() {
  const std::string path = testing::TempDir() + "glare_pattern.exr";
  Image image;
  image.header.data_window = image.header.display_window = {0, 0, 31, 31};
  for (const char* c : {"B", "G", "R"})
    image.header.channels.push_back({c, PixelType::float32});
  for (int c = 0; c < 3; ++c) {
    std::vector<float> plane(31 * 31);
    for (int i = 0; i < 31; ++i)
      plane[std::size_t(15 * 31 + i)] = plane[std::size_t(31 * i + 15)] =
          1.f / float(1 + std::abs(i - 15) + c);
    plane[2 * 31 + 3] = 0.5f;
    image.planes.push_back(plane);
  }
  write_image(image, path);
  return path;
}

PatternSettings settings(const std::string& kind) {
  PatternSettings s;
  s.kind = kind;
  s.grid = 1024;
  if (kind == "aperture") s.aperture = 2e-4, s.dust = 5, s.scratches = 2, s.blades = 5;
  if (kind == "image") s.image = pattern_image(), s.image_width = 31 * s.pixel;
  return s;
}

const char* const kKinds[] = {"photopic", "mesopic", "aperture", "image"};

// A dark field, a few of its pixels bright: up to `most`, on edges and corners too.
std::vector<float> sparse(int width, int height, int bright, double most, unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&] { return double(random() >> 8) / (1 << 24); };
  std::vector<float> plane(std::size_t(width * height));
  for (float& v : plane) v = float(0.005 * uniform());
  for (int i = 0; i < bright; ++i)
    plane[random() % plane.size()] = float(most * std::pow(10, -9 * uniform()));
  plane[0] = float(most);
  plane[std::size_t(width) - 1] = float(most / 7);
  return plane;
}

std::vector<float> glared(const Prepared& p, int channel, const std::vector<float>& in,
                          int width, double e) {
  std::vector<float> out = in;
  const Bright bright{in.data(), nullptr, width};
  std::vector<Complex> room;
  convolve(p, channel, bright, room, [&](std::size_t y, const double* c) {
    for (std::size_t x = 0; x < std::size_t(width); ++x) {
      float& v = out[y * std::size_t(width) + x];
      if (std::isfinite(v))
        v = float(v + e * (c[x] - p.kernel.lost[std::size_t(channel)] *
                                      bright.value(x, y, std::size_t(width))));
    }
  });
  return out;
}

TEST(Glare, EveryPixelOfARangeOf1e9IsTheDirectSum) {
  const int width = 90, height = 61;
  double worst = 0;
  for (const char* kind : kKinds)
    for (const int bright :
         {1, 12, 60, 400}) {  // fewer and more than are spread directly
      const auto p =
          prepare(make_kernel(settings(kind), width, height), width, height, kCacheBytes);
      const auto in = sparse(width, height, bright, 5e6, kSeed + unsigned(bright));
      for (const int c : {0, 2}) {
        const auto got = glared(*p, c, in, width, 0.3);
        const auto want = direct(in, width, height, p->kernel, c, 0.3);
        for (std::size_t i = 0; i < got.size(); ++i) {
          const double error = std::abs(double((got[i] - want[i]) / want[i]));
          worst = std::max(worst, error);
          ASSERT_LE(error, 1e-5) << kind << " " << bright << " pixel " << i;  // issue 6
        }
      }
    }
  std::printf("seed %u: relative error <= %.1e\n", kSeed, worst);
}

TEST(Glare, WhatLeavesTheFrameIsTheSumOfEveryPixelThere) {
  // Kernels of a frame and of the whole disc: nothing of it is `beyond` the second, and
  // each of its pixels is looked at by itself. Runs of pixels are good to 1e-7 each.
  for (const char* kind : {"photopic", "mesopic"})
    for (const double pixel : {5e-4, 2e-4}) {
      PatternSettings s = settings(kind);
      s.pixel = pixel;
      s.reach = 700 * pixel;
      const Kernel small = make_kernel(s, 40, 9), whole = make_kernel(s, 800, 800);
      for (int c = 0; c < 3; c += 2) {
        double held = 0;
        for (int y = -8; y <= 8; ++y)
          for (int x = -39; x <= 39; ++x) {
            held += double(whole.at(c, x, y));
            ASSERT_NEAR(small.at(c, x, y) / whole.at(c, x, y), 1, 5e-7) << x << " " << y;
          }
        EXPECT_NEAR(small.beyond[std::size_t(c)], 1 - held, 1e-6) << kind << " " << pixel;
      }
    }
}

TEST(Glare, KeepsItsDigitsWhereItAddsNothing) {
  // The sun at the left, outside the reach of a small pattern: no pixel at the right may
  // change by more than double's noise, 1e-16 x 1e9 x a few, here 5e-7 of 0.005 x e.
  const int width = 120, height = 50;
  const auto p =
      prepare(make_kernel(settings("image"), width, height), width, height, kCacheBytes);
  for (const int suns : {1, 40}) {  // spread directly; by FFT
    std::vector<float> in(std::size_t(width * height), 0.005f);
    for (int i = 0; i < suns; ++i)
      in[std::size_t((i % height) * width + i / height)] = 1e9f;
    const auto out = glared(*p, 1, in, width, 1);
    for (int y = 0; y < height; ++y)
      for (int x = 60; x < width - 20; ++x) {
        const float v = out[std::size_t(y * width + x)];
        if (y >= 20 && y < height - 20) {
          ASSERT_NEAR(v, 0.005, 1e-5 * 0.005) << suns;
        }
        ASSERT_LE(v, 0.005f * 1.00001f) << "wrapped around: " << x << "," << y;
        ASSERT_GE(v, 0) << x << "," << y;
      }
  }
}

TEST(Glare, ASpectrumMadeOnTheWayIsTheOneThatIsHeld) {
  const int width = 70, height = 45;
  const auto in = sparse(width, height, 200, 1e3, kSeed);
  for (const char* kind : kKinds) {
    const auto held =
        prepare(make_kernel(settings(kind), width, height), width, height, kCacheBytes);
    const auto made =
        prepare(make_kernel(settings(kind), width, height), width, height, 0);
    ASSERT_FALSE(held->spectra.empty());
    ASSERT_TRUE(made->spectra.empty());
    const auto a = glared(*held, 2, in, width, 0.5), b = glared(*made, 2, in, width, 0.5);
    for (std::size_t i = 0; i < a.size(); ++i)  // one rounding to float, either way
      ASSERT_NEAR(a[i], b[i], 1.2e-7 * a[i]) << kind;
  }
}

TEST(Glare, NeitherLosesNorMakesLight) {
  // A light whose pattern lies within the frame entirely.
  const int side = 301;
  for (const char* kind : kKinds) {
    PatternSettings s = settings(kind);
    s.reach = 100 * s.pixel;
    if (s.kind == "aperture") s.aperture = 3e-3;
    const auto p = prepare(make_kernel(s, side, side), side, side, kCacheBytes);
    for (const int lights : {1, 30}) {
      std::vector<float> in(std::size_t(side * side));
      for (int i = 0; i < lights; ++i)
        in[std::size_t((140 + i / 8) * side + 140 + i % 8)] = 100.f + float(i);
      for (int c = 0; c < 3; ++c) {
        const auto out = glared(*p, c, in, side, 0.7);
        const double before = std::accumulate(in.begin(), in.end(), 0.),
                     after = std::accumulate(out.begin(), out.end(), 0.);
        const double left = p->kernel.beyond[std::size_t(c)];
        EXPECT_NEAR(after / before, 1 - 0.7 * left, 1e-6) << kind << " " << lights;
        EXPECT_LE(left, 1e-12) << kind;
      }
    }
  }
}

TEST(Glare, WhatLeavesTheFrameIsTheSameInEveryFrame) {
  // A part of a picture glares as the whole does: the kernel of a small frame is the
  // middle of a large one's.
  for (const char* kind : kKinds) {
    const Kernel small = make_kernel(settings(kind), 40, 30),
                 large = make_kernel(settings(kind), 200, 160);
    for (int c = 0; c < 3; ++c)
      for (int y = -29; y <= 29; ++y)
        for (int x = -39; x <= 39; ++x) {
          if (std::abs(x) > large.reach_x || std::abs(y) > large.reach_y) continue;
          ASSERT_NEAR(small.at(c, x, y), large.at(c, x, y),
                      3e-7 * large.at(c, x, y) + (x || y ? 0 : 1e-6))
              << kind;
        }
  }
}

TEST(Glare, PixelsThatAreNoNumbersStayAlone) {
  const int width = 64, height = 48;
  const float inf = std::numeric_limits<float>::infinity();
  const float odd[3] = {std::numeric_limits<float>::quiet_NaN(), inf, -inf};
  for (const int bright : {3, 300}) {
    auto in = sparse(width, height, bright, 1e4, kSeed);
    auto without = in;
    for (std::size_t k = 0; k < 3; ++k) {
      in[1000 + 77 * k] = odd[k];
      without[1000 + 77 * k] = 0;
    }
    const auto p = prepare(make_kernel(settings("photopic"), width, height), width,
                           height, kCacheBytes);
    const auto a = glared(*p, 0, in, width, 0.5), b = glared(*p, 0, without, width, 0.5);
    for (std::size_t i = 0; i < a.size(); ++i) {
      const bool is_odd = i >= 1000 && (i - 1000) % 77 == 0 && (i - 1000) / 77 < 3;
      const float want = is_odd ? in[i] : b[i];
      ASSERT_EQ(std::bit_cast<std::uint32_t>(a[i]), std::bit_cast<std::uint32_t>(want));
    }
  }
}

TEST(GlarePattern, OfARoundApertureIsAiryAtEveryWavelength) {
  PatternSettings s;
  s.kind = "aperture";
  s.blades = 0;
  s.grid = 2048;
  s.aperture = 1e-3;
  const Spectral spectrum(s.chromaticities);
  for (const double step : {0.4, 2.5}) {  // pixels finer and coarser than the rings
    s.pixel = step * 550e-9 / s.aperture;
    const Kernel k = aperture_kernel(s, 65, 65);
    double peak = 0, worst = 0;
    for (int y = 0; y <= 12; ++y)
      for (int x = 0; x <= 12; ++x) {
        Triple want{};
        for (std::size_t i = 0; i < Spectral::kCount; ++i) {
          const double pixel = s.pixel * s.aperture / (spectrum.nm[i] * 1e-9);
          const double e = airy(x, y, pixel);
          for (std::size_t c = 0; c < 3; ++c) want[c] += spectrum.weight[i][c] * e;
        }
        if (x == 0 && y == 0) peak = want[1];
        for (std::size_t c = 0; c < 3; ++c)
          worst = std::max(worst, std::abs(k.at(int(c), x, y) - std::max(0., want[c])));
      }
    // Samples of the intensity are squares a quarter of a pixel wide, or half a lambda /
    // D: they soften the peak by 1 %; what fades at the pattern's end is another.
    EXPECT_LE(worst, 0.02 * peak) << step;
    std::printf("pixel %.1f lambda/D: error <= %.4f of the peak\n", step, worst / peak);
  }
}

TEST(GlarePattern, OfFourBladesHasFourSpikesAndOfFiveTen) {
  PatternSettings s = settings("aperture");
  s.dust = s.scratches = 0;
  s.roundness = 0;
  s.grid = 2048;
  s.aperture = 5e-4;
  for (const int blades : {4, 5}) {
    s.blades = blades;
    const Kernel k = aperture_kernel(s, 400, 400);
    // Energy on a circle, smoothed over 5 degrees: as many maxima as spikes.
    std::vector<double> ring(72);
    for (int y = -120; y <= 120; ++y)
      for (int x = -120; x <= 120; ++x) {
        const double r = std::hypot(x, y);
        if (r < 60 || r > 110 || r > k.reach_x) continue;
        const double phi = std::atan2(y, x) + 2 * std::numbers::pi;
        ring[std::size_t(phi / (2 * std::numbers::pi) * 72 + 0.5) % 72] += k.at(1, x, y);
      }
    const double mean = std::accumulate(ring.begin(), ring.end(), 0.) / 72;
    int spikes = 0;
    for (std::size_t i = 0; i < 72; ++i)
      spikes += ring[i] > 2 * mean && ring[i] >= ring[(i + 71) % 72] &&
                ring[i] > ring[(i + 1) % 72];
    EXPECT_EQ(spikes, blades == 4 ? 4 : 10);
  }
}

TEST(GlarePattern, OfPixelsMuchFinerThanItIsEven) {
  // Within v = pi x 40 pixels x .00024 = .03 of its middle a round aperture's pattern
  // falls by v^2 / 4 = 2.3e-4 (Airy: (2 J1(v) / v)^2), its samples, squares of a quarter
  // or more, not at all; each pixel holds 3e-9 of the whole, and less than a part in 1e6
  // of noise.
  PatternSettings s;
  s.kind = "aperture";
  s.blades = 0;
  s.grid = 1024;
  s.aperture = 1e-5;
  s.pixel = 1.3e-7;
  const Kernel k = make_kernel(s, 41, 41);
  const double middle = k.at(1, 1, 0);
  EXPECT_GT(middle, 0);
  for (int y = -40; y <= 40; ++y)
    for (int x = -40; x <= 40; ++x)
      if (x || y) {
        ASSERT_NEAR(k.at(1, x, y) / middle, 1, 1e-6) << x << " " << y;
      }
  EXPECT_NEAR(81 * 81 * middle + k.beyond[1], 1, 1e-6);  // reach 40
}

TEST(GlarePattern, OfPixelsMuchCoarserThanItStillGivesAway) {
  // The pattern fades out at .96 to 1.8 of the pixel's edge: less and less leaves it,
  // until a float's centre is 1 to the bit; what leaves stays what arrives.
  PatternSettings s;
  s.kind = "aperture";
  s.blades = 0;
  s.grid = 1024;
  s.aperture = 1;
  double least = 1;
  for (const double pixel : {1.2e-4, 2e-4, 2.1e-4, 2.2e-4}) {
    s.pixel = pixel;
    const Kernel k = make_kernel(s, 128, 1);
    double away = k.beyond[1];
    for (int x = 1; x <= k.reach_x; ++x) away += 2. * double(k.at(1, x, 0));
    ASSERT_GT(away, 0) << pixel;
    EXPECT_NEAR(k.lost[1] / away, 1, 1e-12) << pixel;
    least = std::min(least, away);
  }
  EXPECT_LT(least, 6e-8) << "a float holds the centre";
}

TEST(GlarePattern, DustIsThrownByItsSeed) {
  PatternSettings s = settings("aperture");
  const Kernel a = aperture_kernel(s, 60, 60), b = aperture_kernel(s, 60, 60);
  EXPECT_EQ(a.planes, b.planes);
  s.seed = 2;
  EXPECT_NE(a.planes, aperture_kernel(s, 60, 60).planes);
}

TEST(GlarePattern, OfTheEyeScattersAllItsLight) {
  // Spencer's parts are densities per steradian; each integrates to 1 over the
  // hemisphere. Their fits do so to a few percent (f2 has no end: its integral grows with
  // the log of where it is cut).
  for (const char* kind : {"photopic", "scotopic"}) {
    double sum = 0;
    const double degree = std::numbers::pi / 180, step = 1e-3;
    for (double angle = step / 2; angle < 90; angle += step)
      sum += eye_psf(kind, angle, eye_halo(angle, 568)) * 2 * std::numbers::pi * angle *
             step * degree * degree;
    EXPECT_NEAR(sum, 1, 0.05) << kind;
  }
  // The halo stands at 3 degrees in green, farther out in red: 3 lambda / 568.
  EXPECT_GT(eye_halo(3, 568), eye_halo(3.1, 568));
  EXPECT_GT(eye_halo(3.17, 600), eye_halo(3.1, 600));
}

// ---- the stage
// ---------------------------------------------------------------------------

class GlareStage : public testing::Test {
 protected:
  Registry registry;
  Pixels pixels = test::make_pixels(83, 47);

  test::Result run(const std::string& parameters) {
    Session session(test::scene_of(registry, "[[stage]]\ntype = \"glare\"\n" +
                                                 parameters + test::kCamera),
                    registry);
    const PreparedFrame frame = session.prepare(test::source_of(pixels, pixels.window));
    reason = frame.plan().stages.at(0).reason;
    return test::apply_whole(frame, pixels, pixels.window);
  }
  std::string reason;
};

TEST_F(GlareStage, AddsLightWhereThereIsNoCoverage) {
  const test::Result out = run("strength = 0.5\n");
  int outside = 0;
  for (std::size_t i = 0; i < pixels.a.size(); ++i) {
    if (pixels.a[i] == 0) outside += out["G"][i] > 0;
    ASSERT_GE(out["G"][i], 0);
  }
  EXPECT_GT(outside, 1000);
  for (const std::string& name : out.names)
    EXPECT_NE(name, "A") << "coverage is not light";
}

TEST_F(GlareStage, IsTheDirectSumThroughTheWholeProduct) {
  const test::Result out = run("strength = 0.5\npixel_angle = 0.03\n");
  PatternSettings s;
  s.pixel = 0.03 * std::numbers::pi / 180;
  s.reach = 20 * std::numbers::pi / 180;
  const Kernel k = make_kernel(s, 83, 47);
  const auto want = direct(pixels.g, 83, 47, k, 1, 0.5);
  for (std::size_t i = 0; i < want.size(); ++i)
    ASSERT_NEAR(out["G"][i], double(want[i]), 1e-5 * double(want[i]));
}

TEST_F(GlareStage, GivesToNeighboursWhateverTheCentreKeeps) {
  // Pixels of 1800 lambda / D: next to nothing leaves one, but of 1e38 that is seen.
  pixels.g[20 * 83 + 40] = 1e38f;
  const float before = pixels.g[20 * 83 + 41];
  const test::Result out = run(
      "pattern = \"aperture\"\naperture = 1000\nstrength = 1\npixel_angle = 0.0573\n");
  EXPECT_GT(out["G"][20 * 83 + 41], 1e20f) << "was " << before;
}

TEST_F(GlareStage, BelowTheThresholdNothingGlares) {
  // Only green has pixels over 10; a pixel's colour counts as a whole.
  const test::Result out = run("strength = 0.5\nthreshold = 2000\nknee = 0\n");
  for (std::size_t i = 0; i < pixels.g.size(); ++i) ASSERT_EQ(out["G"][i], pixels.g[i]);
  const test::Result some = run("strength = 0.5\nthreshold = 100\nknee = 0.5\n");
  for (std::size_t i = 0; i < pixels.g.size(); ++i)
    ASSERT_TRUE(pixels.g[i] > 50 || some["G"][i] >= pixels.g[i]) << "gave light";
}

TEST_F(GlareStage, SetsInWithoutAStep) {
  // One pixel, brighter and brighter: what it gives grows from 0 at (1 - knee) threshold,
  // with a slope that never jumps.
  double last = 0, slope = 0;
  for (double v = 0.4; v < 2; v += 0.01) {
    for (auto* plane : {&pixels.r, &pixels.g, &pixels.b})
      std::fill(plane->begin(), plane->end(), 0.f);
    pixels.g[20 * 83 + 40] = float(v);
    const double given =
        v - run("strength = 1\nthreshold = 1\nknee = 0.5\n")["G"][20 * 83 + 40];
    if (v > 0.405) {
      // d(part)/dv = (over + k) / (2 k): it grows by .01 in a step of .01 at k = .5;
      // twice that for the parabola's own bend; 1e-4 of light is left out as unseen.
      EXPECT_LE(std::abs((given - last) / 0.01 - slope), 0.02 + 0.011) << v;
      slope = (given - last) / 0.01;
    }
    last = given;
  }
}

TEST_F(GlareStage, LeavesItselfOut) {
  run("strength = 0\n");
  EXPECT_NE(reason.find("strength is 0"), std::string::npos) << reason;
  run("tint = 0\n");
  EXPECT_NE(reason.find("tint is 0"), std::string::npos) << reason;
  // Less light than anyone can see, with the scene's tolerance: the same bits.
  const test::Result out = run("strength = 1e-9\n");
  for (std::size_t i = 0; i < pixels.g.size(); ++i) ASSERT_EQ(out["G"][i], pixels.g[i]);
}

TEST_F(GlareStage, TellsWhatIsWrongWithAnImage) {
  EXPECT_THROW(run("pattern = \"image\"\n"), std::exception);
  EXPECT_THROW(run("pattern = \"image\"\nimage = \"/nowhere.exr\"\n"), std::exception);
  run("pattern = \"image\"\nimage = \"" + pattern_image() + "\"\n");
}

TEST_F(GlareStage, ItsParametersAreInItsReadme) {
  test::expect_generated("plugins/glare/README.md", "parameters",
                         markdown_table(registry.specs("glare")));
}

}  // namespace
}  // namespace brume::glare
