#include "oracle.h"

#include "num/quadrature.h"

namespace brume::noise_fog {
namespace {

// The middles of a cube's edges (Perlin 2002), by what a corner's hash says: its two
// highest bits are signs, the 23 below pick the axis that is left out.
Point gradient(std::uint32_t hash) {
  const double first = hash >> 31 ? -1 : 1, second = hash >> 30 & 1 ? -1 : 1;
  const double pick = double(hash << 2 >> 9) / (1 << 23);
  if (pick < 1. / 3) return {0, first, second};
  if (pick > 2. / 3) return {first, second, 0};
  return {first, 0, second};
}

double fade(double t) { return t * t * t * (t * (6 * t - 15) + 10); }

/// The lattice points below and above along each axis, in a period's first turn.
struct Cell {
  std::uint32_t below[3], above[3], seed;
};

std::uint32_t wrapped(double lattice, double turn) {
  if (lattice >= 0 && lattice < turn) return std::uint32_t(lattice);
  const double r = std::fmod(lattice, turn);
  return std::uint32_t(r < 0 ? r + turn : r);
}

/// The gradients at a cell's eight corners; bit k of the index: above along axis k.
struct Corners {
  Cell of{};
  bool known = false;
  Point gradient[8];
};

// Points along a ray share cells, and hashing their corners takes most of the time: those
// met last are kept, by thread.
const Corners& corners(const Cell& cell) {
  constexpr std::size_t kKept = 2048;
  thread_local std::vector<Corners> kept(kKept);
  const std::uint32_t *b = cell.below, *a = cell.above;
  const std::uint32_t mixed = (b[0] * 0x9e3779b1u) ^ (b[1] * 0x85ebca77u) ^
                              (b[2] * 0xc2b2ae3du) ^ (cell.seed * 0x27d4eb2fu);
  Corners& c = kept[(mixed >> 15 ^ mixed) % kKept];
  const auto same = [&](int k) { return c.of.below[k] == b[k] && c.of.above[k] == a[k]; };
  if (c.known && c.of.seed == cell.seed && same(0) && same(1) && same(2)) return c;
  c.of = cell;
  c.known = true;
  for (int n = 0; n < 8; ++n)
    c.gradient[n] = gradient(
        brume::hash((n & 1 ? a : b)[0], (n & 2 ? a : b)[1], (n & 4 ? a : b)[2], cell.seed)
            .x);
  return c;
}

}  // namespace

double gradient_noise(const Point& q, std::uint32_t seed, int period) {
  const double turn = period > 0 ? period : 0x1p32;
  Cell cell{{}, {}, seed};
  double away[3][2], weight[3][2];  // from the corner below and the one above
  for (std::size_t k = 0; k < 3; ++k) {
    const double lower = std::floor(q[k]), x = q[k] - lower;
    cell.below[k] = wrapped(lower, turn);
    cell.above[k] = double(cell.below[k]) + 1 < turn ? cell.below[k] + 1 : 0;
    away[k][0] = x, away[k][1] = x - 1;
    weight[k][1] = fade(x), weight[k][0] = 1 - weight[k][1];
  }
  const Corners& c = corners(cell);
  double sum = 0;
  for (int n = 0; n < 8; ++n) {
    const int i = n & 1, j = n >> 1 & 1, k = n >> 2;
    const Point& g = c.gradient[n];
    sum += weight[0][i] * weight[1][j] * weight[2][k] *
           (g[0] * away[0][i] + g[1] * away[1][j] + g[2] * away[2][k]);
  }
  return sum;
}

double log_mean_exponential(double c) {
  // Corners are independent: at a place the mean is a product of eight, each the mean
  // over twelve gradients (w a, w b, 0) with all signs: (1/3) Sum cosh cosh over axes.
  static const auto rule = brume::gauss_legendre<12>();
  double mean = 0;
  for (int i = 0; i < 1728; ++i) {
    const int at[3] = {i % 12, i / 12 % 12, i / 144};
    double product = 1, volume = 1;
    Point x;
    for (std::size_t k = 0; k < 3; ++k) {
      x[k] = double(1 + rule.x[std::size_t(at[k])]) / 2;
      volume *= double(rule.w[std::size_t(at[k])]) / 2;
    }
    for (int corner = 0; corner < 8; ++corner) {
      double w = c, ch[3];
      for (std::size_t k = 0; k < 3; ++k) w *= fade(corner >> k & 1 ? x[k] : 1 - x[k]);
      for (std::size_t k = 0; k < 3; ++k)
        ch[k] = std::cosh(w * (corner >> k & 1 ? 1 - x[k] : x[k]));
      product *= (ch[0] * ch[1] + ch[1] * ch[2] + ch[2] * ch[0]) / 3;
    }
    mean += volume * product;
  }
  return std::log(mean);
}

namespace {

// log_mean_exponential over [0, 8], by cubic interpolation between 257 places: within
// 1e-9.
double log_mean_table(double c) {
  constexpr int n = 256;
  static const std::vector<double> table = [] {
    std::vector<double> v;
    for (int i = -1; i <= n + 1; ++i)
      v.push_back(log_mean_exponential(std::abs(8. * i / n)));
    return v;
  }();
  const double u = std::min(std::abs(c) / 8 * n, n - 1e-9);
  const auto i = std::size_t(u);
  const double t = u - double(i);
  const double* f = table.data() + i;
  return -f[0] * t * (t - 1) * (t - 2) / 6 + f[1] * (t + 1) * (t - 1) * (t - 2) / 2 -
         f[2] * (t + 1) * t * (t - 2) / 2 + f[3] * (t + 1) * t * (t - 1) / 6;
}

}  // namespace

Oracle::Oracle(const Look& s) : s_(s) {
  for (int k = 0; k < s_.octaves && s_.contrast > 0; ++k)
    waves_.push_back({cell_of(s_, k), amplitude(s_, k), stagger(s_, k)});
}

double Oracle::rho(const Point& x, double filter_variance) const {
  double z = 0, above_eye = 0, log_rho = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    z += s_.up[i] * x[i];
    above_eye += s_.up[i] * (x[i] - s_.eye[i]);
  }
  double W = 0;  // e^(-10 s^2/cell^2); of half the cell the fourth power
  for (std::size_t k = 0; k < waves_.size(); ++k) {
    const auto& [cell, amplitude, apart] = waves_[k];
    W = k == 0 ? std::exp(-10 * filter_variance / (cell * cell)) : (W * W) * (W * W);
    if (W <= 1e-3) break;
    Point q;
    for (std::size_t i = 0; i < 3; ++i) q[i] = (x[i] - s_.shift[i]) / cell + apart[i];
    const double c = amplitude * W;
    const auto seed = std::uint32_t(s_.seed) * 16 + std::uint32_t(k);
    log_rho += c * gradient_noise(q, seed, s_.period > 0 ? s_.period << k : 0) -
               log_mean_table(c);
  }
  double clear = 1;
  if (s_.clearing > 0) {
    const double half = std::pow(above_eye / s_.clearing, 2) / 2;
    clear = 0.001 + 0.999 * half / (1 + half);
  }
  return std::exp(std::min(log_rho - s_.falloff * (z - s_.height), 300.)) * clear;
}

double Oracle::density(const Point& x) const {
  const Point seen = {x[0] - s_.eye[0], x[1] - s_.eye[1], x[2] - s_.eye[2]};
  return rho(x, pixel_variance(s_.pixel(seen)) + blur_variance(s_));
}

double Oracle::unfiltered(const Point& x) const { return rho(x, blur_variance(s_)); }

}  // namespace brume::noise_fog
