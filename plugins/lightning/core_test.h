#pragma once
// A bolt's core by its definition, and rays and stages to ask the product with.

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "../../tests/stage/through_air.h"
#include "num/quadrature.h"

namespace lightning::test {

using namespace brume;
using namespace brume::test;

inline constexpr float kInf = std::numeric_limits<float>::infinity();
inline constexpr double kEps = std::numeric_limits<float>::epsilon();
inline constexpr double kPixel = 0.65, kRoot2Pi = 2.5066282746310002;

using Point = std::array<double, 3>;
inline Point operator+(const Point& a, const Point& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Point operator*(double t, const Point& a) {
  return {t * a[0], t * a[1], t * a[2]};
}
inline double dot(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline double length(const Point& a) { return std::sqrt(dot(a, a)); }
inline Point unit(const Point& a) { return 1 / length(a) * a; }

// README (4) by its words: every place of a stretch from p to q shines with a Gaussian,
// integrated over the stretch and over the ray, 8 nodes in every two deviations. The eye
// is at 0; r is the channel's deviation. Times sqrt(2 pi) r: per radiance.
inline double light(const Point& p, const Point& q, double r, double pixel,
                    const Ray& ray) {
  const Point o = {ray.o[0], ray.o[1], ray.o[2]}, d = {ray.d[0], ray.d[1], ray.d[2]};
  const Point way = q + -1. * p, a = unit(way);
  const double L = length(way);
  const auto at = [&](double u) { return p + u * a; };
  const auto foot = [&](double u) { return dot(at(u) + -1. * o, d); };
  // The place nearest to the ray, by ternary search; of a stretch along it, its middle.
  const auto away = [&](double u) {
    const Point off = at(u) + -1. * o + -foot(u) * d;
    return dot(off, off) + 1e-6 * (u - L / 2) * (u - L / 2);
  };
  double lo = 0, hi = L;
  for (int i = 0; i < 200; ++i) {
    const double third = (hi - lo) / 3;
    (away(lo + third) > away(hi - third) ? lo : hi) =
        away(lo + third) > away(hi - third) ? lo + third : hi - third;
  }
  const double u0 = (lo + hi) / 2;
  const double s2 = r * r + std::pow(kPixel * pixel, 2) * dot(at(u0), at(u0)),
               s = std::sqrt(s2);
  const auto rule = gauss_legendre<8>();
  const auto over = [&](double a0, double b0, const auto& f) {
    const int panels = std::max(1, int(std::ceil((b0 - a0) / (2 * s))));
    const double half = (b0 - a0) / panels / 2;
    double sum = 0;
    for (int i = 0; i < panels && b0 > a0; ++i)
      for (int k = 0; k < 8; ++k)
        sum += half * double(rule.w[k]) * f(a0 + half * (2 * i + 1 + double(rule.x[k])));
    return sum;
  };
  // Farther along the stretch than 9 deviations across the ray nothing comes.
  const Point across = a + -dot(a, d) * d;
  const double wide = 9 * s / std::max(length(across), 1e-9);
  const double sum = over(std::max(0., u0 - wide), std::min(L, u0 + wide), [&](double u) {
    const double t = foot(u);
    return over(std::max(0., t - 9 * s), std::min(double(ray.t), t + 9 * s),
                [&](double x) {
                  const Point off = o + x * d + -1. * at(u);
                  return std::exp(-dot(off, off) / (2 * s2)) / (kRoot2Pi * s);
                });
  });
  return r * r / s2 * sum / (kRoot2Pi * r);
}

inline Ray toward(const Point& from, const Point& to, double t) {
  const Point d = unit(to + -1. * from);
  Ray ray;
  for (std::size_t i = 0; i < 3; ++i) {
    ray.o[i] = float(from[i]);
    ray.d[i] = float(d[i]);
  }
  ray.t = float(t);
  return ray;
}

inline std::string list(const std::vector<Point>& points) {
  std::string s;
  for (const Point& p : points)
    for (double x : p) s += (s.empty() ? "" : ",") + text(x);
  return s;
}

inline Set line(const std::vector<Point>& points, double radius,
                const char* radiance = "1") {
  return {{"form", "line"},
          {"points", list(points)},
          {"intensity", "0"},
          {"core_radiance", radiance},
          {"core_radius", text(radius)}};
}

inline FrameInfo frame_of(double pixel) {
  FrameInfo f = eye_at(0, 0, 0);
  f.pixel_footprint = pixel;
  return f;
}

}  // namespace lightning::test
