#include "truth/physics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace brume::truth {
namespace {

using Real = long double;

// f (x - origin) . direction, and |x - origin|^2, with x = eye + relative.
Real height(const World& w, const brume_medium& m, const glm::dvec3& x) {
  Real h = 0;
  for (int i = 0; i < 3; ++i) h += (Real(w.eye[i]) - m.origin[i] + x[i]) * m.direction[i];
  return h;
}
Real square_distance(const World& w, const brume_medium& m, const glm::dvec3& x) {
  Real s = 0;
  for (int i = 0; i < 3; ++i) {
    const Real v = Real(w.eye[i]) - m.origin[i] + x[i];
    s += v * v;
  }
  return s;
}

// How much a spotlight sends at angle theta from its axis.
double edge(const brume_light& l, double theta) {
  if (l.cone_falloff == 1) {  // saturate(|cone / theta| - 1), Intel 2008
    if (theta <= 0) return 1;
    return std::clamp(std::abs(l.cone / theta) - 1, 0., 1.);
  }
  const double soft = std::min(l.cone_soft, l.cone);
  if (!(soft > 0)) return theta <= l.cone ? 1 : 0;
  const double x = std::clamp((l.cone - theta) / soft, 0., 1.);
  return x * x * (3 - 2 * x);
}

}  // namespace

AtPoint medium_at(const World& w, const brume_medium& m, const glm::dvec3& x,
                  const glm::dvec3& direction) {
  AtPoint p;
  if (m.profile == BRUME_CUSTOM || m.source == BRUME_SOURCE_CUSTOM) {
    double position[3], d[3], rho = 1;
    for (int i = 0; i < 3; ++i) position[i] = w.eye[i] + x[i], d[i] = direction[i];
    m.point(m.self, position, d, &rho, p.source.data());
    p.rho = rho > 0 ? std::min(rho, 1e130) : 0;
    if (m.tint) m.tint(m.self, position, p.tint.data());
  }
  switch (m.profile) {
    case BRUME_UNIFORM:
      p.rho = 1;
      break;
    case BRUME_EXPONENTIAL:
      p.rho = double(std::exp(std::min(-Real(m.falloff) * height(w, m, x), Real(300))));
      break;
    case BRUME_LORENTZIAN:
      p.rho = double(1 / (1 + Real(m.falloff) * square_distance(w, m, x)));
      break;
    default:
      break;
  }
  return p;
}

double phase(const brume_medium& m, const glm::dvec3& to, const glm::dvec3& direction) {
  const double mu = glm::dot(to, direction), g = m.g, pi = M_PI;
  if (m.phase == BRUME_RAYLEIGH) return 3 * (1 + mu * mu) / (16 * pi);
  // 1 + g^2 - 2 g mu = (1 - |g|)^2 + |g| |to -+ d|^2: the peak keeps its digits.
  const glm::dvec3 off = g < 0 ? to + direction : to - direction;
  const double away = 1 - std::abs(g);
  const double q = away * away + std::abs(g) * glm::dot(off, off);
  const double hg = (1 - g * g) / (4 * pi * std::pow(q, 1.5));
  if (m.phase == BRUME_HENYEY_GREENSTEIN) return hg;
  return hg * 3 * (1 + mu * mu) / (2 * (2 + g * g));  // Cornette & Shanks 1992, eq. 8
}

Incident light_at(const World& w, const brume_light& l, const glm::dvec3& x) {
  Incident in;
  double share = 1;
  const glm::dvec3 axis(l.direction[0], l.direction[1], l.direction[2]);
  if (l.kind == BRUME_POINT || l.kind == BRUME_SPOT) {
    glm::dvec3 v;
    for (int i = 0; i < 3; ++i) v[i] = l.position[i] - w.eye[i] - x[i];
    in.distance = glm::length(v);
    in.to = in.distance > 0 ? v / in.distance : -axis;
    share = 1 / std::max({in.distance * in.distance, l.radius * l.radius, 1e-30});
    if (l.kind == BRUME_SPOT)
      share *= edge(
          l, std::atan2(glm::length(glm::cross(axis, in.to)), -glm::dot(axis, in.to)));
  } else {
    in.to = axis;
    in.distance = l.kind == BRUME_SUN ? std::numeric_limits<double>::infinity() : 0;
  }
  for (int c = 0; c < 3; ++c) in.E[c] = l.power[c] * share;
  return in;
}

}  // namespace brume::truth
