#include "scene/camera.h"

#include <cmath>
#include <glm/gtc/quaternion.hpp>

namespace brume {

Film film_of(const ImageHeader& header, const std::string& where) {
  const Film film{header.display_window, header.pixel_aspect};
  if (film.display.empty()) throw Error(where, "the display window is empty");
  if (!(film.pixel_aspect > 0) || !std::isfinite(film.pixel_aspect))
    throw Error(where, "pixelAspectRatio is not positive");
  return film;
}

View view_of(const Pose& pose, const Film& film) {
  View v;
  v.projection = pose.projection;
  v.eye = pose.eye;
  v.right = pose.right;
  v.up = pose.up;
  v.forward = pose.forward;
  v.display = film.display;
  const double w = film.display.width, h = film.display.height;
  if (pose.projection == Projection::latlong) {
    v.corner = {-0.5, 0.25, 0};
    v.across = {1 / w, 0, 0};
    v.down = {0, -0.5 / h, 0};
  } else {
    v.corner = pose.left * pose.right + (pose.bottom + pose.height) * pose.up;
    if (pose.projection == Projection::perspective) v.corner += pose.forward;
    v.across = pose.width / w * pose.right;
    v.down = -pose.height / h * pose.up;
  }
  v.corner -= double(film.display.x) * v.across + double(film.display.y) * v.down;
  return v;
}

Pose pose_of(const View& v, const Film& film) {
  Pose pose{v.projection, v.eye, v.right, v.up, v.forward};
  if (v.projection == Projection::latlong) return pose;
  const glm::dvec3 lower_left = v.corner + double(film.display.x) * v.across +
                                double(film.display.bottom()) * v.down;
  pose.left = glm::dot(lower_left, v.right);
  pose.bottom = glm::dot(lower_left, v.up);
  pose.width = film.display.width * glm::dot(v.across, v.right);
  pose.height = -film.display.height * glm::dot(v.down, v.up);
  return pose;
}

void set_axes(Pose& pose, const glm::dvec3& right, const glm::dvec3& up,
              const glm::dvec3& forward, const std::string& where) {
  pose.forward = glm::normalize(forward);
  pose.right = glm::normalize(right - glm::dot(right, pose.forward) * pose.forward);
  pose.up = glm::normalize(up - glm::dot(up, pose.forward) * pose.forward -
                           glm::dot(up, pose.right) * pose.right);
  const double volume = glm::dot(pose.right, glm::cross(pose.up, pose.forward));
  // NaN when a direction is zero or lies in the others' plane.
  if (!(std::abs(volume) > 0.5))
    throw Error(where, "the camera's axes are not independent");
}

void set_axes_from_rest(Pose& pose, const glm::dmat4& world_from_camera,
                        const std::string& where) {
  set_axes(pose, glm::dvec3(world_from_camera[0]), glm::dvec3(world_from_camera[1]),
           -glm::dvec3(world_from_camera[2]), where);
  pose.eye = glm::dvec3(world_from_camera[3]);
}

void set_lens(Pose& pose, double focal, double aperture_width, const Film& film,
              const std::string& where) {
  const double width = aperture_width / focal;
  if (!(focal > 0) || !(width > 0) || !std::isfinite(width))
    throw Error(where, "the camera's focal length and aperture must be positive");
  pose.width = width;
  pose.height = width / film.aspect();
  pose.left = -0.5 * pose.width;
  pose.bottom = -0.5 * pose.height;
}

Pose interpolate(const Pose& a, const Pose& b, double t) {
  if (t <= 0) return a;
  if (t >= 1) return b;
  // A mirrored camera (left-handed world) has no quaternion; its right is turned over for
  // the while.
  const auto turn = [](const Pose& p, bool mirrored) {
    return glm::quat_cast(glm::dmat3(mirrored ? -p.right : p.right, p.up, -p.forward));
  };
  const auto is_mirrored = [](const Pose& p) {
    return glm::dot(p.right, glm::cross(p.up, p.forward)) > 0;
  };
  const bool mirrored = is_mirrored(a);
  if (mirrored != is_mirrored(b)) return t < 0.5 ? a : b;
  const glm::dmat3 axes =
      glm::mat3_cast(glm::slerp(turn(a, mirrored), turn(b, mirrored), t));
  const auto mix = [t](const auto& x, const auto& y) { return x + t * (y - x); };
  Pose p = a;
  p.eye = mix(a.eye, b.eye);
  p.right = mirrored ? -axes[0] : axes[0];
  p.up = axes[1];
  p.forward = -axes[2];
  p.left = mix(a.left, b.left);
  p.bottom = mix(a.bottom, b.bottom);
  p.width = mix(a.width, b.width);
  p.height = mix(a.height, b.height);
  return p;
}

void scale_world(View& view, double metres) {
  view.eye *= metres;
  if (view.projection != Projection::orthographic) return;
  view.corner *= metres;
  view.across *= metres;
  view.down *= metres;
}

std::optional<View> find_view(const ImageHeader& header, const SceneFile& scene,
                              double frame, const std::string& where) {
  const Film film = film_of(header, where);
  // A scene made in memory may have no [input] at all.
  const InputSection input = scene.input.specs.empty()
                                 ? InputSection{}
                                 : SceneFile::section<InputSection>(scene.input, frame);
  if (scene.has_camera) return view_from_section(scene, input, frame, film);
  std::optional<View> view = view_from_attributes(header, film, where);
  if (view) scale_world(*view, input.metres);
  return view;
}

}  // namespace brume
