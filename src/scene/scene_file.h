#pragma once
// The scene file: what to do to a frame. TOML, no programming. Sections declare their
// keys like stages do (params.h).

#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "params/describe.h"
#include "params/params.h"

namespace brume {

/// [input]: where the frame's channels come from. Every name is "channel" or
/// "file:channel", the file with its own frame pattern. Empty: found from the file
/// (EXR_CONVENTIONS order), and `brume plan` says what was taken.
struct InputSection {
  std::string color, depth, alpha, position, normal,
      albedo;  // color: layer name ("" = R,G,B), others: one channel or layer
  std::string depth_kind = "planar";     // planar | distance | inverse | normalised
  double depth_near = 0, depth_far = 0;  // metres, for normalised
  bool depth_white_near = false;
  double metres = 1;
  std::string up = "z";  // x | y | z
  double background_from =
      1e9;  // depths of at least this are background, as are <= 0, inf and NaN
  std::string background = "empty";  // empty | plate
  double background_distance = std::numeric_limits<double>::infinity();
  int part = 0;
  std::string view;
  template <class V>
  void describe(V& v);
};

/// [camera]: only where the file carries none (or to replace it). Keyframes allowed.
struct CameraSection {
  std::string file;                        // "cam.chan" or "cam.json"
  std::string projection = "perspective";  // perspective | orthographic | latlong
  Vec3 position{0, 0, 0}, look_at{0, 1, 0},
      rotation{0, 0, 0};  // rotation: Euler degrees, order as `rotation_order`
  std::string rotation_order = "xyz";
  double focal = 35, roll = 0;  // mm, degrees
  double aperture_width = 36,
         aperture_height = 0;  // mm; height 0: from the frame's aspect
  double ortho_width = 10;     // metres
  Vec3 window{0, 0, 1};        // x offset, y offset (of half apertures), scale
  template <class V>
  void describe(V& v);
};

struct SunSection {
  double elevation = 45,
         azimuth = 180;  // degrees; azimuth clockwise from north (+Y), +X east
  std::string time;      // ISO 8601 with zone; with latitude and longitude, replaces
                         // elevation and azimuth
  double latitude = 0, longitude = 0;  // degrees, north and east positive
  Rgb irradiance{0, 0,
                 0};  // scene units on a plane facing the sun at the eye; 0: not scaled
  template <class V>
  void describe(V& v);
};

struct TimeSection {
  double fps = 0;     // 0: the file's framesPerSecond, else 24
  double origin = 0;  // the frame at which time is 0
  template <class V>
  void describe(V& v);
};

struct OutputSection {
  std::vector<std::string> aovs;   // "T", "L", "height_fog.L"
  std::string alpha = "over";      // over | keep
  double white = 1;                // the white of the tolerance
  std::string compression;         // "" keeps the source's
  double dwa_level = 0;            // 0 keeps the source's
  std::string aov_type = "float";  // float | half
  template <class V>
  void describe(V& v);
};

/// One [[stage]]: common keys and the stage's own parameters.
struct StageEntry {
  std::string type, name;  // name: type unless given; unique
  bool enabled = true;
  std::string mask;  // channel or file:channel, "" none
  Setting mix;       // 0..1, 1
  double first_frame = -std::numeric_limits<double>::infinity();
  double last_frame = std::numeric_limits<double>::infinity();
  Settings params;
  Location where;
};

struct SceneFile {
  std::filesystem::path path;  // "" for a scene made in memory
  int version = 1;
  double tolerance = 1e-3;
  Settings input, camera, sun, time, output;  // specs of the sections above
  bool has_camera = false, has_sun = false;   // the section stands in the file
  std::vector<StageEntry> stages;             // in file order

  template <class Section>
  static Section section(const Settings& s, double frame) {
    Section out;
    const auto values = s.at(frame);
    assign(out, std::span<const Value>(values));
    return out;
  }
};

/// How the parser asks what parameters a stage type has; throws Error (unknown stage,
/// with the nearest name).
using StageSpecs =
    std::function<std::vector<ParamSpec>(const std::string& type, const Location&)>;

/// Reads a scene. Unknown keys, wrong kinds, values out of range: Error
/// "valley.toml:12:9: height_fog.density = -3; allowed 0 to 10 per m".
SceneFile read_scene(const std::filesystem::path&, const StageSpecs&);
SceneFile parse_scene(std::string_view toml, const std::string& source_name,
                      const StageSpecs&);

/// "name.param=value", "sun.elevation=3", "tolerance=1e-4": from the command line.
void set(SceneFile&, std::string_view assignment, const StageSpecs&);

/// The resolved scene as TOML (defaults spelled out): parses back to the same. What goes
/// into `brume/scene`.
std::string print(const SceneFile&);

}  // namespace brume
