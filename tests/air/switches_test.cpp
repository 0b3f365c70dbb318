// Where a formula of the integrator changes over to another, its error may not jump: else
// a gradient shows a line. The mean error of 64 numbers before the switch and that of 64
// after it are compared, as single ones waver by their rounding. The same formulas in
// double, good to 1e-12 on either side, say what is right.
//   4 ulp, but for a lamp's glow where it is a difference of two, K (scaled_e1) near less
//   K far: each is off by up to 2 ulp in the mean of neighbours, who share the rounding
//   of poles and series. Near is at most 2 of the answer, so far at most 1: 6 ulp, and 2
//   for what multiplies it. The others, nodes and a difference term by term, are good
//   to 4.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "air/airlight.h"
#include "air/profile.h"
#include "num/random.h"

namespace brume::air {
namespace {

constexpr int kBeside = 64;
constexpr double kOfDepth = 4, kOfSeries = 4, kOfGlow = 8;  // [ulp]

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
  Random r(3);
  double worst = 0;
  int asked = 0;
  for (int i = 0; i < 4000; ++i) {
    const auto draw = [&](double lo, double hi) {
      return float(lo * std::pow(hi / lo, r.uniform()));
    };
    const float s = draw(1e-4, 1e2), h = draw(1e-4, 1e3);
    const float x = (i % 2 ? 1.f : -1.f) * draw(1e-4, 1e3);
    if (s * x < -0.1f) continue;
    const auto brief = [&](float length) {
      const float end = x + length;
      return is_brief(s, std::sqrt(h * h + x * x), std::sqrt(h * h + end * end), length);
    };
    float at = 0;  // the first that is not
    for (float more = 1e4f; at + more != at; more /= 2)
      if (brief(at + more)) at += more;
    while (brief(at)) at = std::nextafter(at, float(INFINITY));
    const double step = step_at(
        at, [&](float l) { return dimmed_lorentzian<float>(s, h, x, x + l, l); },
        [&](double l) { return dimmed_lorentzian<double>(s, h, x, x + l, l); });
    EXPECT_LE(std::abs(step), kOfGlow) << s << " " << h << " " << x << " " << at;
    worst = std::max(worst, std::abs(step));
    ++asked;
  }
  EXPECT_GT(asked, 2000);
  std::printf("%d, largest step %.1f ulp\n", asked, worst);
}

TEST(Switches, TheDimmedGlowWhereItsFarEndLeavesTheSeries) {
  // s m_end = 1/2, before the foot: from a difference term by term to that of two K.
  Random r(4);
  double worst = 0;
  int asked = 0;
  for (int i = 0; i < 4000; ++i) {
    const double s = std::pow(10, r.uniform(-4, 2)), h = r.uniform() * .3 / s,
                 x = r.uniform(-.1, 0) / s, end = std::sqrt(.25 / s / s - h * h);
    const float sf = float(s), hf = float(h), xf = float(x);
    const auto within = [&](float length) {
      const float e = xf + length;
      return sf * std::sqrt(hf * hf + e * e) < kSeriesEnds;
    };
    float at = float(end - x);
    while (!within(at)) at = std::nextafter(at, 0.f);
    while (within(at)) at = std::nextafter(at, float(INFINITY));
    if (is_brief(s, std::hypot(h, x), .5 / s, double(at) * .999)) continue;
    const double step = step_at(
        at, [&](float l) { return dimmed_lorentzian<float>(sf, hf, xf, xf + l, l); },
        [&](double l) { return dimmed_lorentzian<double>(sf, hf, xf, xf + l, l); });
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
