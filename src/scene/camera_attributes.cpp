// Cameras in the attributes of EXR files. EXR_CONVENTIONS lists them; a [?] there is one
// here. First come the two matrices of the OpenEXR standard, whoever wrote them; then
// what single renderers write instead.

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "scene/camera.h"

namespace brume {
namespace {

std::string lower(std::string_view s) {
  std::string out(s);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

// Numbers in text: "1.5", "{1 0 0 0 ...}", as packages that carry metadata as strings
// write them.
std::vector<double> numbers_in(const std::string& text) {
  std::vector<double> out;
  const char *p = text.data(), *end = p + text.size();
  while (p < end) {
    double v;
    const char* start = *p == '+' ? p + 1 : p;
    if (const auto r = std::from_chars(start, end, v); r.ec == std::errc{}) {
      out.push_back(v);
      p = r.ptr;
    } else {
      ++p;
    }
  }
  return out;
}

std::vector<double> numbers_of(const Attribute& a) {
  if (const auto n = a.numbers()) return *n;
  if (const auto n = a.number()) return {*n};
  if (const auto t = a.text()) return numbers_in(*t);
  return {};
}

/// The header's attributes, found without regard to case (OpenImageIO writes
/// `worldtocamera`) and to the prefixes that packages put before what they passed through
/// (Nuke: `exr/`, [?] `nuke/exr/`). Remembers what was taken.
class Finder {
 public:
  Finder(const ImageHeader& header, std::string where)
      : header_(header), where_(std::move(where)) {}

  /// All numbers of an attribute, if it has `count` of them.
  std::optional<std::vector<double>> numbers(std::string_view name, std::size_t count) {
    const auto* found = find(name);
    if (!found) return {};
    auto n = numbers_of(found->second);
    if (n.size() != count)
      throw Error(where_, "attribute " + found->first + " is not " +
                              std::to_string(count) + " numbers");
    taken_ += (taken_.empty() ? "" : ", ") + found->first;
    return n;
  }
  std::optional<double> number(std::string_view name) {
    const auto n = numbers(name, 1);
    return n ? std::optional((*n)[0]) : std::nullopt;
  }
  /// The first attribute named prefix + anything + suffix.
  std::optional<double> number_like(std::string_view prefix, std::string_view suffix) {
    for (const auto& [key, value] : header_.attributes) {
      const std::string k = stripped(key);
      if (k.starts_with(prefix) && k.ends_with(suffix)) return number(key);
    }
    return {};
  }
  bool has(std::string_view name) const { return find(name); }
  const std::string& where() const { return where_; }
  std::string source(const std::string& note = {}) const {
    return taken_ + " of " + where_ + (note.empty() ? "" : " (" + note + ")");
  }

 private:
  static std::string stripped(std::string_view key) {
    std::string k = lower(key);
    for (const char* prefix : {"nuke/", "exr/"})
      if (k.starts_with(prefix)) k.erase(0, std::string_view(prefix).size());
    return k;
  }
  const std::pair<const std::string, Attribute>* find(std::string_view name) const {
    // The plain name before a copy of it.
    if (const auto it = header_.attributes.find(std::string(name));
        it != header_.attributes.end())
      return &*it;
    const std::string wanted = stripped(name);
    for (const auto& entry : header_.attributes)
      if (stripped(entry.first) == wanted) return &entry;
    return nullptr;
  }

  const ImageHeader& header_;
  std::string where_, taken_;
};

// The OpenEXR standard: worldToCamera, worldToNDC, and for a file without the latter
// screenWindowCenter and screenWindowWidth, the window at distance 1. Those two every
// file must have, so writers that do not care leave them at (0, 0) and 1; then a lens
// that the attributes spell out in millimetres is believed instead.
std::optional<View> from_standard(Finder f, const Film& film) {
  const auto camera = f.numbers("worldToCamera", 16);
  const auto ndc = f.numbers("worldToNDC", 16);
  if (!camera && !ndc) return {};
  ScreenWindow window;
  std::string note;
  if (!ndc) {
    if (const auto centre = f.numbers("screenWindowCenter", 2)) {
      window.x = (*centre)[0];
      window.y = (*centre)[1];
    }
    if (const auto width = f.number("screenWindowWidth")) window.width = *width;
    if (window.x == 0 && window.y == 0 && window.width == 1) {
      note = "a window of width 1 at distance 1, the format's default: check it";
      if (f.has("focalLengthMM") && f.has("sensorWidthMM")) {
        window.width = *f.number("sensorWidthMM") / *f.number("focalLengthMM");
        note.clear();
      }
    }
  }
  View view = view_from_matrices(camera ? camera->data() : nullptr,
                                 ndc ? ndc->data() : nullptr, window, film, f.where());
  view.source = f.source(note);
  return view;
}

// A camera-to-world matrix for row vectors, translation in the last row, of a camera that
// looks along its -z with +y up.
glm::dmat4 from_rows(const std::vector<double>& m) {
  glm::dmat4 out;
  for (int i = 0; i < 4; ++i)
    out[i] = {m[4 * i], m[4 * i + 1], m[4 * i + 2], m[4 * i + 3]};
  return out;
}

// V-Ray. cameraTransform: camera to world, seen in files of Z-up scenes; that the camera
// looks along -z is [?] (as in its host packages). cameraFov [degrees]: horizontal [?].
// cameraAperture (width) and cameraFocalLength, both mm, where there is no cameraFov.
std::optional<View> from_vray(Finder f, const Film& film) {
  if (!f.has("cameraTransform")) return {};
  Pose pose;
  set_axes_from_rest(pose, from_rows(*f.numbers("cameraTransform", 16)), f.where());
  if (const auto fov = f.number("cameraFov")) {
    if (!(*fov > 0 && *fov < 180))
      throw Error(f.where(), "cameraFov is not between 0 and 180 degrees");
    set_lens(pose, 1, 2 * std::tan(0.5 * glm::radians(*fov)), film, f.where());
  } else {
    const auto aperture = f.number("cameraAperture");
    const auto focal = f.number("cameraFocalLength");
    if (!aperture || !focal) return {};
    set_lens(pose, *focal, *aperture, film, f.where());
  }
  View view = view_of(pose, film);
  view.source = f.source("V-Ray");
  return view;
}

// Unreal's Movie Render Queue: numbers as text. Position [cm] in a left-handed world, x
// forward, y right, z up; pitch up, yaw to the right, roll clockwise, in degrees. Field
// of view: unreal/camera/<pass>/fov, horizontal, in degrees [?], else focalLength and
// sensorWidth. Our world is right-handed: y changes its sign.
std::optional<View> from_unreal(Finder f, const Film& film) {
  const std::string base = "unreal/camera/";
  if (!f.has(base + "curPos/x") || !f.has(base + "curRot/yaw")) return {};
  const auto part = [&](const char* name) { return f.number(base + name).value_or(0); };
  Pose pose;
  pose.eye = {part("curPos/x"), -part("curPos/y"), part("curPos/z")};
  const double pitch = glm::radians(part("curRot/pitch"));
  const double yaw = glm::radians(part("curRot/yaw"));
  const double roll = glm::radians(part("curRot/roll"));
  const glm::dvec3 forward{std::cos(pitch) * std::cos(yaw),
                           -std::cos(pitch) * std::sin(yaw), std::sin(pitch)};
  const glm::dvec3 level{-std::sin(yaw), -std::cos(yaw), 0};  // right before the roll
  const glm::dvec3 upright = glm::cross(level, forward);
  set_axes(pose, std::cos(roll) * level - std::sin(roll) * upright,
           std::cos(roll) * upright + std::sin(roll) * level, forward, f.where());
  if (const auto fov = f.number_like(base, "/fov")) {
    if (!(*fov > 0 && *fov < 180))
      throw Error(f.where(), "unreal/camera fov is not between 0 and 180 degrees");
    set_lens(pose, 1, 2 * std::tan(0.5 * glm::radians(*fov)), film, f.where());
  } else {
    const auto focal = f.number_like(base, "/focallength");
    const auto sensor = f.number_like(base, "/sensorwidth");
    if (!focal || !sensor) return {};
    set_lens(pose, *focal, *sensor, film, f.where());
  }
  View view = view_of(pose, film);
  view.source = f.source("Unreal, in centimetres: [input] metres = 0.01; y turned over");
  return view;
}

// Redshift. rs/camera/transform: camera to world, its rows right, up, forward, position
// [?: scripts that rebuild the camera in a compositor agree on +z forward, not on the
// sign of x, so right is taken from the other two]. rs/camera/fov: horizontal [?],
// radians by the manual, degrees in files; rs/camera/orthoHeight: world units, for
// orthographic cameras. rs/camera/aperture is redundant beside fov, and its unit differs
// by host.
std::optional<View> from_redshift(Finder f, const Film& film) {
  if (!f.has("rs/camera/transform")) return {};
  const bool perspective = f.has("rs/camera/fov");
  if (!perspective && !f.has("rs/camera/orthoHeight")) return {};
  Pose pose;
  const glm::dmat4 m = from_rows(*f.numbers("rs/camera/transform", 16));
  const glm::dvec3 up(m[1]), forward(m[2]);
  set_axes(pose, glm::cross(forward, up), up, forward, f.where());
  pose.eye = glm::dvec3(m[3]);
  if (perspective) {
    double fov = *f.number("rs/camera/fov");
    if (fov > glm::pi<double>()) fov = glm::radians(fov);
    if (!(fov > 0 && fov < glm::pi<double>()))
      throw Error(f.where(), "rs/camera/fov is not between 0 and 180 degrees");
    set_lens(pose, 1, 2 * std::tan(0.5 * fov), film, f.where());
  } else {
    pose.projection = Projection::orthographic;
    set_lens(pose, 1, *f.number("rs/camera/orthoHeight") * film.aspect(), film,
             f.where());
  }
  View view = view_of(pose, film);
  view.source = f.source("Redshift");
  return view;
}

}  // namespace

std::optional<View> view_from_attributes(const ImageHeader& header, const Film& film,
                                         const std::string& where) {
  const Finder f(header, where);
  for (const auto known : {from_standard, from_vray, from_unreal, from_redshift})
    if (auto view = known(f, film)) return view;
  return {};
}

}  // namespace brume
