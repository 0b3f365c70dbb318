#pragma once
// The fast way from a scene and pixels to pixels with air. No file in sight: a
// compositing node sits on this header; the command line's frames (pipeline/frame_file.h)
// go through the same calls.
//
//   Session session(read_scene(...), registry);             // once per sequence: scene,
//   plugins, shared tables PreparedFrame frame = session.prepare(source);          //
//   once per frame: plan made, stages prepared, World compiled frame.apply(buffers,
//   window);                           // any windows, any order, any threads

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "image/image.h"
#include "plugin.h"
#include "scene/scene_file.h"
#include "scene/view.h"

namespace brume {

class Registry;

/// What a frame brings before its pixels are read.
struct FrameSource {
  double frame = 0;
  ImageHeader header;  ///< windows, channel names, attributes (camera, chromaticities,
                       ///< framesPerSecond)
  std::string name;    ///< for messages: the file, or the node's clip
  std::optional<View> view;         ///< given by a host; else found from scene and header
  double scale_x = 1, scale_y = 1;  ///< render scale (proxy): pixel coordinates of the
                                    ///< buffers = full ones x scale

  /// A tolerance that cannot be reached is no error: the best is taken.
  bool best_effort = false;

  /// Headers of further files that the scene names ("depth.####.exr:Z"), resolved by the
  /// caller: key is the file's pattern.
  std::function<const ImageHeader*(const std::string& file)> other_header;
};

/// One channel the frame must be given, and what for.
struct InputChannel {
  std::string file;     ///< pattern of another file; "" = the frame's own
  std::string channel;  ///< full name there
  std::string purpose;  ///< "colour red", "depth", "mask of height_fog"
};

/// One channel the frame writes: a colour channel changed, or a new one (AOV).
struct OutputChannel {
  Channel channel;
  bool changed = false;  ///< it replaces the input channel of that name
};

/// What the plan says of one stage.
struct StagePlan {
  std::string name, type;
  brume_role role = BRUME_AIR;
  bool runs = false;
  std::string reason;                ///< why it is left out, or how it runs
  std::vector<std::string> reads;    ///< channels
  double nearest = 0, farthest = 0;  ///< [m]
  Window screen;                     ///< where it can matter (display pixels)
};

/// How an accuracy knob is set at a frame, or what a stage promises that has none.
struct KnobPlan {
  std::string name;  ///< "sky.harmonics"; "air" for the integrator's tolerance; a stage
  double value = 0;
  double promised = 0;  ///< |dC| <= promised (white + |C|), from the stage's curve
  bool given = false;   ///< by the scene; else from `tolerance`
  bool none = false;    ///< there is no knob: the stage's own promise (brume_needs)
};

/// Everything decided before a pixel is touched; `brume plan` prints it.
struct Plan {
  double frame = 0;
  std::vector<StagePlan> stages;
  std::vector<std::string> decisions;  ///< "depth: channel Z (planar, metres x 1): named
                                       ///< Z", "camera: worldToCamera of shot.exr" ...
  std::vector<std::string> air;        ///< how each medium is integrated
  std::vector<KnobPlan> knobs;
  double tolerance = 0, promised = 0;  ///< asked for, and what the knobs add up to
  std::vector<std::string> channels_read, channels_written,
      channels_left;                      ///< left: never decoded
  std::vector<std::string> lossy_layers;  ///< of those added, what the compression of an
                                          ///< EXR would change
  bool changes_nothing = false;
  bool whole_frame = false;
  Window active;  ///< outside it no pixel changes (display pixels)
};

/// A caller's plane: the sample of pixel (x, y) of `FrameBuffers::window` lies at data[(x
/// - window.x) pixel_stride + row(y) row_stride].
struct PlaneIn {
  const float* data = nullptr;
  std::ptrdiff_t pixel_stride = 1, row_stride = 0;  ///< in floats; may be negative
};
struct PlaneOut {
  float* data = nullptr;
  std::ptrdiff_t pixel_stride = 1, row_stride = 0;
};

/// A frame's pixels in the caller's memory. Inputs in the order of
/// PreparedFrame::inputs(), outputs in that of outputs(). An output may be the very
/// memory of the input it replaces when the window rendered is the whole, or when no
/// stage looks around.
struct FrameBuffers {
  Window window;             ///< the pixels the input planes hold (scaled display pixels)
  bool bottom_left = false;  ///< rows of the planes count upward (row 0 is the lowest)
  std::span<const PlaneIn> in;
  std::span<const PlaneOut>
      out;  ///< hold the rendered window only: their row 0, column 0 is its corner
};

struct ApplyCounts {
  std::uint64_t pixels = 0, touched = 0;
};

class PreparedFrame {
 public:
  PreparedFrame(PreparedFrame&&) noexcept;
  PreparedFrame& operator=(PreparedFrame&&) noexcept;
  ~PreparedFrame();

  const Plan& plan() const;
  std::span<const InputChannel> inputs() const;
  std::span<const OutputChannel> outputs() const;

  /// How many pixels around a window must be in the buffers for its pixels to come out as
  /// those of the whole frame do (at the frame's edges there are none). -1: the whole
  /// frame (a lens stage runs).
  int around() const;

  /// Applies the scene to `render` (inside buffers.window). Pixels do not depend on how a
  /// frame is cut, on threads, or on strides. Thread-safe. Throws Error when a stage
  /// fails.
  ApplyCounts apply(const FrameBuffers& buffers, const Window& render) const;

  struct Impl;
  explicit PreparedFrame(std::unique_ptr<Impl>);
  const Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

class Session {
 public:
  Session(SceneFile scene, Registry& registry);
  ~Session();

  const SceneFile& scene() const;
  Registry& registry() const;

  /// Plans and prepares one frame: resolves channels and camera, asks every stage for its
  /// needs, leaves out what is idle, publishes the World, compiles the air. Thread-safe.
  /// Throws Error: no depth, no camera where a stage needs the world, a failing stage ...
  PreparedFrame prepare(const FrameSource&) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace brume
