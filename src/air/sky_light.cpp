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

/// A sky light by rings about `up`.
class Sphere {
 public:
  Sphere(const brume_light& light, const glm::dvec3& up)
      : light_(light),
        up_(up),
        x_(glm::normalize(glm::cross(
            up, std::abs(up.x) < .5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)))),
        y_(glm::cross(up, x_)) {}

  template <std::size_t N>
  struct Ring {
    glm::dvec3 at[N];
    double L[3][N];  ///< what is no number, or negative, is no light
  };
  template <std::size_t N>
  Ring<N> ring(double z) const {
    Ring<N> r;
    float d[3][N], L[3][N];
    const double sine = std::sqrt((1 - z) * (1 + z));
    for (std::size_t j = 0; j < N; ++j) {
      const double phi = (double(j) + .5) * kTau / N;
      r.at[j] = z * up_ + sine * (std::cos(phi) * x_ + std::sin(phi) * y_);
      for (int a = 0; a < 3; ++a) d[a][j] = float(r.at[j][a]);
    }
    const brume_rays rays = {N, nullptr, nullptr, nullptr, d[0], d[1], d[2]};
    light_.radiance(light_.self, &rays, L[0], L[1], L[2]);
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t j = 0; j < N; ++j)
        r.L[c][j] = std::isfinite(L[c][j]) && L[c][j] > 0 ? double(L[c][j]) : 0;
    return r;
  }

 private:
  const brume_light& light_;
  glm::dvec3 up_, x_, y_;
};

// The height at which a sky jumps most from ring to ring: rings are cut there. An eye on
// the ground has it a little below 0, where a strip of 1e-3 is 1e-3 of the light.
double horizon(const Sphere& sphere) {
  const auto light = [&](double z) {
    const auto ring = sphere.ring<16>(z);
    double sum = 0;
    for (const auto& plane : ring.L)
      for (const double L : plane) sum += L;
    return sum;
  };
  constexpr int kSteps = 128;  // 0 among them
  const auto height = [](int i) { return 2. * i / kSteps - 1; };
  double best = 0, lo = 0, hi = 0, before = light(-1);
  for (int i = 1; i <= kSteps; ++i) {
    const double here = light(height(i));
    if (std::abs(here - before) > best) {
      best = std::abs(here - before);
      lo = height(i - 1), hi = height(i);
    }
    before = here;
  }
  if (best == 0) return 0;
  // On the side where most of the change is.
  double at_lo = light(lo), at_hi = light(hi);
  while (hi - lo > 1e-6) {
    const double middle = (lo + hi) / 2, here = light(middle);
    if (std::abs(here - at_lo) > std::abs(at_hi - here))
      hi = middle, at_hi = here;
    else
      lo = middle, at_lo = here;
  }
  return (lo + hi) / 2;
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

  // Rings of even height, above the horizon and below it each by themselves.
  constexpr int kRings = 64, kAround = 128;
  const RuleOfSize rule = gauss_legendre(kRings);
  const Sphere sphere(light, up);
  const double middle = horizon(sphere);
  Sums sums{};
  for (const double end : {-1., 1.})
    for (std::size_t k = 0; k < kRings; ++k) {
      const double z = middle + (end - middle) * (1 + rule.x[k]) / 2;
      const auto ring = sphere.ring<kAround>(z);
      const double weight = std::abs(end - middle) * rule.w[k] / 2 * kTau / kAround;
      for (std::size_t j = 0; j < kAround; ++j) {
        double part[3];
        for (std::size_t c = 0; c < 3; ++c) part[c] = weight * ring.L[c][j];
        add(h, ring.at[j], part, sums);
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
