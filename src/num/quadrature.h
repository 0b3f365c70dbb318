#pragma once
// Integrals. Gauss-Legendre rules of any size, at compile time and at run time, and an
// adaptive integrator for oracles, which want the truth and do not mind the time.

#include <algorithm>
#include <cmath>
#include <vector>

#include "num/polynomial.h"

namespace brume::inline BRUME_ISA_NS {

/// Nodes x in (-1, 1), ascending, and weights w, whose sum is 2.
template <int N>
struct Rule {
  static constexpr int size = N;
  long double x[N], w[N];
};

// Node k (from the right) of n: Newton's iteration on P_n from Tricomi's first guess
// cos(pi (k + 3/4)/(n + 1/2)); w = 2/((1 - x^2) P_n'(x)^2) (Abramowitz & Stegun 25.4.29).
constexpr void legendre_node(int n, int k, long double& x, long double& w) {
  x = cosine(kPi * (k + 0.75L) / (n + 0.5L));
  long double slope = 1, move = 1;
  for (int step = 0; step < 10 && (move > 1e-18L || move < -1e-18L); ++step) {
    // P_{i-1} and P_i, by (i + 1) P_{i+1} = (2 i + 1) x P_i - i P_{i-1}.
    long double before = 1, here = x;
    for (int i = 1; i < n; ++i) {
      const long double next = ((2 * i + 1) * x * here - i * before) / (i + 1);
      before = here;
      here = next;
    }
    slope = n * (before - x * here) / (1 - x * x);
    move = here / slope;
    x -= move;
  }
  w = 2 / ((1 - x * x) * slope * slope);
}

/// The Gauss-Legendre rule with N nodes: exact for polynomials of degree up to 2 N - 1.
template <int N>
constexpr Rule<N> gauss_legendre() {
  Rule<N> rule = {};
  for (int k = 0; k < N; ++k) legendre_node(N, N - 1 - k, rule.x[k], rule.w[k]);
  return rule;
}

/// The same for n >= 1 known only at run time.
struct RuleOfSize {
  std::vector<double> x, w;
};
inline RuleOfSize gauss_legendre(int n) {
  RuleOfSize rule;
  for (int k = n - 1; k >= 0; --k) {
    long double x, w;
    legendre_node(n, k, x, w);
    rule.x.push_back(static_cast<double>(x));
    rule.w.push_back(static_cast<double>(w));
  }
  return rule;
}

/// An integral, what it may be wrong by, and what it cost.
template <class R>
struct Integral {
  R value = 0, error = 0;
  int evaluations = 0;
  bool converged = true;  ///< error is within the tolerance asked for
};

/// The integral of f from a to b (b may be infinite) to |error| <= max(absolute, relative
/// |value|), R = double or long double.
///   Each piece is done with the 15-node Gauss-Legendre rule, whole and as two halves;
///   the halves are summed, and three times the difference bounds their error: far above
///   it where f is smooth, still so at x^(-1/2), where halving gains only 1/sqrt(2). The
///   worst piece is halved until the bounds add up to the tolerance or 20 000 pieces are
///   used up. `breaks` are places where f has a kink, a step or a narrow peak: pieces end
///   there. To infinity, x = a + u/(1 - u).
template <class R, class F>
Integral<R> integrate(F&& f, R a, R b, R relative, R absolute = 0,
                      std::vector<R> breaks = {}) {
  static constexpr auto rule = gauss_legendre<15>();
  struct Piece {
    R lo, hi, left, right, error;  // integrals of the halves
    bool operator<(const Piece& o) const { return error < o.error; }
  };
  const bool endless = std::isinf(b);
  const auto at = [&](R u) { return endless ? a + u / (1 - u) : u; };
  Integral<R> sum;
  const auto gauss = [&](R lo, R hi) {
    const R mid = (lo + hi) / 2, half = (hi - lo) / 2;
    R s = 0;
    for (int k = 0; k < rule.size; ++k) {
      const R u = mid + half * R(rule.x[k]);
      s += R(rule.w[k]) * f(at(u)) * (endless ? 1 / ((1 - u) * (1 - u)) : R(1));
    }
    sum.evaluations += rule.size;
    return s * half;
  };
  const auto piece = [&](R lo, R hi, R whole) {
    const R mid = (lo + hi) / 2, left = gauss(lo, mid), right = gauss(mid, hi);
    return Piece{lo, hi, left, right, 3 * std::abs(left + right - whole)};
  };

  std::vector<R> ends = {endless ? R(0) : a, endless ? R(1) : b};
  for (const R x : breaks) ends.push_back(endless ? (x - a) / (1 + x - a) : x);
  std::sort(ends.begin(), ends.end());
  if (!endless && b < a) std::reverse(ends.begin(), ends.end());
  std::vector<Piece> heap;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i)
    if (ends[i] != ends[i + 1])
      heap.push_back(piece(ends[i], ends[i + 1], gauss(ends[i], ends[i + 1])));
  std::make_heap(heap.begin(), heap.end());

  const auto total = [&] {
    sum.value = sum.error = 0;
    for (const Piece& p : heap) sum.value += p.left + p.right, sum.error += p.error;
    return sum.error <= std::max(absolute, relative * std::abs(sum.value));
  };
  // Totals are taken anew now and then only: their cost grows with the pieces.
  while (!(sum.converged = total()) && heap.size() < 20000) {
    for (std::size_t n = 1 + heap.size() / 4; n > 0; --n) {
      std::pop_heap(heap.begin(), heap.end());
      const Piece p = heap.back();
      heap.pop_back();
      const R mid = (p.lo + p.hi) / 2;
      for (const Piece& half : {piece(p.lo, mid, p.left), piece(mid, p.hi, p.right)}) {
        heap.push_back(half);
        std::push_heap(heap.begin(), heap.end());
      }
    }
  }
  return sum;
}

}  // namespace brume::inline BRUME_ISA_NS
