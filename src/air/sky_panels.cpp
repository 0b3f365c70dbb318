#include "air/sky_panels.h"

#include <algorithm>

namespace brume::air {
namespace {

// Nodes and weights on [-1, 1]: x_k = -cos(k pi/n), n even,
//   w_k = c_k/n (1 - Sum_(j=1)^(n/2) b_j cos(2 j k pi/n)/(4 j^2 - 1)),
// c_k = 1 at the ends, else 2; b_j = 1 for j = n/2, else 2.
template <std::size_t N>
struct ClenshawCurtis {
  double x[N], w[N];
  ClenshawCurtis() {
    constexpr int n = int(N) - 1;
    for (int k = 0; k <= n; ++k) {
      double sum = 1;
      for (int j = 1; j <= n / 2; ++j)
        sum -= (2 * j == n ? 1 : 2) * std::cos(j * k * kTurn / n) / (4 * j * j - 1);
      x[k] = -std::cos(k * kTurn / (2 * n));
      w[k] = (k == 0 || k == n ? 1 : 2) * sum / n;
    }
  }
};
template <std::size_t N>
const ClenshawCurtis<N>& rule() {
  static const ClenshawCurtis<N> r;
  return r;
}

SkyRing ring(const brume_light& light, const glm::dvec3 axis[3], double elevation) {
  SkyRing r{elevation, std::sin(elevation), std::cos(elevation), {}};
  float d[3][kSkySamples], L[3][kSkySamples];
  for (std::size_t j = 0; j < kSkySamples; ++j) {
    const auto& [x, y] = turns<kSkySamples>()[j];
    const glm::dvec3 to = r.z * axis[2] + r.s * (x * axis[0] + y * axis[1]);
    for (int a = 0; a < 3; ++a) d[a][j] = float(to[a]);
  }
  const brume_rays rays = {kSkySamples, nullptr, nullptr, nullptr, d[0], d[1], d[2]};
  light.radiance(light.self, &rays, L[0], L[1], L[2]);
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t j = 0; j < kSkySamples; ++j)
      r.L[c][j] = std::isfinite(L[c][j]) && L[c][j] > 0 ? double(L[c][j]) : 0;
  return r;
}

SkyPanel panel(const brume_light& light, const glm::dvec3 axis[3], double lo, double hi) {
  SkyPanel p{lo, hi, {}};
  for (const double x : rule<SkyPanel::kRings>().x)
    p.rings.push_back(ring(light, axis, (lo + hi) / 2 + (hi - lo) / 2 * x));
  return p;
}

// Of the colour where it is most: the light of all azimuths, and how much of it changes
// with every second ring alone.
struct Sums {
  double light = 0, change = 0;
};
Sums sums_of(const SkyPanel& p) {
  const auto& coarse = rule<SkyPanel::kRings / 2 + 1>();
  Sums most;
  for (std::size_t c = 0; c < 3; ++c) {
    Sums sums;
    for (std::size_t j = 0; j < kSkySamples; ++j) {
      double all = 0, every_second = 0;
      for (std::size_t k = 0; k < SkyPanel::kRings; ++k) {
        all += p.weight(k) * p.rings[k].L[c][j];
        if (k % 2 == 0)
          every_second +=
              (p.hi - p.lo) / 2 * coarse.w[k / 2] * p.rings[k].s * p.rings[k].L[c][j];
      }
      sums.light += all;
      sums.change += std::abs(all - every_second);
    }
    most.light = std::max(most.light, sums.light);
    most.change = std::max(most.change, sums.change);
  }
  return most;
}

// How much of a sky differs between two elevations.
double jump(const SkyRing& a, const SkyRing& b) {
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t j = 0; j < kSkySamples; ++j) sum += std::abs(a.L[c][j] - b.L[c][j]);
  return sum;
}

// Between which elevations a sky changes most: from the rings of panels on by halves.
double horizon(const brume_light& light, const glm::dvec3 axis[3],
               const std::vector<SkyPanel>& panels) {
  const SkyRing *below = nullptr, *above = nullptr;
  double most = 0;
  for (const SkyPanel& p : panels)
    for (std::size_t k = 1; k < SkyPanel::kRings; ++k)
      if (const double here = jump(p.rings[k - 1], p.rings[k]); here > most)
        most = here, below = &p.rings[k - 1], above = &p.rings[k];
  if (most == 0) return 0;
  SkyRing lo = *below, hi = *above;
  while (hi.elevation - lo.elevation > 1e-6) {
    const SkyRing middle = ring(light, axis, (lo.elevation + hi.elevation) / 2);
    (jump(lo, middle) > jump(middle, hi) ? hi : lo) = middle;
  }
  return (lo.elevation + hi.elevation) / 2;
}

}  // namespace

double SkyPanel::weight(std::size_t k) const {
  return (hi - lo) / 2 * rule<kRings>().w[k] * rings[k].s;
}

SkyPanels panels_of(const brume_light& light, const glm::dvec3& up) {
  constexpr int kFirst = 8;
  constexpr double kEnough = 1e-5;
  constexpr std::size_t kMost = 128;
  SkyPanels sky;
  auto& axis = sky.axis;
  axis[2] = up;
  axis[0] = glm::normalize(
      glm::cross(up, std::abs(up.x) < .5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
  axis[1] = glm::cross(up, axis[0]);

  std::vector<SkyPanel> open;
  double all = 0;
  for (int k = 0; k < kFirst; ++k) {
    const double lo = kTurn / 2 * k / kFirst - kTurn / 4;
    open.push_back(panel(light, axis, lo, lo + kTurn / 2 / kFirst));
    all += sums_of(open.back()).light;
  }
  sky.horizon = horizon(light, axis, open);

  // The widest first, so that a sky that is rough everywhere is so to the same degree.
  for (std::size_t i = 0; i < open.size(); ++i) {
    const double lo = open[i].lo, hi = open[i].hi;
    if (open.size() + 2 > kMost || sums_of(open[i]).change <= kEnough * all) {
      sky.panels.push_back(std::move(open[i]));
      continue;
    }
    const bool across = sky.horizon > lo && sky.horizon < hi;
    const double at = across ? sky.horizon : (lo + hi) / 2;
    open.push_back(panel(light, axis, lo, at));
    open.push_back(panel(light, axis, at, hi));
  }
  return sky;
}

}  // namespace brume::air
