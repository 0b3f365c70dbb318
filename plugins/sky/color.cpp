#include "color.h"

#include <algorithm>
#include <cmath>

#include "num/error.h"

namespace brume::sky {

std::array<double, 3> matching(double nm) {
  // A lobe: Gaussian of different width on either side.
  const auto lobe = [nm](double height, double centre, double left, double right) {
    const double t = (nm - centre) * (nm < centre ? left : right);
    return height * std::exp(-.5 * t * t);
  };
  return {lobe(.362, 442.0, .0624, .0374) + lobe(1.056, 599.8, .0264, .0323) +
              lobe(-.065, 501.1, .0490, .0382),
          lobe(.821, 568.8, .0213, .0247) + lobe(.286, 530.9, .0613, .0322),
          lobe(1.217, 437.0, .0845, .0278) + lobe(.681, 459.0, .0385, .0725)};
}

std::array<std::array<double, 3>, 3> rgb_from_xyz(const std::array<double, 8>& c) {
  // Columns of M: XYZ of the primaries, scaled so that they add up to white (SMPTE RP
  // 177-1993).
  double p[3][3], white[3];
  for (int i = 0; i < 4; ++i) {
    const double x = c[2 * i], y = c[2 * i + 1];
    if (!(std::abs(y) > 1e-9)) throw Error("sky", "chromaticities with y = 0", "");
    const double xyz[3] = {x / y, 1, (1 - x - y) / y};
    for (int k = 0; k < 3; ++k) (i < 3 ? p[k][i] : white[k]) = xyz[k];
  }
  const auto inverse = [](const double m[3][3],
                          std::array<std::array<double, 3>, 3>& out) {
    double det = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        out[j][i] = m[(i + 1) % 3][(j + 1) % 3] * m[(i + 2) % 3][(j + 2) % 3] -
                    m[(i + 1) % 3][(j + 2) % 3] * m[(i + 2) % 3][(j + 1) % 3];
    for (int j = 0; j < 3; ++j) det += m[0][j] * out[j][0];
    for (auto& row : out)
      for (double& x : row) x /= det;
    return std::abs(det);
  };
  std::array<std::array<double, 3>, 3> out;
  if (!(inverse(p, out) > 1e-9))
    throw Error("sky", "chromaticities on a line",
                "three primaries that span a triangle");
  for (auto& row : out) {
    const double scale = row[0] * white[0] + row[1] * white[1] + row[2] * white[2];
    for (double& x : row) x /= scale;
  }
  return out;
}

Colors colors_of(const std::vector<double>& nm,
                 const std::array<double, 8>& chromaticities, double (*sun)(double)) {
  const int n = static_cast<int>(nm.size());
  const auto M = rgb_from_xyz(chromaticities);
  Colors out;
  out.radiance.assign(n, {}), out.transmittance.assign(n, {});
  std::vector<int> order(n);
  for (int i = 0; i < n; ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](int a, int b) { return nm[a] < nm[b]; });

  for (double x = 380.5; x < 780; ++x) {
    // Lagrange weights of the nearest four (or all, if fewer); beyond the ends the end
    // value.
    const double at = std::clamp(x, nm[order.front()], nm[order.back()]);
    const int points = std::min(n, 4);
    int first = 0;
    while (first + points < n && nm[order[first + points / 2]] < at) ++first;
    const auto xyz = matching(x);
    for (int i = first; i < first + points; ++i) {
      double w = 1;
      for (int j = first; j < first + points; ++j)
        if (j != i) w *= (at - nm[order[j]]) / (nm[order[i]] - nm[order[j]]);
      w *= sun(x) / sun(nm[order[i]]);
      for (int c = 0; c < 3; ++c)
        out.radiance[order[i]][c] +=
            w * (M[c][0] * xyz[0] + M[c][1] * xyz[1] + M[c][2] * xyz[2]);
    }
  }
  // What a channel sees of a white surface in sunlight; the negative lobes of the
  // primaries would give T outside [0, 1].
  for (int c = 0; c < 3; ++c) {
    double sum = 0;
    for (int i = 0; i < n; ++i)
      sum += out.transmittance[i][c] = std::max(out.radiance[i][c] * sun(nm[i]), 0.);
    for (int i = 0; i < n; ++i)
      out.transmittance[i][c] = sum > 0 ? out.transmittance[i][c] / sum : 1. / n;
  }
  return out;
}

Colors colors_none(int wavelengths) {
  Colors out;
  out.radiance.assign(wavelengths, {}), out.transmittance.assign(wavelengths, {});
  for (int c = 0; c < 3; ++c) {
    const int i = std::min(c, wavelengths - 1);
    out.radiance[i][c] = out.transmittance[i][c] = 1;
  }
  return out;
}

}  // namespace brume::sky
