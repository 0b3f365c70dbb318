#include "stress/scenery.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "stage/stage.h"
#include "stress/draw.h"

namespace brume::stress {
namespace {

void set(double to[3], const glm::dvec3& v) {
  for (int i = 0; i < 3; ++i) to[i] = v[i];
}
glm::dvec3 vec(const double v[3]) { return {v[0], v[1], v[2]}; }

void draw_power(Random& r, double to[3], double typical) {
  const double most =
      integer(r, 8) ? log_uniform(r, 1e-3, 1e3) * typical : log_uniform(r, 1e-9, 1e9);
  const bool grey = integer(r, 2);
  for (int c = 0; c < 3; ++c)
    to[c] = grey && c > 0        ? to[0]
            : integer(r, 8) == 0 ? 0
                                 : std::min(most * r.uniform(), 1e9);
}

glm::dmat3 matrix(const brume_medium& m) {
  glm::dmat3 a;
  for (int row = 0; row < 3; ++row)
    for (int c = 0; c < 3; ++c) a[c][row] = m.local_from_world[4 * row + c];
  return a;
}

// x_local = A x + b.
void set_local(brume_medium& m, const glm::dmat3& a, const glm::dvec3& b) {
  for (int row = 0; row < 3; ++row) {
    for (int c = 0; c < 3; ++c) m.local_from_world[4 * row + c] = a[c][row];
    m.local_from_world[4 * row + 3] = b[row];
  }
}

}  // namespace

brume_light draw_lamp(Random& r, const FrameInfo& f, double away) {
  brume_light l = new_light();
  const int place = integer(r, 8);
  const glm::dvec3 way = place < 3    ? f.forward
                         : place == 3 ? -f.forward
                                      : draw_direction(r, f.up);
  const double distance = place == 7 ? 0 : away * log_uniform(r, 0.1, 10);
  set(l.position, f.eye + distance * way);
  draw_power(r, l.power, away * away);
  l.radius = integer(r, 3) ? away * log_uniform(r, 1e-6, 1) : 0;
  l.attenuated = integer(r, 4) != 0;
  if (integer(r, 2)) return l;
  l.kind = BRUME_SPOT;
  const int toward = integer(r, 4);  // the eye is in its cone, or just at its edge
  set(l.direction, toward == 0 ? -way : draw_direction(r, f.up));
  const double most = std::numbers::pi / 2;
  l.cone = integer(r, 4)   ? most * r.uniform(0.01, 1)
           : integer(r, 2) ? most
                           : log_uniform(r, 2e-4, 0.1);
  l.cone_soft = integer(r, 3) ? l.cone * r.uniform() : 0;
  l.cone_falloff = integer(r, 4) == 0;
  return l;
}

brume_light draw_sun(Random& r, const FrameInfo& f) {
  brume_light l = new_light();
  l.kind = BRUME_SUN;
  set(l.direction, draw_direction(r, f.up));
  draw_power(r, l.power, 1);
  l.attenuated = integer(r, 4) != 0;
  return l;
}

brume_medium draw_fog(Random& r, const FrameInfo& f, double away) {
  brume_medium m = new_medium();
  const double sigma = integer(r, 8) ? std::min(log_uniform(r, 1e-3, 1e3) / away, 1e6)
                                     : log_uniform(r, 1e-9, 1e6);
  const bool grey = integer(r, 2);
  for (int c = 0; c < 3; ++c) {
    m.extinction[c] = grey ? sigma : sigma * r.uniform();
    m.albedo[c] = integer(r, 8) ? r.uniform() : double(integer(r, 2));
  }
  m.g = integer(r, 2) ? r.uniform(-0.95, 0.95) : 0;
  set(m.origin, f.eye);
  if (integer(r, 3) == 0) {
    m.profile = BRUME_EXPONENTIAL;
    set(m.direction, integer(r, 2) ? f.up : draw_direction(r, f.up));
    m.falloff = log_uniform(r, 1e-3, 10) / away;
  }
  if (integer(r, 2)) return m;
  m.shape = integer(r, 2) ? BRUME_BOX : BRUME_ELLIPSOID;
  const glm::dvec3 middle = f.eye + away * r.uniform(0, 2) * draw_direction(r, f.up);
  glm::dmat3 a(0);
  for (int i = 0; i < 3; ++i) a[i][i] = 1 / (away * log_uniform(r, 0.1, 10));
  set_local(m, a, -(a * middle));
  return m;
}

World scaled(const World& world, double k) {
  World w = world;
  w.eye *= k;
  for (auto& p : w.media) {
    brume_medium& m = p.what;
    for (int c = 0; c < 3; ++c) {
      m.extinction[c] /= k, m.emission[c] /= k, m.origin[c] *= k;
      for (int row = 0; row < 3; ++row) m.local_from_world[4 * row + c] /= k;
    }
    m.falloff /= m.profile == BRUME_LORENTZIAN ? k * k : k;
    m.start *= k;
    for (double& x : m.ground) x *= k;
  }
  for (auto& p : w.lights) {
    if (p.what.kind != BRUME_POINT && p.what.kind != BRUME_SPOT) continue;
    for (int c = 0; c < 3; ++c) p.what.position[c] *= k, p.what.power[c] *= k * k;
    p.what.radius *= k;
  }
  return w;
}

World turned(const World& world, const glm::dmat3& R) {
  World w = world;
  const glm::dvec3 eye = w.eye;
  const auto place = [&](double x[3]) { set(x, eye + R * (vec(x) - eye)); };
  w.up = R * w.up;
  for (auto& p : w.media) {
    brume_medium& m = p.what;
    const glm::dmat3 a = matrix(m) * glm::transpose(R);
    const glm::dvec3 b(m.local_from_world[3], m.local_from_world[7],
                       m.local_from_world[11]);
    if (m.shape != BRUME_EVERYWHERE) set_local(m, a, b + matrix(m) * eye - a * eye);
    place(m.origin);
    place(m.ground);
    set(m.direction, R * vec(m.direction));
  }
  for (auto& p : w.lights) {
    place(p.what.position);
    set(p.what.direction, R * vec(p.what.direction));
  }
  return w;
}

World with_lights(const World& world, const std::vector<std::size_t>& which) {
  World w = world;
  w.lights.clear();
  for (const std::size_t k : which) w.lights.push_back(world.lights[k]);
  return w;
}

}  // namespace brume::stress
