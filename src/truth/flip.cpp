#include "truth/flip.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace brume {
namespace {

using Planes = std::array<std::vector<float>, 3>;
using Triple = std::array<float, 3>;

// CIE XYZ of Rec.709 (IEC 61966-2-1), and of its white, D65.
constexpr double kXyz[3][3] = {
    {10135552. / 24577794, 8788810. / 24577794, 4435075. / 24577794},
    {2613072. / 12288897, 8788810. / 12288897, 887015. / 12288897},
    {1425312. / 73733382, 8788810. / 73733382, 70074185. / 73733382}};
constexpr double kWhite[3] = {kXyz[0][0] + kXyz[0][1] + kXyz[0][2],
                              kXyz[1][0] + kXyz[1][1] + kXyz[1][2],
                              kXyz[2][0] + kXyz[2][1] + kXyz[2][2]};

// X/Xn, Y/Yn, Z/Zn.
std::array<double, 3> to_xyz(const Triple& rgb) {
  std::array<double, 3> t{};
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) t[i] += kXyz[i][k] * double(rgb[k]);
    t[i] /= kWhite[i];
  }
  return t;
}

struct Inverse {
  double m[3][3];
};
Inverse inverse_xyz() {
  Inverse r;
  const auto& a = kXyz;
  double det = 0;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, k1 = (k + 1) % 3, k2 = (k + 2) % 3;
      r.m[k][i] = a[i1][k1] * a[i2][k2] - a[i1][k2] * a[i2][k1];
      if (i == 0) det += a[0][k] * r.m[k][0];
    }
  for (auto& row : r.m)
    for (double& x : row) x /= det;
  return r;
}
Triple to_rgb(const std::array<double, 3>& t) {
  static const Inverse inverse = inverse_xyz();
  Triple rgb{};
  for (int i = 0; i < 3; ++i) {
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += inverse.m[i][k] * t[k] * kWhite[k];
    rgb[i] = float(std::clamp(sum, 0., 1.));
  }
  return rgb;
}

// The opponent space in which the eye's blur is applied (2020, eq. 1; linear in XYZ).
Triple to_opponent(const Triple& rgb) {
  const auto t = to_xyz(rgb);
  return {float(116 * t[1] - 16), float(500 * (t[0] - t[1])), float(200 * (t[1] - t[2]))};
}
Triple from_opponent(const Triple& o) {
  const double y = (o[0] + 16) / 116.;
  return to_rgb({y + o[1] / 500., y, y - o[2] / 200.});
}

// CIELAB, its chroma scaled by lightness for the Hunt effect.
std::array<double, 3> hunt_lab(const Triple& rgb) {
  std::array<double, 3> f;
  const auto t = to_xyz(rgb);
  for (int i = 0; i < 3; ++i) {
    constexpr double d = 6. / 29;
    f[i] = t[i] > d * d * d ? std::cbrt(t[i]) : t[i] / (3 * d * d) + 4. / 29;
  }
  const double L = 116 * f[1] - 16;
  return {L, .01 * L * 500 * (f[0] - f[1]), .01 * L * 200 * (f[1] - f[2])};
}
double hyab(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

template <class F>
void each(std::size_t n, const F& f) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) f(i);
  });
}

// Contrast sensitivity as sums of Gaussians a sqrt(pi/b) exp(-pi^2 x^2 / b), x in degrees
// (2020, table 1).
struct Csf {
  double a1, b1, a2, b2;
};
constexpr Csf kCsf[3] = {
    {1, .0047, 0, 1e-5}, {1, .0053, 0, 1e-5}, {34.1, .04, 13.5, .025}};

// What the eye sees of a picture: blurred in opponent space, back to light on the screen.
Planes blurred(const Planes& opponent, int w, int h, double ppd) {
  const int r = int(std::ceil(3 * std::sqrt(.04 / (2 * M_PI * M_PI)) * ppd));
  Planes out;
  for (int c = 0; c < 3; ++c) {
    const Csf& s = kCsf[c];
    // Each Gaussian is separable; `total` normalises their sum.
    const auto taps = [&](double b) {
      std::vector<float> k;
      for (int i = -r; i <= r; ++i)
        k.push_back(float(std::exp(-M_PI * M_PI * (i / ppd) * (i / ppd) / b)));
      return k;
    };
    const auto sum = [](const std::vector<float>& k) {
      double t = 0;
      for (const float x : k) t += double(x);
      return t * t;
    };
    const auto k1 = taps(s.b1), k2 = taps(s.b2);
    const double w1 = s.a1 * std::sqrt(M_PI / s.b1), w2 = s.a2 * std::sqrt(M_PI / s.b2);
    const double total = w1 * sum(k1) + w2 * sum(k2);
    out[c] = convolve({opponent[c], w, h}, k1, k1);
    std::vector<float> second;
    if (s.a2 != 0) second = convolve({opponent[c], w, h}, k2, k2);
    each(out[c].size(), [&](std::size_t i) {
      out[c][i] = float((w1 * out[c][i] + (s.a2 != 0 ? w2 * second[i] : 0)) / total);
    });
  }
  return out;
}

// Edges and points of lightness: first and second derivatives of a Gaussian as wide as
// what the eye resolves (2020, section 4.2), positive and negative weights summing to
// +-1.
struct Features {
  std::vector<float> edge, point;
};
Features features(const std::vector<float>& Y, int w, int h, double ppd) {
  const double sigma = .5 * .082 * ppd;
  const int r = int(std::ceil(3 * sigma));
  std::vector<float> g, first, second;
  double g_sum = 0, first_sum = 0, positive = 0, negative = 0;
  std::vector<double> d1, d2;
  for (int i = -r; i <= r; ++i) {
    const double e = std::exp(-i * i / (2 * sigma * sigma));
    g.push_back(float(e));
    g_sum += e;
    d1.push_back(-i * e);
    d2.push_back((i * i / (sigma * sigma) - 1) * e);
    first_sum += std::max(d1.back(), 0.);
    (d2.back() > 0 ? positive : negative) += std::abs(d2.back());
  }
  for (float& x : g) x = float(x / g_sum);
  for (const double x : d1) first.push_back(float(x / first_sum));
  for (const double x : d2) second.push_back(float(x / (x > 0 ? positive : negative)));
  const PlaneView p{Y, w, h};
  const auto length = [](std::vector<float> x, const std::vector<float>& y) {
    each(x.size(), [&](std::size_t i) { x[i] = std::hypot(x[i], y[i]); });
    return x;
  };
  return {length(convolve(p, first, g), convolve(p, g, first)),
          length(convolve(p, second, g), convolve(p, g, second))};
}

// What one picture is turned into before two are compared.
struct Seen {
  Planes blurred;
  Features features;
};
Seen see(const Planes& rgb, int w, int h, double ppd) {
  Planes o;
  for (auto& p : o) p.resize(rgb[0].size());
  std::vector<float> Y(rgb[0].size());
  each(Y.size(), [&](std::size_t i) {
    const Triple t = to_opponent({rgb[0][i], rgb[1][i], rgb[2][i]});
    for (int c = 0; c < 3; ++c) o[c][i] = t[c];
    Y[i] = (t[0] + 16) / 116;
  });
  return {blurred(o, w, h, ppd), features(Y, w, h, ppd)};
}

std::vector<float> compare(const Seen& a, const Seen& b) {
  // The largest distance there is, between green and blue, comes to 1; 0.4 of it to 0.95
  // (2020, section 4.1).
  constexpr double kQc = .7, kPc = .4, kPt = .95, kQf = .5;
  static const double most =
      std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), kQc);
  std::vector<float> error(a.blurred[0].size());
  each(error.size(), [&](std::size_t i) {
    const auto lab = [&](const Seen& s) {
      return hunt_lab(from_opponent({s.blurred[0][i], s.blurred[1][i], s.blurred[2][i]}));
    };
    const double d = std::pow(hyab(lab(a), lab(b)), kQc), knee = kPc * most;
    const double color =
        d < knee ? kPt / knee * d : kPt + (d - knee) / (most - knee) * (1 - kPt);
    const auto apart = [i](const auto& x, const auto& y) {
      return double(std::abs(x[i] - y[i]));
    };
    const double feature = std::max(apart(a.features.edge, b.features.edge),
                                    apart(a.features.point, b.features.point));
    const double f = std::clamp(std::pow(feature / std::sqrt(2.), kQf), 0., 1.);
    error[i] = float(std::clamp(std::pow(std::min(color, 1.), 1 - f), 0., 1.));
  });
  return error;
}

template <class F>
Planes mapped(ColorView v, const F& f) {
  Planes p;
  for (int c = 0; c < 3; ++c) {
    p[c].resize(v.rgb[c].size());
    each(p[c].size(), [&](std::size_t i) { p[c][i] = f(v.rgb[c][i]); });
  }
  return p;
}

double mean_of(const std::vector<float>& v) {
  double sum = 0;
  for (const float x : v) sum += double(x);
  return v.empty() ? 0 : sum / double(v.size());
}

// Narkowicz 2015, with its exposure of 0.6 folded in.
constexpr double kTone[6] = {.36 * 2.51, .6 * .03, 0, .36 * 2.43, .6 * .59, .14};
float tone(float x, double gain) {
  const double v = double(x) * gain;
  const double y = (kTone[0] * v * v + kTone[1] * v + kTone[2]) /
                   (kTone[3] * v * v + kTone[4] * v + kTone[5]);
  return float(std::clamp(y, 0., 1.));
}
// Scene light that comes to t.
double before_tone(double t) {
  const double a = kTone[0] - t * kTone[3], b = kTone[1] - t * kTone[4],
               c = kTone[2] - t * kTone[5];
  return (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
}

std::pair<double, double> exposures_of(ColorView v) {
  std::vector<float> Y(v.rgb[0].size());
  each(Y.size(), [&](std::size_t i) {
    double y = 0;
    for (int c = 0; c < 3; ++c)
      y += kXyz[1][c] * (v.rgb[c][i] > 0 ? std::min(double(v.rgb[c][i]), 65536.) : 0);
    Y[i] = float(y);
  });
  std::erase(Y, 0.f);
  if (Y.empty()) return {0, 0};
  const auto middle = Y.begin() + std::ptrdiff_t((Y.size() - 1) / 2);
  std::nth_element(Y.begin(), middle, Y.end());
  const double median = double(*middle),
               most = double(*std::max_element(Y.begin(), Y.end()));
  const double x = before_tone(.85);
  return {std::log2(x / most), std::log2(x / median)};
}

}  // namespace

FlipMap ldr_flip(ColorView reference, ColorView test, const FlipOptions& o) {
  const auto clamp = [](float x) { return x > 0 ? std::min(x, 1.f) : 0.f; };
  const int w = reference.width, h = reference.height;
  const double ppd = o.pixels_per_degree;
  FlipMap map;
  map.error = compare(see(mapped(reference, clamp), w, h, ppd),
                      see(mapped(test, clamp), w, h, ppd));
  map.mean = mean_of(map.error);
  return map;
}

FlipMap hdr_flip(ColorView reference, ColorView test, const FlipOptions& o) {
  const auto [first, last] = o.exposures ? *o.exposures : exposures_of(reference);
  FlipMap map;
  map.first_exposure = first, map.last_exposure = last;
  map.exposures = std::max(2, int(std::ceil(last - first)));
  map.error.assign(reference.rgb[0].size(), 0);
  const int w = reference.width, h = reference.height;
  for (int k = 0; k < map.exposures; ++k) {
    const double gain = std::exp2(first + (last - first) * k / (map.exposures - 1));
    const auto on_screen = [gain](float x) {
      return x > 0 ? tone(std::min(x, 65536.f), gain) : 0;
    };
    const auto one = compare(see(mapped(reference, on_screen), w, h, o.pixels_per_degree),
                             see(mapped(test, on_screen), w, h, o.pixels_per_degree));
    each(one.size(),
         [&](std::size_t i) { map.error[i] = std::max(map.error[i], one[i]); });
  }
  map.mean = mean_of(map.error);
  return map;
}

}  // namespace brume
