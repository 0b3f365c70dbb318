// f(t) < 0 inside and f convex along a ray, as both shapes are: f's least value by
// ternary search, then each crossing by bisection. Nothing is known of slabs or of
// quadratic equations.

#include "oracle.h"

#include <algorithm>
#include <cmath>

namespace fog_volume {
namespace {

struct Quaternion {
  Real w, x, y, z;
};

Quaternion operator*(const Quaternion& a, const Quaternion& b) {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
          a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
          a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

Quaternion about(int axis, Real degrees) {
  const Real half = degrees * 3.141592653589793238462643L / 360;
  Real v[3] = {0, 0, 0};
  v[axis] = std::sin(half);
  return {std::cos(half), v[0], v[1], v[2]};
}

Real fade(Real u) { return u <= 0 ? 0 : u >= 1 ? 1 : u * u * (3 - 2 * u); }

// Simpson's rule, halved until halves agree with the whole and its least part is small.
template <class F>
Real simpson(const F& f, Real a, Real b, Real fa, Real fm, Real fb, Real whole,
             Real allowed, int depth) {
  const Real m = (a + b) / 2, f1 = f((a + m) / 2), f2 = f((m + b) / 2);
  const Real left = (m - a) / 6 * (fa + 4 * f1 + fm),
             right = (b - m) / 6 * (fm + 4 * f2 + fb);
  const Real error = (left + right - whole) / 15;
  if (depth <= 0 || std::abs(error) <= allowed) return left + right + error;
  return simpson(f, a, m, fa, f1, fm, left, allowed / 2, depth - 1) +
         simpson(f, m, b, fm, f2, fb, right, allowed / 2, depth - 1);
}

// Within 1e-7 of itself or so.
template <class F>
Real integral(const F& f, Real a, Real b) {
  constexpr int n = 24;
  const auto at = [&](int i) { return f(a + (b - a) * i / (2 * n)); };
  Real plain = 0, sum = 0;
  for (int i = 0; i <= 2 * n; ++i) plain += at(i) * (b - a) / (2 * n);
  for (int i = 0; i < n; ++i) {
    const Real fx = at(2 * i), fm = at(2 * i + 1), fy = at(2 * i + 2), h = (b - a) / n;
    sum += simpson(f, a + h * i, a + h * (i + 1), fx, fm, fy, h / 6 * (fx + 4 * fm + fy),
                   1e-7L / n * plain, 20);
  }
  return sum;
}

}  // namespace

Point to_local(const Volume& v, const Point& p, bool is_direction) {
  const Quaternion q =
      about(2, v.degrees[2]) * (about(1, v.degrees[1]) * about(0, v.degrees[0]));
  const Quaternion back = {q.w, -q.x, -q.y, -q.z};
  Point x = p;
  for (std::size_t i = 0; i < 3; ++i) x[i] -= is_direction ? 0 : v.center[i];
  const Quaternion r = back * (Quaternion{0, x[0], x[1], x[2]} * q);
  return {r.x / v.half[0], r.y / v.half[1], r.z / v.half[2]};
}

Depth optical_depth(const Volume& v, const Point& o, const Point& d, Real t_end) {
  const Point lo = to_local(v, o, false), ld = to_local(v, d, true);
  Real away = 0, size = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    away += (o[i] - v.center[i]) * (o[i] - v.center[i]);
    size += v.half[i] * v.half[i];
  }
  const auto f = [&](Real t) {
    Real most = 0, sum = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Real x = lo[i] + t * ld[i];
      most = std::max(most, std::abs(x));
      sum += x * x;
    }
    return v.box ? most - 1 : sum - 1;
  };
  // Beyond this nothing of it is left, were the shift as large as the shape.
  const Real end = std::min(t_end, std::sqrt(away) + 3 * std::sqrt(size));
  Real a = 0, b = end;
  for (int i = 0; i < 115; ++i) {
    const Real third = (b - a) / 3, x = a + third, y = b - third;
    if (f(x) < f(y))
      b = y;
    else
      a = x;
  }
  const Real inside = f(0) <= f((a + b) / 2) ? 0 : (a + b) / 2;
  Depth out;
  if (!(f(inside) < 0)) return out;
  const auto crossing = [&](Real in, Real outside) {
    if (f(outside) < 0) return outside;
    for (int i = 0; i < 75; ++i) {
      const Real m = (in + outside) / 2;
      (f(m) < 0 ? in : outside) = m;
    }
    return in;
  };
  out.t0 = crossing(inside, 0);
  out.t1 = crossing(inside, end);
  Real exponent = 0, slope = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    exponent -= v.falloff * v.gradient[i] * (o[i] + out.t0 * d[i] - v.origin[i]);
    slope += v.falloff * v.gradient[i] * d[i];
  }
  const Real length = out.t1 - out.t0, x = slope * length;
  out.sigma0 = v.density * std::exp(exponent);
  out.sigma1 = v.density * std::exp(exponent - x);
  if (v.softness == 0) {
    out.tau = out.sigma0 * length * (x == 0 ? 1 : -std::expm1(-x) / x);
    return out;
  }
  const auto soft = [&](Real s) {  // s from where it enters
    Real w = 1, r2 = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Real at = (lo[i] + out.t0 * ld[i]) + s * ld[i];
      if (v.box) w *= fade((1 - std::abs(at)) / v.softness);
      r2 += at * at;
    }
    if (!v.box) w = fade((1 - r2) / (v.softness * (2 - v.softness)));
    return w * v.density * std::exp(exponent - slope * s);
  };
  out.sigma0 = soft(0);
  out.sigma1 = soft(length);
  out.tau = integral(soft, 0, length);
  return out;
}

}  // namespace fog_volume
