// Diffraction by a lens' aperture: the Fraunhofer pattern of the pupil, per wavelength.
//
//   I(theta) = |P^(theta / lambda)|^2,  P^ the Fourier transform of the pupil's
//   transmission
//
// (Goodman, Introduction to Fourier Optics, 3rd ed., eq. 4-25.) One transform serves all
// wavelengths: the pattern only scales. A pixel holds the sum over its area, so that
// rings finer than a pixel neither vanish nor alias.

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "fft.h"
#include "kernel.h"
#include "num/random.h"
#include "spectrum.h"

namespace brume::glare {
namespace {

constexpr double kPi = std::numbers::pi;
// Width of the pupil's plane in diameters: at 2 samples of the intensity lose nothing,
// its own transform, the autocorrelation of the pupil, just fits. Wider where a pixel is
// finer than the pattern, so that it has four samples or more.
double plane_of(const PatternSettings& s) {
  return std::clamp(4 / (s.pixel * s.aperture / 550e-9), 2., 16.);
}
// Frequencies beyond this part of the transform are left out: there the pupil's steps of
// pixels begin to show. The pattern fades over the last quarter.
constexpr double kUsed = 0.75, kFade = 0.75;

struct Speck {  // a disc, or a thin rectangle (length > 0) about its middle
  double x, y, radius, length, cosine, sine;
};

std::vector<Speck> specks_of(const PatternSettings& s) {
  Random random(std::uint64_t(s.seed));
  std::vector<Speck> specks;
  for (int i = 0; i < s.dust + s.scratches; ++i) {
    const double angle = 2 * kPi * random.uniform(), turn = 2 * kPi * random.uniform();
    const double r = std::sqrt(random.uniform()), size = random.uniform();
    const bool dust = i < s.dust;
    specks.push_back({r * std::cos(angle), r * std::sin(angle),
                      dust ? 0.004 + 0.03 * size * size : 0.003 + 0.003 * size,
                      dust ? 0 : 0.1 + 0.6 * random.uniform(), std::cos(turn),
                      std::sin(turn)});
  }
  return specks;
}

// Transmission of the pupil, unit circle, `step` between samples: the part of a sample's
// square that is open, from the distance to the edge.
std::vector<double> pupil(const PatternSettings& s, int n) {
  const double step = 2 * plane_of(s) / n;
  const auto open = [&](double inside) {
    return std::clamp(inside / step + 0.5, 0., 1.);
  };
  const std::vector<Speck> specks = specks_of(s);
  const double sector = 2 * kPi / std::max(s.blades, 3);
  std::vector<double> plane(std::size_t(n) * std::size_t(n));
  tbb::parallel_for(0, n, [&](int j) {
    const double y = (j - n / 2) * step;
    if (std::abs(y) > 1 + step) return;
    double* const row = &plane[std::size_t(j) * std::size_t(n)];
    for (int i = 0; i < n; ++i) {
      const double x = (i - n / 2) * step, r = std::hypot(x, y);
      if (r > 1 + step) continue;
      double edge = 1, slope = 1;  // slope: of the edge's distance against r
      if (s.blades >= 3) {
        const double phi = std::atan2(y, x) - s.rotation;
        const double off = phi - sector * std::round(phi / sector);
        const double straight = std::cos(sector / 2) / std::cos(off);
        edge = std::lerp(straight, 1., s.roundness);
        slope = std::lerp(std::cos(off), 1., s.roundness);
      }
      row[i] = open((edge - r) * slope);
    }
    // Each speck where it is: a circle around it meets the row there.
    for (const Speck& k : specks) {
      const double reach = std::hypot(k.radius, k.length / 2) + step;
      const double half2 = reach * reach - (y - k.y) * (y - k.y);
      if (half2 <= 0) continue;
      const double half = std::sqrt(half2) / step, middle = k.x / step + n / 2;
      const int from = std::max(0, int(middle - half)),
                to = std::min(n - 1, int(middle + half) + 1);
      for (int i = from; i <= to; ++i) {
        const double x = (i - n / 2) * step;
        const double u = (x - k.x) * k.cosine + (y - k.y) * k.sine,
                     v = (y - k.y) * k.cosine - (x - k.x) * k.sine;
        const double inside =
            k.length > 0 ? std::min(k.radius - std::abs(v), k.length / 2 - std::abs(u))
                         : k.radius - std::hypot(u, v);
        row[i] *= 1 - open(inside);
      }
    }
  });
  return plane;
}

// The intensity at all frequencies, each sample a square of side 1; their sum is 1.
class Intensity {
 public:
  Intensity(const PatternSettings& s, int n)
      : half_(int(kUsed * n / 2)),
        samples_(std::size_t(2 * half_ + 1) * std::size_t(2 * half_ + 1)) {
    const std::size_t un = std::size_t(n), wide = un / 2 + 1;
    std::vector<Complex> f(un * wide);
    {
      const std::vector<double> plane = pupil(s, n);
      tbb::parallel_for(std::size_t{0}, un / 8, [&](std::size_t k) {
        fft().forward_rows(&plane[8 * k * un], 8, un, &f[8 * k * wide], wide);
      });
    }
    tbb::parallel_for(std::size_t{0}, (wide + 7) / 8, [&](std::size_t k) {
      const std::size_t u = 8 * k, m = std::min<std::size_t>(8, wide - u);
      std::vector<Complex> strip(un * m);
      for (std::size_t y = 0; y < un; ++y)
        std::copy_n(&f[y * wide + u], m, &strip[y * m]);
      fft().transform_columns(strip.data(), un, m, true);
      for (std::size_t y = 0; y < un; ++y)
        std::copy_n(&strip[y * m], m, &f[y * wide + u]);
    });
    std::vector<double> sums(std::size_t(2 * half_ + 1));
    tbb::parallel_for(-half_, half_ + 1, [&](int v) {
      double& sum = sums[std::size_t(v + half_)];
      for (int u = 0; u <= half_; ++u) {
        const double fade =
            std::clamp((1 - std::hypot(u, v) / half_) / (1 - kFade), 0., 1.);
        const double i = std::norm(f[std::size_t((v + n) % n) * wide + std::size_t(u)]) *
                         fade * fade * (3 - 2 * fade);
        samples_[index(u, v)] = i;
        if (u > 0) samples_[index(-u, -v)] = i;  // a real pupil: F(-f) = F*(f)
        sum += u > 0 ? 2 * i : i;
      }
    });
    const double total = std::accumulate(sums.begin(), sums.end(), 0.);
    for (double& x : samples_) x /= total;
  }

  int half() const { return half_; }

  /// Over [v0, v1] of each column that meets [u0, u1], frequencies in samples: a line,
  /// for `over`.
  void line(double u0, double u1, double v0, double v1, std::vector<double>& to) const {
    const Range u = range(u0, u1), v = range(v0, v1);
    to.assign(std::size_t(2 * half_ + 1), 0.);
    for (int j = v.first; j <= v.last; ++j) {
      const double part = v.part(j);
      const double* row = &samples_[index(-half_, j)];
      for (std::size_t i = index(u.first), end = index(u.last); i <= end; ++i)
        to[i] += part * row[i];
    }
  }
  /// Over [u0, u1] of such a line. Added up, never the difference of two sums: what lies
  /// far out is 1e-15 of what lies in the middle.
  double over(const std::vector<double>& line, double u0, double u1) const {
    const Range u = range(u0, u1);
    const double* at = &line[index(0)];
    const double first = u.part(u.first) * at[u.first];
    if (u.last == u.first) return first;
    return std::reduce(at + u.first + 1, at + u.last,
                       first + u.part(u.last) * at[u.last]);
  }

 private:
  struct Range {  // from one place to another, and the samples that they meet
    double from, to;
    int first, last;
    double part(int i) const {
      return std::max(0., std::min(to, i + 0.5) - std::max(from, i - 0.5));
    }
  };
  Range range(double from, double to) const {
    from = std::clamp(from, -half_ - 0.5, half_ + 0.5);
    to = std::clamp(to, -half_ - 0.5, half_ + 0.5);
    return {from, to, std::clamp(int(std::floor(from + 0.5)), -half_, half_),
            std::clamp(int(std::floor(to + 0.5)), -half_, half_)};
  }
  std::size_t index(int u, int v) const {
    return std::size_t(v + half_) * std::size_t(2 * half_ + 1) + index(u);
  }
  std::size_t index(int u) const { return std::size_t(u + half_); }

  int half_;
  std::vector<double> samples_;
};

}  // namespace

Kernel aperture_kernel(const PatternSettings& s, int width, int height) {
  const Intensity intensity(s, s.grid);
  const Spectral spectrum(s.chromaticities);
  const double plane = plane_of(s);
  // Frequency sample k is the angle k lambda / (plane D).
  const double longest = spectrum.nm.back() * 1e-9;
  const double farthest = intensity.half() * longest / (plane * s.aperture) / s.pixel;
  const int reach = std::clamp(int(std::ceil(farthest)), 1, kMostReach);
  Kernel k;
  k.symmetric = true;
  k.reach_x = std::min(reach, width - 1);
  k.reach_y = std::min(reach, height - 1);
  const std::size_t wide = std::size_t(k.width());
  k.planes.assign(3, std::vector<float>(wide * std::size_t(2 * k.reach_y + 1)));
  // Energy of `count` pixels in a row, each `side` pixels wide and high, from the middle
  // x0, y on.
  const auto energy = [&](int x0, int count, int y, int side) {
    std::vector<Triple> sums(static_cast<std::size_t>(count));
    std::vector<double> line;
    for (std::size_t i = 0; i < Spectral::kCount; ++i) {
      const double scale = s.pixel * plane * s.aperture / (spectrum.nm[i] * 1e-9);
      const auto edge = [&](int at, double half) { return (at + half * side) * scale; };
      intensity.line(edge(x0, -0.5), edge(x0 + count - 1, 0.5), edge(y, -0.5),
                     edge(y, 0.5), line);
      for (int n = 0; n < count; ++n) {
        const double e = intensity.over(line, edge(x0 + n, -0.5), edge(x0 + n, 0.5));
        for (std::size_t c = 0; c < 3; ++c)
          sums[std::size_t(n)][c] += spectrum.weight[i][c] * e;
      }
    }
    return sums;
  };
  // Parts of what lies within reach, before they become floats: pixels may be so fine
  // that each holds next to nothing.
  const Triple all =
      farthest <= reach ? Triple{1, 1, 1} : energy(0, 1, 0, 2 * reach + 1)[0];
  std::vector<Triple> held(std::size_t(k.reach_y) + 1);
  tbb::parallel_for(
      0, k.reach_y + 1, [&](int y) {  // the lower half; the upper mirrors it
        const int first = y ? -k.reach_x : 0;
        const std::vector<Triple> row = energy(first, k.reach_x - first + 1, y, 1);
        for (int x = first; x <= k.reach_x; ++x)
          for (std::size_t c = 0; c < 3; ++c) {
            const float v = float(row[std::size_t(x - first)][c] / all[c]);
            const auto at = [&](int px, int py) -> float& {
              return k.planes[c][std::size_t(py + k.reach_y) * wide +
                                 std::size_t(px + k.reach_x)];
            };
            at(x, y) = at(-x, -y) = v;
            held[std::size_t(y)][c] += (x || y ? 2. : 1.) * v;
          }
      });
  for (std::size_t c = 0; c < 3; ++c) {
    double sum = 0;
    for (const Triple& row : held) sum += row[c];
    const bool whole = k.reach_x == reach && k.reach_y == reach;
    k.beyond[c] = whole ? 0 : std::max(0., 1 - sum);
  }
  return k;
}

}  // namespace brume::glare
