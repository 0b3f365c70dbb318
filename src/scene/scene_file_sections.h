#pragma once
// The sections of a scene file: each key once, with unit, range and what it means.

#include <limits>
#include <string>
#include <vector>

#include "params/describe.h"
#include "scene/color_space.h"

namespace brume {

/// The newest `version` that this library knows.
inline constexpr int kSceneVersion = 1;

/// The keys above all sections.
struct TopSection {
  int version = kSceneVersion;
  double tolerance = 1e-3;
  std::string colorspace = "frame";
  template <class V>
  void describe(V& v) {
    v("version", version,
      {.doc = "Version of the scene file; keeps its look when defaults change.",
       .minimum = 1,
       .maximum = kSceneVersion,
       .animatable = false});
    v("tolerance", tolerance,
      {.doc = "Largest numerical error of a pixel, relative to white + its own value.",
       .minimum = 1e-9,
       .maximum = 1,
       .animatable = false});
    v("colorspace", colorspace,
      {.doc = "What the scene's colours are in: the frame's own primaries, linear, or a "
              "space of that name; all linear but srgb.",
       .words = color_space_names(),
       .animatable = false});
  }
};

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
  void describe(V& v) {
    const auto name = [&](const char* key, std::string& member, const char* doc) {
      v(key, member, {.doc = doc, .animatable = false});
    };
    name("color", color, "Layer of the colour (file:layer); empty for R, G, B.");
    name("depth", depth, "Channel of the depth (file:channel); empty: found by name.");
    name("alpha", alpha, "Channel of the coverage (file:channel); empty for A.");
    name("position", position,
         "Layer of world positions (file:layer), used instead of a depth.");
    name("normal", normal, "Layer of world normals (file:layer).");
    name("albedo", albedo, "Layer of the surface colour without light (file:layer).");
    v("depth_kind", depth_kind,
      {.doc = "What the depth means: planar along the view axis, distance from the eye, "
              "1 / planar, or 0 to 1 between depth_near and depth_far.",
       .words = {"planar", "distance", "inverse", "normalised"},
       .animatable = false});
    v("depth_near", depth_near,
      {.unit = "m", .doc = "Where a normalised depth begins.", .minimum = 0});
    v("depth_far", depth_far,
      {.unit = "m", .doc = "Where a normalised depth ends.", .minimum = 0});
    v("depth_white_near", depth_white_near,
      {.doc = "A normalised depth is white near the eye.", .animatable = false});
    v("metres", metres,
      {.unit = "m",
       .doc = "Length of one scene unit.",
       .minimum = 1e-9,
       .maximum = 1e12,
       .animatable = false});
    v("up", up,
      {.doc = "The world axis that points up.",
       .words = {"x", "y", "z"},
       .animatable = false});
    v("background_from", background_from,
      {.doc = "Depths of at least this, as the file has them, are background (as are <= "
              "0, inf and NaN).",
       .minimum = 0,
       .animatable = false,
       .infinite = true});
    v("background", background,
      {.doc = "What the pixels at infinity show: nothing, or a real sky (plate).",
       .words = {"empty", "plate"},
       .animatable = false});
    v("background_distance", background_distance,
      {.unit = "m", .doc = "Where a plate's background lies.", .minimum = 0});
    v("part", part,
      {.doc = "Part of a multi-part file, from 0.", .minimum = 0, .animatable = false});
    name("view", view, "View of a stereo file (left, right); empty for the first.");
  }
};

/// [camera]: only where the file carries none (or to replace it). Keyframes allowed.
/// Where the camera looks is said once: by `look_at` or by `rotation`, never both;
/// `rotation` holds where its setting is not a default.
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
  void describe(V& v) {
    v("file", file,
      {.doc = "A camera from a file instead: .chan or .json.", .animatable = false});
    v("projection", projection,
      {.doc = "How the camera projects.",
       .words = {"perspective", "orthographic", "latlong"},
       .animatable = false});
    v("position", position, {.unit = "m", .doc = "The eye, in the world."});
    v("look_at", look_at, {.unit = "m", .doc = "The world point in the middle."});
    v("rotation", rotation,
      {.unit = "degrees",
       .doc = "Rotation about the world axes instead of look_at; 0, 0, 0 looks along -Z "
              "with +Y up."});
    v("rotation_order", rotation_order,
      {.doc = "Which axis the camera turns about first.",
       .words = {"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"},
       .animatable = false});
    v("focal", focal,
      {.unit = "mm", .doc = "Focal length.", .minimum = 1e-3, .maximum = 1e6});
    v("roll", roll,
      {.unit = "degrees", .doc = "Turn about the view axis, clockwise picture."});
    v("aperture_width", aperture_width,
      {.unit = "mm",
       .doc = "Width of the film behind the display window.",
       .minimum = 1e-3,
       .maximum = 1e6});
    v("aperture_height", aperture_height,
      {.unit = "mm",
       .doc = "Its height; 0: from the frame's aspect.",
       .minimum = 0,
       .maximum = 1e6});
    v("ortho_width", ortho_width,
      {.unit = "m",
       .doc = "Width of an orthographic view.",
       .minimum = 1e-6,
       .maximum = 1e12});
    v("window", window,
      {.doc = "Shift of the film in x and y, in half apertures, and its scale."});
  }
};

struct SunSection {
  double elevation = 45,
         azimuth = 180;  // degrees; azimuth clockwise from north (+Y), +X east
  std::string time;      // ISO 8601 with zone; with latitude and longitude, replaces
                         // elevation and azimuth
  double hours = 0;      // after `time`
  double latitude = 0, longitude = 0;  // degrees, north and east positive
  Rgb irradiance{0, 0,
                 0};  // scene units on a plane facing the sun at the eye; 0: not scaled
  template <class V>
  void describe(V& v) {
    v("elevation", elevation,
      {.unit = "degrees",
       .doc = "Height of the sun above the horizon.",
       .minimum = -90,
       .maximum = 90});
    v("azimuth", azimuth,
      {.unit = "degrees",
       .doc = "Where it stands, clockwise from north (+Y), +X is east.",
       .minimum = -3600,
       .maximum = 3600});
    v("time", time,
      {.doc = "Date and time with zone (2024-06-21T18:30:00+02:00); with latitude and "
              "longitude in place of elevation and azimuth."});
    v("hours", hours,
      {.unit = "h",
       .doc = "Added to the time; keyframes let a day pass.",
       .minimum = -1e6,
       .maximum = 1e6});
    v("latitude", latitude,
      {.unit = "degrees",
       .doc = "Of the place, north positive.",
       .minimum = -90,
       .maximum = 90});
    v("longitude", longitude,
      {.unit = "degrees",
       .doc = "Of the place, east positive.",
       .minimum = -360,
       .maximum = 360});
    v("irradiance", irradiance,
      {.doc = "What the sun gives to a plane facing it at the eye, in scene units; 0: as "
              "the sky computes it.",
       .minimum = 0});
  }
};

struct TimeSection {
  double fps = 0;     // 0: the file's framesPerSecond, else 24
  double origin = 0;  // the frame at which time is 0
  template <class V>
  void describe(V& v) {
    v("fps", fps,
      {.unit = "1/s",
       .doc = "Frames per second; 0: as the file says, else 24.",
       .minimum = 0,
       .maximum = 1e6,
       .animatable = false});
    v("origin", origin,
      {.doc = "The frame at which time is 0.",
       .minimum = -1e9,
       .maximum = 1e9,
       .animatable = false});
  }
};

struct OutputSection {
  std::vector<std::string> aovs;   // "T", "L", "height_fog.L"
  std::string alpha = "over";      // over | keep
  double white = 1;                // the white of the tolerance
  std::string compression;         // "" keeps the source's
  double dwa_level = 0;            // 0 keeps the source's
  std::string aov_type = "float";  // float | half
  template <class V>
  void describe(V& v) {
    v("aovs", aovs,
      {.doc =
           "Layers to add: T, L, a stage's share such as height_fog.L, S (the surfaces), "
           "what a stage of surface or lens adds such as relight.",
       .animatable = false});
    v("alpha", alpha,
      {.doc = "The air covers what is behind it (over), or alpha stays (keep).",
       .words = {"over", "keep"},
       .animatable = false});
    v("white", white,
      {.doc = "The white that `tolerance` is relative to.",
       .minimum = 1e-6,
       .maximum = 1e12,
       .animatable = false});
    v("compression", compression,
      {.doc = "Compression of the output; empty keeps the source's.",
       .words = {"", "none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa",
                 "dwab"},
       .animatable = false});
    v("dwa_level", dwa_level,
      {.doc = "Level of DWA compression; 0 keeps the source's.",
       .minimum = 0,
       .maximum = 1e5,
       .animatable = false});
    v("aov_type", aov_type,
      {.doc = "Type of the added layers; half near 1 steps 5e-4.",
       .words = {"float", "half"},
       .animatable = false});
  }
};

/// The keys that every [[stage]] has beside its own parameters.
struct StageCommon {
  std::string name;
  bool enabled = true;
  std::string mask;
  double mix = 1;
  std::vector<double> frames{-std::numeric_limits<double>::infinity(),
                             std::numeric_limits<double>::infinity()};
  template <class V>
  void describe(V& v) {
    v("name", name,
      {.doc = "What the stage is called; its type unless given, and unique.",
       .animatable = false});
    v("enabled", enabled, {.doc = "false leaves the stage out.", .animatable = false});
    v("mask", mask,
      {.doc = "Channel (file:channel) that scales the stage per pixel.",
       .animatable = false});
    v("mix", mix,
      {.doc = "How much of the stage: 0 none, 1 all.", .minimum = 0, .maximum = 1});
    v("frames", frames,
      {.doc = "First and last frame at which the stage acts.", .animatable = false});
  }
};

}  // namespace brume
