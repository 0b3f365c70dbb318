#include "air/sky_light.h"

#include <array>
#include <cmath>

#include "num/quadrature.h"

namespace brume::air {
namespace {

constexpr double kTau = 6.283185307179586;

// Coefficient of a clamped cosine.
double cosine_lobe(int l) {
  if (l == 0) return kTau / 2;
  if (l == 1) return kTau / 3;
  if (l % 2 == 1) return 0;
  double central = 1;  // l! / (2^l ((l/2)!)^2)
  for (int k = 1; k <= l / 2; ++k) central *= (2. * k - 1) / (2. * k);
  return (l / 2 % 2 == 1 ? kTau : -kTau) / ((l + 2.) * (l - 1.)) * central;
}

// Square of what makes Q_l r^m cos(m phi) orthonormal: (2 l + 1)/(4 pi) (l - m)!/(l + m)!
// ((2 m - 1)!!)^2, twice for m > 0.
double norm2(int l, int m) {
  double n = (2 * l + 1) / (2 * kTau) * (m > 0 ? 2 : 1);
  for (int k = l - m + 1; k <= l + m; ++k) n /= k;
  for (int k = 1; k < 2 * m; k += 2) n *= double(k) * k;
  return n;
}

using Sums = std::array<std::array<std::array<double, SkyHarmonics::kTerms>, 2>, 3>;

// One direction's part of all sums.
void add(const SkyHarmonics& h, const glm::dvec3& d, const double part[3], Sums& sums) {
  double re = 1, im = 0;
  int i = 0;
  for (int m = 0; m <= SkyHarmonics::kDegree; ++m) {
    double before = 0, here = 1;
    for (int l = m; l <= SkyHarmonics::kDegree; ++l, ++i) {
      if (l > m) {
        const double next = double(h.rise[i]) * d.z * here - double(h.fall[i]) * before;
        before = here;
        here = next;
      }
      if (l > 1 && l % 2 == 1) continue;  // a clamped cosine has none of these
      for (std::size_t c = 0; c < 3; ++c) {
        sums[c][0][std::size_t(i)] += part[c] * here * re;
        sums[c][1][std::size_t(i)] += part[c] * here * im;
      }
    }
    const double turned = re * d.x - im * d.y;
    im = re * d.y + im * d.x;
    re = turned;
  }
}

SkyHarmonics harmonics_of(const brume_light& light, const glm::dvec3& up) {
  SkyHarmonics h;
  int i = 0;
  for (int m = 0; m <= SkyHarmonics::kDegree; ++m)
    for (int l = m; l <= SkyHarmonics::kDegree; ++l, ++i)
      if (l > m) {
        h.rise[i] = float((2. * l - 1) / (l - m));
        h.fall[i] = float((l + m - 1.) / (l - m));
      }

  // Rings of even height, each half of the sphere by itself.
  constexpr int kRings = 64, kAround = 128;
  const RuleOfSize rule = gauss_legendre(kRings);
  const glm::dvec3 x = glm::normalize(glm::cross(up, std::abs(up.x) < .5
                                                         ? glm::dvec3(1, 0, 0)
                                                         : glm::dvec3(0, 1, 0))),
                   y = glm::cross(up, x);
  Sums sums{};
  for (int half = -1; half <= 1; half += 2)
    for (std::size_t k = 0; k < kRings; ++k) {
      const double z = half * (1 + rule.x[k]) / 2, sine = std::sqrt((1 - z) * (1 + z));
      glm::dvec3 at[kAround];
      float d[3][kAround], L[3][kAround];
      for (int j = 0; j < kAround; ++j) {
        const double phi = (j + .5) * kTau / kAround;
        at[j] = z * up + sine * (std::cos(phi) * x + std::sin(phi) * y);
        for (int a = 0; a < 3; ++a) d[a][j] = float(at[j][a]);
      }
      const brume_rays rays = {kAround, nullptr, nullptr, nullptr, d[0], d[1], d[2]};
      light.radiance(light.self, &rays, L[0], L[1], L[2]);
      const double weight = rule.w[k] / 2 * kTau / kAround;
      for (int j = 0; j < kAround; ++j) {
        double part[3];
        for (int c = 0; c < 3; ++c)
          part[c] = std::isfinite(L[c][j]) && L[c][j] > 0 ? weight * double(L[c][j]) : 0;
        add(h, at[j], part, sums);
      }
    }

  i = 0;
  for (int m = 0; m <= SkyHarmonics::kDegree; ++m)
    for (int l = m; l <= SkyHarmonics::kDegree; ++l, ++i)
      for (int c = 0; c < 3; ++c) {
        const double factor = cosine_lobe(l) * norm2(l, m);
        h.C[c][i] = float(factor * sums[std::size_t(c)][0][std::size_t(i)]);
        h.S[c][i] = float(factor * sums[std::size_t(c)][1][std::size_t(i)]);
      }
  return h;
}

}  // namespace

const SkyHarmonics& SkyIrradiance::harmonics() const {
  std::call_once(once_, [this] { harmonics_ = harmonics_of(light_, up_); });
  return harmonics_;
}

}  // namespace brume::air
