#include "oracle.h"

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>

namespace brume::oracle {
namespace {

using Medium = brume_medium;
using V3 = std::array<double, 3>;

V3 at(const Ray& r, double t) {
  return {r.o[0] + t * r.d[0], r.o[1] + t * r.d[1], r.o[2] + t * r.d[2]};
}

V3 local(const Medium& m, const V3& p) {
  V3 q;
  for (int i = 0; i < 3; ++i) {
    const double* row = m.local_from_world + 4 * i;
    q[i] = row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
  }
  return q;
}

bool inside(const Medium& m, const V3& world) {
  const V3 q = local(m, world);
  switch (m.shape) {
    case BRUME_HALF_SPACE:
      return q[2] <= 0;
    case BRUME_BOX:
      return std::abs(q[0]) <= 1 && std::abs(q[1]) <= 1 && std::abs(q[2]) <= 1;
    case BRUME_ELLIPSOID:
      return q[0] * q[0] + q[1] * q[1] + q[2] * q[2] <= 1;
    default:
      return true;
  }
}

V3 world_of(const World& w, const V3& p) {
  return {p[0] + w.eye.x, p[1] + w.eye.y, p[2] + w.eye.z};
}

double density(const Medium& m, const V3& p, const double* direction) {
  double along = 0, r2 = 0;
  for (int i = 0; i < 3; ++i) {
    along += m.direction[i] * (p[i] - m.origin[i]);
    r2 += (p[i] - m.origin[i]) * (p[i] - m.origin[i]);
  }
  switch (m.profile) {
    case BRUME_UNIFORM:
      return 1;
    case BRUME_EXPONENTIAL:
      return std::exp(-m.falloff * along);
    case BRUME_LORENTZIAN:
      return 1 / (1 + m.falloff * r2);
    default: {
      double rho = 0, source[3] = {0, 0, 0};
      m.point(m.self, p.data(), direction, &rho, source);
      return rho;
    }
  }
}

// Parameters at which a ray may enter or leave a shape: all roots, sorted by the caller.
void boundaries(const World& w, const Medium& m, const Ray& r, std::vector<double>& t) {
  const V3 o = local(m, world_of(w, at(r, 0))), e = local(m, world_of(w, at(r, 1)));
  const V3 d = {e[0] - o[0], e[1] - o[1], e[2] - o[2]};
  if (m.shape == BRUME_HALF_SPACE) t.push_back(-o[2] / d[2]);
  if (m.shape == BRUME_BOX)
    for (int i = 0; i < 3; ++i)
      for (double face : {-1., 1.}) t.push_back((face - o[i]) / d[i]);
  if (m.shape == BRUME_ELLIPSOID) {
    const double a = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    const double b = o[0] * d[0] + o[1] * d[1] + o[2] * d[2];
    const double c = o[0] * o[0] + o[1] * o[1] + o[2] * o[2] - 1;
    const double disc = b * b - a * c;
    if (disc > 0)
      for (double s : {-1., 1.}) t.push_back((-b + s * std::sqrt(disc)) / a);
  }
  if (m.start > 0) {  // a sphere around the eye
    double a = 0, b = 0, c = -m.start * m.start;
    for (int i = 0; i < 3; ++i) {
      a += r.d[i] * r.d[i];
      b += r.o[i] * r.d[i];
      c += r.o[i] * r.o[i];
    }
    const double disc = b * b - a * c;
    if (disc > 0)
      for (double s : {-1., 1.}) t.push_back((-b + s * std::sqrt(disc)) / a);
  }
}

double cone_edge(const brume_light& l, double theta) {
  if (l.cone_falloff == 1)
    return std::clamp(std::abs(l.cone / std::max(theta, 1e-12)) - 1, 0., 1.);
  const double x = std::clamp((l.cone - theta) / std::max(l.cone_soft, 1e-6), 0., 1.);
  return x * x * (3 - 2 * x);
}

double phase(const Medium& m, double mu) {
  const double pi = M_PI, g = m.g;
  const double hg = (1 - g * g) / (4 * pi * std::pow(1 + g * g - 2 * g * mu, 1.5));
  if (m.phase == BRUME_RAYLEIGH) return 3 / (16 * pi) * (1 + mu * mu);
  if (m.phase == BRUME_CORNETTE_SHANKS) return hg * 1.5 * (1 + mu * mu) / (2 + g * g);
  return hg;
}

struct Scene {
  const World& world;
  const Ray& ray;
  /// Where each medium ends on this ray by its max_opacity, per channel.
  std::vector<Rgb> cap;

  double rho(std::size_t k, double t) const {
    const Medium& m = world.media[k].what;
    const V3 p = at(ray, t), w = world_of(world, p);
    if (std::hypot(p[0], p[1], p[2]) < m.start || !inside(m, w)) return 0;
    return density(m, w, ray.d);
  }
  /// Extinction and emission at t.
  void point(double t, Rgb& sigma, Rgb& e) const {
    sigma = e = {0, 0, 0};
    for (std::size_t k = 0; k < world.media.size(); ++k) {
      const Medium& m = world.media[k].what;
      const double d = rho(k, t);
      if (d == 0) continue;
      Rgb S = source(m, t);
      for (int c = 0; c < 3; ++c) {
        if (t > cap[k][c]) continue;
        sigma[c] += d * m.extinction[c];
        e[c] += d * (m.emission[c] + m.extinction[c] * S[c]);
      }
    }
  }
  Rgb source(const Medium& m, double t) const {
    Rgb S = {0, 0, 0};
    const V3 p = at(ray, t), w = world_of(world, p);
    const bool sky = m.source == BRUME_SOURCE_SKY;
    if (m.source == BRUME_SOURCE_COLOR) S = {m.color[0], m.color[1], m.color[2]};
    if (m.source == BRUME_SOURCE_CUSTOM) {
      double unused;
      m.point(m.self, w.data(), ray.d, &unused, S.data());
    }
    for (const auto& light : world.lights) {
      const brume_light& l = light.what;
      const bool lamp = l.kind == BRUME_POINT || l.kind == BRUME_SPOT;
      Rgb E = {l.power[0], l.power[1], l.power[2]};
      double p_mu = 1;
      if (l.kind != BRUME_SKY_LIGHT) {
        Ray to;
        double r = 1e5;
        for (int i = 0; i < 3; ++i) to.o[i] = p[i], to.d[i] = l.direction[i];
        if (lamp) {
          V3 v;
          for (int i = 0; i < 3; ++i) v[i] = l.position[i] - w[i];
          r = std::hypot(v[0], v[1], v[2]);
          double axis = 0;
          for (int i = 0; i < 3; ++i)
            to.d[i] = v[i] / r, axis -= to.d[i] * l.direction[i];
          double fall = 1 / std::max(r * r, l.radius * l.radius);
          if (l.kind == BRUME_SPOT)
            fall *= cone_edge(l, std::acos(std::clamp(axis, -1., 1.)));
          for (auto& x : E) x *= fall;
          if (fall == 0) continue;
        }
        double mu = 0;
        for (int i = 0; i < 3; ++i) mu += to.d[i] * ray.d[i];
        p_mu = phase(m, mu);
        if (l.attenuated) {
          to.end = r;
          const Rgb T = transmittance(world, to);
          for (int c = 0; c < 3; ++c) E[c] *= T[c];
        }
      }
      for (int c = 0; c < 3; ++c)
        S[c] += E[c] * p_mu * (sky && !lamp ? 1.0 : m.albedo[c]);
    }
    return S;
  }
};

// tau of all media over [a, b], no boundary inside.
Rgb depth(const Scene& s, double a, double b) {
  using G = boost::math::quadrature::gauss<double, 10>;
  Rgb tau = {0, 0, 0};
  for (int c = 0; c < 3; ++c)
    tau[c] = G::integrate(
        [&](double t) {
          double sum = 0;
          for (std::size_t k = 0; k < s.world.media.size(); ++k) {
            const double sigma = s.world.media[k].what.extinction[c];
            if (sigma > 0 && t <= s.cap[k][c]) sum += sigma * s.rho(k, t);
          }
          return sum;
        },
        a, b);
  return tau;
}

Answer compose(const Answer& x, const Answer& y) {
  Answer z;
  for (int c = 0; c < 3; ++c) {
    z.L[c] = x.L[c] + x.T[c] * y.L[c];
    z.T[c] = x.T[c] * y.T[c];
  }
  return z;
}

// One panel: 10 nodes, tau at each by a panel of its own.
Answer panel(const Scene& s, double a, double b) {
  using G = boost::math::quadrature::gauss<double, 10>;
  Answer r;
  const Rgb tau = depth(s, a, b);
  for (int c = 0; c < 3; ++c) r.T[c] = std::exp(-tau[c]);
  const double half = (b - a) / 2, mid = (a + b) / 2;
  for (std::size_t i = 0; i < G::abscissa().size(); ++i)
    for (double sign : {-1., 1.}) {
      const double t = mid + sign * half * G::abscissa()[i];
      Rgb sigma, e;
      s.point(t, sigma, e);
      if (e[0] == 0 && e[1] == 0 && e[2] == 0) continue;
      const Rgb to = depth(s, a, t);
      for (int c = 0; c < 3; ++c)
        r.L[c] += half * G::weights()[i] * std::exp(-to[c]) * e[c];
    }
  return r;
}

Answer adaptive(const Scene& s, double a, double b, const Answer& whole, double T0,
                double accuracy, int level) {
  const double mid = (a + b) / 2;
  const Answer x = panel(s, a, mid), y = panel(s, mid, b), both = compose(x, y);
  double error = 0;
  for (int c = 0; c < 3; ++c) {
    error = std::max(error, T0 * std::abs(both.L[c] - whole.L[c]) / (1 + both.L[c]));
    error = std::max(error, T0 * std::abs(both.T[c] - whole.T[c]));
  }
  if (level <= 0 || (error < accuracy && level < 58) || T0 < 1e-14) return both;
  const double Tx = T0 * *std::max_element(x.T.begin(), x.T.end());
  const Answer first = adaptive(s, a, mid, x, T0, accuracy, level - 1);
  return compose(first, adaptive(s, mid, b, y, Tx, accuracy, level - 1));
}

std::vector<double> splits(const World& w, const Ray& r) {
  std::vector<double> t = {0, r.end};
  for (const auto& m : w.media) boundaries(w, m.what, r, t);
  // The foot of every lamp and of every lorentzian, where things change fastest.
  const auto foot = [&](const double* x) {
    double f = 0, d2 = 0;
    for (int i = 0; i < 3; ++i) {
      f += (x[i] - w.eye[i] - r.o[i]) * r.d[i];
      d2 += r.d[i] * r.d[i];
    }
    t.push_back(f / d2);
  };
  for (const auto& l : w.lights) foot(l.what.position);
  for (const auto& m : w.media)
    if (m.what.profile == BRUME_LORENTZIAN) foot(m.what.origin);
  std::erase_if(t, [&](double x) { return !(x >= 0 && x <= r.end); });
  std::sort(t.begin(), t.end());
  return t;
}

// Where max_opacity ends each medium: the root of its own optical depth, by bisection.
void find_caps(Scene& s) {
  const double inf = std::numeric_limits<double>::infinity();
  s.cap.assign(s.world.media.size(), {inf, inf, inf});
  for (std::size_t k = 0; k < s.world.media.size(); ++k) {
    const Medium& m = s.world.media[k].what;
    if (m.max_opacity >= 1) continue;
    World alone;
    alone.eye = s.world.eye;
    alone.media.push_back(s.world.media[k]);
    alone.media[0].what.max_opacity = 1;
    for (int c = 0; c < 3; ++c) {
      if (m.extinction[c] == 0) continue;
      const auto T = [&](double t) {
        Ray r = s.ray;
        r.end = t;
        return transmittance(alone, r)[c];
      };
      if (T(s.ray.end) > 1 - m.max_opacity) continue;
      double lo = 0, hi = s.ray.end;
      for (int i = 0; i < 100; ++i) {
        const double mid = (lo + hi) / 2;
        (T(mid) > 1 - m.max_opacity ? lo : hi) = mid;
      }
      s.cap[k][c] = hi;
    }
  }
}

}  // namespace

Answer integrate(const World& w, const Ray& r, double accuracy) {
  Scene s{w, r, {}};
  find_caps(s);
  auto t = splits(w, r);
  for (const auto& cap : s.cap)
    for (double x : cap)
      if (x < r.end) t.push_back(x);
  // Attenuated sunlight may be cut by shadows that no boundary tells of: 8 parts, each of
  // which `adaptive` halves three times whatever it finds.
  for (const auto& l : w.lights)
    if (l.what.kind == BRUME_SUN && l.what.attenuated)
      for (int i = 1; i < 8; ++i) t.push_back(r.end * i / 8);
  std::sort(t.begin(), t.end());
  Answer all;
  for (std::size_t i = 0; i + 1 < t.size(); ++i) {
    if (!(t[i] < t[i + 1])) continue;
    const double T0 = *std::max_element(all.T.begin(), all.T.end());
    all = compose(
        all, adaptive(s, t[i], t[i + 1], panel(s, t[i], t[i + 1]), T0, accuracy, 60));
  }
  return all;
}

Rgb transmittance(const World& w, const Ray& r) {
  using GK = boost::math::quadrature::gauss_kronrod<double, 15>;
  Scene s{w, r, std::vector<Rgb>(w.media.size(), {1e300, 1e300, 1e300})};
  const auto t = splits(w, r);
  Rgb tau = {0, 0, 0};
  for (std::size_t k = 0; k < w.media.size(); ++k) {
    double D = 0;
    const auto& sigma = w.media[k].what.extinction;
    if (sigma[0] == 0 && sigma[1] == 0 && sigma[2] == 0) continue;
    for (std::size_t i = 0; i + 1 < t.size(); ++i)
      if (t[i] < t[i + 1])
        D += GK::integrate([&](double x) { return s.rho(k, x); }, t[i], t[i + 1], 12,
                           1e-9);
    for (int c = 0; c < 3; ++c) tau[c] += sigma[c] * D;
  }
  return {std::exp(-tau[0]), std::exp(-tau[1]), std::exp(-tau[2])};
}

}  // namespace brume::oracle
