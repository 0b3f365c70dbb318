// Facts about glare's convolution, against direct sums.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "convolve.h"
#include "oracle.h"
#include "patterns_test.h"
#include "spectrum.h"

namespace brume::glare {
namespace {

constexpr unsigned kSeed = 19950806;

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

}  // namespace
}  // namespace brume::glare
