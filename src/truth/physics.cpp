#include "truth/physics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace brume::truth {
namespace {

using Real = long double;

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

MediumOnRay::MediumOnRay(const World& w, const brume_medium& m, const Ray& ray)
    : world_(&w), medium_(&m), ray_(ray) {
  Real from[3], along = 0, away = 0;
  for (int i = 0; i < 3; ++i) from[i] = Real(w.eye[i]) - m.origin[i] + ray.o[i];
  if (m.profile == BRUME_EXPONENTIAL) {
    for (int i = 0; i < 3; ++i) {
      a_ += m.falloff * from[i] * m.direction[i];
      b_ += m.falloff * Real(ray.d[i]) * m.direction[i];
    }
  }
  if (m.profile == BRUME_LORENTZIAN) {
    for (int i = 0; i < 3; ++i) along -= from[i] * ray.d[i];
    for (int i = 0; i < 3; ++i) {
      const Real at_foot = from[i] + along * ray.d[i];
      away += at_foot * at_foot;
    }
    a_ = 1 + m.falloff * away;
    b_ = along;
  }
}

AtPoint MediumOnRay::at(double t) const {
  const brume_medium& m = *medium_;
  AtPoint p;
  if (m.profile == BRUME_CUSTOM || m.source == BRUME_SOURCE_CUSTOM) {
    const glm::dvec3 x = world_->eye + ray_.at(t);
    double rho = 1;
    m.point(m.self, &x[0], &ray_.d[0], &rho, p.source.data());
    p.rho = rho > 0 ? std::min(rho, 1e130) : 0;
    if (m.tint) m.tint(m.self, &x[0], p.tint.data());
  }
  switch (m.profile) {
    case BRUME_UNIFORM:
      p.rho = 1;
      break;
    case BRUME_EXPONENTIAL:
      p.rho = std::exp(double(std::min(-(a_ + b_ * t), Real(300))));
      break;
    case BRUME_LORENTZIAN: {
      const double x = double(t - b_);
      p.rho = 1 / (double(a_) + m.falloff * (x * x));
      break;
    }
    default:
      break;
  }
  return p;
}

MediumOnRay::Peak MediumOnRay::peak() const {
  return {double(b_), double(std::sqrt(a_ / medium_->falloff))};
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
