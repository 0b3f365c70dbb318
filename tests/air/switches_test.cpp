// Where a formula of the integrator changes over to another, its error may not jump: else
// a gradient shows a line. The mean error of 64 numbers before the switch and that of 64
// after it are compared, as single ones waver by their rounding. The same formulas in
// double, good to 1e-12 on either side, say what is right.
//   4 ulp, but for a lamp's glow, whose closed form is good to 1e-5: its poles are off by
//   1e-6 near the imaginary axis (20 for 16 of them, a fifth more time, leave 3.5 ulp of
//   the 8), and where the glow is a difference of two that counts up to five times.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "air/airlight.h"
#include "air/profile.h"
#include "num/random.h"

namespace brume::air {
namespace {

constexpr int kBeside = 64;
constexpr double kOfDepth = 4, kOfSeries = 8, kOfGlow = 48;  // [ulp]

/// The step of the mean error [ulp] at the float `at`, the first after the switch.
double step_at(float at, const std::function<float(float)>& made,
               const std::function<double(double)>& wanted) {
  float x = at;
  for (int i = 0; i < kBeside; ++i) x = std::nextafter(x, -INFINITY);
  double before = 0, after = 0;
  for (int i = 0; i < 2 * kBeside; ++i, x = std::nextafter(x, float(INFINITY))) {
    const double want = wanted(double(x));
    int exponent = 0;
    std::frexp(want, &exponent);
    const double off = (double(made(x)) - want) / std::ldexp(1., exponent - 24);
    (i < kBeside ? before : after) += off / kBeside;
  }
  return after - before;
}

TEST(Switches, TheScaledExponentialIntegralAtItsSeries) {
  double worst = 0;
  for (double angle = 0.01; angle < 1.65; angle += 0.03) {
    const double c = std::cos(angle), s = std::sin(angle);
    // x and y are floats for both.
    const auto x = [&](double m) { return float(m * c); };
    const auto y = [&](double m) { return float(m * s); };
    const double step = step_at(
        kSeriesEnds, [&](float m) { return scaled_e1<float>(x(m), y(m), m); },
        [&](double m) {
          return scaled_e1<double>(x(m), y(m), std::hypot(double(x(m)), double(y(m))));
        });
    EXPECT_LE(std::abs(step), kOfSeries) << angle;
    worst = std::max(worst, std::abs(step));
  }
  std::printf("largest step %.1f ulp\n", worst);
}

TEST(Switches, TheDimmedGlowAtItsBriefPieces) {
  // depth + length / m = 1, 0.6 before the foot, m the distance of the lamp, or what
  // stands for it.
  Random r(3);
  double worst = 0;
  int asked = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto draw = [&](double lo, double hi) {
      return float(lo * std::pow(hi / lo, r.uniform()));
    };
    const float s = draw(1e-4, 1e2), h = draw(1e-4, 1e3);
    const float x = (i % 2 ? 1.f : -1.f) * draw(1e-4, 1e3);
    if (s * x < -0.1f) continue;
    const auto brief = [&](float length) {
      return s * length + length / std::sqrt(h * h + x * x) <= 0.5f;
    };
    float at = float(0.5 / (double(s) + 1 / std::hypot(double(h), double(x))));
    while (brief(at)) at = std::nextafter(at, float(INFINITY));
    while (!brief(std::nextafter(at, 0.f))) at = std::nextafter(at, 0.f);
    // Beyond the switch the other form has to have an answer.
    if (x < 0 && h * at < 0.51f * x * (x + at)) continue;
    const double step = step_at(
        at, [&](float l) { return dimmed_lorentzian<float>(s, h, x, x + l, l); },
        [&](double l) { return dimmed_lorentzian<double>(s, h, x, x + l, l); });
    EXPECT_LE(std::abs(step), kOfGlow) << s << " " << h << " " << x << " " << at;
    worst = std::max(worst, std::abs(step));
    ++asked;
  }
  EXPECT_GT(asked, 1000);
  std::printf("%d, largest step %.1f ulp\n", asked, worst);
}

TEST(Switches, HowFarADepthReachesInFogThatIsAllButEven) {
  for (const float slope : {1e-3f, -1e-3f})
    for (const float a : {0.f, 5.f, -5.f}) {
      const Along<float> p = {a, slope, 0};
      const Along<double> q = {double(a), double(slope), 0};
      // slope D / rho(0) = 1e-6
      const auto at = float(1e-6 / 1e-3 * std::exp(double(a)));
      EXPECT_LE(std::abs(step_at(
                    at, [&](float D) { return exponential_reach<float>(p, 0, D); },
                    [&](double D) { return exponential_reach<double>(q, 0, D); })),
                kOfDepth)
          << slope << " " << a;
    }
}

}  // namespace
}  // namespace brume::air
