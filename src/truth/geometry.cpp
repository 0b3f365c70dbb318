#include "truth/geometry.h"

#include <cmath>

namespace brume::truth {
namespace {

using Real = long double;
using V = glm::tvec3<Real>;

// Both roots of a t^2 + 2 b t + c, the smaller in size by the product of both.
void add_roots(Real a, Real b, Real c, std::vector<double>& t) {
  const Real disc = b * b - a * c;
  if (!(disc >= 0)) return;
  const Real q = -(b + std::copysign(std::sqrt(disc), b));
  t.push_back(double(q / a));
  t.push_back(double(c / q));
}

struct LocalRay {
  V o, d;
};
LocalRay local(const World& w, const brume_medium& m, const Ray& r) {
  LocalRay l;
  for (int i = 0; i < 3; ++i) {
    const double* row = m.local_from_world + 4 * i;
    Real o = row[3], d = 0;
    for (int k = 0; k < 3; ++k) {
      o += Real(row[k]) * (Real(w.eye[k]) + r.o[k]);
      d += Real(row[k]) * r.d[k];
    }
    l.o[i] = o;
    l.d[i] = d;
  }
  return l;
}

V from_lamp(const World& w, const double p[3], const Ray& r) {
  V v;
  for (int i = 0; i < 3; ++i) v[i] = Real(w.eye[i]) - p[i] + r.o[i];
  return v;
}

}  // namespace

void add_bounds(const World& w, const brume_medium& m, const Ray& r,
                std::vector<double>& t) {
  const LocalRay l = local(w, m, r);
  if (m.shape == BRUME_HALF_SPACE) t.push_back(double(-l.o.z / l.d.z));
  if (m.shape == BRUME_BOX)
    for (int i = 0; i < 3; ++i)
      for (const Real face : {-1, 1}) t.push_back(double((face - l.o[i]) / l.d[i]));
  if (m.shape == BRUME_ELLIPSOID)
    add_roots(glm::dot(l.d, l.d), glm::dot(l.o, l.d), glm::dot(l.o, l.o) - 1, t);
  if (m.start > 0) {
    const V o(r.o), d(r.d);
    add_roots(glm::dot(d, d), glm::dot(o, d), glm::dot(o, o) - Real(m.start) * m.start,
              t);
  }
}

bool inside(const World& w, const brume_medium& m, const Ray& r, double t) {
  const V eye_to = V(r.o) + Real(t) * V(r.d);
  if (m.start > 0 && glm::dot(eye_to, eye_to) < Real(m.start) * m.start) return false;
  const LocalRay l = local(w, m, r);
  const V p = l.o + Real(t) * l.d;
  switch (m.shape) {
    case BRUME_HALF_SPACE:
      return p.z <= 0;
    case BRUME_BOX:
      return std::abs(p.x) <= 1 && std::abs(p.y) <= 1 && std::abs(p.z) <= 1;
    case BRUME_ELLIPSOID:
      return glm::dot(p, p) <= 1;
    default:
      return true;
  }
}

void add_foot(const World& w, const double p[3], const Ray& r, std::vector<double>& t) {
  t.push_back(double(-glm::dot(from_lamp(w, p, r), V(r.d))));
}

void add_lamp(const World& w, const brume_light& l, const Ray& r,
              std::vector<double>& t) {
  if (l.kind != BRUME_POINT && l.kind != BRUME_SPOT) return;
  add_foot(w, l.position, r, t);
  const V o = from_lamp(w, l.position, r), d(r.d);
  if (l.radius > 0)
    add_roots(glm::dot(d, d), glm::dot(o, d), glm::dot(o, o) - Real(l.radius) * l.radius,
              t);
  if (l.kind != BRUME_SPOT) return;
  // On the cone of half angle alpha: (v . axis)^2 = cos^2 alpha |v|^2. Its mirror image's
  // crossings come along.
  const V axis(l.direction[0], l.direction[1], l.direction[2]);
  const Real inner = l.cone_falloff == 1 ? Real(l.cone) / 2
                                         : std::max(Real(l.cone) - l.cone_soft, Real(0));
  for (const Real alpha : {Real(l.cone), inner}) {
    const Real C = std::cos(alpha) * std::cos(alpha);
    const Real da = glm::dot(d, axis), oa = glm::dot(o, axis);
    add_roots(da * da - C * glm::dot(d, d), da * oa - C * glm::dot(o, d),
              oa * oa - C * glm::dot(o, o), t);
  }
}

}  // namespace brume::truth
