// Adaptive Gauss-Legendre quadrature of the density, panel by panel.
//
// The density along a ray changes by a factor e in 1/(c |mu|) metres, which may be a
// micrometre of a ray of 10^9 metres. So that no such layer falls between nodes, panels
// double in width away from both ends of the ray (an exponential is largest at an end),
// from 2^-40 m on; each is halved until its two halves agree with the whole.

#include "oracle.h"

#include <array>
#include <cmath>
#include <limits>

namespace height_fog {
namespace {

using Real = long double;
constexpr int kNodes = 12;

struct Rule {
  std::array<Real, kNodes> x, w;  // on [-1, 1]
};

// Roots of the Legendre polynomial by Newton's method from the usual first guess
// (Abramowitz and Stegun 22.16.6), weights 2 / ((1 - x^2) P'(x)^2) (25.4.29).
Rule gauss_legendre() {
  Rule r;
  for (int i = 0; i < kNodes; ++i) {
    Real x = std::cos(3.141592653589793238462643L * (i + 0.75L) / (kNodes + 0.5L));
    Real slope = 1;
    for (int step = 0; step < 20; ++step) {
      Real p = 1, before = 0;
      for (int n = 1; n <= kNodes; ++n) {
        const Real next = ((2 * n - 1) * x * p - (n - 1) * before) / n;
        before = p;
        p = next;
      }
      slope = kNodes * (x * p - before) / (x * x - 1);
      x -= p / slope;
    }
    r.x[std::size_t(i)] = x;
    r.w[std::size_t(i)] = 2 / ((1 - x * x) * slope * slope);
  }
  return r;
}

template <class F>
Real panel(const F& f, Real a, Real b) {
  static const Rule rule = gauss_legendre();
  const Real middle = (a + b) / 2, half = (b - a) / 2;
  Real sum = 0;
  for (std::size_t i = 0; i < kNodes; ++i)
    sum += rule.w[i] * f(middle + half * rule.x[i]);
  return sum * half;
}

// What is looked for: the integral of f to a relative `noise` that f itself has. `total`
// is what has been found before: a panel that cannot matter to it is not refined.
template <class F>
Real refined(const F& f, Real a, Real b, Real whole, Real total, Real noise, int depth) {
  const Real m = (a + b) / 2, left = panel(f, a, m), right = panel(f, m, b);
  const Real both = left + right;
  if (!(both < std::numeric_limits<Real>::infinity())) return both;
  const Real error = std::abs(both - whole);
  if (depth == 0 || error <= noise * both || error <= 1e-20L * total) return both;
  return refined(f, a, m, left, total, noise, depth - 1) +
         refined(f, m, b, right, total + left, noise, depth - 1);
}

template <class F>
Real integrate(const F& f, Real a, Real b, Real total, Real noise) {
  return refined(f, a, b, panel(f, a, b), total, noise, 40);
}

}  // namespace

Real extinction(const Fog& fog, Real z) {
  return fog.density * std::exp(-fog.falloff * (z - fog.height));
}

Real optical_depth(const Fog& fog, Real z, Real mu, Real t0, Real t1) {
  if (!(t1 > t0)) return 0;
  // An exponent x is rounded to eps |x|, and so is the density.
  const auto noise = [&](Real t) {
    return 1e-14L + 4 * std::numeric_limits<Real>::epsilon() * fog.falloff *
                        (std::abs(z - fog.height) + std::abs(mu) * t);
  };
  const auto near = [&](Real s) { return extinction(fog, z + mu * (t0 + s)); };
  Real total = 0, from = 0;
  if (std::isinf(t1)) {
    // Outward until it has faded and nothing more is added. What has not faded after
    // 2^300 m never does.
    for (int k = -40; k < 300; ++k) {
      const Real to = std::ldexp(1.0L, k);
      const Real more = integrate(near, from, to, total, noise(t0 + to));
      total += more;
      if (std::isinf(total)) return total;
      if (near(to) == 0 && total > 0 && more <= 1e-25L * total) return total;
      from = to;
    }
    return near(from) > 0 ? std::numeric_limits<Real>::infinity() : total;
  }
  // From both ends to the middle, the far half written from the far end.
  const auto far = [&](Real s) { return extinction(fog, z + mu * (t1 - s)); };
  const Real half = (t1 - t0) / 2;
  for (int k = -40; from < half; ++k) {
    const Real to = std::fmin(std::ldexp(1.0L, k), half);
    total += integrate(near, from, to, total, noise(t1));
    total += integrate(far, from, to, total, noise(t1));
    if (std::isinf(total)) return total;
    from = to;
  }
  return total;
}

Real seen(const Fog& fog, Real z, Real mu, Real t) {
  const Real end = -std::log1p(-fog.max_opacity);
  return std::fmin(optical_depth(fog, z, mu, fog.start, t), end);
}

}  // namespace height_fog
