// Numbers and perceptual measures of difference: what their papers say must hold.

#include "truth/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "truth/flip.h"

namespace brume {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

/// Colour planes filled by a function of x, y.
struct Picture {
  int w, h;
  std::array<std::vector<float>, 3> rgb;
  template <class F>
  Picture(int width, int height, F f) : w(width), h(height) {
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const std::array<float, 3> c = f(x, y);
        for (std::size_t i = 0; i < 3; ++i) rgb[i].push_back(c[i]);
      }
  }
  ColorView view() const { return {{rgb[0], rgb[1], rgb[2]}, w, h}; }
  PlaneView plane() const { return {rgb[1], w, h}; }
};
Picture plain(float r, float g, float b) {
  return {24, 24, [=](int, int) { return std::array<float, 3>{r, g, b}; }};
}
Picture noise(unsigned seed, float brightest) {
  std::mt19937 random(seed);
  return {40, 32, [&](int, int) {
            std::array<float, 3> c;
            for (float& x : c) x = brightest * float(random() % 1000) / 1000.f;
            return c;
          }};
}

TEST(Metrics, CountsOfASmallExample) {
  const float a[] = {1, 2, 3, 4}, b[] = {1, 2.5f, 3, 3};
  const Errors e = errors(std::span(a), std::span(b));
  EXPECT_EQ(e.max, 1);
  EXPECT_EQ(e.worst, 3u);
  EXPECT_DOUBLE_EQ(e.mean, 1.5 / 4);
  EXPECT_DOUBLE_EQ(e.rms, std::sqrt(1.25 / 4));
  EXPECT_DOUBLE_EQ(e.relative, .25);
  EXPECT_DOUBLE_EQ(e.psnr(10), 20 * std::log10(10 / std::sqrt(1.25 / 4)));
  EXPECT_EQ(e.p99, 1);
}

TEST(Metrics, NaNAndInfinityArePairsOrBroken) {
  const float a[] = {kNaN, kInf, kInf, 1, kNaN}, b[] = {kNaN, kInf, -kInf, kNaN, 1};
  const Errors e = errors(std::span(a), std::span(b));
  EXPECT_EQ(e.broken, 3u);
  EXPECT_EQ(e.max, 0);
  EXPECT_TRUE(std::isinf(e.psnr()));
}

TEST(Metrics, SsimIsOneForEqualSymmetricAndFallsWithNoise) {
  const Picture a = noise(1, 1), b = noise(2, 1);
  EXPECT_NEAR(ssim(a.plane(), a.plane()), 1, 1e-6);
  EXPECT_NEAR(ssim(a.plane(), b.plane()), ssim(b.plane(), a.plane()), 1e-6);
  EXPECT_LT(ssim(a.plane(), b.plane()), .2);
}

TEST(Metrics, SsimOfFlatPicturesIsTheirLuminanceTerm) {
  // sigma = 0: (2 a b + C1)/(a^2 + b^2 + C1), Wang et al. 2004 eq. 6.
  const double C1 = 1e-4, a = .25, b = .5;
  EXPECT_NEAR(ssim(plain(0, .25f, 0).plane(), plain(0, .5f, 0).plane()),
              (2 * a * b + C1) / (a * a + b * b + C1), 1e-4);  // float sums, C2 = 9e-4
}

TEST(Flip, ZeroForEqualOneAtMostSymmetric) {
  const Picture a = noise(3, 1), b = noise(4, 1);
  for (const float e : ldr_flip(a.view(), a.view()).error) EXPECT_EQ(e, 0);
  const FlipMap ab = ldr_flip(a.view(), b.view()), ba = ldr_flip(b.view(), a.view());
  for (std::size_t i = 0; i < ab.error.size(); ++i) {
    EXPECT_NEAR(ab.error[i], ba.error[i], 1e-6);
    EXPECT_GE(ab.error[i], 0);
    EXPECT_LE(ab.error[i], 1);
  }
  EXPECT_GT(ab.mean, .05);
}

TEST(Flip, GreenAgainstBlueIsTheLargestErrorThereIs) {
  // Section 4.1 of 2020: the redistribution takes their distance to 1.
  EXPECT_NEAR(ldr_flip(plain(0, 1, 0).view(), plain(0, 0, 1).view()).mean, 1, 1e-5);
}

TEST(Flip, BlackAgainstWhiteByHand) {
  // HyAB 100; largest distance |87.735 - 32.297| + |(-75.60, 72.99) - (25.59, -34.85)| =
  // 203.4 (CIELAB of sRGB green and blue, chroma x L/100).
  const double most = std::pow(203.4, .7), d = std::pow(100, .7);
  EXPECT_NEAR(ldr_flip(plain(0, 0, 0).view(), plain(1, 1, 1).view()).mean,
              .95 + (d - .4 * most) / (.6 * most) * .05, 2e-4);  // 203.4 is of 4 digits
}

TEST(Flip, ErrorsGrowWithDifferenceAndFineNoiseCountsLess) {
  const Picture grey = plain(.2f, .2f, .2f);
  double before = 0;
  for (const float step : {.01f, .05f, .2f, .6f}) {
    const double e =
        ldr_flip(grey.view(), plain(.2f + step, .2f + step, .2f + step).view()).mean;
    EXPECT_GT(e, before);
    before = e;
  }
  // A chequerboard of pixels is finer than blue can be seen: most of it is blurred away.
  const Picture blue(24, 24, [](int x, int y) {
    return std::array<float, 3>{.2f, .2f, (x + y) % 2 ? .4f : 0.f};
  });
  EXPECT_LT(ldr_flip(grey.view(), blue.view()).mean,
            .5 * ldr_flip(grey.view(), plain(.2f, .2f, .4f).view()).mean);
}

TEST(Flip, HdrSeesWhatTheBrightestAndTheMedianExposureShow) {
  const Picture a = noise(5, 100);
  Picture b = a;
  EXPECT_EQ(hdr_flip(a.view(), a.view()).mean, 0);
  for (auto& p : b.rgb)
    for (float& x : p) x *= 1.5f;
  const FlipMap map = hdr_flip(a.view(), b.view());
  EXPECT_GT(map.mean, .02);
  EXPECT_LE(map.mean, 1);
  EXPECT_GE(map.exposures, 2);
  EXPECT_LT(map.first_exposure, map.last_exposure);
  // Brightness is relative: the same pair a thousand times brighter is judged the same.
  Picture A = a, B = b;
  for (auto* picture : {&A, &B})
    for (auto& p : picture->rgb)
      for (float& x : p) x *= 100;
  EXPECT_NEAR(hdr_flip(A.view(), B.view()).mean, map.mean, 1e-4);
}

TEST(Flip, NaNAndInfinityAreOfThisWorld) {
  Picture a = noise(6, 1), b = a;
  b.rgb[0][5] = kNaN, b.rgb[1][9] = kInf, b.rgb[2][11] = -3;
  for (const float e : hdr_flip(a.view(), b.view()).error) {
    EXPECT_GE(e, 0);
    EXPECT_LE(e, 1);
  }
}

}  // namespace
}  // namespace brume
