#pragma once
// Polynomials whose coefficients the compiler works out. Every approximation in math.h
// starts from the function's own power series, which a reader can check, and is shortened
// at compile time by Chebyshev economisation; no table of fitted digits is needed.

#include "num/batch.h"

namespace brume::inline BRUME_ISA_NS {

/// c[0] + c[1] x + ... + c[N-1] x^(N-1).
template <int N>
struct Polynomial {
  long double c[N];
};

/// The polynomial at x, by Horner's rule.
template <Real T, int N>
BRUME_INLINE T evaluate(const Polynomial<N>& p, T x) {
  T y = T(static_cast<Scalar_t<T>>(p.c[N - 1]));
#pragma GCC unroll 32
  for (int k = N - 2; k >= 0; --k) y = y * x + T(static_cast<Scalar_t<T>>(p.c[k]));
  return y;
}

/// `p` on [lo, hi] shortened to N terms: from the top, each term x^k is replaced by what
/// the Chebyshev polynomial T_k of the interval leaves of it (Lanczos 1938), which adds
/// the least possible error, |c_k| ((hi - lo)/4)^k 2.
template <int N, int M>
constexpr Polynomial<N> economised(Polynomial<M> p, long double lo, long double hi) {
  // T_k(a + b x) in powers of x for k = 0, 1, ..., by T_{k+1} = 2 (a + b x) T_k -
  // T_{k-1}.
  const long double b = 2 / (hi - lo), a = -(lo + hi) / (hi - lo);
  long double t[M + 1][M + 1] = {};
  t[0][0] = 1;
  t[1][0] = a;
  t[1][1] = b;
  for (int k = 1; k < M; ++k)
    for (int i = 0; i <= k + 1; ++i)
      t[k + 1][i] = 2 * a * t[k][i] + (i > 0 ? 2 * b * t[k][i - 1] : 0) - t[k - 1][i];
  for (int k = M - 1; k >= N; --k) {
    const long double share = p.c[k] / t[k][k];
    for (int i = 0; i <= k; ++i) p.c[i] -= share * t[k][i];
  }
  Polynomial<N> q = {};
  for (int i = 0; i < N; ++i) q.c[i] = p.c[i];
  return q;
}

/// The power series with M terms whose k-th coefficient is coefficient(k).
template <int M, class F>
constexpr Polynomial<M> series(F coefficient) {
  Polynomial<M> p = {};
  for (int k = 0; k < M; ++k) p.c[k] = coefficient(k);
  return p;
}

inline constexpr long double kPi = 3.14159265358979323846264338327950288L;

/// cos(x), |x| <= pi, by its series; for coefficients.
constexpr long double cosine(long double x) {
  long double term = 1, sum = 1;
  for (int k = 2; k < 40; k += 2) sum += term *= -x * x / (k * (k - 1));
  return sum;
}

/// The polynomial with N terms that equals f(y) at the Chebyshev nodes of [-1, 1]: for
/// functions without a usable series (Clenshaw 1955; error close to the least possible).
template <int N, class F>
constexpr Polynomial<N> interpolated(F f) {
  long double t[N + 1][N + 1] = {};  // T_k in powers of y
  t[0][0] = t[1][1] = 1;
  for (int k = 1; k < N; ++k)
    for (int i = 0; i <= k + 1; ++i)
      t[k + 1][i] = (i > 0 ? 2 * t[k][i - 1] : 0) - t[k - 1][i];
  long double share[N] = {};  // of each T_k in f
  for (int j = 0; j < N; ++j) {
    const long double y = cosine(kPi * (j + 0.5L) / N), fy = f(y);
    long double before = y, here = 1;  // T_{k-1}(y), T_k(y)
    for (int k = 0; k < N; ++k) {
      share[k] += (k > 0 ? 2 : 1) * fy / N * here;
      const long double next = 2 * y * here - before;
      before = here;
      here = next;
    }
  }
  Polynomial<N> p = {};
  for (int k = 0; k < N; ++k)
    for (int i = 0; i <= k; ++i) p.c[i] += share[k] * t[k][i];
  return p;
}

/// n!, for coefficients.
constexpr long double factorial(int n) { return n < 2 ? 1 : n * factorial(n - 1); }

}  // namespace brume::inline BRUME_ISA_NS
