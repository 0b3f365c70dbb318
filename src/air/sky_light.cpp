#include "air/sky_light.h"

#include <algorithm>
#include <cmath>

#include "air/sky_panels.h"
#include "num/quadrature.h"

namespace brume::air {
namespace {

constexpr int kOrders = SkyMap::kAround / 2;  // m from 0 on
constexpr std::size_t kRings = SkyPanel::kRings;

// L_m of a panel's rings, by cos(m phi) and sin(m phi).
struct Orders {
  const SkyPanel* panel;
  double C[kRings][3][kOrders], S[kRings][3][kOrders];
};

Orders orders_of(const SkyPanel& panel) {
  Orders r{&panel, {}, {}};
  for (std::size_t k = 0; k < kRings; ++k)
    for (std::size_t m = 0; m < kOrders; ++m)
      for (std::size_t j = 0; j < kSkySamples; ++j) {
        const auto& [x, y] = turns<kSkySamples>()[m * j % kSkySamples];
        for (int c = 0; c < 3; ++c) {
          const double L = (m ? 2. : 1.) / kSkySamples * panel.rings[k].L[c][j];
          r.C[k][c][m] += L * x;
          r.S[k][c][m] += L * y;
        }
      }
  return r;
}

// K_m = Int cos(m psi) max(a + b cos(psi), 0) dpsi over a turn, b >= 0. Positive up to
// psi_0 = arccos(-a/b):
//   K_m = 2 a sin(m psi_0)/m + b (sin((m + 1) psi_0)/(m + 1) + sin((m - 1) psi_0)/(m -
//   1)), each sin(k psi_0)/k being psi_0 where k = 0.
void clamped_cosine(double a, double b, double K[kOrders]) {
  const double psi = a >= b ? kTurn / 2 : a <= -b ? 0 : std::acos(-a / b);
  double over[kOrders + 2];  // sin(k psi)/k, k from 0 on
  const double twice = 2 * std::cos(psi);
  double before = 0, here = std::sin(psi);
  over[0] = psi;
  for (int k = 1; k < kOrders + 2; ++k) {
    over[k] = here / k;
    const double next = twice * here - before;
    before = here, here = next;
  }
  K[0] = 2 * (a * psi + b * over[1]);
  for (int m = 1; m < kOrders; ++m)
    K[m] = 2 * a * over[m] + b * (over[m + 1] + over[m - 1]);
}

// Weights of a panel's rings in E_m of normals at an angle to up: K_m times their
// own. Where rings begin and end to be cut by the plane's own horizon, at elevations
// of angle and -angle, K_m bends as a power 3/2: a panel that has such a place in it is
// integrated anew up to there and from there on, L being the polynomial through its
// rings, in u with e' = u^2 (3 - 2 u), of which the power 3/2 is smooth.
void weights_of(const SkyPanel& p, double angle, double W[kRings][kOrders]) {
  const double cosine = std::cos(angle), sine = std::sin(angle);
  double ends[4] = {p.lo};
  int pieces = 0;
  for (const double e : {-angle, angle})
    if (e > ends[pieces] && e < p.hi) ends[++pieces] = e;
  if (pieces == 0) {
    for (std::size_t k = 0; k < kRings; ++k) {
      clamped_cosine(cosine * p.rings[k].z, sine * p.rings[k].s, W[k]);
      for (int m = 0; m < kOrders; ++m) W[k][m] *= p.weight(k);
    }
    return;
  }
  ends[++pieces] = p.hi;
  std::fill_n(W[0], kRings * kOrders, 0.);
  static constexpr auto rule = gauss_legendre<12>();
  for (int i = 0; i < pieces; ++i)
    for (int q = 0; q < rule.size; ++q) {
      const double length = ends[i + 1] - ends[i], u = (1 + double(rule.x[q])) / 2;
      const double e = ends[i] + length * u * u * (3 - 2 * u);
      const double weight = length * 3 * u * (1 - u) * double(rule.w[q]) * std::cos(e);
      double K[kOrders];
      clamped_cosine(cosine * std::sin(e), sine * std::cos(e), K);
      for (std::size_t k = 0; k < kRings; ++k) {
        double part = weight;  // Lagrange's polynomial of ring k
        for (std::size_t j = 0; j < kRings; ++j)
          if (j != k)
            part *= (e - p.rings[j].elevation) /
                    (p.rings[k].elevation - p.rings[j].elevation);
        for (int m = 0; m < kOrders; ++m) W[k][m] += part * K[m];
      }
    }
}

// Angle to up of a row's normals.
double angle_of(int row, double edge) {
  const bool in_cap = row <= SkyMap::kCap;
  const double part = in_cap ? double(row) / SkyMap::kCap
                             : double(row - SkyMap::kCap - 1) / SkyMap::kBelt;
  return edge + part * part * (in_cap ? -edge : kTurn / 4 - edge);
}

// Coefficients of the row of normals at an angle to up.
void fill_row(const std::vector<Orders>& panels, double angle, float to[SkyMap::kRow]) {
  double C[3][kOrders] = {}, S[3][kOrders] = {};
  for (const Orders& p : panels) {
    double W[kRings][kOrders];
    weights_of(*p.panel, angle, W);
    for (std::size_t k = 0; k < kRings; ++k)
      for (int c = 0; c < 3; ++c)
        for (int m = 0; m < kOrders; ++m) {
          C[c][m] += W[k][m] * p.C[k][c][m];
          S[c][m] += W[k][m] * p.S[k][c][m];
        }
  }
  constexpr std::size_t N = SkyMap::kAround;
  const auto& turn = turns<N>();
  for (std::size_t j = 0; j < N; ++j)
    for (std::size_t c = 0; c < 3; ++c) {
      double sum = 0;
      for (std::size_t m = 0; m < kOrders; ++m) {
        const auto& [x, y] = turn[j * m % N];
        // A B-spline leaves (2 + cos(m h))/3 of a wave with steps of h.
        sum += (C[c][m] * x + S[c][m] * y) * 3 / (2 + turn[m][0]);
      }
      to[4 * (j + 1) + c] = float(sum);
    }
  // Around once more.
  std::copy_n(to + 4 * N, 4, to);
  std::copy_n(to + 4, 8, to + 4 * (N + 1));
}

SkyMap map_of(const brume_light& light, const glm::dvec3& up) {
  const SkyPanels sky = panels_of(light, up);
  std::vector<Orders> panels;
  for (const SkyPanel& p : sky.panels) panels.push_back(orders_of(p));

  SkyMap map;
  for (int k = 0; k < 3; ++k)
    for (int a = 0; a < 3; ++a) map.axis[k][a] = float(sky.axis[k][a]);
  // Planes with these normals touch the horizon.
  const double edge = std::min(std::abs(sky.horizon), 1.5);
  map.edge = float(edge);
  map.cap = edge > 0 ? float(SkyMap::kCap * SkyMap::kCap / edge) : 0;
  map.belt = float(SkyMap::kBelt * SkyMap::kBelt / (kTurn / 4 - edge));
  map.E.resize(std::size_t(SkyMap::kRows * SkyMap::kRow));
  for (int row = 0; row < SkyMap::kRows; ++row)
    fill_row(panels, angle_of(row, edge), &map.E[std::size_t(row * SkyMap::kRow)]);

  for (int c = 0; c < 3; ++c) {
    double F[3] = {};
    for (const Orders& p : panels)
      for (std::size_t k = 0; k < kRings; ++k) {
        const SkyRing& r = p.panel->rings[k];
        const double half_turn = kTurn / 2 * p.panel->weight(k);
        F[0] += half_turn * r.s * p.C[k][c][1];
        F[1] += half_turn * r.s * p.S[k][c][1];
        F[2] += 2 * half_turn * r.z * p.C[k][c][0];
      }
    for (int k = 0; k < 3; ++k) map.flux[c][k] = float(F[k]);
  }
  return map;
}

}  // namespace

const SkyMap& SkyIrradiance::map() const {
  std::call_once(once_, [this] { map_ = map_of(light_, up_); });
  return map_;
}

}  // namespace brume::air
