#include "truth/geometry.h"

#include <algorithm>
#include <cmath>
#include <limits>

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

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr Stretch kAll{-kInf, kInf}, kNone{0, 0};

// o + t d <= 0.
Stretch below(Real o, Real d) {
  if (d == 0) return o <= 0 ? kAll : kNone;
  const double t = double(-o / d);
  return d > 0 ? Stretch{-kInf, t} : Stretch{t, kInf};
}

// |o + t d| <= r. What b^2 - a c would lose of a small ball far away, the distance
// |o cross d| keeps.
Stretch within(const V& o, const V& d, Real r) {
  const V across = glm::cross(o, d);
  const Real a = glm::dot(d, d), b = glm::dot(o, d), c = glm::dot(o, o) - r * r;
  if (a == 0) return c <= 0 ? kAll : kNone;
  const Real disc = a * r * r - glm::dot(across, across);
  if (!(disc > 0)) return kNone;
  const Real q = -(b + std::copysign(std::sqrt(disc), b));
  const double t0 = double(q / a), t1 = double(c / q);
  return {std::min(t0, t1), std::max(t0, t1)};
}

Stretch both(const Stretch& a, const Stretch& b) {
  return {std::max(a.from, b.from), std::min(a.to, b.to)};
}

Stretch in_shape(const brume_medium& m, const LocalRay& l) {
  Stretch s = kAll;
  if (m.shape == BRUME_HALF_SPACE) s = below(l.o.z, l.d.z);
  if (m.shape == BRUME_BOX)
    for (int i = 0; i < 3; ++i)
      s = both(s, both(below(l.o[i] - 1, l.d[i]), below(-1 - l.o[i], -l.d[i])));
  if (m.shape == BRUME_ELLIPSOID) s = within(l.o, l.d, 1);
  return s;
}

// Where a ray begins, from the middle of a medium's ground.
V above_ground(const World& w, const brume_medium& m, const Ray& r) {
  return V(r.o) -
         V(m.ground[0] - w.eye[0], m.ground[1] - w.eye[1], m.ground[2] - w.eye[2]);
}

}  // namespace

Place nearest_ground(const World& w, const brume_medium& m, const Ray& r) {
  const double t = -double(glm::dot(above_ground(w, m, r), V(r.d)));
  return {std::max(t, 0.), 1e-4 * m.ground[3]};
}

bool Stays::meet(double length) const {
  return std::any_of(begin(), end(),
                     [&](const Stretch& s) { return s.to > 0 && s.from < length; });
}

Stays stays(const World& w, const brume_medium& m, const Ray& r) {
  Stretch shape = m.shape == BRUME_EVERYWHERE ? kAll : in_shape(m, local(w, m, r));
  if (m.ground[3] > 0) {
    const V o = above_ground(w, m, r);
    const Stretch core = within(o, V(r.d), m.core);
    if (core.from < core.to && core.to > 0)
      shape =
          both(shape, core.from < 0 ? Stretch{core.to, kInf} : Stretch{-kInf, core.from});
    const double height = double(glm::length(o)) - m.ground[3];
    const Stretch ball = within(o, V(r.d), m.ground[3]);
    if (r.end == kInf && height >= -1e-9 * m.ground[3] && ball.from < ball.to &&
        ball.from + ball.to > 0)
      shape = both(shape, {-kInf, std::max(ball.from, 0.)});
  }
  Stays all;
  const auto add = [&](const Stretch& s) {
    if (s.from < s.to) all.part[all.count++] = s;
  };
  const Stretch empty = m.start > 0 ? within(V(r.o), V(r.d), m.start) : kNone;
  if (empty.from < empty.to) {
    add(both(shape, {-kInf, empty.from}));
    add(both(shape, {empty.to, kInf}));
  } else {
    add(shape);
  }
  return all;
}

namespace {

// The way to the light from the ray's origin; to a sun a direction.
V way_to(const World& w, const brume_light& light, const Ray& r) {
  return light.kind == BRUME_SUN
             ? V(light.direction[0], light.direction[1], light.direction[2])
             : -from_lamp(w, light.position, r);
}
V turned(const brume_medium& m, const V& way) {
  V u;
  for (int i = 0; i < 3; ++i) {
    const double* row = m.local_from_world + 4 * i;
    u[i] = row[0] * way[0] + row[1] * way[1] + row[2] * way[2];
  }
  return u;
}

}  // namespace

// All ways lie in the plane through the ray and the light, and in the triangle that they
// span there.
bool may_stand_between(const World& w, const brume_medium& m, const brume_light& light,
                       const Ray& r) {
  if (m.shape != BRUME_BOX && m.shape != BRUME_ELLIPSOID) return true;
  constexpr Real slack = 1 + Real(1e-9);
  const LocalRay l = local(w, m, r);
  const V u = turned(m, way_to(w, light, r)), n = glm::cross(l.d, u);
  const Real away = std::abs(glm::dot(n, l.o));
  const V reach = glm::abs(n);
  if (away >
      slack * (m.shape == BRUME_BOX ? reach.x + reach.y + reach.z : glm::length(n)))
    return false;
  const bool sun = light.kind == BRUME_SUN;
  for (int i = 0; i < 3; ++i)
    for (const int side : {-1, 1}) {
      // Beyond a face of the box about it are the ray's origin, its end, and the light.
      const Real o = side * l.o[i], d = side * l.d[i], to = side * u[i];
      const bool end = r.end < kInf ? o + d * Real(r.end) > slack : d >= 0;
      const bool from = sun ? to >= 0 : o + to > slack;
      if (o > slack && end && from) return false;
    }
  return true;
}

void add_shadow_edges(const World& w, const brume_medium& m, const brume_light& light,
                      const Ray& r, std::vector<double>& t) {
  const bool sun = light.kind == BRUME_SUN;
  const V way = way_to(w, light, r);
  const auto toward = [&](const V& u, const V& d) {
    return Toward{u, sun ? V(0) : -d, sun};
  };
  if (m.start > 0) add_tangents({V(r.o), V(r.d)}, toward(way, V(r.d)), m.start, t);
  const LocalRay l = local(w, m, r);
  const V u = turned(m, way);
  if (m.shape == BRUME_ELLIPSOID) add_tangents(l, toward(u, l.d), 1, t);
  if (m.shape == BRUME_BOX) add_edges(l, toward(u, l.d), t);
  for (const Stretch& s : stays(w, m, r)) t.insert(t.end(), {s.from, s.to});
}

void add_lamp(const World& w, const brume_light& l, const Ray& r,
              std::vector<Place>& places) {
  if (l.kind != BRUME_POINT && l.kind != BRUME_SPOT) return;
  const V o = from_lamp(w, l.position, r), d(r.d);
  const Real foot = -glm::dot(o, d);
  // However large the lamp is: light scattered toward the eye turns about within h.
  places.push_back({double(foot), double(glm::length(o + foot * d))});
  std::vector<double> kinks;
  if (l.radius > 0)
    add_roots(glm::dot(d, d), glm::dot(o, d), glm::dot(o, o) - Real(l.radius) * l.radius,
              kinks);
  if (l.kind == BRUME_SPOT) {
    // On the cone of half angle alpha: (v . axis)^2 = cos^2 alpha |v|^2. Its mirror
    // image's crossings come along.
    const V axis(l.direction[0], l.direction[1], l.direction[2]);
    const Real inner = l.cone_falloff == 1
                           ? Real(l.cone) / 2
                           : std::max(Real(l.cone) - l.cone_soft, Real(0));
    for (const Real alpha : {Real(l.cone), inner}) {
      const Real C = std::cos(alpha) * std::cos(alpha);
      const Real da = glm::dot(d, axis), oa = glm::dot(o, axis);
      add_roots(da * da - C * glm::dot(d, d), da * oa - C * glm::dot(o, d),
                oa * oa - C * glm::dot(o, o), kinks);
    }
  }
  for (const double t : kinks) places.push_back({t, 0});
}

}  // namespace brume::truth
