// Diffraction by a lens' aperture: the Fraunhofer pattern of the pupil, per wavelength.
//
//   I(theta) = |P^(theta / lambda)|^2,  P^ the Fourier transform of the pupil's
//   transmission
//
// (Goodman, Introduction to Fourier Optics, 3rd ed., eq. 4-25.) One transform serves all
// wavelengths: the pattern only scales. A pixel holds the mean over its area, taken from
// a table of sums, so that rings finer than a pixel neither vanish nor alias.

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

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

// Sums of the intensity over all frequencies left of and above a corner; bilinear between
// corners: each sample is a square of side 1.
class Sums {
 public:
  Sums(const PatternSettings& s, int n)
      : half_(int(kUsed * n / 2)), side_(2 * half_ + 2) {
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
    sums_.resize(std::size_t(side_) * std::size_t(side_));
    double total = 0;
    for (int v = -half_; v <= half_; ++v) {
      double row = 0;
      for (int u = -half_; u <= half_; ++u) {
        const int fu = u < 0 ? -u : u,
                  fv = u < 0 ? -v : v;  // a real pupil: F(-f) = F*(f)
        const double fade =
            std::clamp((1 - std::hypot(u, v) / half_) / (1 - kFade), 0., 1.);
        const double i =
            std::norm(f[std::size_t((fv + n) % n) * wide + std::size_t(fu)]) * fade *
            fade * (3 - 2 * fade);
        row += i;
        at(u + half_ + 1, v + half_ + 1) = at(u + half_ + 1, v + half_) + row;
      }
      total += row;
    }
    for (double& x : sums_) x /= total;
  }

  int half() const { return half_; }
  /// Over [u0, u1] x [v0, v1], frequencies in samples.
  double over(double u0, double u1, double v0, double v1) const {
    return corner(u1, v1) - corner(u0, v1) - corner(u1, v0) + corner(u0, v0);
  }

 private:
  double& at(int i, int j) {
    return sums_[std::size_t(j) * std::size_t(side_) + std::size_t(i)];
  }
  double corner(double u, double v) const {
    const double x = std::clamp(u + half_ + 0.5, 0., side_ - 1.),
                 y = std::clamp(v + half_ + 0.5, 0., side_ - 1.);
    const int i = std::min(int(x), side_ - 2), j = std::min(int(y), side_ - 2);
    const double* p = &sums_[std::size_t(j) * std::size_t(side_) + std::size_t(i)];
    return std::lerp(std::lerp(p[0], p[1], x - i),
                     std::lerp(p[side_], p[side_ + 1], x - i), y - j);
  }
  int half_, side_;
  std::vector<double> sums_;
};

}  // namespace

Kernel aperture_kernel(const PatternSettings& s, int width, int height) {
  const Sums sums(s, s.grid);
  const Spectral spectrum(s.chromaticities);
  const double plane = plane_of(s);
  // Frequency sample k is the angle k lambda / (plane D).
  const double longest = spectrum.nm.back() * 1e-9;
  const double farthest = sums.half() * longest / (plane * s.aperture) / s.pixel;
  const int reach = std::clamp(int(std::ceil(farthest)), 1, kMostReach);
  Kernel k;
  k.symmetric = true;
  k.reach_x = std::min(reach, width - 1);
  k.reach_y = std::min(reach, height - 1);
  const std::size_t wide = std::size_t(k.width());
  k.planes.assign(3, std::vector<float>(wide * std::size_t(2 * k.reach_y + 1)));
  const auto energy = [&](double x0, double x1, double y0, double y1) {
    Triple sum{};
    for (std::size_t i = 0; i < Spectral::kCount; ++i) {
      const double scale = s.pixel * plane * s.aperture / (spectrum.nm[i] * 1e-9);
      const double e = sums.over(x0 * scale, x1 * scale, y0 * scale, y1 * scale);
      for (std::size_t c = 0; c < 3; ++c) sum[c] += spectrum.weight[i][c] * e;
    }
    return sum;
  };
  std::vector<Triple> held(std::size_t(k.reach_y) + 1);
  tbb::parallel_for(
      0, k.reach_y + 1, [&](int y) {  // the lower half; the upper mirrors it
        for (int x = y ? -k.reach_x : 0; x <= k.reach_x; ++x) {
          const Triple e = energy(x - 0.5, x + 0.5, y - 0.5, y + 0.5);
          for (std::size_t c = 0; c < 3; ++c) {
            const float v = float(std::max(0., e[c]));  // differences of sums: -1e-17
            const auto at = [&](int px, int py) -> float& {
              return k.planes[c][std::size_t(py + k.reach_y) * wide +
                                 std::size_t(px + k.reach_x)];
            };
            at(x, y) = at(-x, -y) = v;
            held[std::size_t(y)][c] += (x || y ? 2. : 1.) * v;
          }
        }
      });
  const Triple all = energy(-reach - 0.5, reach + 0.5, -reach - 0.5, reach + 0.5);
  for (std::size_t c = 0; c < 3; ++c) {
    double sum = 0;
    for (const Triple& row : held) sum += row[c];
    const bool whole = k.reach_x == reach && k.reach_y == reach;
    k.beyond[c] = whole ? 0 : std::max(0., all[c] - sum);
  }
  return k;
}

}  // namespace brume::glare
