#include "truth/geometry.h"

#include <algorithm>
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

/// A light as the points of a ray x = o + t d see it: along u = w0 + t w1, for a lamp at
/// p that is p - x, and for a sun always the same.
struct Toward {
  V w0, w1;
  bool sun;

  V at(Real t) const { return sun ? w0 : w0 + t * w1; }
  // Whether x + part u lies before the light.
  bool before(Real part) const { return part >= 0 && (sun || part <= 1); }
};

// Where the line from x along u is at distance r from the origin, |x cross u|^2 = r^2
// |u|^2, and is nearest to it before the light. The cross product has no term in t^2,
// whose factor is d cross w1 = -d cross d.
void add_tangents(const LocalRay& l, const Toward& u, Real r, std::vector<double>& t) {
  const V c0 = glm::cross(l.o, u.w0), c1 = glm::cross(l.o, u.w1) + glm::cross(l.d, u.w0);
  const Real r2 = r * r;
  std::vector<double> found;
  add_roots(glm::dot(c1, c1) - r2 * glm::dot(u.w1, u.w1),
            glm::dot(c0, c1) - r2 * glm::dot(u.w0, u.w1),
            glm::dot(c0, c0) - r2 * glm::dot(u.w0, u.w0), found);
  for (const double at : found) {
    const V x = l.o + Real(at) * l.d, way = u.at(at);
    if (u.before(-glm::dot(x, way) / glm::dot(way, way))) t.push_back(at);
  }
}

// Where the line from x along u meets an edge of the box |x|, |y|, |z| <= 1 before the
// light, a + s e with |s| <= 1: x - a, u and e lie in one plane. With u = w0 + t w1 that
// is quadratic at most.
void add_edges(const LocalRay& l, const Toward& u, std::vector<double>& t) {
  for (int axis = 0; axis < 3; ++axis)
    for (int corner = 0; corner < 4; ++corner) {
      V e(0), a(0);
      e[axis] = 1;
      a[(axis + 1) % 3] = corner & 1 ? 1 : -1;
      a[(axis + 2) % 3] = corner & 2 ? 1 : -1;
      const V o = l.o - a;
      const auto triple = [&](const V& x, const V& y) {
        return glm::dot(glm::cross(x, y), e);
      };
      std::vector<double> found;
      add_roots(triple(l.d, u.w1), (triple(o, u.w1) + triple(l.d, u.w0)) / 2,
                triple(o, u.w0), found);
      for (const double at : found) {
        const V x = o + Real(at) * l.d, way = u.at(at);
        V flat = way;
        flat[axis] = 0;
        const Real part = -glm::dot(x, flat) / glm::dot(flat, flat);
        if (u.before(part) && std::abs(x[axis] + part * way[axis]) <= 1) t.push_back(at);
      }
    }
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

void add_shadow_edges(const World& w, const brume_medium& m, const brume_light& light,
                      const Ray& r, std::vector<double>& t) {
  const bool sun = light.kind == BRUME_SUN;
  const V way = sun ? V(light.direction[0], light.direction[1], light.direction[2])
                    : -from_lamp(w, light.position, r);  // from the ray's origin
  const auto toward = [&](const V& u, const V& d) {
    return Toward{u, sun ? V(0) : -d, sun};
  };
  if (m.start > 0) add_tangents({V(r.o), V(r.d)}, toward(way, V(r.d)), m.start, t);
  const LocalRay l = local(w, m, r);
  V u;
  for (int i = 0; i < 3; ++i) {
    const double* row = m.local_from_world + 4 * i;
    u[i] = row[0] * way[0] + row[1] * way[1] + row[2] * way[2];
  }
  if (m.shape == BRUME_ELLIPSOID) add_tangents(l, toward(u, l.d), 1, t);
  if (m.shape == BRUME_BOX) add_edges(l, toward(u, l.d), t);
  std::vector<double> bounds;  // of a box: of its faces, not of their planes
  add_bounds(w, m, r, bounds);
  for (const double at : bounds) {
    const V x = glm::abs(l.o + Real(at) * l.d);
    if (m.shape != BRUME_BOX || std::max({x.x, x.y, x.z}) <= 1 + Real(1e-9))
      t.push_back(at);
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
