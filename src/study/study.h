#pragma once
// Error against run time, on a user's own frame: what `brume study` measures.
//
// For the air of each stage alone and of the whole scene, every way to compute it (ours
// along its knobs, the stage's source document, even steps, painting one medium over the
// other) is timed on the frame's rays and held against the truth on a sample of them.
// For a surface or lens stage likewise, on the pixels that it is given: ours, its
// source's, windows of its own pattern, against the stage's own truth.

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "picture/picture.h"
#include "scene/scene_file.h"
#include "study/measure.h"

namespace brume {
class Registry;
}

namespace brume::study {

struct Options {
  double frame = 0;
  double seconds = 40;  ///< about so long it may take; more rays go to the truth
  int pixels = 4096;    ///< at most so many of an even grid are held against the truth
  int repeats = 9;      ///< of each timing
  bool baselines = true, pictures = true;
  std::function<void(const std::string&)> progress;
};

/// One setting of a method.
struct Point {
  std::string setting;           ///< "tolerance 0.001", "32 steps"
  std::vector<std::string> set;  ///< arguments of --set that make it (ours)
  double once = 0;               ///< tables for a whole sequence [s]
  double frame = 0;              ///< for each frame, whatever its pixels [s]
  Spread per_pixel;              ///< [s]
  double seconds = 0;            ///< of the frame: frame + pixels x median [s]
  ErrorOf color, T, L;
  int x = 0, y = 0;        ///< where the colour is farthest off
  std::vector<float> map;  ///< error of the colour on the subject's grid

  Cost cost() const { return {seconds, color.max}; }
};

enum class MethodKind { ours, source, marching, painting };
const char* name(MethodKind);

struct Method {
  MethodKind kind = MethodKind::ours;
  std::string name;
  std::vector<Point> points;
};

/// What is studied: the media of one stage in the light of the scene, or all of them.
struct Subject {
  std::string name;       ///< of the stage, or "scene"
  bool whole = false;     ///< the last of a study
  std::string reference;  ///< what is right here, in words
  double reference_error = 0;
  std::size_t rays = 0;  ///< held against it: the grid's and those found to be worst
  int grid_width = 0, grid_height = 0;
  std::vector<Method> methods;
  std::vector<std::string> notes;
};

struct Study {
  std::string scene, in, version, machine, isa, date;
  int width = 0, height = 0, cores = 0;
  double tolerance = 0, white = 1;
  double seconds = 0;  ///< that the study took
  int repeats = 0;
  std::vector<Subject> subjects;
  std::vector<std::string> notes;  ///< stages that are not studied, and why
  Picture before, after;

  const Subject& whole() const { return subjects.back(); }
};

/// Throws Error as apply_frame does, and where no stage does anything that can be
/// studied.
Study run(const SceneFile&, Registry&, const std::filesystem::path& in, const Options&);

}  // namespace brume::study
