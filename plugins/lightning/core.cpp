#include "core.h"

#include <algorithm>
#include <cmath>

namespace lightning {
namespace {

// Of a pixel's width: so wide is the Gaussian that the pixel is. A row of pixels then
// holds the light of a thin line to 5e-4 wherever the line lies between them.
constexpr double kPixel = 0.65;
constexpr double kBranch = 0.6;
constexpr double kLeast = 1e-3;  // of the trunk's: deviation at the tip of a branch
constexpr double kEven = 4;      // s^2 at the widest place of a stretch, over its least
constexpr int kCuts = 20;        // how often one is halved

Vec3 minus(const Vec3& a, const Vec3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Vec3 plus(const Vec3& a, double t, const Vec3& b) {
  return {a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]};
}
double dot(const Vec3& a, const Vec3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
          a[0] * b[1] - a[1] * b[0]};
}

// Some direction across v, not unit.
Vec3 aside(const Vec3& v) {
  std::size_t least = 0;
  for (std::size_t i = 1; i < 3; ++i)
    if (std::abs(v[i]) < std::abs(v[least])) least = i;
  Vec3 axis{};
  axis[least] = 1;
  return cross(v, axis);
}

// A row of pixels' Gaussian across the stretch as the eye sees it. Of one that points at
// the eye, where any direction is across, some.
brume::FootprintAcross pixel_across(const Sight& sight, const Core& core) {
  const Vec3 way = sight.parallel ? sight.forward : minus(core.middle, sight.eye);
  Vec3 n = cross(way, core.axis);
  double length = std::sqrt(dot(n, n));
  if (length <= 1e-9 * std::sqrt(dot(way, way))) {
    n = aside(core.axis);
    length = std::sqrt(dot(n, n));
  }
  for (double& x : n) x /= length;
  brume::FootprintAcross w = sight.pixel.across(n);
  w.even2 *= kPixel * kPixel;
  w.fan2 *= kPixel * kPixel;
  for (double& x : w.linear) x *= kPixel;
  return w;
}

}  // namespace

double Core::deviation2(double u, double r) const {
  return r * r + pixel(minus(plus(middle, u, axis), eye));
}

double Core::density(const double position[3], const double direction[3]) const {
  const Vec3 x = {position[0], position[1], position[2]};
  const Vec3 d = {direction[0], direction[1], direction[2]};
  // The place nearest to the ray: what is across the ray of middle - x and of the axis.
  const Vec3 c = cross(minus(middle, x), d), e = cross(axis, d);
  const double nearest = std::clamp(-dot(c, e) / (dot(e, e) + 1e-6), -half, half);
  const double r = radius + tapers * nearest, s2 = deviation2(nearest, r);
  const double u = dot(minus(x, middle), axis), s = std::sqrt(2 * s2);
  const Vec3 off = cross(minus(x, middle), axis);
  // erf(b) - erf(a) without cancellation far beyond either end.
  const double a = (-half - u) / s, b = (half - u) / s;
  const double part = a > 0   ? std::erfc(a) - std::erfc(b)
                      : b < 0 ? std::erfc(-b) - std::erfc(-a)
                              : std::erf(b) - std::erf(a);
  return r * r / s2 * std::exp(-dot(off, off) / (2 * s2)) * part / 2;
}

Channel Core::channel() const {
  Channel k;
  const Vec3 y = minus(middle, eye);
  for (std::size_t i = 0; i < 3; ++i) {
    k.middle[i] = float(y[i]);
    k.axis[i] = float(axis[i]);
  }
  k.half = float(half);
  k.radius = float(radius);
  k.tapers = float(tapers);
  k.even2 = float(pixel.even2);
  k.wide = float(dot(pixel.linear, y));
  k.widens = float(dot(pixel.linear, axis));
  k.fan2 = float(pixel.fan2);
  k.tilt2 = float(pixel.tilt2);
  for (std::size_t i = 0; i < 2; ++i) {
    k.level[i][0] = float(dot(pixel.level[i], y));
    k.level[i][1] = float(dot(pixel.level[i], axis));
  }
  return k;
}

// No less than s^2 anywhere on the stretch. All of it is largest at an end but for the
// narrowing of tilted pixels, of which the least counts.
double Core::widest2() const {
  double most = 0, far2 = 0;
  brume::FootprintAcross even = pixel;
  even.fan2 = 0;
  for (const double u : {-half, half}) {
    const Vec3 y = minus(plus(middle, u, axis), eye);
    const double r = radius + tapers * u;
    most = std::max(most, r * r + even(y));
    far2 = std::max(far2, dot(y, y));
  }
  // Nearest to the pole: of a parabola in u.
  const Vec3 y = minus(middle, eye);
  double a = 0, b = 0, c = 0;
  for (const Vec3& v : pixel.level) {
    a += dot(v, axis) * dot(v, axis);
    b += dot(v, axis) * dot(v, y);
    c += dot(v, y) * dot(v, y);
  }
  const double u = a > 0 ? std::clamp(-b / a, -half, half) : 0;
  const double level2 = c + u * (2 * b + u * a), tilted = pixel.tilt2 * far2;
  return most + pixel.fan2 * far2 * (tilted < level2 ? tilted / level2 : 1);
}

bool Core::even() const {
  const Vec3 to_middle = minus(middle, eye);
  const double nearest = std::clamp(-dot(to_middle, axis), -half, half);
  double most = 0, least = INFINITY;
  for (const double u : {-half, nearest, half}) {
    const double s2 = deviation2(u, radius);
    most = std::max(most, s2), least = std::min(least, s2);
  }
  return most <= kEven * least;
}

Core Core::part(double from, double to) const {
  Core c = *this;
  c.middle = plus(middle, (from + to) / 2, axis);
  c.half = (to - from) / 2;
  c.radius = radius + tapers * (from + to) / 2;
  return c;
}

void Core::local_from_world(double matrix[12]) const {
  const double widest = std::sqrt(widest2());
  // Two directions across: any, and the one across both.
  Vec3 side = aside(axis);
  const double length = std::sqrt(dot(side, side));
  for (double& x : side) x /= length;
  const Vec3 rows[3] = {side, cross(axis, side), axis};
  const double reach = kReach * widest, extent[3] = {reach, reach, half + reach};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) matrix[4 * i + k] = rows[i][k] / extent[i];
    matrix[4 * i + 3] = -dot(rows[i], middle) / extent[i];
  }
}

namespace {

// A stretch that comes near the eye is cut until each part is as wide everywhere, within
// a factor of two: its box is no wider than it, and s is that of a place nearby.
void append(const Core& core, int cuts, std::vector<Core>& to) {
  if (cuts == 0 || core.even()) {
    to.push_back(core);
    return;
  }
  append(core.part(-core.half, 0), cuts - 1, to);
  append(core.part(0, core.half), cuts - 1, to);
}

}  // namespace

std::vector<Core> cores(const std::vector<std::vector<Vec3>>& lines, double radius,
                        const Sight& sight) {
  std::vector<Core> all;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const auto& line = lines[k];
    double length = 0, done = 0;
    for (std::size_t i = 1; i < line.size(); ++i)
      length += std::sqrt(dot(minus(line[i], line[i - 1]), minus(line[i], line[i - 1])));
    const auto radius_at = [&](double w) {
      return k == 0 ? radius : radius * std::max(kBranch * (1 - w), kLeast);
    };
    for (std::size_t i = 1; i < line.size(); ++i) {
      const Vec3 way = minus(line[i], line[i - 1]);
      const double L = std::sqrt(dot(way, way));
      if (!(L > 0)) continue;
      Core c;
      c.middle = plus(line[i - 1], 0.5, way);
      for (std::size_t j = 0; j < 3; ++j) c.axis[j] = way[j] / L;
      c.half = L / 2;
      const double r0 = radius_at(done / length), r1 = radius_at((done + L) / length);
      c.radius = (r0 + r1) / 2;
      c.tapers = (r1 - r0) / L;
      c.eye = sight.eye;
      c.pixel = pixel_across(sight, c);
      append(c, kCuts, all);
      done += L;
    }
  }
  return all;
}

}  // namespace lightning
