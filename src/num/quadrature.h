#pragma once
// Integrals. Gauss-Legendre rules of any size, at compile time and at run time; an
// adaptive Gauss-Kronrod for oracles, which want the truth and do not mind the time.

#include <cmath>
#include <limits>
#include <queue>
#include <vector>

#include "num/polynomial.h"

namespace brume::inline BRUME_ISA_NS {

/// Nodes x in (-1, 1), ascending, and weights w (sum 2) of a quadrature rule.
template <int N>
struct Rule {
  static constexpr int size = N;
  long double x[N], w[N];
};

// Node k of n by Newton's iteration on P_n from Tricomi's first guess
// cos(pi (k + 3/4)/(n + 1/2)); w = 2/((1 - x^2) P_n'^2) (Abramowitz & Stegun 25.4.29).
constexpr void legendre_node(int n, int k, long double& x, long double& w) {
  x = cosine(kPi * (k + 0.75L) / (n + 0.5L));
  long double slope = 1;
  for (int step = 0; step < 10; ++step) {
    long double before = 1,
                here = x;  // P_{i-1}, P_i by (i+1)P_{i+1} = (2i+1)xP_i - iP_{i-1}
    for (int i = 1; i < n; ++i) {
      const long double next = ((2 * i + 1) * x * here - i * before) / (i + 1);
      before = here;
      here = next;
    }
    slope = n * (before - x * here) / (1 - x * x);
    const long double move = here / slope;
    x -= move;
    if (move < 1e-19L && move > -1e-19L) break;
  }
  w = 2 / ((1 - x * x) * slope * slope);
}

/// The Gauss-Legendre rule with N nodes: exact for polynomials of degree 2N - 1.
template <int N>
constexpr Rule<N> gauss_legendre() {
  Rule<N> rule = {};
  for (int k = 0; k < N; ++k) legendre_node(N, N - 1 - k, rule.x[k], rule.w[k]);
  return rule;
}

}  // namespace brume::inline BRUME_ISA_NS
