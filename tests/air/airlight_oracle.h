#pragma once
// The glow of a lamp in uniform fog along a ray, straight from the physics, in long
// double: adaptive quadrature over the ray, no special function.
//
//   Int_a^b e^(-s (t - a) - s_leg r) / r^2 dt,  r = hypot(t - foot, h),
//   s_leg = s (the lamp shines through the fog) or 0 (nothing dims it)

#include <algorithm>
#include <cmath>
#include <vector>

#include "num/quadrature.h"

namespace brume::oracle {

/// s, s_leg [1/m]; h [m] the lamp's distance from the ray's line, `foot` where along it;
/// 0 <= a < b [m], b may be infinite. Relative error about 1e-12, to which its panels
/// agree.
inline long double airlight(long double s, long double s_leg, long double h,
                            long double foot, long double a, long double b) {
  // t = foot + h sinh v makes the peak of 1/r^2 and its tails alike: dt = r dv.
  const auto depth = [=](long double v) {
    return s * (foot + h * std::sinh(v) - a) + s_leg * h * std::cosh(v);
  };
  const auto integrand = [=](long double v) {
    return std::exp(-depth(v)) / (h * std::cosh(v));
  };
  const long double va = std::asinh((a - foot) / h);
  const long double vb = std::isinf(b)
                             ? va + 2 * std::asinh(1e5L * (1 + 1 / (s * h))) + 60
                             : std::asinh((b - foot) / h);
  // Pieces that grow from where light is last dimmed: its depth there may be anything.
  // It only grows, while 1/r grows by less than e^30 for floats: far ends add nothing.
  std::vector<long double> ends;
  long double v = va;
  for (long double step = 1e-9L; v < vb && depth(v) - depth(va) < 90;
       step = std::min(4 * step, 0.75L)) {
    v = std::min(v + step, vb);
    ends.push_back(v);
  }
  return integrate<long double>(integrand, va, v, 1e-12L, 0, ends).value;
}

/// One case of the stiff grid.
struct AirlightCase {
  float s, h, foot, length;
};

/// s 1e-6 to 1e3 per metre, h 1e-4 to 100 m, the foot 50 m behind to 100 m before the
/// ray's beginning, length 1 m to 10 km.
inline std::vector<AirlightCase> stiff_airlight() {
  std::vector<AirlightCase> all;
  for (double s : {1e-6, 1e-4, 1e-2, 0.1, 1., 10., 1e3})
    for (double h : {1e-4, 1e-3, 1e-2, 0.1, 1., 10., 100.})
      for (double foot : {-50., -1., 0., 0.5, 4., 20., 100.})
        for (double length : {1., 10., 100., 1e3, 1e4})
          all.push_back({float(s), float(h), float(foot), float(length)});
  return all;
}

}  // namespace brume::oracle
