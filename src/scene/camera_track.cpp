// Cameras over frames, from files: .chan here, JSON in camera_json.cpp.

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <glm/gtc/matrix_transform.hpp>
#include <mutex>
#include <sstream>

#include "scene/camera.h"

namespace brume {
namespace {

std::string frame_text(double frame) {
  std::ostringstream s;
  s << frame;
  return s.str();
}

std::string read_text(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  if (!in || !(text << in.rdbuf()))
    throw Error(path.string(), "cannot be read", "[camera] file names it");
  return text.str();
}

}  // namespace

Pose CameraTrack::at(double frame, const Film& film) const {
  const auto pose = [&](const Key& key) {
    Pose p = key.pose;
    if (key.width_from_film) {
      p.width = p.height * film.aspect();
      p.left = -0.5 * p.width;
    }
    return p;
  };
  if (any_frame) return pose(keys.front());
  // NaN falls through to the error.
  if (!(frame >= keys.front().frame && frame <= keys.back().frame))
    throw Error(source, "has no camera for frame " + frame_text(frame),
                "it has " + frame_text(keys.front().frame) + " to " +
                    frame_text(keys.back().frame));
  const auto next =
      std::lower_bound(keys.begin(), keys.end(), frame,
                       [](const Key& key, double wanted) { return key.frame < wanted; });
  if (next->frame == frame) return pose(*next);
  const auto& before = *(next - 1);
  return interpolate(pose(before), pose(*next),
                     (frame - before.frame) / (next->frame - before.frame));
}

// A line is: frame, translation x y z, rotation x y z [degrees], and for cameras the
// vertical field of view [degrees]. Nuke and Houdini write it in a y-up world; rotation
// order ZXY (z first), Nuke's default; the camera at rest looks along -z.
CameraTrack read_chan(const std::string& text, const std::string& where) {
  CameraTrack track;
  track.source = where;
  track.y_up = true;
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    std::vector<double> v;
    const char *p = line.data(), *end = p + line.size();
    const auto here = [&] { return where + ":" + std::to_string(number); };
    while (true) {
      while (p < end && (*p == ' ' || *p == '\t' || *p == '\r')) ++p;
      if (p == end || *p == '#') break;
      double x;
      const auto r = std::from_chars(*p == '+' ? p + 1 : p, end, x);
      if (r.ec != std::errc{} || !std::isfinite(x))
        throw Error(here(), "is not a number: " + std::string(p, std::min(end, p + 20)));
      v.push_back(x);
      p = r.ptr;
    }
    if (v.empty()) continue;
    if (v.size() < 8)
      throw Error(here(), "has " + std::to_string(v.size()) + " numbers",
                  "a camera's line is: frame tx ty tz rx ry rz vertical-fov");
    if (!(v[7] > 0 && v[7] < 180))
      throw Error(here(), "the field of view is " + frame_text(v[7]) + " degrees");
    if (!track.keys.empty() && v[0] <= track.keys.back().frame)
      throw Error(here(), "frame " + frame_text(v[0]) + " does not follow " +
                              frame_text(track.keys.back().frame));
    CameraTrack::Key key{v[0], {}, true};
    glm::dmat4 m = glm::translate(glm::dmat4(1), glm::dvec3(v[1], v[2], v[3]));
    m = glm::rotate(m, glm::radians(v[5]), glm::dvec3(0, 1, 0));
    m = glm::rotate(m, glm::radians(v[4]), glm::dvec3(1, 0, 0));
    m = glm::rotate(m, glm::radians(v[6]), glm::dvec3(0, 0, 1));
    set_axes_from_rest(key.pose, m, here());
    key.pose.height = 2 * std::tan(0.5 * glm::radians(v[7]));
    key.pose.bottom = -0.5 * key.pose.height;
    track.keys.push_back(key);
  }
  if (track.keys.empty()) throw Error(where, "has no camera");
  return track;
}

void turn_y_up_to(Pose& pose, const glm::dvec3& up) {
  const auto turned = [&](const glm::dvec3& v) -> glm::dvec3 {
    if (up.z > 0) return {v.x, -v.z, v.y};
    if (up.x > 0) return {v.y, v.x, -v.z};
    return v;
  };
  for (glm::dvec3* v : {&pose.eye, &pose.right, &pose.up, &pose.forward}) *v = turned(*v);
}

std::shared_ptr<const CameraTrack> load_camera_file(const std::filesystem::path& path,
                                                    const Film& film) {
  struct Entry {
    std::string path;
    std::filesystem::file_time_type written;
    Film film;
    std::shared_ptr<const CameraTrack> track;
  };
  static std::mutex mutex;
  static std::vector<Entry> kept;  // a sequence asks for the same file every frame
  constexpr std::size_t kKept = 4;

  std::error_code none;
  const auto written = std::filesystem::last_write_time(path, none);
  const std::lock_guard lock(mutex);
  for (const Entry& e : kept)
    if (e.path == path && e.written == written && e.film.display == film.display &&
        e.film.pixel_aspect == film.pixel_aspect)
      return e.track;

  const std::string where = path.string();
  const auto extension = path.extension();
  std::shared_ptr<const CameraTrack> track;
  if (extension == ".chan")
    track = std::make_shared<CameraTrack>(read_chan(read_text(path), where));
  else if (extension == ".json")
    track = std::make_shared<CameraTrack>(read_camera_json(read_text(path), film, where));
  else
    throw Error(where, "is not a camera file", "allowed: .chan and .json");
  std::erase_if(kept, [&](const Entry& e) { return e.path == path; });
  if (kept.size() == kKept) kept.erase(kept.begin());
  kept.push_back({where, written, film, track});
  return track;
}

}  // namespace brume
