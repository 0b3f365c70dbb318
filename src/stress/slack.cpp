#include "stress/slack.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "air/air.h"

namespace brume::stress {
namespace {

constexpr double kEps = std::numeric_limits<float>::epsilon();
constexpr double kTiny = std::numeric_limits<float>::min();
constexpr double kFar = 1e30;

glm::dvec3 vec(const double v[3]) { return {v[0], v[1], v[2]}; }

double spread(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::dot(glm::abs(a), glm::abs(b));
}

// Profiles whose density falls exponentially, or whose smooth part does.
bool falls(const brume_medium& m) {
  return m.falloff != 0 && (m.profile == BRUME_EXPONENTIAL || m.profile == BRUME_CUSTOM);
}

double log_density(const World& w, const brume_medium& m, const glm::dvec3& x) {
  if (!falls(m)) return 0;
  return -m.falloff * glm::dot(vec(m.direction), x + w.eye - vec(m.origin));
}

// How far off along the ray a boundary may be found.
double boundary(const World& w, const brume_medium& m, const glm::dvec3& o,
                const glm::dvec3& d, double t) {
  double off = 0;
  if (m.start > 0) {
    // Roots -b +- sqrt(disc) of |o + t d| = start. Rounding moves disc by `moved`, of the
    // size of the squares that it is made of, and the root by |sqrt(disc + moved) -
    // sqrt(disc)| <= moved / sqrt(max(disc, moved)).
    const double reach = m.start + glm::length(o), b = glm::dot(o, d);
    const double disc = b * b - glm::dot(o, o) + m.start * m.start;
    const double moved = 2 * kEps * reach * reach;
    off += std::min(t, kEps * reach + moved / std::sqrt(std::max(disc, moved)));
    off += 2 * std::numeric_limits<double>::epsilon() * glm::length(w.eye);
  }
  if (m.shape == BRUME_EVERYWHERE) return off;
  glm::dmat3 a;
  glm::dvec3 b;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) a[c][r] = m.local_from_world[4 * r + c];
    b[r] = m.local_from_world[4 * r + 3];
  }
  double size = 0, away = glm::length(a * w.eye + b);
  for (int r = 0; r < 3; ++r) {
    const double row = glm::length(glm::dvec3(a[0][r], a[1][r], a[2][r]));
    if (row > 0) size = std::max(size, 1 / row);
  }
  const double place = 8 * kEps * (size * (1 + away) + glm::length(o));
  if (m.shape == BRUME_BOX)
    // A face is met sooner or later by its own shift over the slope toward it.
    for (int r = 0; r < 3; ++r) {
      const glm::dvec3 row(a[0][r], a[1][r], a[2][r]);
      const double per_metre = glm::length(row);
      if (!(per_metre > 0)) continue;
      const double at = glm::dot(row, w.eye + o) + b[r], slope = glm::dot(row, d);
      for (const double face : {-1., 1.}) {
        const double begin = at - face, end = begin + slope * t, near = place * per_metre;
        if (std::min(begin, end) < near && std::max(begin, end) > -near)
          off += std::min(t, near / std::max(std::abs(slope), 1e-300));
      }
    }
  // A chord near a rounded edge goes with the root of what is left of the radius.
  return off + place + (m.shape == BRUME_ELLIPSOID ? 4 * std::sqrt(size * place) : 0);
}

// A medium of its own functions that fades across a thin box, e-folds to a few of its
// sizes: by how much of itself a place as floats know it changes that.
double thinness(const World& w, const brume_medium& m, const glm::dvec3& o) {
  double thin = std::numeric_limits<double>::infinity(), away = 0;
  for (int r = 0; r < 3; ++r) {
    const double* row = m.local_from_world + 4 * r;
    const double length = glm::length(vec(row));
    if (!(length > 0)) continue;
    thin = std::min(thin, 1 / length);
    away = std::max(away, std::abs(glm::dot(vec(row), w.eye) + row[3]) / length);
  }
  return 16 * 8 * kEps * (away + glm::length(o)) / thin;
}

}  // namespace

double Slack::of_opacity(double opacity) const {
  const double share = std::min(1 / std::exp(1.), 1.6 * std::abs(opacity));
  return rel < 0.5 ? rel * share + abs : std::numeric_limits<double>::infinity();
}

double Slack::of_light(int c, double L, double uncut) const {
  const double most = light_most[c];
  if (!(most > 0)) return 0;
  if (!(light_rel < 0.5 && rel < 0.5)) return std::numeric_limits<double>::infinity();
  const double dimmed = 1 + std::log(std::max(most / std::max(L, 1e-300), 1.));
  const auto part = [](double share, double of) { return of > 0 ? share * of : 0; };
  return part(light_rel + 2 * rel * dimmed, L) + part(2 * abs + grazing, light_next[c]) +
         part(cone, uncut);
}

Slack& Slack::operator+=(const Slack& b) {
  rel += b.rel, abs += b.abs, light_rel += b.light_rel, cone += b.cone;
  grazing += b.grazing;
  for (int c = 0; c < 3; ++c) {
    light_most[c] = std::max(light_most[c], b.light_most[c]);
    light_next[c] = std::max(light_next[c], b.light_next[c]);
  }
  return *this;
}

namespace {

// Nearer to a lamp than this its light grows no more, as floats end; 0: it has a size and
// does so by itself.
double nearest_of(const brume_light& l) {
  const double most = std::max({l.power[0], l.power[1], l.power[2]});
  const double nearest = std::sqrt(most / kMostIrradiance);
  return nearest > l.radius ? nearest : 0;
}

// What one light may make of one medium on the way.
void add_light(Slack& sum, const World& w, const brume_light& l, const brume_medium& m,
               const glm::dvec3& o, const glm::dvec3& d, double length) {
  const double g = std::abs(m.g);
  // Henyey & Greenstein: largest value, and largest |p'| / p.
  const double peak = m.phase == BRUME_HENYEY_GREENSTEIN
                          ? (1 + g) / ((1 - g) * (1 - g)) / (4 * M_PI)
                          : 0.2,
               steep = 2 + 3 * g / (1 - g * g);
  const double thick = std::exp(
      std::min(std::max(log_density(w, m, o), log_density(w, m, o + length * d)), 700.));
  // Inside a lamp's sphere it is the direction to the lamp that counts, in the part of
  // the way that shows.
  const double free_way =
      1 / std::max(thick * std::max({m.extinction[0], m.extinction[1], m.extinction[2]}),
                   1e-300);
  // Where density leaves the floats nothing is known of what dims a light.
  if (thick * std::max({m.extinction[0], m.extinction[1], m.extinction[2]}) > 1e30)
    sum.light_rel = std::numeric_limits<double>::infinity();
  if (l.kind == BRUME_SUN && l.attenuated && falls(m)) {
    // Depth goes with 1 / slope, and T tau <= 1/e.
    const glm::dvec3 axis = vec(m.direction), to = vec(l.direction);
    const double slope = std::max(std::abs(glm::dot(axis, to)), 1e-300);
    sum.grazing =
        std::max(sum.grazing, std::min(4 * kEps * spread(axis, to) / slope, 1.));
  }
  double per_depth = 1, along = 1;  // light per power: at a point, along the ray
  if (l.kind == BRUME_POINT || l.kind == BRUME_SPOT) {
    const glm::dvec3 to = vec(l.position) - w.eye - o;
    const double foot = std::clamp(glm::dot(to, d), 0., length);
    const double h = glm::length(to - foot * d),
                 near = std::max(h, std::min({l.radius, length, free_way}));
    // What floats know: where the lamp is, where the ray begins, where it goes.
    const double off = 8 * kEps * (glm::length(to + o) + glm::length(o) + foot) +
                       2 * std::numeric_limits<double>::epsilon() * glm::length(w.eye) +
                       kLeastDistance;
    if (near <= std::max(off, nearest_of(l))) {
      sum.light_rel = std::numeric_limits<double>::infinity();
      for (double& x : sum.light_most) x = std::max(x, 1e-300);
      return;
    }
    sum.light_rel = std::max(sum.light_rel, steep * off / near);
    per_depth = 1 / (near * near);
    along = M_PI / near;
    if (l.kind == BRUME_SPOT) {
      const double turn = off / std::max(h, off) + 4 * kEps;
      // Along its edge a ray may be in or out for the root of that, as a part of the
      // cone.
      const double soft = l.cone_falloff ? l.cone : l.cone_soft;
      double off_edge = 4 * std::sqrt(turn / std::max(std::sin(l.cone), turn));
      // A wide cone is a plane, and a ray in it all in or all out.
      if (std::cos(l.cone) < off_edge)
        off_edge += 4 * turn / std::max(std::abs(glm::dot(d, vec(l.direction))), turn);
      sum.cone =
          std::max(sum.cone, std::min(1.5 * turn / std::max(soft, 1e-12), off_edge));
    }
  }
  const bool sky = l.kind == BRUME_SUN || l.kind == BRUME_SKY_LIGHT;
  const bool all = sky && m.source == BRUME_SOURCE_SKY;
  for (int c = 0; c < 3; ++c) {
    const double each = (all ? 1 : m.albedo[c]) * peak * l.power[c];
    if (!(each > 0 && m.extinction[c] > 0)) continue;
    sum.light_next[c] += each * per_depth;
    sum.light_most[c] +=
        each * (sky ? 1 : along * std::min(m.extinction[c] * thick, 1e38));
  }
}

}  // namespace

Slack slack_of(const World& w, const glm::dvec3& o, const glm::dvec3& d, double t,
               double tolerance) {
  Slack sum;
  sum.rel = 8 * kEps;
  const double length = std::min(t, kFar);
  for (const auto& p : w.media) {
    const brume_medium& m = p.what;
    const double most = std::max({m.extinction[0], m.extinction[1], m.extinction[2]});
    double rel = 8 * kEps;
    // An integral of density below the normal floats is a multiple of the smallest.
    sum.abs += 4 * most * double(std::numeric_limits<float>::denorm_min());
    if (falls(m)) {
      const glm::dvec3 axis = vec(m.direction);
      const double at_eye = std::abs(log_density(w, m, glm::dvec3(0)));
      const double x = m.falloff * glm::dot(axis, d) * length;
      const double along = std::abs(m.falloff) * spread(axis, d) * length;
      rel += 2 * kEps * std::abs(m.falloff) * spread(axis, o);
      if (o != glm::dvec3(0)) rel += kEps * at_eye;
      rel += 2 * kEps * along * (x > 1 ? 1 / x : 1);
      sum.abs += most * length * kTiny;  // densities below the normal floats
    }
    if (m.profile == BRUME_LORENTZIAN) {
      const double away = glm::length(vec(m.origin) - w.eye) + glm::length(o);
      rel += 4 * kEps * std::sqrt(m.falloff) * away;
    }
    if (m.profile == BRUME_CUSTOM || m.alone) rel += tolerance;
    if (m.profile == BRUME_CUSTOM) sum.abs += tolerance;  // |dT| <= tolerance (white + T)
    if (m.profile == BRUME_CUSTOM && m.shape != BRUME_EVERYWHERE &&
        m.shape != BRUME_HALF_SPACE)
      rel += thinness(w, m, o);
    sum.rel = std::max(sum.rel, rel);
    if (m.shape != BRUME_EVERYWHERE || m.start > 0) {
      const double thick =
          std::max(log_density(w, m, o), log_density(w, m, o + length * d));
      sum.abs += most * std::exp(std::min(thick, 700.)) * boundary(w, m, o, d, length);
    }
    for (const auto& l : w.lights) add_light(sum, w, l.what, m, o, d, length);
  }
  return sum;
}

namespace {

double density(const brume_medium& m, const glm::dvec3& x, const glm::dvec3& d) {
  double rho = 0, source[3];
  m.point(m.self, &x[0], &d[0], &rho, source);
  return rho > 0 ? std::min(rho, 1e130) : 0;
}

}  // namespace

double doubt_of(const World& w, const glm::dvec3& o, const glm::dvec3& d, double t,
                const glm::dvec3& shift) {
  // Midpoints of even steps in x, s = a sinh x: as close as the ray is near its begin,
  // and 1 % of the way there apart.
  constexpr int kPoints = 2048;
  const double length = std::min(t, kFar), a = std::min(1e-4 * length, 1e-3);
  if (!(a > 0)) return 0;
  const double dx = std::asinh(length / a) / kPoints;
  double doubt = 0;
  for (const auto& p : w.media) {
    if (p.what.profile != BRUME_CUSTOM) continue;
    const auto rho = [&](const glm::dvec3& at) { return density(p.what, at, d); };
    const auto integral = [&](auto&& f) {
      double sum = 0;
      for (int k = 0; k < kPoints; ++k) {
        const double x = (k + 0.5) * dx, s = a * std::sinh(x);
        sum += f(w.eye + o + s * d, s) * a * std::cosh(x) * dx;
      }
      return sum;
    };
    const double depth = integral([&](auto at, double) { return rho(at); });
    if (!(depth > 0)) continue;
    const double moved =
        integral([&](auto at, double) { return std::abs(rho(at + shift) - rho(at)); });
    const double way =
        2 * integral([&](auto at, double s) { return s * rho(at); }) / depth;
    const double h = way / kDetail;
    const double v = integral([&](auto at, double) {
      const double off = rho(at + h * d) - rho(at);
      return off * off / 2;
    });
    doubt = std::max(doubt, (moved + 3 * std::sqrt(h * v)) / depth);
  }
  return doubt;
}

}  // namespace brume::stress
