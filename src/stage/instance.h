#pragma once
// A stage at one frame: made from its parameters' values, asked, and destroyed with it.
// Every call into a plugin goes through here; whatever happens in it comes back as a
// value or as an Error that names scene place, stage and file.
//
// What is guaranteed of a plugin that misbehaves: a failing status with or without a
// message, a message of any length or encoding, two messages, a status that is none, a
// C++ exception (from code built with unwind tables, which g++ and clang do), an answer
// that makes no sense: Error, and nothing of what it published is in the World. What a
// plugin does to memory, or a signal it raises, cannot be undone in the same process;
// files are written beside and renamed, so that even then no half-written frame has its
// name.

#include <array>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "image/image.h"
#include "params/params.h"
#include "plugin.h"
#include "scene/scene_file.h"
#include "scene/view.h"
#include "scene/world.h"
#include "stage/cache.h"
#include "stage/module.h"
#include "stage/needs.h"

namespace brume {

/// What the host knows of a frame, as stages are told it.
struct FrameInfo {
  double frame = 0, time = 0,
         fps = 24;  ///< number; seconds since [time] origin; per second
  bool has_camera = false;
  glm::dvec3 eye{0}, up{0, 0, 1}, forward{0, 1, 0};  ///< world; up is the world's
  double pixel_footprint = 0;                        ///< View::pixel_footprint()
  Projection projection = Projection::perspective;   ///< orthographic: that is a distance
  glm::dvec3 corner{0}, across{0}, down{0};          ///< as View's; 0: not known
  glm::dvec3 camera_right{1, 0, 0}, camera_up{0, 0, 1};
  /// All that a stage is told of the camera.
  void look(const View&);
  bool orthographic() const { return projection == Projection::orthographic; }
  Window display;
  double tolerance = 1e-3, white = 1;
  Chromaticities chromaticities = kRec709;  ///< kRec709 when the file has none
  struct Sun {
    glm::dvec3 to{0, 0, 1}, irradiance{0};
  };
  std::optional<Sun> sun;
  std::vector<std::string> channels;  ///< of the frame's own file
  double mix = 1;                     ///< of the stage that is told
};

/// One stage at one frame. `type` and `cache` must outlive it; what it published holds
/// pointers into it, so a World and an Air must not outlive it either.
class StageInstance {
 public:
  /// Creates it with values in the order of type.specs, checked already. `name` is the
  /// stage's own ("fog2"), `where` stands in errors. Throws Error.
  StageInstance(const StageType& type, std::string name, std::span<const Value> values,
                StageCache& cache, Location where = {});

  const StageType& type() const { return *type_; }
  const std::string& name() const { return name_; }

  /// Asked before publish and run, from one thread. Throws Error.
  StageNeeds needs(const FrameInfo&);

  /// Adds what the stage publishes to `world`, marked as stage number `stage`, with the
  /// stage's name before the medium's own ("sky", "sky/haze"). World gets everything or,
  /// when it throws, nothing. From one thread. Throws Error: the plugin's own, or for
  /// what makes no sense ("extinction 0 is nan").
  void publish(const FrameInfo&, int stage, World& world);

  /// Changes the pixels of a tile (surface and lens). Thread-safe. Throws Error; the tile
  /// may then be changed in part.
  void run(const brume_tile&) const;

  /// What run must make of pixels (xy[0], xy[1]), ... of the tile, by another way:
  /// three numbers a pixel. type().table.truth must be there. Thread-safe. Throws Error.
  void truth(const brume_tile&, std::span<const int> xy, double* rgb) const;

  /// run as its source document has it (table.baseline_run must be there). Thread-safe.
  /// Throws Error where that has no answer.
  void run_baseline(const brume_tile&) const;

  /// The stage's air alone over [0, t1[i]] of each ray as its source document has it
  /// (type().baseline names it, table.baseline must be there), after publish.
  /// Thread-safe. Throws Error where that has no answer.
  void baseline(const brume_rays&, const float* t1, float* const L[3],
                float* const T[3]) const;

 private:
  template <class F>
  void call(const char* function, F&&) const;

  const StageType* type_;
  std::string name_;
  StageCache* cache_;
  Location where_;
  // A stage may have no state: null is a valid self, so unique_ptr alone does not do.
  struct Self {
    void* self = nullptr;
    void (*destroy)(void*) = nullptr;
    Self() = default;
    Self(Self&& o) noexcept : self(o.self), destroy(o.destroy) { o.destroy = nullptr; }
    Self& operator=(Self&& o) noexcept {
      std::swap(self, o.self);
      std::swap(destroy, o.destroy);
      return *this;
    }
    ~Self();
  } self_;
};

}  // namespace brume
