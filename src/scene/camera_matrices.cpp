// View from worldToCamera and worldToNDC. Both act on row vectors, (p, 1) M, and come as
// floats, so each thing is taken from where it is known best:
//
//   axes, eye     worldToCamera: columns of its 3 x 3 part, and -t R^-1
//   window        worldToNDC's directions alone. With a, b, n the world gradients of X, Y
//                 and W, the ray with NDC (x, y) and planar depth 1 is
//                     r = |n| (x, y, 1) [a b n]^-1,
//                 which the translation, the least exact part far from the origin, does
//                 not enter.
//
// Conventions (OpenEXR standard attributes): camera space is left-handed, +x right, +y
// up, +z forward; NDC is (0, 0) at the upper left and (1, 1) at the lower right corner of
// the display window.

#include <cmath>

#include "scene/camera.h"

namespace brume {
namespace {

// Below this ratio of the gradients of W and X the projection is orthographic: as an
// angle of view it would be 1e-6 rad, and float matrices of orthographic cameras have
// exact zeros.
constexpr double kOrthographic = 1e-6;

struct RowMatrix {
  glm::dvec3 column[4];  // gradient of each output over the world
  double at_origin[4];   // each output at the world's origin

  explicit RowMatrix(const double* m) {
    for (int j = 0; j < 4; ++j) {
      column[j] = {m[j], m[4 + j], m[8 + j]};
      at_origin[j] = m[12 + j];
    }
  }
};

bool finite(const double* m) {
  for (int i = 0; i < 16; ++i)
    if (!std::isfinite(m[i])) return false;
  return true;
}

// Solves r . a = x, r . b = y, r . c = z. Singular when the volume of (a, b, c) is lost
// in float rounding beside the product of their lengths.
struct Dual {
  glm::dvec3 a, b, c;
  Dual(const glm::dvec3& x, const glm::dvec3& y, const glm::dvec3& z,
       const std::string& where, const char* what) {
    const double volume = glm::dot(x, glm::cross(y, z));
    const double size = glm::length(x) * glm::length(y) * glm::length(z);
    if (!(std::abs(volume) > 1e-12 * size) || !std::isfinite(1 / volume))
      throw Error(where, std::string(what) + " is singular",
                  "give a [camera] in the scene file");
    a = glm::cross(y, z) / volume;
    b = glm::cross(z, x) / volume;
    c = glm::cross(x, y) / volume;
  }
};

// Eye and axes of worldToCamera. The specification says that +z is forward. A camera
// space that is right-handed over a right-handed world is another convention (-z forward,
// as in OpenGL [?]); with `ahead`, the gradient of depth, we know, without it we assume
// that one.
Pose pose_from_camera_matrix(const RowMatrix& m, const glm::dvec3* ahead,
                             const std::string& where) {
  const auto& [right, up, z, unused] = m.column;
  const Dual inverse(right, up, z, where, "worldToCamera");
  const bool as_specified = glm::dot(right, glm::cross(up, z)) < 0;
  const bool backward = !as_specified && (!ahead || glm::dot(*ahead, z) < 0);
  Pose pose;
  set_axes(pose, right, up, backward ? -z : z, where);
  pose.eye = -(m.at_origin[0] * inverse.a + m.at_origin[1] * inverse.b +
               m.at_origin[2] * inverse.c);
  return pose;
}

}  // namespace

View view_from_matrices(const double* world_to_camera, const double* world_to_ndc,
                        const ScreenWindow& window, const Film& film,
                        const std::string& where) {
  if (world_to_camera && !finite(world_to_camera))
    throw Error(where, "worldToCamera is not finite");
  if (world_to_ndc && !finite(world_to_ndc))
    throw Error(where, "worldToNDC is not finite");

  if (!world_to_ndc) {
    Pose pose = pose_from_camera_matrix(RowMatrix(world_to_camera), nullptr, where);
    if (!(window.width > 0) || !std::isfinite(window.width + window.x + window.y))
      throw Error(where, "screenWindowWidth is not positive");
    pose.width = window.width;
    pose.height = window.width / film.aspect();
    pose.left = window.x - 0.5 * pose.width;
    pose.bottom = window.y - 0.5 * pose.height;
    return view_of(pose, film);
  }

  const RowMatrix ndc(world_to_ndc);
  const glm::dvec3 a = ndc.column[0], b = ndc.column[1];
  glm::dvec3 n = ndc.column[3];
  const double size = std::max(glm::length(a), glm::length(b));
  const bool orthographic = !(glm::length(n) > kOrthographic * size);

  Pose pose;
  View view;
  if (!orthographic) {
    const Dual dual(a, b, n, where, "worldToNDC");
    if (world_to_camera) {
      pose = pose_from_camera_matrix(RowMatrix(world_to_camera), &n, where);
    } else {
      // The projective centre is where X = Y = W = 0.
      pose.eye = -(ndc.at_origin[0] * dual.a + ndc.at_origin[1] * dual.b +
                   ndc.at_origin[3] * dual.c);
      set_axes(pose, dual.a, -dual.b, n, where);
    }
    // (X, Y, W) and its negative are one projection: |n| takes the sign of forward.
    const double unit = std::copysign(glm::length(n), glm::dot(n, pose.forward));
    view = view_of(pose, film);
    view.corner = unit * dual.c;
    view.across = unit / film.display.width * dual.a;
    view.down = unit / film.display.height * dual.b;
  } else {
    const double w = ndc.at_origin[3];
    if (!(std::abs(w) > 0)) throw Error(where, "worldToNDC is singular");
    // Depth in NDC grows along the view direction.
    const glm::dvec3 z = ndc.column[2] / w;
    if (world_to_camera) {
      pose = pose_from_camera_matrix(RowMatrix(world_to_camera), &z, where);
    }
    const glm::dvec3 ahead = world_to_camera ? pose.forward : glm::normalize(z);
    const Dual dual(a / w, b / w, ahead, where, "worldToNDC");
    if (!world_to_camera) {
      // Where the camera stands along its axis nobody says: depth counts from the near
      // plane, at the middle of the picture.
      const Dual near(a / w, b / w, z, where, "worldToNDC");
      set_axes(pose, dual.a, -dual.b, ahead, where);
      pose.eye = (0.5 - ndc.at_origin[0] / w) * near.a +
                 (0.5 - ndc.at_origin[1] / w) * near.b - ndc.at_origin[2] / w * near.c;
    }
    pose.projection = Projection::orthographic;
    view = view_of(pose, film);
    view.across = dual.a / double(film.display.width);
    view.down = dual.b / double(film.display.height);
    const double x = glm::dot(pose.eye, a / w) + ndc.at_origin[0] / w;
    const double y = glm::dot(pose.eye, b / w) + ndc.at_origin[1] / w;
    view.corner = -x * dual.a - y * dual.b;
  }
  view.corner -=
      double(film.display.x) * view.across + double(film.display.y) * view.down;
  return view;
}

}  // namespace brume
