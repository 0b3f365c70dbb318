#pragma once
// Wavelengths to the frame's primaries.

#include <algorithm>
#include <array>
#include <cmath>

namespace brume::glare {

using Triple = std::array<double, 3>;

/// CIE 1931 colour matching functions, fits of Wyman, Sloan & Shirley 2013 ("Simple
/// analytic approximations to the CIE XYZ color matching functions", eq. 4), wavelength
/// in nm; error below .04 of the peak, smooth everywhere.
inline Triple matching(double nm) {
  const auto lobe = [nm](double mean, double below, double above) {
    const double t = (nm - mean) / (nm < mean ? below : above);
    return std::exp(-0.5 * t * t);
  };
  return {1.056 * lobe(599.8, 37.9, 31.0) + 0.362 * lobe(442.0, 16.0, 26.7) -
              0.065 * lobe(501.1, 20.4, 26.2),
          0.821 * lobe(568.8, 46.9, 40.5) + 0.286 * lobe(530.9, 16.3, 31.1),
          1.217 * lobe(437.0, 11.8, 36.0) + 0.681 * lobe(459.0, 26.0, 13.8)};
}

/// The frame's RGB of an XYZ, up to a factor per channel (a pattern's channels are
/// normalised one by one, so that white stays white): rows of the inverse of the
/// primaries' matrix.
inline Triple rgb_from_xyz(const std::array<double, 8>& c, const Triple& xyz) {
  double m[3][3];  // columns: the primaries' XYZ
  for (int k = 0; k < 3; ++k) {
    m[0][k] = c[std::size_t(2 * k)];
    m[1][k] = c[std::size_t(2 * k + 1)];
    m[2][k] = 1 - m[0][k] - m[1][k];
  }
  Triple rgb{};
  double det = 0;
  for (int k = 0; k < 3; ++k) {  // Cramer's rule
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const double cross[3] = {m[1][i] * m[2][j] - m[2][i] * m[1][j],
                             m[2][i] * m[0][j] - m[0][i] * m[2][j],
                             m[0][i] * m[1][j] - m[1][i] * m[0][j]};
    if (k == 0) det = m[0][0] * cross[0] + m[1][0] * cross[1] + m[2][0] * cross[2];
    rgb[std::size_t(k)] =
        (cross[0] * xyz[0] + cross[1] * xyz[1] + cross[2] * xyz[2]) / det;
  }
  return rgb;
}

/// Wavelengths the visible range is cut into, and what white of equal energy gives each
/// channel at them, summing to 1 per channel. Colours purer than the primaries are cut at
/// 0.
struct Spectral {
  static constexpr int kCount = 40;
  std::array<double, kCount> nm;
  std::array<Triple, kCount> weight;

  explicit Spectral(const std::array<double, 8>& chromaticities) {
    Triple sum{};
    for (std::size_t i = 0; i < kCount; ++i) {
      nm[i] = 390 + (700 - 390) * (double(i) + 0.5) / kCount;
      weight[i] = rgb_from_xyz(chromaticities, matching(nm[i]));
      for (double& w : weight[i]) w = std::max(w, 0.);
      for (std::size_t c = 0; c < 3; ++c) sum[c] += weight[i][c];
    }
    for (Triple& w : weight)
      for (std::size_t c = 0; c < 3; ++c) w[c] /= sum[c];
  }
};

}  // namespace brume::glare
