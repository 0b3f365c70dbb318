// What a camera sees of faces, for stages that work on surfaces.

#include <algorithm>
#include <cmath>
#include <limits>

#include "stage/stage.h"
#include "stress/draw.h"
#include "stress/scenery.h"
#include "stress/surface_group.h"

namespace brume::stress {
namespace {

// Distance along a ray, and the normal there.
struct Face {
  double t = std::numeric_limits<double>::infinity();
  glm::dvec3 n{0, 0, 1};
};

Face plane(const glm::dvec3& at, const glm::dvec3& n, const glm::dvec3& o,
           const glm::dvec3& d) {
  const double t = glm::dot(at - o, n) / glm::dot(d, n);
  return t > 0 ? Face{t, n} : Face{};
}

Face ball(const glm::dvec3& middle, double radius, const glm::dvec3& o,
          const glm::dvec3& d) {
  const glm::dvec3 m = middle - o;
  const double b = glm::dot(m, d), q = b * b - glm::dot(m, m) + radius * radius;
  if (q < 0 || b - std::sqrt(q) <= 0) return {};
  const double t = b - std::sqrt(q);
  return {t, (o + t * d - middle) / radius};
}

void draw_rays(SurfaceGroup& g) {
  Pixels& p = g.in;
  const FrameInfo& f = g.frame;
  for (auto& plane : p.d) plane.assign(p.alpha.size(), 0.f);
  if (f.orthographic())
    for (auto& plane : p.o) plane.assign(p.alpha.size(), 0.f);
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width; ++x) {
      const glm::dvec3 off =
          f.pixel_footprint * ((x + .5 - .5 * p.width) * f.camera_right +
                               (.5 * p.height - y - .5) * f.camera_up);
      const glm::dvec3 d = f.orthographic() ? f.forward : glm::normalize(f.forward + off);
      for (int c = 0; c < 3; ++c) {
        p.d[c][p.at(x, y)] = float(d[c]);
        if (f.orthographic()) p.o[c][p.at(x, y)] = float(off[c]);
      }
    }
}

}  // namespace

void draw_surfaces(SurfaceGroup& g) {
  Random& r = g.random;
  Pixels& p = g.in;
  FrameInfo& f = g.frame;
  const double away = log_uniform(r, 1e-2, 1e5);
  if (f.orthographic()) f.pixel_footprint = 1e-3;  // that was a length
  f.projection = integer(r, 8) == 0 ? Projection::orthographic : Projection::perspective;
  f.corner = f.across = f.down = glm::dvec3(0);  // draw_rays says where pixels look
  if (f.orthographic()) f.pixel_footprint = away * log_uniform(r, 1e-4, 1e-2);

  // What the frame's file holds: the stage chooses.
  f.channels = {"A", "B", "G", "R", "Z"};
  if (integer(r, 2))
    f.channels.insert(f.channels.end(), {"N.X", "N.Y", "N.Z", "Position.X"});
  if (integer(r, 3) == 0)
    f.channels.insert(f.channels.end(), {"albedo.R", "albedo.G", "albedo.B"});
  const auto [width, height] = draw_size(r);
  f.display = {0, 0, width, height};
  g.stage = g.subject.at(f);
  const StageNeeds& needs = g.stage.needs;
  p.resize(width, height, std::max(needs.rows_around, needs.columns_around), 0);
  g.spoilt = integer(r, 4) == 0;
  draw_colors(r, p, g.spoilt);
  draw_rays(g);

  // Faces: one plane, a ball, steps, anything.
  const int kind = integer(r, 6);
  g.smooth = kind < 3 && !g.spoilt;
  glm::dvec3 n =
      -f.forward + (integer(r, 4) ? 1. : 8.) * r.uniform() * draw_direction(r, f.up);
  n = glm::normalize(n);
  if (glm::dot(n, f.forward) > -0.05) n = -f.forward;
  p.t.assign(p.alpha.size(), 0.f);
  std::vector<glm::dvec3> normal(p.alpha.size());
  for (int i = 0; i < p.size(); ++i) {
    const std::size_t k = p.at(i);
    const glm::dvec3 d(p.d[0][k], p.d[1][k], p.d[2][k]),
        o = f.orthographic() ? glm::dvec3(p.o[0][k], p.o[1][k], p.o[2][k])
                             : glm::dvec3(0);
    const double step = kind == 4 ? double(1 + i % p.width / 3) : 1;
    Face face = kind == 3 ? ball(2 * away * f.forward, away * 1.2, o, d)
                          : plane(step * away * f.forward, n, o, d);
    if (kind == 5) face.t = away * log_uniform(r, 1e-3, 1e3);
    p.t[k] = float(face.t);
    normal[k] = face.n;
    if (g.spoilt && integer(r, 6) == 0) p.t[k] = draw_bad(r);
    if (!(face.t < 1e30)) g.smooth = false;  // an edge
  }
  for (const std::string& name : needs.channels) {
    auto& plane = p.channels.emplace_back(p.alpha.size());
    for (int i = 0; i < p.size(); ++i) {
      const std::size_t k = p.at(i);
      const std::size_t axis = name.ends_with(".X")   ? 0
                               : name.ends_with(".Y") ? 1
                               : name.ends_with(".Z") ? 2
                                                      : 3;
      plane[k] = axis < 3 ? float(normal[k][int(axis)])
                          : p.alpha[k] * float(r.uniform(-0.1, 1.2));
      if (g.spoilt && integer(r, 6) == 0) plane[k] = draw_bad(r);
    }
  }
  p.channels.resize(needs.channels.size() + needs.optional.size());
  p.replicate();

  // Lights: around the camera, close to what it sees, on it.
  World& w = g.world = g.stage.world;
  w.eye = f.eye;
  w.up = f.up;
  for (int k = integer(r, 4); k > 0; --k) {
    brume_light l = draw_lamp(r, f, away);
    const std::size_t at = p.at(integer(r, p.size()));
    const double t = double(p.t[at]);
    if (integer(r, 2) && t > 0 && t < 1e30)
      for (int c = 0; c < 3; ++c)
        l.position[c] = f.eye[c] + t * double(p.d[c][at]) +
                        (f.orthographic() ? double(p.o[c][at]) : 0) +
                        (integer(r, 8) ? away * log_uniform(r, 1e-6, 1) : 0) * n[c];
    w.lights.push_back({l, 0, "lamp"});
  }
  if (integer(r, 3) == 0) w.lights.push_back({draw_sun(r, f), 0, "sun"});
  if (integer(r, 6) == 0) {
    brume_light sky = draw_sun(r, f);
    sky.kind = BRUME_SKY_LIGHT;
    w.lights.push_back({sky, 0, "sky"});
  }
  for (int k = integer(r, 3); k > 0; --k)
    w.media.push_back({draw_fog(r, f, away), 0, k == 1 ? "fog" : "more fog"});
}

}  // namespace brume::stress
