#pragma once
// The glow of a point lamp in uniform fog, in closed form: the airlight integral.
//
//   x     along the ray from the lamp's foot, the point nearest to it [m]
//   h     the lamp's distance from the ray's line [m];  r = hypot(x, h) from the lamp
//   s     extinction [1/m]
//
// A ray from a to b sees, of a lamp that the fog dims too (README of lamps, eq. 3 to 6),
//   Int_a^b e^(-s (x - a + r)) / r^2 dx = 2 e^(-s r_a) Int_{V_a}^{V_b} e^(-s (V - V_a)) /
//   (h^2 + V^2) dV,  V = x + r
// and of one that only the way to the eye dims the same with x in V's place and without
// the factor before it. So all is one integral over a Lorentzian, which is
// Im{e^z E1(z)} (Pegoraro & Parker 2009 have it by series of incomplete gammas).

#include "num/math.h"
#include "num/quadrature.h"

namespace brume::air::inline BRUME_ISA_NS {

// e^x for coefficients: the series of x/2^20, squared as often.
constexpr long double exponential(long double x) {
  x /= 1 << 20;
  long double y = x * (1 + x / 2 * (1 + x / 3 * (1 + x / 4)));  // e^x - 1
  for (int i = 0; i < 20; ++i) y = y * (2 + y);
  return 1 + y;
}

/// Poles t and weights w with Int_0^inf e^-t f(t) dt = Sum w f(t) for f = 1/(z + t).
template <int N>
struct Poles {
  long double t[N], w[N];
};

// The double exponential rule for e^-t (Takahasi & Mori 1974): t = exp(q - e^-q), q in
// even steps from lo to hi.
template <int N>
constexpr Poles<N> double_exponential(long double lo, long double hi) {
  Poles<N> p = {};
  const long double step = (hi - lo) / (N - 1);
  for (int k = 0; k < N; ++k) {
    const long double q = lo + k * step, e = exponential(-q);
    p.t[k] = exponential(q - e);
    p.w[k] = step * p.t[k] * (1 + e) * exponential(-p.t[k]);
  }
  return p;
}

// Gauss' rule for the weight e^-t and polynomials in u = (t - 1)/(t + 1), in which f is
// 1/(a + b u), with its pole at (z + 1)/(z - 1): off [-1, 1] by much wherever |z| >= 1/2,
// and where it comes near an end, e^-t (or the rest of f) is small. So every pole buys a
// digit (12: 1e-8) where even steps buy an eighth of one beyond 1e-6. Made from a finer
// rule's sums (Gautschi 2004, "Orthogonal Polynomials", 2.2.3.1): the recurrence
// p_(k+1) = (u - alpha_k) p_k - beta_k p_(k-1), its roots by counting changes of sign.
template <int N>
constexpr Poles<N> rational_gauss() {
  constexpr int kFine = 96;
  constexpr Poles<kFine> fine = double_exponential<kFine>(-4.2L, 4.6L);
  long double alpha[N] = {}, beta[N] = {}, norm[N] = {};
  long double before[kFine] = {}, here[kFine] = {};
  const auto u = [&](int i) { return (fine.t[i] - 1) / (fine.t[i] + 1); };
  for (int i = 0; i < kFine; ++i) here[i] = 1;
  for (int k = 0; k < N; ++k) {
    long double moment = 0;
    for (int i = 0; i < kFine; ++i) {
      norm[k] += fine.w[i] * here[i] * here[i];
      moment += fine.w[i] * here[i] * here[i] * u(i);
    }
    alpha[k] = moment / norm[k];
    beta[k] = k ? norm[k] / norm[k - 1] : 0;
    for (int i = 0; i < kFine; ++i) {
      const long double next = (u(i) - alpha[k]) * here[i] - beta[k] * before[i];
      before[i] = here[i];
      here[i] = next;
    }
  }
  Poles<N> p = {};
  for (int root = 0; root < N; ++root) {
    long double lo = -1, hi = 1;
    for (int step = 0; step < 66; ++step) {
      const long double at = (lo + hi) / 2;
      int above =
          0;  // roots beyond `at`: signs that change, as all are + beyond the last
      long double p_before = 0, p_here = 1;
      for (int k = 0; k < N; ++k) {
        const long double next = (at - alpha[k]) * p_here - beta[k] * p_before;
        above += (next < 0) != (p_here < 0);
        p_before = p_here;
        p_here = next;
      }
      (N - above <= root ? lo : hi) = at;
    }
    const long double at = (lo + hi) / 2;
    long double sum = 0, p_before = 0, p_here = 1;
    for (int k = 0; k < N; ++k) {
      sum += p_here * p_here / norm[k];
      const long double next = (at - alpha[k]) * p_here - beta[k] * p_before;
      p_before = p_here;
      p_here = next;
    }
    p.t[root] = (1 + at) / (1 - at);
    p.w[root] = 1 / sum;
  }
  return p;
}

// For |z| from where the series ends, in the right half plane: relative error 4e-8 in
// float, 3e-15 in double.
inline constexpr float kSeriesEnds = 0.5f;
template <bool wide>
inline constexpr auto poles = rational_gauss<12>();
template <>
inline constexpr auto poles<true> = rational_gauss<32>();

// Where |z| < 1/2, e^z E1(z) = -e^z (gamma + ln z) + Sum H_k z^k/k!, H_k = 1 + 1/2 + ...
// + 1/k (DLMF 6.6.2 times e^z: the sum solves f' = f + (e^z - 1)/z). Im z^k / y follow
// the recurrence of Chebyshev's U_k: Im{Sum}/y by Clenshaw's rule, m = |z|.
template <Real T>
BRUME_INLINE T harmonic_sum(T x, T m) {
  using S = Scalar_t<T>;
  constexpr int kTerms = is_double<T> ? 16 : 9;
  constexpr auto harmonic = series<kTerms + 1>([](int k) {
    long double H = 0;
    for (int i = 1; i <= k; ++i) H += 1.0L / i;
    return H / factorial(k);
  });
  const T z2 = m * m, x2 = x + x;
  T above(0), here(0);
#pragma GCC unroll 16
  for (int k = kTerms; k >= 1; --k) {
    const T next = T(S(harmonic.c[k])) + x2 * here - z2 * above;
    above = here;
    here = next;
  }
  return here;
}

// Im{e^z (l + i theta)}/y = e^x (sin(y)/y l + cos(y) theta/y), y <= 1/2 (or no matter).
template <Real T>
BRUME_INLINE T turned(T x, T y, T l, T theta_over_y) {
  constexpr auto sine =
      series<10>([](int k) { return (k % 2 ? -1 : 1) / factorial(2 * k + 1); });
  constexpr auto cosine =
      series<10>([](int k) { return (k % 2 ? -1 : 1) / factorial(2 * k); });
  constexpr auto sine_ = economised<(is_double<T> ? 8 : 4)>(sine, 0, 0.25L);
  constexpr auto cosine_ = economised<(is_double<T> ? 8 : 4)>(cosine, 0, 0.25L);
  const T yy = min(y * y, T(1));
  return exp(min(x, T(1))) *
         (evaluate(sine_, yy) * l + evaluate(cosine_, yy) * theta_over_y);
}

// scaled_e1(x, y, m) = -Im{e^z E1(z)}/y = Int_0^inf e^-t / ((x + t)^2 + y^2) dt,
// z = x + i y, m = |z| (given, since x^2 + y^2 may be below the smallest float).
//   |z| >= 1/2: a sum over poles, all terms positive. Below: the series. y is taken as
//   1e-10 x at least, which changes 1e-20 of it.
//   Domain: x >= -0.1, y >= 0, not both 0; below 1e-30 y is taken as that.
//   Relative error (Airlight.TheScaledExponentialIntegral...): float 5e-7, double 1e-12;
//   for x < 0 float 1e-5, double 1e-11.
//   Cost: 15 to 55 ns a batch, by whether a lane needs the series.
template <Real T>
inline T scaled_e1(T x, T y, T m) {
  using S = Scalar_t<T>;
  y = max(max(y, T(S(1e-10)) * abs(x)), T(S(1e-30)));
  const auto small = m < T(kSeriesEnds);
  T sum(0);
  if (!all(small)) {
    constexpr auto p = poles<is_double<T>>;
    const T y2 = y * y;
#pragma GCC unroll 4
    for (std::size_t k = 0; k < sizeof p.t / sizeof p.t[0]; ++k) {
      const T from = x + T(S(p.t[k]));
      sum += T(S(p.w[k])) / (from * from + y2);
    }
  }
  if (none(small)) return sum;
  constexpr long double kEuler = 0.57721566490153286060651209008240243L;
  const T log_z = T(S(kEuler)) + log(max(m, T(S(1e-30))));
  const T by_series = turned(x, y, log_z, atan2pos(y, x) / y) - harmonic_sum(x, m);
  return select(small, by_series, sum);
}

// Whether a stretch is short against its e-folds and against its distance from the lamp,
// m where it begins and m_end where it ends.
template <Real T>
BRUME_INLINE Mask_t<T> is_brief(T s, T m, T m_end, T length) {
  return s * length + length / min(m, m_end) <= T(1);
}

// dimmed_lorentzian = Int_x^end e^(-s (q - x)) / (h^2 + q^2) dq, over length = end - x.
//   = s (K(s x) - e^(-s length) K(s end)), K = scaled_e1(., s h): relative to the answer
//   the difference cancels where little happens on the way, and there seven nodes of
//   Gauss's rule do (16 in double): e-folds and the nearest pole +-i h are two half
//   lengths away at least. Beyond, K(s x) is twice the answer at most, but where x < 0:
//   if the stretch ends before the foot, 8 times and without bound as h falls (pi / h
//   less pi / h); then both ends are within the series, as s x >= -0.1, and the
//   difference is taken term by term: of angles and of logarithms, whose e^z is the same
//   for both. Domain: s > 0, h >= 1e-15, length >= 0 (1e18 is forever), s x >= -0.1.
template <Real T>
inline T dimmed_lorentzian(T s, T h, T x, T end, T length) {
  using S = Scalar_t<T>;
  const T h2 = h * h, m = sqrt(h2 + x * x), m_end = sqrt(h2 + end * end);
  const T depth = s * length;
  const auto brief = is_brief(s, m, m_end, length);
  T by_nodes(0);
  if (any(brief)) {
    constexpr auto rule = gauss_legendre<(is_double<T> ? 16 : 7)>();
    for (int k = 0; k < rule.size; ++k) {
      const T part = T(S((1 + rule.x[k]) / 2)), q = x + part * length;
      by_nodes += T(S(rule.w[k] / 2)) * exp(-depth * part) / (h2 + q * q);
    }
    by_nodes = by_nodes * length;
    if (all(brief)) return by_nodes;
  }
  const T left = exp(-depth);
  const auto within = (x < T(0)) & (s * max(m, m_end) < T(kSeriesEnds)) & (!brief);
  const auto done = brief | within;
  T sum = by_nodes;
  if (any(within)) {
    const T angle = atan2pos(h * length, h2 + x * end) / h;
    const T sums = harmonic_sum(s * x, s * m) - left * harmonic_sum(s * end, s * m_end);
    const T by_series = turned(s * x, s * h, s * log(m / m_end), angle) - s * sums;
    sum = select(within, max(by_series, T(0)), sum);
    if (all(done)) return sum;
  }
  // Those that are done by poles, too: no series for their sake.
  const T near = scaled_e1(s * x, s * h, select(done, T(1), s * m));
  const T far = scaled_e1(s * end, s * h, select(done, T(1), s * m_end));
  return select(done, sum, max(s * (near - left * far), T(0)));
}

/// A stretch of a ray as a lamp sees it.
template <Real T>
struct Sight {
  T h, x, end, length;  ///< from x to end, beyond the foot
  T r;                  ///< the lamp's distance from its beginning
  T V, V_end, V_length;
};

// V = x + r without cancellation before the foot; its increase over a stretch likewise:
// V_b - V_a = (b - a) (V_a + V_b) / (r_a + r_b).
//   h is at least 1e-15 m and 1e-7 |x| (double: 1e-15 |x|): a lamp closer to the ray than
//   its numbers can tell would glow without bound. x and end are at most 1e18 m.
template <Real T>
BRUME_INLINE Sight<T> sight(T h, T x, T end, T length) {
  using S = Scalar_t<T>;
  const T far(S(1e18));
  Sight<T> g;
  g.x = clamp(x, -far, far);
  g.end = min(end, far);
  g.length = min(length, T(S(2e18)));
  g.h = max(h, max(T(S(is_double<T> ? 1e-15 : 1e-7)) * abs(g.x), T(S(1e-15))));
  const T h2 = g.h * g.h;
  const T r_end = sqrt(h2 + g.end * g.end);
  g.r = sqrt(h2 + g.x * g.x);
  const auto V = [&](T q, T r) {
    const T apart = r + abs(q);
    return select(q < T(0), h2 / apart, apart);
  };
  g.V = V(g.x, g.r);
  g.V_end = V(g.end, r_end);
  g.V_length = g.length * ((g.V + g.V_end) / (g.r + r_end));
  return g;
}

// airlight(s, sight) = Int e^(-s (x' - x + r)) / r^2 dx': both ways are dimmed.
//   Domain: s > 0. Where h is 0 and the lamp on the stretch it has no limit; it is then
//   taken as if h were what `sight` makes of it.
//   Relative error over the stiff grid [test Airlight.IsTheIntegral...]: float 1e-5,
//   double 1e-12, and what the exponent s r loses.
template <Real T>
BRUME_INLINE T airlight(T s, const Sight<T>& g) {
  return T(2) * exp(-s * g.r) * dimmed_lorentzian(s, g.h, g.V, g.V_end, g.V_length);
}

// Whether the next has an answer: where the way to the foot is thicker, e^z E1(z) nears
// its branch cut, and the glow is a small difference of large numbers.
template <Real T>
BRUME_INLINE Mask_t<T> clear_leg_is_closed(T s, const Sight<T>& g) {
  return s * g.x >= T(Scalar_t<T>(-0.1));
}

// The same of a lamp that nothing dims on its way to the fog: Int e^(-s (x' - x)) / r^2.
//   Domain: s > 0, where clear_leg_is_closed. Relative error: float 1e-6, double 1e-12.
template <Real T>
BRUME_INLINE T airlight_of_clear_leg(T s, const Sight<T>& g) {
  return dimmed_lorentzian(s, g.h, g.x, g.end, g.length);
}

}  // namespace brume::air::inline BRUME_ISA_NS
