// Facts about glare's patterns: of apertures, of dust and of the eye.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "oracle.h"
#include "patterns_test.h"
#include "spectrum.h"

namespace brume::glare {
namespace {

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

}  // namespace
}  // namespace brume::glare
