// Facts about noise fog at the ends of its domain: its kernels are total.

#include <gtest/gtest.h>

#include "fogs_test.h"

namespace {

using namespace brume;
using namespace brume::test;

double power_of_ten(Random& r, double least, double most) {
  return std::pow(10, r.uniform(least, most));
}

// Settings out of all that the parameters allow, seen from anywhere on a planet.
Look extreme_look(Random& r) {
  Look s;
  s.size = power_of_ten(r, -3, 6);
  s.octaves = 1 + int(r.word() % noise_fog::kMostOctaves);
  s.gain = r.uniform();
  s.contrast = r.word() % 4 ? r.uniform(0, 2) : 0;
  s.seed = int(r.uniform(0, 1e6));
  s.period = r.word() % 2 ? 0 : 1 + int(r.word() % 2048);
  s.falloff = r.word() % 4 ? power_of_ten(r, -12, 3) : 0;
  s.height = r.uniform(-1, 1) * power_of_ten(r, 0, 7);
  s.clearing = r.word() % 2 ? 0 : power_of_ten(r, -3, 6);
  s.smoothing = r.word() % 2 ? 0 : int(r.word() % 1025);
  if (r.word() % 2) s.pixel = Footprint(power_of_ten(r, -6, 0)).mean();
  const Point up = unit(r);
  for (std::size_t i = 0; i < 3; ++i) {
    s.up[i] = up[i];
    s.eye[i] = r.uniform(-1, 1) * power_of_ten(r, 0, 7);
    s.shift[i] = r.uniform(-1, 1) * power_of_ten(r, 0, 9);
  }
  const double most = power_of_ten(r, -12, 6);
  for (double& x : s.sigma) x = r.word() % 3 ? most * r.uniform() : 0;
  s.sigma[r.word() % 3] = most;
  if (r.word() % 2) s.start = power_of_ten(r, -3, 9);
  s.tolerance = power_of_ten(r, -7, 0);
  return s;
}

// Any direction, or nearly along the fog's layers, or along an axis.
Point extreme_direction(Random& r, const Look& s) {
  Point d = unit(r);
  if (r.word() % 3 == 0) d = {0, 0, 0}, d[r.word() % 3] = r.word() % 2 ? 1 : -1;
  if (r.word() % 2) {
    double rises = -r.uniform(-1, 1) * power_of_ten(r, -9, -1), n = 0;
    for (std::size_t i = 0; i < 3; ++i) rises += d[i] * s.up[i];
    for (std::size_t i = 0; i < 3; ++i) d[i] -= rises * s.up[i], n += d[i] * d[i];
    if (n < 1e-12) return unit(r);
    for (double& x : d) x /= std::sqrt(n);
  }
  return d;
}

// A level ray enters its fog where a float's next place is 10^7 m away.
Look far_below(Random& r, Point& d) {
  Look s = extreme_look(r);
  s.clearing = 0;
  s.falloff = power_of_ten(r, -4, -1);
  for (double& x : s.eye) x = 0;
  s.height = -r.uniform(100, 1e4) / s.falloff;
  d = unit(r);
  double rises = power_of_ten(r, -16, -7), n = 0;
  for (std::size_t i = 0; i < 3; ++i) rises += d[i] * s.up[i];
  for (std::size_t i = 0; i < 3; ++i) d[i] -= rises * s.up[i], n += d[i] * d[i];
  for (double& x : d) x /= std::sqrt(n);
  return s;
}

void expect_numbers(Random& r, const Look& s, const Point& d, int i) {
  const auto fog = noise_fog::fog_of(s, std::uint64_t(i) + 1);
  Kernel kernel;
  const Isa isa = Isa(r.word() % (unsigned(best_isa()) + 1));
  for (int k = 0; k < 4; ++k) {
    const double t1 = k ? power_of_ten(r, -30, 30) : kInf;
    const double t0 = s.start + (r.word() % 2 ? 0 : power_of_ten(r, -30, 30));
    const double D = kernel.integral(fog, d, t0, t1, isa);
    const double rho = kernel.density(fog, {0, 0, 0}, d, t1, isa);
    EXPECT_TRUE(D >= 0 && std::isfinite(D))
        << i << ", " << name(isa) << ": " << D << " over " << t0 << " to " << t1 << " m";
    EXPECT_TRUE(rho >= 0 && std::isfinite(rho)) << i << ": " << rho << " at " << t1;
  }
}

// Laws of numbers, not of accuracy: of 0 <= D < inf is made 0 <= T <= 1. Over rays up to
// 10^30 m and without end, from any place along them.
TEST(NoiseFogIsTotal, IntegralsAreNumbersWhateverTheFog) {
  Random r(41);
  for (int i = 0; i < 150; ++i) {
    const Look s = extreme_look(r);
    expect_numbers(r, s, extreme_direction(r, s), i);
  }
}

TEST(NoiseFogIsTotal, IntegralsAreNumbersWhereFogIsDenserThanItsStepsAreShort) {
  Random r(42);
  for (int i = 0; i < 100; ++i) {
    Point d;
    const Look s = far_below(r, d);
    expect_numbers(r, s, d, i);
  }
}

}  // namespace
