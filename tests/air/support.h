#pragma once
// Worlds and rays for tests.

#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include "air/air.h"
#include "oracle.h"

namespace brume::testing_air {

inline constexpr float kInf = std::numeric_limits<float>::infinity();

/// Uniform grey fog everywhere, black.
inline brume_medium fog(double sigma, double source = 0) {
  brume_medium m = {};
  m.size = sizeof m;
  m.name = "";
  m.shape = BRUME_EVERYWHERE;
  for (int i : {0, 5, 10}) m.local_from_world[i] = 1;
  m.profile = BRUME_UNIFORM;
  m.direction[2] = 1;
  for (int c = 0; c < 3; ++c) {
    m.extinction[c] = sigma;
    m.color[c] = source;
  }
  m.source = BRUME_SOURCE_COLOR;
  m.max_opacity = 1;
  return m;
}

/// Fog that scatters all it takes, by Henyey & Greenstein's g.
inline brume_medium white_fog(double sigma, double g = 0) {
  brume_medium m = fog(sigma);
  for (double& a : m.albedo) a = 1;
  m.g = g;
  return m;
}

inline brume_medium height_fog(double sigma, double falloff, double height = 0,
                               double source = 1) {
  brume_medium m = fog(sigma, source);
  m.profile = BRUME_EXPONENTIAL;
  m.falloff = falloff;
  m.origin[2] = height;
  return m;
}

/// Bounds: centre and half extents, axes turned by `angle` about z, then x.
inline brume_medium shaped(brume_medium m, brume_shape shape, glm::dvec3 center,
                           glm::dvec3 half, double angle = 0) {
  m.shape = shape;
  const double c = std::cos(angle), s = std::sin(angle);
  const glm::dvec3 axes[3] = {{c, s * c, s * s}, {-s, c * c, c * s}, {0, -s, c}};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m.local_from_world[4 * i + j] = axes[i][j] / half[i];
    m.local_from_world[4 * i + 3] = -glm::dot(axes[i], center) / half[i];
  }
  return m;
}

/// A lamp that media dim.
inline brume_light lamp(glm::dvec3 at, double power = 1,
                        brume_light_kind kind = BRUME_POINT) {
  brume_light l = {};
  l.size = sizeof l;
  l.kind = kind;
  l.attenuated = 1;
  l.direction[0] = 1;
  for (int c = 0; c < 3; ++c) l.position[c] = at[c], l.power[c] = power;
  return l;
}

inline World world_of(std::vector<brume_medium> media,
                      std::vector<brume_light> lights = {}) {
  World w;
  int stage = 0;
  for (const auto& m : media) w.media.push_back({m, stage++, ""});
  for (const auto& l : lights) w.lights.push_back({l, 0, ""});
  return w;
}

inline AirOptions options(int stages = 16, double tolerance = 1e-3) {
  AirOptions o;
  o.tolerance = tolerance;
  o.stages = stages;
  return o;
}

/// Rays as vectors of floats.
struct Bundle {
  std::vector<float> o[3], d[3], end;
  bool from_eye = true;

  int size() const { return int(end.size()); }
  void add(glm::dvec3 dir, double t) {
    dir = glm::normalize(dir);
    for (int c = 0; c < 3; ++c) d[c].push_back(float(dir[c]));
    end.push_back(float(t));
    for (auto& x : o) x.push_back(0);
  }
  void add(glm::dvec3 origin, glm::dvec3 dir, double t) {
    add(dir, t);
    from_eye = false;
    for (int c = 0; c < 3; ++c) o[c].back() = float(origin[c]);
  }
  RaySpans spans() const {
    RaySpans r{size(),      nullptr,     nullptr,     nullptr,
               d[0].data(), d[1].data(), d[2].data(), end.data()};
    if (!from_eye) r.ox = o[0].data(), r.oy = o[1].data(), r.oz = o[2].data();
    return r;
  }
  oracle::Ray ray(int i) const {
    oracle::Ray r;
    for (int c = 0; c < 3; ++c) r.o[c] = o[c][i], r.d[c] = d[c][i];
    r.end = end[i];
    return r;
  }
};

struct Result {
  std::vector<float> T[3], L[3];
  std::vector<std::vector<float>> stage_L, stage_T;
};

inline Result integrate(const Air& air, const Bundle& b, int stages = 0,
                        std::span<const float* const> weights = {}) {
  Result r;
  const auto n = std::size_t(b.size());
  std::vector<float*> sL, sT;
  for (int c = 0; c < 3; ++c) {
    r.T[c].assign(n, -1);
    r.L[c].assign(n, -1);
  }
  r.stage_L.assign(3 * std::size_t(stages), std::vector<float>(n));
  r.stage_T = r.stage_L;
  for (auto& v : r.stage_L) sL.push_back(v.data());
  for (auto& v : r.stage_T) sT.push_back(v.data());
  AirOut out{{r.T[0].data(), r.T[1].data(), r.T[2].data()},
             {r.L[0].data(), r.L[1].data(), r.L[2].data()},
             sL,
             sT};
  air.integrate(b.spans(), weights, out);
  return r;
}

/// Every instruction set this processor has.
inline std::vector<Isa> isas() {
  std::vector<Isa> all;
  for (Isa i : {Isa::v2, Isa::v3, Isa::v4})
    if (i <= best_isa()) all.push_back(i);
  return all;
}

struct Random {
  std::mt19937_64 engine;
  explicit Random(unsigned long seed) : engine(seed) {}
  double uniform(double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(engine);
  }
  double log(double a, double b) { return std::exp(uniform(std::log(a), std::log(b))); }
  int integer(int n) { return int(engine() % unsigned(n)); }
  glm::dvec3 direction() {
    for (;;) {
      const glm::dvec3 v(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
      const double r = glm::dot(v, v);
      if (r > 1e-3 && r < 1) return v / std::sqrt(r);
    }
  }
};

}  // namespace brume::testing_air
