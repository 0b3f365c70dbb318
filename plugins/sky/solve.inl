#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

namespace brume::sky {

template <class S, int N>
Air<S, N> make_air(const Atmosphere& a) {
  Air<S, N> out;
  out.shape = {S(a.planet_radius),    S(a.atmosphere_height), S(a.rayleigh_scale_height),
               S(a.mie_scale_height), S(a.ozone_altitude),    S(a.ozone_half_width)};
  out.g = S(a.mie_g);
  const auto lanes = [&](const std::vector<double>& v) {
    S x[N];
    for (int i = 0; i < N; ++i) x[i] = S(v[std::min<std::size_t>(i, v.size() - 1)]);
    return Spectrum<S, N>::at(x);
  };
  out.at1 = {lanes(a.rayleigh_scattering), lanes(a.mie_scattering),
             lanes(a.rayleigh_scattering), lanes(a.mie_extinction),
             lanes(a.ozone_absorption)};
  out.irradiance = lanes(a.solar_irradiance), out.ground_albedo = lanes(a.ground_albedo);
  for (int l = 0; l < 8; ++l) out.beta_M[l] = S(mie_eigenvalue(l, a.mie_g));
  return out;
}

/// Nodes in (0, 1) and weights of Gauss and Legendre: Newton on P_n.
inline std::vector<std::array<double, 2>> gauss_legendre(int n) {
  std::vector<std::array<double, 2>> q(n);
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
    q[i] = {.5 * (1 + x), 1 / ((1 - x * x) * slope * slope)};
  }
  return q;
}

template <class S, int N, int L>
void solve(const Atmosphere& a, const Resolution& res, const Gather<S, N, L>& gather,
           DiffuseLight<S, N>& out) {
  constexpr int kCount = harmonics_count(L);
  const double R = a.planet_radius, top = a.atmosphere_height;
  const int rows = res.suns + 2, na = res.around, W = lanes<Lanes<S>>;
  out.air = make_air<S, N>(a);
  {
    const auto f = forward_tables(a, L);
    out.peak = {{f.series.begin(), f.series.end()},
                {f.column.begin(), f.column.end()},
                S(f.inv_top),
                S(f.x0),
                S(f.inv_dx)};
    out.forward = {out.peak.series.data(), out.peak.column.data(), out.peak.inv_top,
                   out.peak.x0, out.peak.inv_dx};
  }

  // Sun heights down to where the top of the air has been dark for as long again as its
  // horizon lies low.
  const double dip = std::sqrt(top * (2 * R + top)) / (R + top), scale = .03;
  const double x_min = std::asinh(-2.2 * dip / scale),
               dx = (std::asinh(1 / scale) - x_min) / (res.suns - 1);
  out.nodes.assign(std::size_t(res.altitudes) * rows * kCount * N, S(0));
  out.ground.assign(std::size_t(rows) * N, S(0));
  out.table = {res.altitudes, res.suns,  S(1 / top),       S(scale),
               S(x_min),      S(1 / dx), out.nodes.data(), out.ground.data()};

  const int count = (res.suns * na + W - 1) / W * W;
  std::vector<S> mu_s(count, S(0)), sin_cos(count, S(0)), cos_phi(na);
  for (int k = 0; k < na; ++k) cos_phi[k] = S(std::cos(M_PI * (k + .5) / na));
  for (int j = 0; j < res.suns; ++j)
    for (int k = 0; k < na; ++k) {
      const double mu = std::min(scale * std::sinh(x_min + j * dx), 1.);
      mu_s[j * na + k] = S(mu),
                    sin_cos[j * na + k] = S(std::sqrt(1 - mu * mu) * cos_phi[k]);
    }
  const Suns<S> suns{count, mu_s.data(), sin_cos.data()};

  // Paths: for each altitude, elevations above and below its horizon, clustered there.
  struct Direction {
    std::unique_ptr<Line<S, N>> line;
    int altitude;
    double weight;
  };
  std::vector<Direction> directions;
  const auto up = gauss_legendre(res.up), down = gauss_legendre(res.down);
  for (int i = 0; i < res.altitudes; ++i) {
    const double x = double(i) / (res.altitudes - 1), h = top * x * x, r = R + h;
    const double horizon = -std::sqrt(h * (2 * R + h)) / r;
    const auto add = [&](double mu, double weight, bool ground) {
      auto line = std::make_unique<Line<S, N>>();
      const Trace t = trace(R, top, {h, mu, 0, 0}, {});
      gather.line(out.air, t, res.panels, *line);
      line->r = S(r), line->t_end = S(t.t_end), line->mu = S(mu),
      line->s = S(std::sqrt(1 - mu * mu)), line->ground = ground;
      directions.push_back({std::move(line), i, weight});
    };
    for (auto [v, w] : up)
      add(horizon + (1 - horizon) * v * v, (1 - horizon) * 2 * v * w, false);
    for (auto [v, w] : down)
      add(horizon - (1 + horizon) * v * v, (1 + horizon) * 2 * v * w, true);
  }

  std::vector<S> first, first_ground, nodes(out.nodes.size()), ground(out.ground.size()),
      sum(std::size_t(count) * N);
  std::array<double, N> before{}, change{};
  for (int order = 0; order <= res.orders; ++order) {
    std::fill(nodes.begin(), nodes.end(), S(0));
    std::fill(ground.begin(), ground.end(), S(0));
    for (const Direction& d : directions) {
      if (order == 0)
        gather.first(out.air, *d.line, suns, sum.data());
      else
        gather.next(out.air, out.table, *d.line, suns, sum.data());
      // Project.
      S polar[kCount], y[64][kCount];
      polar_part<L>(d.line->mu, polar);
      const S weight = S(d.weight * 2 * M_PI / na);
      for (int k = 0; k < na; ++k) {
        S azimuth[L + 1];
        azimuth_part<L>(d.line->s * cos_phi[k], d.line->mu, azimuth);
        for (int l = 0; l <= L; ++l)
          for (int m = 0; m <= l; ++m)
            y[k][harmonic(l, m)] = weight * polar[harmonic(l, m)] * azimuth[m];
      }
      for (int j = 0; j < res.suns; ++j) {
        S* node = &nodes[(std::size_t(d.altitude) * rows + j + 1) * kCount * N];
        for (int k = 0; k < na; ++k) {
          const S* from = &sum[(std::size_t(j) * na + k) * N];
          for (int c = 0; c < kCount; ++c)
            for (int i = 0; i < N; ++i) node[c * N + i] += y[k][c] * from[i];
          if (d.altitude == 0 && d.line->mu > 0)
            for (int i = 0; i < N; ++i)
              ground[(j + 1) * N + i] += weight * d.line->mu * from[i];
        }
      }
    }
    // Ghosts.
    for (int i = 0; i < res.altitudes; ++i)
      for (int c = 0; c < kCount * N; ++c) {
        S* row = &nodes[std::size_t(i) * rows * kCount * N + c];
        constexpr int step = kCount * N;
        row[0] = 2 * row[step] - row[2 * step];
        row[(rows - 1) * step] = 2 * row[(rows - 2) * step] - row[(rows - 3) * step];
      }
    for (int i = 0; i < N; ++i) {
      ground[i] = 2 * ground[N + i] - ground[2 * N + i];
      ground[(rows - 1) * N + i] =
          2 * ground[(rows - 2) * N + i] - ground[(rows - 3) * N + i];
    }

    if (order == 0) {
      first = nodes, first_ground = ground;
      out.nodes = nodes, out.ground = ground;
    } else {
      before = change;
      change.fill(0);
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        nodes[i] += first[i];
        change[i % N] += std::abs(nodes[i] - out.nodes[i]);
      }
      for (std::size_t i = 0; i < ground.size(); ++i) ground[i] += first_ground[i];
      // The orders left over fall off like a geometric series.
      std::array<S, N> more{};
      if (order == res.orders && order > 1)
        for (int i = 0; i < N; ++i) {
          const double ratio =
              std::clamp(change[i] / std::max(before[i], 1e-300), 0., .95);
          more[i] = S(ratio / (1 - ratio));
        }
      for (std::size_t i = 0; i < nodes.size(); ++i)
        out.nodes[i] = nodes[i] + more[i % N] * (nodes[i] - out.nodes[i]);
      for (std::size_t i = 0; i < ground.size(); ++i)
        out.ground[i] = ground[i] + more[i % N] * (ground[i] - out.ground[i]);
    }
    out.table.nodes = out.nodes.data(), out.table.ground = out.ground.data();
  }
}

}  // namespace brume::sky
