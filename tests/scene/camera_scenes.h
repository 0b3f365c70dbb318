#pragma once
// What the tests of this folder share: headers with a camera in them.

#include <glm/glm.hpp>
#include <string>
#include <utility>
#include <vector>

#include "image/image.h"
#include "scene/view.h"

namespace brume::test {

inline Attribute matrix(const glm::dmat4& rows) {  // rows[i] is row i
  std::vector<float> f;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) f.push_back(static_cast<float>(rows[i][j]));
  return Attribute::from_floats("m44f", f);
}
inline Attribute floats(const char* type, std::vector<float> f) {
  return Attribute::from_floats(type, f);
}

inline ImageHeader header(int width, int height) {
  ImageHeader h;
  h.display_window = h.data_window = {0, 0, width, height};
  return h;
}

/// worldToCamera of a camera with these axes (columns of the 3 x 3 part).
inline glm::dmat4 world_to_camera(const glm::dvec3& eye, const glm::dvec3& right,
                                  const glm::dvec3& up, const glm::dvec3& forward) {
  glm::dmat4 m(0);
  for (int i = 0; i < 3; ++i) m[i] = {right[i], up[i], forward[i], 0};
  m[3] = {-glm::dot(eye, right), -glm::dot(eye, up), -glm::dot(eye, forward), 1};
  return m;
}

/// Rows of a b for row vectors: first a, then b.
inline glm::dmat4 then(const glm::dmat4& a, const glm::dmat4& b) {
  glm::dmat4 m(0);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k) m[i][j] += a[i][k] * b[k][j];
  return m;
}

/// Camera space to NDC of a perspective window [left, right] x [bottom, top] at
/// distance 1.
inline glm::dmat4 perspective_ndc(double left, double right, double bottom, double top,
                                  double near = 0.1, double far = 1e4) {
  glm::dmat4 m(0);
  m[0][0] = 1 / (right - left);
  m[1][1] = -1 / (top - bottom);
  m[2] = {-left / (right - left), top / (top - bottom), far / (far - near), 1};
  m[3][2] = -near * far / (far - near);
  return m;
}
inline glm::dmat4 orthographic_ndc(double left, double right, double bottom, double top,
                                   double near = 0.1, double far = 1e4) {
  glm::dmat4 m(0);
  m[0][0] = 1 / (right - left);
  m[1][1] = -1 / (top - bottom);
  m[2][2] = 1 / (far - near);
  m[3] = {-left / (right - left), top / (top - bottom), -near / (far - near), 1};
  return m;
}

/// A run of rays in memory.
struct Rays {
  explicit Rays(int n) : planes(7, std::vector<float>(static_cast<std::size_t>(n))) {}
  RaySpan span(int from = 0) {
    const auto p = [&](int k) {
      return planes[static_cast<std::size_t>(k)].data() + from;
    };
    return {p(0), p(1), p(2), p(3), p(4), p(5), p(6)};
  }
  glm::dvec3 origin(int i) const { return at(0, i); }
  glm::dvec3 direction(int i) const { return at(3, i); }
  double per_planar(int i) const { return planes[6][static_cast<std::size_t>(i)]; }
  std::vector<std::vector<float>> planes;

 private:
  glm::dvec3 at(std::size_t k, int n) const {
    const auto i = static_cast<std::size_t>(n);
    return {planes[k][i], planes[k + 1][i], planes[k + 2][i]};
  }
};

}  // namespace brume::test
