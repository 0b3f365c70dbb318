#include "depth_stats.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

namespace brume::cli {

namespace {

// Positive floats sorted by their leading 16 bits: bins of 2^-7 relative width.
struct Histogram {
  std::vector<std::uint64_t> bins = std::vector<std::uint64_t>(1u << 16);

  void add(float v) {
    std::uint32_t bits;
    std::memcpy(&bits, &v, sizeof bits);
    ++bins[bits >> 16];
  }
  double median(std::uint64_t count) const {
    std::uint64_t below = 0;
    for (std::uint32_t i = 0; i < bins.size(); ++i) {
      below += bins[i];
      if (2 * below < count) continue;
      const std::uint32_t bits = (i << 16) | 0x8000u;  // middle of the bin
      float v;
      std::memcpy(&v, &bits, sizeof v);
      return v;
    }
    return 0;
  }
};

std::string convention_of(const DepthStats& s, std::uint64_t surfaces) {
  if (surfaces == 0) return "no pixel has a depth";
  const bool far_marked =
      std::any_of(s.background_values.begin(), s.background_values.end(),
                  [](double v) { return v >= 1e9; });
  if (s.farthest <= 1.0 && s.median > 0.5 && !far_marked)
    return "looks normalised (all within 0..1): set [input] depth_kind = \"normalised\", "
           "depth_near and depth_far";
  if (s.farthest <= 1.0 && s.zero > 0 && !far_marked)
    return "looks inverse (1/Z, background 0): set [input] depth_kind = \"inverse\", or "
           "\"normalised\"";
  return "scene units; taken as planar unless [input] depth_kind says otherwise";
}

}  // namespace

DepthStats depth_stats(const ImageReader& reader, int channel) {
  const Window& w = reader.header().data_window;
  const int band = std::max(reader.band_rows(), 16);
  std::vector<float> rows(std::size_t(band) * std::size_t(w.width));
  DepthStats s;
  Histogram histogram;
  double nearest = std::numeric_limits<double>::infinity(), farthest = 0;
  for (int y = w.y; y < w.bottom(); y += band) {
    const int count = std::min(band, w.bottom() - y);
    float* const out = rows.data();
    reader.read(y, count, std::array{channel}, std::array{out});
    const std::size_t n = std::size_t(count) * std::size_t(w.width);
    s.pixels += n;
    for (std::size_t i = 0; i < n; ++i) {
      const float v = rows[i];
      if (v > 0 && v < 1e9f) {
        histogram.add(v);
        nearest = std::min(nearest, double(v));
        farthest = std::max(farthest, double(v));
        continue;
      }
      ++s.background;
      s.nan += std::isnan(v);
      s.infinite += std::isinf(v);
      s.zero += v == 0;
      s.negative += v < 0;
      if (!std::isnan(v) && s.background_values.size() < 4 &&
          std::find(s.background_values.begin(), s.background_values.end(), double(v)) ==
              s.background_values.end())
        s.background_values.push_back(v);
    }
  }
  const std::uint64_t surfaces = s.pixels - s.background;
  if (surfaces > 0) {
    s.nearest = nearest;
    s.farthest = farthest;
    s.median = std::clamp(histogram.median(surfaces), nearest, farthest);
  }
  s.convention = convention_of(s, surfaces);
  return s;
}

}  // namespace brume::cli
