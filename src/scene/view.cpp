#include "scene/view.h"

#include <cmath>
#include <glm/gtc/constants.hpp>

#include "scene/view_run.h"

namespace brume {
namespace {

constexpr double kTurn = glm::two_pi<double>();  // [rad]

void store(float (&to)[3], const glm::dvec3& v) {
  for (int k = 0; k < 3; ++k) to[k] = static_cast<float>(v[k]);
}

}  // namespace

RayRow ray_row(const View& view, int y) noexcept {
  RayRow r{};
  r.middle = view.display.x + view.display.width / 2;
  const double row = y + 0.5;
  if (view.projection == Projection::latlong) {
    const double elevation = kTurn * (view.corner.y + row * view.down.y);
    r.turns_at_middle = static_cast<float>(view.corner.x + r.middle * view.across.x);
    r.pixels_per_turn = static_cast<float>(1 / view.across.x);
    store(r.east, std::cos(elevation) * view.right);
    store(r.ahead, std::cos(elevation) * view.forward);
    store(r.pole, std::sin(elevation) * view.up);
  } else {
    store(r.at_middle, view.corner + double(r.middle) * view.across + row * view.down);
    store(r.per_f, view.across);
    store(r.forward, view.forward);
  }
  return r;
}

View::RayAt View::ray(double x, double y) const {
  const glm::dvec3 at = corner + x * across + y * down;
  switch (projection) {
    case Projection::perspective: {
      const double length = glm::length(at);
      return {eye, at / length, 1 / length};
    }
    case Projection::orthographic:
      return {eye + at, forward, 1};
    case Projection::latlong:
      break;
  }
  const double longitude = kTurn * at.x, elevation = kTurn * at.y;
  return {eye,
          std::cos(elevation) *
                  (std::sin(longitude) * right + std::cos(longitude) * forward) +
              std::sin(elevation) * up,
          1};
}

double View::pixel_footprint() const {
  const double x = display.x + 0.5 * display.width, y = display.y + 0.5 * display.height;
  const RayAt here = ray(x, y), beside = ray(x + 1, y), below = ray(x, y + 1);
  // The area of the parallelogram: also right where rows and columns are not orthogonal.
  if (projection == Projection::orthographic)
    return std::sqrt(glm::length(glm::cross(across, down)));
  return std::sqrt(glm::length(
      glm::cross(beside.direction - here.direction, below.direction - here.direction)));
}

View View::scaled(double scale_x, double scale_y) const {
  View v = *this;
  v.across /= scale_x;
  v.down /= scale_y;
  v.display.x = static_cast<int>(std::floor(display.x * scale_x));
  v.display.y = static_cast<int>(std::floor(display.y * scale_y));
  v.display.width = static_cast<int>(std::ceil(display.right() * scale_x)) - v.display.x;
  v.display.height =
      static_cast<int>(std::ceil(display.bottom() * scale_y)) - v.display.y;
  return v;
}

glm::dvec3 world_up(const InputSection& input) {
  if (input.up == "x") return {1, 0, 0};
  if (input.up == "y") return {0, 1, 0};
  return {0, 0, 1};
}

bool fill_rays(const View& view, int x, int y, int n, const RaySpan& out) noexcept {
  static const RayKernels& kernels = BRUME_ISA_SELECT(ray_kernels);
  const RayRow row = ray_row(view, y);
  switch (view.projection) {
    case Projection::perspective:
      kernels.perspective(row, x, n, out);
      return true;
    case Projection::orthographic:
      kernels.orthographic(row, x, n, out);
      return false;
    case Projection::latlong:
      kernels.latlong(row, x, n, out);
      return true;
  }
  return true;
}

}  // namespace brume
