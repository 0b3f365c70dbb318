#include "solve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "lookup.h"

namespace brume::sky {
namespace {

template <class S>
Air<S> make_air(const Atmosphere& a, int begin, int N) {
  Air<S> out{};
  out.shape = {S(a.planet_radius),    S(a.atmosphere_height), S(a.rayleigh_scale_height),
               S(a.mie_scale_height), S(a.ozone_altitude),    S(a.ozone_half_width)};
  out.g = S(a.mie_g);
  for (int l = 0; l <= kMaxL; ++l) out.beta_M[l] = S(mie_eigenvalue(l, a.mie_g));
  for (int i = 0; i < N; ++i) {
    const std::size_t k = std::min<std::size_t>(begin + i, a.wavelengths.size() - 1);
    out.scatter_R[i] = out.extinct_R[i] = S(a.rayleigh_scattering[k]);
    out.scatter_M[i] = S(a.mie_scattering[k]), out.extinct_M[i] = S(a.mie_extinction[k]);
    out.absorb_O[i] = S(a.ozone_absorption[k]);
    out.irradiance[i] = S(a.solar_irradiance[k]),
    out.ground_albedo[i] = S(a.ground_albedo[k]);
  }
  return out;
}

struct Node {
  double x, weight;
};
// Gauss and Legendre on [0, 1], Newton on P_n.
std::vector<Node> gauss_legendre(int n) {
  std::vector<Node> q;
  for (int i = 0; i < n; ++i) {
    double x = std::cos(M_PI * (i + .75) / (n + .5)), slope = 0;
    for (int step = 0; step < 10; ++step) {
      double before = 1, p = x;
      for (int k = 2; k <= n; ++k) {
        const double next = ((2 * k - 1) * x * p - (k - 1) * before) / k;
        before = p, p = next;
      }
      slope = n * (x * p - before) / (x * x - 1);
      x -= p / slope;
    }
    q.push_back({.5 * (1 + x), 1 / ((1 - x * x) * slope * slope)});
  }
  return q;
}

// The sun heights' axis (types.h), and back by Newton's method.
double axis(double elevation) {
  return std::asinh(elevation / Table<float>::kHorizon) +
         Table<float>::kSpread * elevation;
}
double elevation(double y) {
  double e = 0;
  for (int i = 0; i < 60; ++i) {
    const double slope =
        1 / std::hypot(e, Table<float>::kHorizon) + Table<float>::kSpread;
    e = std::min(e - (axis(e) - y) / slope, M_PI / 2);
  }
  return e;
}

// Of sun heights: the lowest stands twice as deep as where the top of the air goes dark.
struct SunAxis {
  double y_min, dy;
  SunAxis(const Atmosphere& a, const Resolution& r)
      : y_min(axis(-2.2 *
                   std::acos(a.planet_radius / (a.planet_radius + a.atmosphere_height)))),
        dy((axis(M_PI / 2) - y_min) / (r.suns - 1)) {}
};

template <class S>
class Solver {
 public:
  Solver(const Atmosphere& a, const Resolution& r, const Kernels<S>& k, Light<S>& out)
      : a_(a),
        r_(r),
        k_(k),
        out_(out),
        row_(harmonics_count(k.L) * k.N),
        rows_(r.suns + 2) {
    const SunAxis y(a, r);
    for (int j = 0; j < r.suns; ++j) elevations_.push_back(elevation(y.y_min + j * y.dy));
  }

  void run() {
    // Sunlight scattered or reflected once.
    std::vector<S> first, first_ground;
    {
      const Stage stage(*this, r_.first);
      gather(stage, true, first, first_ground);
    }
    // In place: out_.table points there.
    std::copy(first.begin(), first.end(), out_.nodes.begin());
    std::copy(first_ground.begin(), first_ground.end(), out_.ground.begin());

    // Each later order; when they fall off evenly, what is left is a geometric series.
    const Stage stage(*this, r_.next);
    std::vector<double> before(k_.N), change(k_.N);
    std::vector<S> nodes, ground;
    for (int order = 1; order <= r_.orders; ++order) {
      gather(stage, false, nodes, ground);
      before = change;
      change.assign(k_.N, 0.);
      for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i] += first[i];
      // Measured by day: at night first orders fall off faster than later ones.
      for (std::size_t node = 0; node < nodes.size() / row_; ++node) {
        const int j = static_cast<int>(node % rows_) - 1;
        if (j < 0 || j >= r_.suns || elevations_[j] < 0) continue;
        for (int i = 0; i < row_; ++i)
          change[i % k_.N] +=
              std::abs(nodes[node * row_ + i] - out_.nodes[node * row_ + i]);
      }
      std::vector<S> more(k_.N, S(0));
      if (order == r_.orders && order > 1)
        for (int i = 0; i < k_.N; ++i) {
          const double ratio = before[i] > 0 ? std::min(change[i] / before[i], .95) : 0;
          more[i] = S(ratio / (1 - ratio));
        }
      for (std::size_t i = 0; i < nodes.size(); ++i)
        out_.nodes[i] = nodes[i] + more[i % k_.N] * (nodes[i] - out_.nodes[i]);
      for (std::size_t i = 0; i < ground.size(); ++i) {
        const S g = ground[i] + first_ground[i];
        out_.ground[i] = g + more[i % k_.N] * (g - out_.ground[i]);
      }
    }
  }

 private:
  struct Direction {
    std::unique_ptr<Line<S>> line;
    int altitude;
    S weight;  // solid angle [sr] per azimuth
  };
  // Paths from every altitude, and the suns they are lit by.
  struct Stage {
    std::vector<S> mu_s, sin_cos, cos_phi;
    Suns<S> suns;
    std::vector<Direction> directions;

    Stage(const Solver& s, const Directions& d) {
      constexpr int kLanes = 16;
      const int used = s.r_.suns * d.around,
                count = (used + kLanes - 1) / kLanes * kLanes;
      mu_s.assign(count, S(0)), sin_cos.assign(count, S(0));
      for (int k = 0; k < d.around; ++k)
        cos_phi.push_back(S(std::cos(M_PI * (k + .5) / d.around)));
      for (int i = 0; i < used; ++i) {
        const double e = s.elevations_[i / d.around];
        mu_s[i] = S(std::sin(e)), sin_cos[i] = S(std::cos(e)) * cos_phi[i % d.around];
      }
      suns = {count, s.r_.suns, d.around, mu_s.data(), sin_cos.data(), cos_phi.data()};

      const double R = s.a_.planet_radius, top = s.a_.atmosphere_height;
      const auto up = gauss_legendre(d.up), down = gauss_legendre(d.down);
      for (int i = 0; i < s.r_.altitudes; ++i) {
        const double x = double(i) / (s.r_.altitudes - 1), h = top * x * x, r = R + h;
        const double horizon = -std::sqrt(h * (2 * R + h)) / r;
        const auto add = [&](double mu, double weight, bool ground) {
          auto line = std::make_unique_for_overwrite<Line<S>>();
          const Trace t = trace(R, top, {h, mu, 0, 0}, {});
          s.k_.line(s.out_.air, t, d.panels, *line);
          line->r = S(r), line->t_end = S(t.t_end), line->mu = S(mu),
          line->s = S(std::sqrt(1 - mu * mu));
          line->ground = ground;
          directions.push_back({std::move(line), i, S(weight * 2 * M_PI / d.around)});
        };
        // Elevations cluster at the horizon, where light changes fastest: mu = horizon +-
        // (..) v^2.
        for (auto [v, w] : up)
          add(horizon + (1 - horizon) * v * v, (1 - horizon) * 2 * v * w, false);
        for (auto [v, w] : down)
          add(horizon - (1 + horizon) * v * v, (1 + horizon) * 2 * v * w, true);
      }
    }
  };

  void gather(const Stage& stage, bool first, std::vector<S>& nodes,
              std::vector<S>& ground) {
    nodes.assign(out_.nodes.size(), S(0));
    ground.assign(out_.ground.size(), S(0));
    std::vector<S> light(std::size_t(stage.suns.count) * k_.N);
    for (const Direction& d : stage.directions) {
      if (first)
        k_.first(out_.air, *d.line, stage.suns, light.data());
      else
        k_.next(out_.air, out_.table, *d.line, stage.suns, light.data());
      const bool falls_on_ground = d.altitude == 0 && d.line->mu > 0;
      k_.project(*d.line, stage.suns, d.weight, light.data(),
                 &nodes[(std::size_t(d.altitude) * rows_ + 1) * row_],
                 falls_on_ground ? &ground[k_.N] : nullptr);
    }
    // What is left without the way twilight fades.
    for (int j = 0; j < r_.suns; ++j)
      for (int i = 0; i < r_.altitudes; ++i) {
        const S left = fade(out_.table, S(i) / S(r_.altitudes - 1), S(elevations_[j]));
        S* node = &nodes[(std::size_t(i) * rows_ + j + 1) * row_];
        for (int c = 0; c < row_; ++c) node[c] /= left;
        for (int c = 0; i == 0 && c < k_.N; ++c) ground[(j + 1) * k_.N + c] /= left;
      }
    std::vector<S> parity;  // of each coefficient, when the sun crosses the zenith
    for (int l = 0; l <= k_.L; ++l)
      for (int m = 0; m <= l; ++m) parity.insert(parity.end(), k_.N, S(m % 2 ? -1 : 1));
    for (int i = 0; i < r_.altitudes; ++i)
      ghosts(&nodes[std::size_t(i) * rows_ * row_], parity);
    ghosts(ground.data(), std::vector<S>(k_.N, S(1)));
  }

  // Straight on into the night; beyond the zenith what lies before it, turned about.
  void ghosts(S* rows, const std::vector<S>& parity) const {
    const std::size_t size = parity.size();
    S* last = rows + std::size_t(rows_ - 1) * size;
    for (std::size_t c = 0; c < size; ++c) {
      rows[c] = 2 * rows[size + c] - rows[2 * size + c];
      last[c] = parity[c] * (last - 2 * size)[c];
    }
  }

  const Atmosphere& a_;
  const Resolution& r_;
  const Kernels<S>& k_;
  Light<S>& out_;
  const int row_, rows_;
  std::vector<double> elevations_;  // of the sun, [rad]
};

}  // namespace

template <class S>
void lay_out(const Atmosphere& a, int begin, const Resolution& r, const Kernels<S>& k,
             Light<S>& out) {
  const double R = a.planet_radius, top = a.atmosphere_height;
  const std::size_t rows = r.suns + 2;
  out.N = k.N, out.L = k.L;
  out.air = make_air<S>(a, begin, k.N);
  out.nodes.assign(r.altitudes * rows * harmonics_count(k.L) * k.N, S(0));
  out.ground.assign(rows * k.N, S(0));
  const SunAxis y(a, r);
  out.table = {r.altitudes,
               r.suns,
               S(1 / top),
               S(y.y_min),
               S(1 / y.dy),
               S(R / (2 * a.rayleigh_scale_height)),
               S(std::sqrt(6 * a.rayleigh_scale_height / R)),
               S(std::sqrt(2 * top / R)),
               out.nodes.data(),
               out.ground.data()};
  using F = Forward<double>;
  out.series.assign((F::kAngles + 1) * F::kTerms, S(0));
  out.column.assign(F::kAltitudes * F::kDirections, S(0));
  const ForwardAxis mu;
  out.forward = {out.series.data(), out.column.data(), S(1 / top), S(mu.y_min),
                 S(1 / mu.dy)};
}

template <class S>
void solve(const Atmosphere& a, int begin, const Resolution& r, const Kernels<S>& k,
           Light<S>& out) {
  lay_out(a, begin, r, k, out);
  Solver<S>(a, r, k, out).run();
  const ForwardTables f = forward_tables(a, k.L);
  std::copy(f.series.begin(), f.series.end(), out.series.begin());
  std::copy(f.column.begin(), f.column.end(), out.column.begin());
}

template void lay_out(const Atmosphere&, int, const Resolution&, const Kernels<float>&,
                      Light<float>&);
template void solve(const Atmosphere&, int, const Resolution&, const Kernels<float>&,
                    Light<float>&);
template void solve(const Atmosphere&, int, const Resolution&, const Kernels<double>&,
                    Light<double>&);

}  // namespace brume::sky
