#include "forward.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "column.h"
#include "harmonics.h"

namespace brume::sky {
namespace {

// q_k = sum_{l > L} (2l+1)/(4 pi) beta_l^{k+1} P_l(nu), k = 0 (what truncation leaves of
// p_M itself) to 3.
std::array<double, 4> forward_series(const std::vector<double>& beta, int L, double nu) {
  std::array<double, 4> q{};
  double before = 1, p = nu;
  for (int l = 2; l < static_cast<int>(beta.size()); ++l) {
    const double next = ((2 * l - 1) * nu * p - (l - 1) * before) / l;
    before = p, p = next;
    double term = l > L ? (2 * l + 1) / (4 * M_PI) * p : 0;
    for (double& k : q) k += (term *= beta[l]);
  }
  return q;
}

// Column of Mie scatterers from altitude h in direction mu, to space or to the ground.
double column(const Atmosphere& a, double h, double mu) {
  const double R = a.planet_radius, H = a.mie_scale_height, r = R + h;
  const double c_t = h * (2 * R + h) - r * r * mu * mu;  // of the line's lowest point
  const auto to_space = [&](double z, double m) {
    return std::exp(-z / H) * exponential_column<double>(R + z, m, H);
  };
  if (mu >= 0) return to_space(h, mu);
  const double beyond = c_t > 0 ? 2 * to_space(altitude<double>(c_t, R), 0)
                                : to_space(0, std::sqrt(-c_t) / R);
  return std::max(beyond - to_space(h, -mu), 0.);
}

}  // namespace

ForwardTables forward_tables(const Atmosphere& a, int L) {
  using F = Forward<double>;
  const double g = a.mie_g;
  ForwardTables out;
  std::vector<double> beta;
  for (int l = 0; l < 300 && (l <= L + 1 || std::abs(beta.back()) > 1e-6); ++l)
    beta.push_back(mie_eigenvalue(l, g));
  for (int i = 0; i <= F::kAngles; ++i) {
    const double s = double(i) / F::kAngles;  // sin(theta/2)
    const auto q = forward_series(beta, L, 1 - 2 * s * s);
    out.series.insert(out.series.end(), {q[1], q[2] / 2, q[3] / 6});
  }

  // Weight of the neighbour at angle theta; midpoints in sqrt(theta) are dense at the
  // core.
  constexpr int kTheta = 24, kPsi = 16;
  double cosine[kTheta], sine[kTheta], weight[kTheta], cos_psi[kPsi], total = 0;
  for (int i = 0; i < kTheta; ++i) {
    const double v = (i + .5) / kTheta, theta = M_PI * v * v;
    cosine[i] = std::cos(theta), sine[i] = std::sin(theta);
    weight[i] =
        forward_series(beta, L, cosine[i])[0] * phase_mie(cosine[i], g) * sine[i] * v;
    total += weight[i];
  }
  for (int i = 0; i < kPsi; ++i) cos_psi[i] = std::cos(M_PI * (i + .5) / kPsi);
  const ForwardAxis axis;
  out.column.assign(F::kAltitudes * F::kDirections, 0.);
  if (g <= 0 || !(total > 1e-12)) return out;
  for (int i = 0; i < F::kAltitudes; ++i)
    for (int j = 0; j < F::kDirections; ++j) {
      const double h = a.atmosphere_height * std::pow(double(i) / (F::kAltitudes - 1), 3);
      const double mu = std::clamp(F::kScale * std::sinh(axis.y_min + j * axis.dy), -1.,
                                   1.),
                   s = std::sqrt(1 - mu * mu);
      double sum = 0;
      for (int k = 0; k < kTheta; ++k)
        for (double c : cos_psi)
          sum += weight[k] *
                 column(a, h, std::clamp(mu * cosine[k] + s * sine[k] * c, -1., 1.));
      out.column[i * F::kDirections + j] = std::max(sum / (total * kPsi), 0.);
    }
  return out;
}

}  // namespace brume::sky
