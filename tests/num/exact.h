#pragma once
// The same functions by another route: with 64 or 168 significant bits, by series or by
// the C library, whichever does not cancel. R = long double or Big.

#include <boost/math/special_functions/erf.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <limits>

namespace brume::test::exact {

using Big = boost::multiprecision::cpp_bin_float_50;

/// sum of first * ratio(0) * ... * ratio(k), until it no longer changes.
template <class R, class F>
R sum(R first, F ratio) {
  R total = first, term = first;
  for (int k = 0; k < 400; ++k) {
    term *= ratio(k);
    if (total + term == total) break;
    total += term;
  }
  return total;
}

inline long double exprel(long double x) {
  return x == 0 ? 1 : x < -12000 ? INFINITY : -std::expm1(-x) / x;
}

// sum (-x)^k / (k + 2)! near 0; 1 - exprel(x) keeps its digits away from it.
inline long double exprel2(long double x) {
  if (std::abs(x) < 0.5L) return sum(0.5L, [=](int k) { return -x / (k + 3); });
  if (x < -12000) return INFINITY;
  return (1 - exprel(x)) / x;
}

// integral of u^m d e^(-d u) over [0, 1] = e^-d d sum d^k / ((m + 1) ... (m + 1 + k)).
inline long double source_weight(int m, long double d) {
  if (!(d > 0)) return 0;
  const long double t = std::exp(-d);
  if (d < 40) return t * d * sum(1.0L / (m + 1), [=](int k) { return d / (m + 2 + k); });
  const long double e0 = -std::expm1(-d), e1 = e0 / d - t;
  return m == 1 ? e1 : 2 * e1 / d - t;
}

inline long double log_mean(long double a, long double b) {
  const long double hi = std::max(a, b), lo = std::min(a, b);
  if (lo < 0) return NAN;
  if (hi == lo || std::isinf(hi)) return hi;
  if (lo == 0) return 0;
  return (hi - lo) /
         (hi < 2 * lo ? std::log1p((hi - lo) / lo) : std::log(hi) - std::log(lo));
}

// The angle; that of (0, 0) is 0.
inline long double angle(long double y, long double x) {
  return y == 0 ? (x < 0 ? std::acos(-1.0L) : 0) : std::atan2(y, x);
}

inline long double atan_difference(long double a, long double b) {
  return std::atan2(b - a, 1 + a * b);
}

// e^(x^2) erfc(x): x^2 in two exact pieces; its asymptotic series from 8 on.
inline long double erfcx(long double x) {
  if (x >= 8)
    return std::isinf(x) ? 0 : 1 / (x * std::sqrt(std::acos(-1.0L))) * [=] {
      long double total = 1, term = 1;
      for (int k = 0; k < 40; ++k) total += term *= -(2 * k + 1) / (2 * x * x);
      return total;
    }();
  if (x < -110) return INFINITY;
  const long double h = static_cast<float>(x);
  return std::exp(h * h) * std::exp((x - h) * (x + h)) * std::erfc(x);
}

inline Big erf_difference(double a, double b) {
  if (a == b) return 0;
  const auto held = [](double x) { return Big(std::min(std::max(x, -100.0), 100.0)); };
  const Big p = held(a), q = held(b);
  if (std::max(std::abs(a), std::abs(b)) <= 1)
    return boost::math::erf(q) - boost::math::erf(p);
  if (a >= 0 && b >= 0 && std::min(a, b) > 0.1)
    return boost::math::erfc(p) - boost::math::erfc(q);
  if (a < 0 && b < 0 && std::max(a, b) < -0.1)
    return boost::math::erfc(Big(-q)) - boost::math::erfc(Big(-p));
  return boost::math::erf(q) - boost::math::erf(p);
}

/// The discriminant b^2 - a c, and the roots of a x^2 + 2 b x + c.
inline Big discriminant(double a, double b, double c) {
  return Big(b) * Big(b) - Big(a) * Big(c);
}
inline std::pair<Big, Big> roots(double a, double b, double c) {
  const Big root = sqrt(discriminant(a, b, c)),
            q = b < 0 ? Big(root - b) : Big(-b - root);
  const Big inf = std::numeric_limits<Big>::infinity();
  if (a == 0) return {Big(c) / q, inf};
  if (q == 0) return {0, 0};
  const Big x0 = q / Big(a), x1 = Big(c) / q;
  return x0 < x1 ? std::pair{x0, x1} : std::pair{x1, x0};
}

}  // namespace brume::test::exact
