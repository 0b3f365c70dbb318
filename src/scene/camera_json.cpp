// Cameras in JSON. One camera is an object, a moving one
//
//   {"frames": [{"frame": 1001, ...}, {"frame": 1002, ...}]}
//
// Each camera says where it is and what it takes in, in scene units, degrees and mm:
//
//   matrices   "worldToCamera" and "worldToNDC" (or either with "_row_vectors" after its
//              name): as in OpenEXR files, in full precision; worldToNDC alone will do;
//              or
//   pose       "world_from_camera" (16 numbers, row by row, acting on column vectors; the
//              camera looks along its -z, +y up), or "position" with "look_at" and "up"
//              (default 0 0 1), with "forward" and "up", or with "rotation" [x, y, z],
//              Euler angles turned about x first;
//   lens       "focal" or "focal_mm" with "aperture" or "sensor_width_mm" (default 36),
//   or
//              "hfov_deg", or "ortho_width".
//
// Matrices may be 16 numbers or 4 rows of 4. Other keys are somebody else's.

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <nlohmann/json.hpp>

#include "scene/camera.h"

namespace brume {
namespace {

using Json = nlohmann::json;

/// One camera object; errors say which.
struct Reader {
  const Json& object;
  std::string where;

  const Json* find(std::initializer_list<const char*> names) const {
    for (const char* name : names)
      if (const auto it = object.find(name); it != object.end()) return &*it;
    return nullptr;
  }

  std::optional<std::vector<double>> numbers(std::initializer_list<const char*> names,
                                             std::size_t count) const {
    const Json* found = find(names);
    if (!found) return {};
    std::vector<double> out;
    const auto add = [&](const Json& j) {
      if (j.is_number()) out.push_back(j.get<double>());
    };
    if (found->is_array())
      for (const Json& row : *found) {
        if (row.is_array())
          for (const Json& x : row) add(x);
        else
          add(row);
      }
    else
      add(*found);
    const auto finite = [](double x) { return std::isfinite(x); };
    if (out.size() != count || !std::all_of(out.begin(), out.end(), finite))
      throw Error(where, std::string(*names.begin()) + " is not " +
                             std::to_string(count) + " numbers");
    return out;
  }
  std::optional<double> number(std::initializer_list<const char*> names) const {
    const auto n = numbers(names, 1);
    return n ? std::optional((*n)[0]) : std::nullopt;
  }
  std::optional<glm::dvec3> vector(const char* name) const {
    const auto n = numbers({name}, 3);
    if (!n) return {};
    return glm::dvec3{(*n)[0], (*n)[1], (*n)[2]};
  }
};

void set_pose(Pose& pose, const Reader& r) {
  if (const auto m = r.numbers({"world_from_camera"}, 16)) {
    glm::dmat4 world_from_camera;
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column)
        world_from_camera[column][row] = (*m)[std::size_t(4 * row + column)];
    set_axes_from_rest(pose, world_from_camera, r.where);
    return;
  }
  const auto position = r.vector("position");
  if (!position)
    throw Error(r.where, "says no place",
                "worldToCamera, world_from_camera or position expected");
  pose.eye = *position;
  const auto look_at = r.vector("look_at"), forward = r.vector("forward");
  if (look_at || forward) {
    const glm::dvec3 to = look_at ? *look_at - pose.eye : *forward;
    const glm::dvec3 up = r.vector("up").value_or(glm::dvec3(0, 0, 1));
    const glm::dvec3 right = glm::cross(to, up);
    if (!(glm::length(right) > 1e-9 * glm::length(to) * glm::length(up)))
      throw Error(r.where, "looks along its up direction", "give another \"up\"");
    set_axes(pose, right, up, to, r.where);
  } else if (const auto angles = r.vector("rotation")) {
    glm::dmat4 m = glm::rotate(glm::dmat4(1), glm::radians(angles->z), {0, 0, 1});
    m = glm::rotate(m, glm::radians(angles->y), {0, 1, 0});
    m = glm::rotate(m, glm::radians(angles->x), {1, 0, 0});
    set_axes_from_rest(pose, m, r.where);
    pose.eye = *position;
  } else {
    throw Error(r.where, "says no direction", "look_at, forward or rotation expected");
  }
}

void set_window(Pose& pose, const Reader& r, const Film& film) {
  const double aperture = r.number({"aperture", "sensor_width_mm"}).value_or(36);
  if (const auto width = r.number({"ortho_width"})) {
    pose.projection = Projection::orthographic;
    set_lens(pose, 1, *width, film, r.where);
  } else if (const auto focal = r.number({"focal", "focal_mm"})) {
    set_lens(pose, *focal, aperture, film, r.where);
  } else if (const auto fov = r.number({"hfov_deg"}); fov && *fov > 0 && *fov < 180) {
    set_lens(pose, 1, 2 * std::tan(0.5 * glm::radians(*fov)), film, r.where);
  } else {
    throw Error(r.where, "says no lens", "focal, hfov_deg or ortho_width expected");
  }
}

Pose camera(const Reader& r, const Film& film) {
  const auto to_camera = r.numbers({"worldToCamera", "worldToCamera_row_vectors"}, 16);
  const auto to_ndc = r.numbers({"worldToNDC", "worldToNDC_row_vectors"}, 16);
  Pose pose;
  if (to_ndc) {
    const View view = view_from_matrices(to_camera ? to_camera->data() : nullptr,
                                         to_ndc->data(), {}, film, r.where);
    return pose_of(view, film);
  }
  if (to_camera)
    pose =
        pose_of(view_from_matrices(to_camera->data(), nullptr, {}, film, r.where), film);
  else
    set_pose(pose, r);
  set_window(pose, r, film);
  return pose;
}

}  // namespace

CameraTrack read_camera_json(const std::string& text, const Film& film,
                             const std::string& where) {
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::parse_error& e) {
    throw Error(where, "is not JSON near byte " + std::to_string(e.byte));
  } catch (const Json::exception&) {
    throw Error(where, "has a number beyond all numbers");
  }
  if (!json.is_object()) throw Error(where, "is not a JSON object");

  CameraTrack track;
  track.source = where;
  const auto frames = json.find("frames");
  if (frames == json.end()) {
    track.any_frame = !json.contains("frame");
    const Reader r{json, where};
    track.keys.push_back({r.number({"frame"}).value_or(0), camera(r, film)});
    return track;
  }
  if (!frames->is_array() || frames->empty())
    throw Error(where, "frames is not a list of cameras");
  for (const Json& object : *frames) {
    const std::string here =
        where + ": frames[" + std::to_string(track.keys.size()) + "]";
    const Reader r{object, here};
    const auto frame = object.is_object() ? r.number({"frame"}) : std::nullopt;
    if (!frame) throw Error(here, "has no frame number");
    track.keys.push_back({*frame, camera(r, film)});
  }
  const auto by_frame = [](const auto& a, const auto& b) { return a.frame < b.frame; };
  std::sort(track.keys.begin(), track.keys.end(), by_frame);
  for (std::size_t i = 1; i < track.keys.size(); ++i)
    if (track.keys[i].frame == track.keys[i - 1].frame)
      throw Error(where, "has two cameras for one frame");
  return track;
}

}  // namespace brume
