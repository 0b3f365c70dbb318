#include "truth/metrics.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace brume {
namespace {

template <class T>
Errors errors_of(std::span<const T> a, std::span<const T> b, double floor) {
  Errors e;
  e.count = a.size();
  std::vector<double> all;
  all.reserve(a.size());
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double x = double(a[i]), y = double(b[i]);
    const bool same = x == y || (std::isnan(x) && std::isnan(y));
    const double d = same ? 0 : std::abs(x - y);
    if (!std::isfinite(d)) {
      ++e.broken;
      continue;
    }
    if (d > e.max) e.max = d, e.worst = i;
    if (d > 0) e.relative = std::max(e.relative, d / std::max(std::abs(x), floor));
    sum += d;
    squares += d * d;
    all.push_back(d);
  }
  if (all.empty()) return e;
  e.mean = sum / double(all.size());
  e.rms = std::sqrt(squares / double(all.size()));
  const std::size_t rank = (all.size() * 99 + 99) / 100 - 1;
  std::nth_element(all.begin(), all.begin() + std::ptrdiff_t(rank), all.end());
  e.p99 = all[rank];
  return e;
}

std::vector<float> product(PlaneView a, PlaneView b) {
  std::vector<float> out(a.values.size());
  const auto at = [](float x) { return std::isnan(x) ? 0 : x; };
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = at(a.values[i]) * at(b.values[i]);
  return out;
}

}  // namespace

double Errors::psnr(double peak) const {
  return rms > 0 ? 20 * std::log10(peak / rms) : std::numeric_limits<double>::infinity();
}

Errors errors(std::span<const float> a, std::span<const float> b, double floor) {
  return errors_of(a, b, floor);
}
Errors errors(std::span<const double> a, std::span<const double> b, double floor) {
  return errors_of(a, b, floor);
}

std::vector<float> convolve(PlaneView p, std::span<const float> across,
                            std::span<const float> down) {
  const int w = p.width, h = p.height;
  const int rx = int(across.size()) / 2, ry = int(down.size()) / 2;
  std::vector<float> once(p.values.size()), twice(p.values.size());
  const auto row = [w](auto& v, int y) {
    return v.data() + std::size_t(y) * std::size_t(w);
  };
  tbb::parallel_for(tbb::blocked_range<int>(0, h, 8), [&](const auto& range) {
    std::vector<float> wide(std::size_t(w + 2 * rx));
    for (int y = range.begin(); y < range.end(); ++y) {
      for (int x = -rx; x < w + rx; ++x)
        wide[std::size_t(x + rx)] = row(p.values, y)[std::clamp(x, 0, w - 1)];
      float* out = row(once, y);
      for (std::size_t k = 0; k < across.size(); ++k)
        for (int x = 0; x < w; ++x) out[x] += across[k] * wide[std::size_t(x) + k];
    }
  });
  tbb::parallel_for(tbb::blocked_range<int>(0, h, 8), [&](const auto& range) {
    for (int y = range.begin(); y < range.end(); ++y)
      for (int k = -ry; k <= ry; ++k) {
        const float* from = row(once, std::clamp(y + k, 0, h - 1));
        const float f = down[std::size_t(k + ry)];
        float* out = row(twice, y);
        for (int x = 0; x < w; ++x) out[x] += f * from[x];
      }
  });
  return twice;
}

double ssim(PlaneView a, PlaneView b, double peak) {
  // Of each window: means, variances, covariance, all weighted by the Gaussian.
  constexpr int kRadius = 5;
  std::vector<float> window(2 * kRadius + 1);
  double total = 0;
  for (int i = -kRadius; i <= kRadius; ++i)
    total += double(window[std::size_t(i + kRadius)] =
                        float(std::exp(-i * i / (2 * 1.5 * 1.5))));
  for (float& g : window) g = float(g / total);

  const std::vector<float> ones(a.values.size(), 1.f);
  const PlaneView one{ones, a.width, a.height};
  const auto mean = [&](PlaneView x, PlaneView y) {
    const std::vector<float> xy = product(x, y);
    return convolve({xy, a.width, a.height}, window, window);
  };
  const auto A = mean(a, one), B = mean(b, one), AA = mean(a, a), BB = mean(b, b),
             AB = mean(a, b);
  const double C1 = std::pow(.01 * peak, 2), C2 = std::pow(.03 * peak, 2);
  // Windows that lie inside; of a side shorter than the window, its middle.
  const int x0 = std::min(kRadius, (a.width - 1) / 2),
            y0 = std::min(kRadius, (a.height - 1) / 2);
  double sum = 0;
  std::uint64_t count = 0;
  for (int y = y0; y < std::max(y0 + 1, a.height - y0); ++y)
    for (int x = x0; x < std::max(x0 + 1, a.width - x0); ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(a.width) + std::size_t(x);
      const double ma = A[i], mb = B[i], va = AA[i] - ma * ma, vb = BB[i] - mb * mb,
                   cov = AB[i] - ma * mb;
      sum += (2 * ma * mb + C1) * (2 * cov + C2) /
             ((ma * ma + mb * mb + C1) * (va + vb + C2));
      ++count;
    }
  return sum / double(count);
}

}  // namespace brume
