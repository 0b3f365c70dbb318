// [camera] of a scene file. Lengths are metres, angles degrees, like everything there.

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include "scene/camera.h"

namespace brume {
namespace {

glm::dvec3 vec(const Vec3& v) { return {v[0], v[1], v[2]}; }

// Euler angles: the axis named first is turned about first ("xyz" is Rz Ry Rx, as Maya,
// Houdini and Blender mean it).
glm::dmat3 turn_from_angles(const Vec3& degrees, const std::string& order) {
  glm::dmat4 m(1);
  for (const char axis : order) {
    const int k = axis - 'x';
    glm::dvec3 unit(0);
    unit[k] = 1;
    m = glm::rotate(glm::dmat4(1), glm::radians(degrees[static_cast<std::size_t>(k)]),
                    unit) *
        m;
  }
  return glm::dmat3(m);
}

void set_turn(Pose& pose, const glm::dmat3& axes) {
  pose.right = axes[0];
  pose.up = axes[1];
  pose.forward = -axes[2];
}

// Axes looking along `to`, the horizon level. Looking straight up or down has no level;
// there the top of the picture is where the world's next axis points (north for z up).
void look_along(Pose& pose, const glm::dvec3& to, const glm::dvec3& up,
                const std::string& where) {
  if (!(glm::length(to) > 0)) throw Error(where, "camera.look_at is at camera.position");
  const glm::dvec3 forward = glm::normalize(to);
  glm::dvec3 right = glm::cross(forward, up);
  if (glm::length(right) < 1e-9)
    right = glm::cross(forward, glm::dvec3(up.y, up.z, up.x));
  set_axes(pose, right, glm::cross(right, forward), forward, where);
}

// Turns between two keys go the short way round (quaternions); a `smooth` or `step`
// setting follows its own curve, angle by angle.
glm::dmat3 turn_at(const Setting& rotation, double frame, const Vec3& now,
                   const std::string& order) {
  if (rotation.interpolation == Interpolation::linear)
    for (std::size_t i = 1; i < rotation.keys.size(); ++i) {
      const auto &a = rotation.keys[i - 1], &b = rotation.keys[i];
      if (frame < a.frame || frame > b.frame) continue;
      const auto turn = [&](const Value& v) {
        return glm::quat_cast(
            turn_from_angles({v.numbers[0], v.numbers[1], v.numbers[2]}, order));
      };
      const double t = b.frame > a.frame ? (frame - a.frame) / (b.frame - a.frame) : 1;
      return glm::mat3_cast(glm::slerp(turn(a.value), turn(b.value), t));
    }
  return turn_from_angles(now, order);
}

}  // namespace

View view_from_section(const SceneFile& scene, const InputSection& input, double frame,
                       const Film& film) {
  const auto c = SceneFile::section<CameraSection>(scene.camera, frame);
  const auto setting = [&](const char* name) -> const Setting& {
    return scene.camera.values[static_cast<std::size_t>(scene.camera.find(name))];
  };
  const auto where = [&](const char* name) {
    const Location& at = setting(name).where;
    return at.source.empty() ? std::string("[camera]") : at.text();
  };

  if (!c.file.empty()) {
    const auto path = scene.path.parent_path() / c.file;
    const auto track = load_camera_file(path, film);
    Pose pose = track->at(frame, film);
    if (track->y_up) turn_y_up_to(pose, world_up(input));
    // Files tell of lenses; that a picture is a panorama only the scene can say.
    if (c.projection == "latlong") pose.projection = Projection::latlong;
    View view = view_of(pose, film);
    scale_world(view, input.metres);
    view.source = "[camera] file " + track->source;
    return view;
  }

  Pose pose;
  pose.eye = vec(c.position);
  const Setting& rotation = setting("rotation");
  if (!rotation.is_default) {  // given; look_at is not, then
    set_turn(pose, turn_at(rotation, frame, c.rotation, c.rotation_order));
  } else {
    look_along(pose, vec(c.look_at) - pose.eye, world_up(input), where("look_at"));
  }
  // Roll turns the camera about its axis, clockwise as seen from behind it.
  const double roll = glm::radians(c.roll);
  const glm::dvec3 right = pose.right, up = pose.up;
  pose.right = std::cos(roll) * right - std::sin(roll) * up;
  pose.up = std::cos(roll) * up + std::sin(roll) * right;

  if (c.projection == "latlong") {
    pose.projection = Projection::latlong;
  } else {
    const bool orthographic = c.projection == "orthographic";
    set_lens(pose, orthographic ? 1 : c.focal,
             orthographic ? c.ortho_width : c.aperture_width, film,
             where(orthographic ? "ortho_width" : "focal"));
    if (orthographic)
      pose.projection = Projection::orthographic;
    else if (c.aperture_height > 0) {
      pose.height = c.aperture_height / c.focal;
      pose.bottom = -0.5 * pose.height;
    }
    // Offsets in half windows, before the scale; the scale is about the lens's axis.
    const double s = c.window[2];
    if (!(s > 0)) throw Error(where("window"), "camera.window's scale is not positive");
    pose.left = s * (pose.left + 0.5 * pose.width * c.window[0]);
    pose.bottom = s * (pose.bottom + 0.5 * pose.height * c.window[1]);
    pose.width *= s;
    pose.height *= s;
  }
  View view = view_of(pose, film);
  view.source = "[camera] of the scene";
  return view;
}

}  // namespace brume
