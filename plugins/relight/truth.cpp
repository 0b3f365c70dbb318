#include "truth.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "kernel.h"
#include "oracle.h"
#include "run.h"

namespace relight {
namespace {

// A pixel's ray and how far it goes.
struct At {
  bool there;
  double t;
  glm::dvec3 d, o{0};
};

At at(const brume_tile& tile, std::ptrdiff_t i) {
  At a{false, tile.distance[i], {tile.dx[i], tile.dy[i], tile.dz[i]}};
  if (tile.ox) a.o = {tile.ox[i], tile.oy[i], tile.oz[i]};
  a.there = a.t > double(kNearest) && a.t < 1e30;
  if (!a.there) a.t = 1;
  return a;
}

// Five pixels in a row or a column (kernel.h).
Line<double> line_of(const Settings& s, const brume_tile& tile, std::ptrdiff_t i,
                     std::ptrdiff_t step) {
  const glm::dvec3 axis(s.forward[0], s.forward[1], s.forward[2]);
  const At here = at(tile, i);
  const bool planar = glm::dot(here.d, axis) > 0.5;
  const auto depth = [&](const At& a) {
    return a.t * (planar ? glm::dot(a.d, axis) : 1.);
  };
  Line<double> line;
  for (int j = 0; j < 5; ++j) {
    const At a = at(tile, i + (j - 2) * step);
    const double w = tile.ox
                         ? std::max(1 - 1e-3 / double(s.footprint) * (a.t - here.t), 1e-6)
                         : depth(here) / depth(a);
    line.t[j] = a.t;
    line.w[j] = a.there && w > 0 ? w : 0;
    const glm::dvec3 q = ((a.o + a.t * a.d) - (here.o + here.t * here.d)) / here.t;
    for (int k = 0; k < 3; ++k) line.q[j][k] = q[k];
  }
  return line;
}

glm::dvec3 normal_at(const Settings& s, const brume_tile& tile, std::ptrdiff_t i) {
  const At here = at(tile, i);
  const double d[3] = {here.d.x, here.d.y, here.d.z}, to_eye[3] = {-d[0], -d[1], -d[2]};
  double n[3];
  if (s.has_normals) {
    const float* const* from = tile.channels + (s.has_albedo ? 3 : 0);
    for (int k = 0; k < 3; ++k) {
      n[k] = 0;
      for (int j = 0; j < 3; ++j) n[k] += double(s.turn[3 * k + j]) * double(from[j][i]);
    }
    normalise(n, to_eye);
  } else {
    normal_of(line_of(s, tile, i, 1), line_of(s, tile, i, tile.row_stride), d, n);
  }
  return {n[0], n[1], n[2]};
}

// Of light k at the point x (relative to the eye), all that stands between included.
oracle::Rgb irradiance_of(const Settings& s, const brume_world& world, std::size_t k,
                          const glm::dvec3& x, const glm::dvec3& n, double half_pixel) {
  const brume_light& l = *world.light(&world, k);
  const float o[3] = {float(x.x), float(x.y), float(x.z)},
              up[3] = {float(n.x), float(n.y), float(n.z)};
  float out[3][1];
  float* const planes[3] = {out[0], out[1], out[2]};
  if (l.kind == BRUME_SKY_LIGHT) {
    const brume_rays point = {1, o, o + 1, o + 2, up, up + 1, up + 2};
    world.irradiance(&world, k, &point, planes);
    return {out[0][0], out[1][0], out[2][0]};
  }
  const glm::dvec3 toward(l.direction[0], l.direction[1], l.direction[2]);
  oracle::Rgb E{};
  glm::dvec3 way = toward;
  float far = INFINITY;
  if (l.kind == BRUME_SUN) {
    for (std::size_t c = 0; c < 3; ++c)
      E[c] = l.power[c] * std::max(glm::dot(toward, n), 0.);
  } else {
    oracle::Lamp lamp;
    lamp.position = glm::dvec3(l.position[0] - s.eye[0], l.position[1] - s.eye[1],
                               l.position[2] - s.eye[2]);
    way = lamp.position - x;
    const double r = glm::length(way);
    if (!(r > 0)) return {};
    std::copy_n(l.power, 3, lamp.power.begin());
    lamp.radius = std::max(l.radius, half_pixel);
    if (l.kind == BRUME_SPOT) {
      lamp.direction = toward;
      lamp.cone = l.cone, lamp.cone_soft = l.cone_soft, lamp.ratio = l.cone_falloff;
    }
    E = oracle::irradiance(lamp, x, n, {});
    way /= r;
    far = float(r);
  }
  if (l.attenuated && E != oracle::Rgb{}) {
    const float d[3] = {float(way.x), float(way.y), float(way.z)};
    const brume_rays ray = {1, o, o + 1, o + 2, d, d + 1, d + 2};
    world.transmittance(&world, &ray, &far, planes);
    for (std::size_t c = 0; c < 3; ++c) E[c] *= double(out[c][0]);
  }
  return E;
}

double clamped(float x, double most) { return x > 0 ? std::min(double(x), most) : 0; }

}  // namespace

void truth(const Settings& s, const brume_tile& tile, std::span<const int> xy,
           double* rgb) {
  const brume_world& world = *tile.world;
  const float* const C[3] = {tile.r, tile.g, tile.b};
  for (std::size_t k = 0; k < xy.size(); k += 2) {
    const std::ptrdiff_t i = xy[k + 1] * tile.row_stride + xy[k];
    double* const out = rgb + 3 * (k / 2);
    for (int c = 0; c < 3; ++c) out[c] = double(C[c][i]);
    const At here = at(tile, i);
    const double a = clamped(tile.a[i], 1);
    if (!here.there || a == 0) continue;
    const glm::dvec3 x = here.o + here.t * here.d, n = normal_at(s, tile, i);
    const double half = 0.5 * double(s.footprint) * (tile.ox ? 1 : here.t);
    oracle::Rgb E{};
    for (std::size_t l = 0; l < world.light_count; ++l) {
      if (!s.answers_to(world.light(&world, l)->kind)) continue;
      const oracle::Rgb one = irradiance_of(s, world, l, x, n, half);
      for (std::size_t c = 0; c < 3; ++c) E[c] += one[c];
    }
    for (int c = 0; c < 3; ++c) {
      const double rho = s.has_albedo   ? clamped(tile.channels[c][i], a)
                         : s.from_color ? clamped(C[c][i], a)
                                        : a * s.albedo[c];
      if (E[std::size_t(c)] > 0) out[c] += rho / M_PI * E[std::size_t(c)];
    }
  }
}

}  // namespace relight
