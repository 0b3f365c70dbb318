#include "truth/sky_light.h"

#include <array>
#include <cmath>

#include "num/quadrature.h"

namespace brume::truth {
namespace {

// A patch's rule. In height Lobatto's (Abramowitz & Stegun 25.4.32), which has both ends:
// a strip beside an end, as between the eye's level and its horizon, escapes nodes that
// keep away from them, and those of the halves.
constexpr int kHigh = 4, kWide = 3, kPoints = kHigh * kWide;
constexpr double kHeight[] = {-1, -0.44721359549995794, 0.44721359549995794, 1};
constexpr double kHeightWeight[] = {1. / 6, 5. / 6, 5. / 6, 1. / 6};
constexpr int kRows = 64, kAround = 128;  // patches to begin with
constexpr int kHalvings = 24;
constexpr double kChange = 1e-5;

/// Heights z and azimuths phi about `up`: equal areas.
struct Patch {
  double z, dz, phi, dphi;  ///< where it begins, how far it goes
};

struct Values {
  glm::dvec3 to[kPoints];
  Rgb light[kPoints];  ///< radiance times solid angle
  Rgb sum{};
};

class Sphere {
 public:
  Sphere(const brume_light& light, const glm::dvec3& up)
      : light_(light),
        up_(up),
        x_(glm::normalize(glm::cross(
            up, std::abs(up.x) < .5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)))),
        y_(glm::cross(up, x_)) {}

  Values at(const Patch& p) const {
    static constexpr Rule<kWide> rule = gauss_legendre<kWide>();
    Values v;
    float d[3][kPoints], L[3][kPoints];
    double weight[kPoints];
    for (int k = 0; k < kPoints; ++k) {
      const int i = k / kWide, j = k % kWide;
      const double z = p.z + p.dz * (1 + kHeight[i]) / 2,
                   phi = p.phi + p.dphi * (1 + double(rule.x[j])) / 2;
      const double sine = std::sqrt((1 - z) * (1 + z));
      v.to[k] = z * up_ + sine * (std::cos(phi) * x_ + std::sin(phi) * y_);
      weight[k] = p.dz * p.dphi * kHeightWeight[i] * double(rule.w[j]) / 4;
      for (int a = 0; a < 3; ++a) d[a][k] = float(v.to[k][a]);
    }
    const brume_rays rays = {kPoints, nullptr, nullptr, nullptr, d[0], d[1], d[2]};
    light_.radiance(light_.self, &rays, L[0], L[1], L[2]);
    for (int k = 0; k < kPoints; ++k)
      for (std::size_t c = 0; c < 3; ++c) {
        // What is no number, or negative, is no light.
        const bool some = std::isfinite(L[c][k]) && L[c][k] > 0;
        v.light[k][c] = some ? weight[k] * double(L[c][k]) : 0;
        v.sum[c] += v.light[k][c];
      }
    return v;
  }

 private:
  const brume_light& light_;
  glm::dvec3 up_, x_, y_;
};

}  // namespace

SkyLight::SkyLight(const brume_light& light, const glm::dvec3& up) {
  const Sphere sphere(light, up);
  struct Open {
    Patch patch;
    Values values;
    int halvings;
  };
  std::vector<Open> open;
  Rgb whole{};
  for (int i = 0; i < kRows; ++i)
    for (int j = 0; j < kAround; ++j) {
      const double dz = 2. / kRows, dphi = 2 * M_PI / kAround;
      const Patch p = {-1 + i * dz, dz, j * dphi, dphi};
      open.push_back({p, sphere.at(p), 0});
      for (std::size_t c = 0; c < 3; ++c) whole[c] += open.back().values.sum[c];
    }
  while (!open.empty()) {
    const Open one = open.back();
    open.pop_back();
    const Patch& p = one.patch;
    const Patch low = {p.z, p.dz / 2, p.phi, p.dphi},
                high = {p.z + p.dz / 2, p.dz / 2, p.phi, p.dphi},
                left = {p.z, p.dz, p.phi, p.dphi / 2},
                right = {p.z, p.dz, p.phi + p.dphi / 2, p.dphi / 2};
    const Values v[4] = {sphere.at(low), sphere.at(high), sphere.at(left),
                         sphere.at(right)};
    double by_height = 0, by_azimuth = 0;  // changes, as parts of the whole
    for (std::size_t c = 0; c < 3; ++c) {
      const auto change = [&](const Values& a, const Values& b) {
        return std::abs(a.sum[c] + b.sum[c] - one.values.sum[c]) /
               std::max(whole[c], 1e-300);
      };
      by_height = std::max(by_height, change(v[0], v[1]));
      by_azimuth = std::max(by_azimuth, change(v[2], v[3]));
    }
    const double enough = kChange * (p.dz * p.dphi / (4 * M_PI) + 1e-4);
    if (std::max(by_height, by_azimuth) <= enough || one.halvings == kHalvings) {
      for (int k = 0; k < kPoints; ++k)
        nodes_.push_back({one.values.to[k], one.values.light[k]});
      continue;
    }
    const bool in_height = by_height >= by_azimuth;
    open.push_back({in_height ? low : left, v[in_height ? 0 : 2], one.halvings + 1});
    open.push_back({in_height ? high : right, v[in_height ? 1 : 3], one.halvings + 1});
  }
}

Rgb SkyLight::irradiance(const glm::dvec3& n) const {
  Rgb E{};
  for (const Node& node : nodes_) {
    const double mu = glm::dot(node.to, n);
    if (!(mu > 0)) continue;
    for (std::size_t c = 0; c < 3; ++c) E[c] += mu * node.light[c];
  }
  return E;
}

}  // namespace brume::truth
