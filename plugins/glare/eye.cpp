// The eye's glare (Spencer et al. 1995): light scattered in cornea, lens and retina, and
// the coloured halo of the lens' fibres.

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kernel.h"
#include "spectrum.h"

namespace brume::glare {
namespace {

// Weights of f0 to f3, table 1 of the paper.
struct Weights {
  double f0, f1, f2, f3;
};
Weights weights_of(const std::string& kind) {
  if (kind == "mesopic") return {0.368, 0.478, 0.138, 0.016};
  if (kind == "scotopic") return {0.282, 0.478, 0.207, 0.033};
  return {0.384, 0.478, 0.138, 0};
}

// Samples per side for the mean over a pixel at distance d [pixels]: within a thousandth
// of it for falls as steep as r^-3.
int samples_at(int d) { return d <= 1 ? 64 : d <= 4 ? 16 : d <= 24 ? 4 : 1; }

constexpr double kDegrees = 180 / std::numbers::pi;

// How many pixels in a row, from d pixels away on, two places stand for: 1/32 of the
// distance, where the fourth derivative of r^-3 leaves 1e-7 of them; but no more than a
// part of what is narrow, the core near 0 and the rings of the halo. 1: alone.
int run_at(double d, double pixel, bool halo, int most) {
  if (d <= 64) return 1;
  const double angle = d * pixel;
  double run = d / 32;
  if (angle < 0.15) run = std::min(run, 0.002 / pixel);
  if (halo && angle < 6.5) run = std::min(run, 0.01 / pixel);
  return std::clamp(int(run), 1, most);
}

}  // namespace

double eye_halo(double angle, double nm) {
  const double t = angle - 3 * nm / 568;
  return 436.9 * (568 / nm) * std::exp(-19.75 * t * t);
}

double eye_psf(const std::string& kind, double angle, double halo) {
  const Weights w = weights_of(kind);
  const double core = angle / 0.02, near = angle + 0.02;
  return w.f0 * 2.61e6 * std::exp(-core * core) + w.f1 * 20.91 / (near * near * near) +
         w.f2 * 72.37 / (near * near) + w.f3 * halo;
}

Kernel eye_kernel(const PatternSettings& s, int width, int height) {
  const double pixel = s.pixel * kDegrees;
  const int reach = std::clamp(int(s.reach * kDegrees / pixel), 1, 16384);
  const bool halo = weights_of(s.kind).f3 > 0;
  const std::size_t channels = halo ? 3 : 1;

  // The halo of white light, per channel, over the angle: a table, since it is smooth on
  // the scale of its width (0.22 degrees).
  constexpr double kStep = 1. / 128;
  std::vector<Triple> rings(halo ? std::size_t(6 / kStep) : 0);
  const Spectral spectrum(s.chromaticities);
  for (std::size_t k = 0; k < rings.size(); ++k)
    for (std::size_t i = 0; i < Spectral::kCount; ++i)
      for (std::size_t c = 0; c < 3; ++c)
        rings[k][c] +=
            spectrum.weight[i][c] * eye_halo(double(k) * kStep, spectrum.nm[i]);
  const auto ring = [&](double angle, std::size_t c) {
    const double at = angle / kStep;
    const std::size_t k = std::size_t(at);
    if (k + 1 >= rings.size()) return 0.;
    return std::lerp(rings[k][c], rings[k + 1][c], at - double(k));
  };

  Kernel kernel;
  kernel.quadrant = kernel.symmetric = true;
  kernel.reach_x = std::min(reach, width - 1);
  kernel.reach_y = std::min(reach, height - 1);
  kernel.planes.assign(channels, std::vector<float>(std::size_t(kernel.reach_x + 1) *
                                                    std::size_t(kernel.reach_y + 1)));
  const auto at = [&](double x, double y) {  // of a point
    const double angle = pixel * std::hypot(x, y), plain = eye_psf(s.kind, angle, 0);
    std::array<double, 3> sum{};
    for (std::size_t c = 0; c < channels; ++c)
      sum[c] = plain + (halo ? weights_of(s.kind).f3 * ring(angle, c) : 0);
    return sum;
  };
  const auto mean = [&](int x, int y) {  // over a pixel
    const int n = samples_at(std::max(x, y));
    std::array<double, 3> sum{};
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const auto v = at(x + (i + 0.5) / n - 0.5, y + (j + 0.5) / n - 0.5);
        for (std::size_t c = 0; c < channels; ++c) sum[c] += v[c] / (n * n);
      }
    return sum;
  };
  // All of the disc is summed, be it in the frame or not: glare is the same whatever part
  // of a picture is rendered. Outside the frame in runs of pixels.
  std::vector<std::array<double, 3>> outside(std::size_t(reach) + 1);
  tbb::parallel_for(0, reach + 1, [&](int y) {
    const int end = int(std::sqrt(double(reach) * reach - double(y) * y));
    for (int x = 0; x <= end;) {
      const bool held = x <= kernel.reach_x && y <= kernel.reach_y;
      const int copies = (x ? 2 : 1) * (y ? 2 : 1);
      const int run =
          held || x == 0 ? 1 : run_at(std::hypot(x, y), pixel, halo, end - x + 1);
      std::array<double, 3> sum = run == 1 ? mean(x, y) : std::array<double, 3>{};
      if (run > 1) {
        // A sum over consecutive whole numbers by two places, exact for cubics.
        const double middle = x + (run - 1) / 2.,
                     off = std::sqrt((run * double(run) - 1) / 12);
        const auto one = at(middle - off, y), two = at(middle + off, y);
        for (std::size_t c = 0; c < channels; ++c) sum[c] = run * (one[c] + two[c]) / 2;
      }
      for (std::size_t c = 0; c < channels; ++c) {
        if (held)
          kernel.planes[c][std::size_t(y) * std::size_t(kernel.reach_x + 1) +
                           std::size_t(x)] = float(sum[c]);
        else
          outside[std::size_t(y)][c] += copies * sum[c];
      }
      x += run;
    }
  });
  for (const auto& row : outside)
    for (std::size_t c = 0; c < channels; ++c) kernel.beyond[c] += row[c];
  for (std::size_t c = channels; c < 3; ++c) kernel.beyond[c] = kernel.beyond[0];
  return kernel;
}

}  // namespace brume::glare
