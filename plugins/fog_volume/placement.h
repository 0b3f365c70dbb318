#pragma once
// Where a volume lies. Coordinates: local, in which the shape is the unit box or ball;
// world, metres.
//
//   world = M (R diag(half) local + center),   R = Rz Ry Rx
//
// All in double; long double where a determinant cancels.

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "params/describe.h"

namespace fog_volume {

using brume::Matrix4;
using brume::Vec3;

using Matrix3 = std::array<std::array<double, 3>, 3>;

/// Rz Ry Rx of angles in degrees about x, y, z; a quarter turn is exact.
inline Matrix3 rotation(const Vec3& degrees) {
  double c[3], s[3];
  for (std::size_t i = 0; i < 3; ++i) {
    // Quarter turns apart: sin(pi) in floating point is not 0.
    const double rest = std::remainder(degrees[i], 90);
    const int quarter = int(std::lround(std::remainder((degrees[i] - rest) / 90, 4)));
    const double a = rest * std::numbers::pi / 180;
    c[i] = std::cos(a), s[i] = std::sin(a);
    for (int turn = 0; turn < ((quarter % 4) + 4) % 4; ++turn) {
      const double was = c[i];
      c[i] = -s[i], s[i] = was;
    }
  }
  return {
      {{c[2] * c[1], c[2] * s[1] * s[0] - s[2] * c[0], c[2] * s[1] * c[0] + s[2] * s[0]},
       {s[2] * c[1], s[2] * s[1] * s[0] + c[2] * c[0], s[2] * s[1] * c[0] - c[2] * s[0]},
       {-s[1], c[1] * s[0], c[1] * c[0]}}};
}

/// M^-1 as 3 x 4, row by row. Throws where M is not affine or is flat: its columns span
/// less than 1e-12 of the box of their lengths.
inline std::array<double, 12> inverse(const Matrix4& m) {
  if (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1)
    throw std::runtime_error(
        "matrix: its last row is not 0 0 0 1; it acts on column vectors and is given row "
        "by row");
  using Long = long double;
  const auto a = [&](std::size_t r, std::size_t c) { return Long(m[4 * r + c]); };
  const auto cofactor = [&](std::size_t r, std::size_t c) {
    const std::size_t r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3,
                      c2 = (c + 2) % 3;
    return a(r1, c1) * a(r2, c2) - a(r1, c2) * a(r2, c1);
  };
  Long det = 0, size = 1;
  for (std::size_t c = 0; c < 3; ++c) {
    det += a(0, c) * cofactor(0, c);
    size *= std::hypot(a(0, c), a(1, c), a(2, c));
  }
  if (!(std::abs(det) > 1e-12L * size))
    throw std::runtime_error(
        "matrix has no inverse: a volume needs three dimensions; check for a scale of 0 "
        "and for columns that are parallel");
  std::array<double, 12> out{};
  for (std::size_t r = 0; r < 3; ++r) {
    Long shift = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const Long x = cofactor(c, r) / det;
      out[4 * r + c] = double(x);
      shift -= x * a(c, 3);
    }
    out[4 * r + 3] = double(shift);
  }
  return out;
}

struct Placement {
  std::array<double, 12> local_from_world;  ///< 3 x 4, row by row
  Vec3 center;                              ///< world
  double radius;                            ///< of a ball about `center` that holds it
};

/// Throws where `matrix` cannot be inverted.
inline Placement place(const Vec3& center, const Vec3& half, const Vec3& degrees,
                       const Matrix4& matrix) {
  const Matrix3 R = rotation(degrees);
  const std::array<double, 12> inv = inverse(matrix);
  Placement p{};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 4; ++c) {
      double sum = 0;  // R^T (M^-1 x - center), one axis of it
      for (std::size_t k = 0; k < 3; ++k)
        sum += R[k][r] * (inv[4 * k + c] - (c == 3 ? center[k] : 0));
      p.local_from_world[4 * r + c] = sum / half[r];
    }
    p.center[r] = matrix[4 * r + 3];
    for (std::size_t k = 0; k < 3; ++k) p.center[r] += matrix[4 * r + k] * center[k];
  }
  for (std::size_t c = 0; c < 3; ++c) {
    double axis[3] = {};
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t k = 0; k < 3; ++k)
        axis[r] += matrix[4 * r + k] * R[k][c] * half[c];
    p.radius += std::hypot(axis[0], axis[1], axis[2]);
  }
  return p;
}

}  // namespace fog_volume
