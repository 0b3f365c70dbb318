#pragma once
// How a View is made: from matrices, from a lens and a pose, from what a file says of its
// camera. Inside the folder only; callers use find_view (view.h).

#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scene/view.h"

namespace brume {

/// What the frame is: the pixels that a camera's window covers.
struct Film {
  Window display;
  double pixel_aspect = 1;  ///< width / height of a pixel
  /// Width / height of the picture as it is looked at.
  double aspect() const { return display.width * pixel_aspect / display.height; }
};
/// Throws Error for an empty display window or a pixel aspect that is not positive.
Film film_of(const ImageHeader&, const std::string& where);

/// A camera apart from any frame: where it stands, how it is turned, what it takes in.
/// Scene units; the axes are orthonormal.
struct Pose {
  Projection projection = Projection::perspective;
  glm::dvec3 eye{0}, right{1, 0, 0}, up{0, 0, 1}, forward{0, 1, 0};
  /// The window in the camera's plane, along right and up: at distance 1 (perspective) or
  /// in scene units (orthographic). Unused by latlong.
  double left = -0.5, bottom = -0.5, width = 1, height = 1;
};

/// The view of a pose over a film. Lat-long spans 360 x 180 degrees, `forward` in the
/// middle.
View view_of(const Pose&, const Film&);
/// The pose of a view (inverse of view_of for views with orthogonal rows and columns).
Pose pose_of(const View&, const Film&);

/// Axes from a matrix's 3 directions, made orthonormal: forward is kept, right is made
/// orthogonal to it, up to both. Throws Error{where} when they are not independent.
void set_axes(Pose&, const glm::dvec3& right, const glm::dvec3& up,
              const glm::dvec3& forward, const std::string& where);

/// The rest pose of cameras in most packages: it looks along -z, +y is up in the picture.
/// `world_from_camera` acts on column vectors.
void set_axes_from_rest(Pose&, const glm::dmat4& world_from_camera,
                        const std::string& where);

/// The window of a lens: `focal` and `aperture` of the picture's width in the same unit;
/// height by the film's aspect.
void set_lens(Pose&, double focal, double aperture_width, const Film&,
              const std::string& where);

/// Matrices for row vectors, as OpenEXR has them; 16 numbers row by row. One of the two
/// may be null. See camera_matrices.cpp for what is taken from which. `window` (centre x,
/// centre y, width at distance 1) is used where there is no world_to_ndc. Throws
/// Error{where} for singular or non-finite ones.
struct ScreenWindow {
  double x = 0, y = 0, width = 1;
};
View view_from_matrices(const double* world_to_camera, const double* world_to_ndc,
                        const ScreenWindow& window, const Film&,
                        const std::string& where);

/// The camera a file's attributes tell of, scene units; nothing when they tell of none.
/// Throws Error for one that is present but broken.
std::optional<View> view_from_attributes(const ImageHeader&, const Film&,
                                         const std::string& where);

/// The camera of [camera], metres: its keys, or its file (scene units times
/// `input.metres`).
View view_from_section(const SceneFile&, const InputSection& input, double frame,
                       const Film&);

/// A pose in a y-up world (.chan files), in the world with this up axis. East and north
/// stay what they are: see direction_to_sun (sun.h) for how they lie in each.
void turn_y_up_to(Pose&, const glm::dvec3& up);

/// Scene units to metres, for views that are not in metres yet.
void scale_world(View&, double metres);

/// The pose at a frame between two: eye and window linear, the turn by spherical
/// interpolation of quaternions, the shorter way.
Pose interpolate(const Pose& a, const Pose& b, double t);

/// A camera over frames, from a file.
struct CameraTrack {
  struct Key {
    double frame;
    Pose pose;
    /// Vertical extent known only: the window's width follows the film's aspect.
    bool width_from_film = false;
  };
  std::vector<Key> keys;   ///< ascending in frame
  bool any_frame = false;  ///< a single camera without a frame number
  bool y_up = false;       ///< the file's world is y up by its format (.chan)
  std::string source;      ///< "cam.chan"
  /// Throws Error for a frame outside the keys.
  Pose at(double frame, const Film&) const;
};
/// Reads "*.chan" or "*.json"; the last few are kept in memory until the file changes.
/// Throws Error naming file and place. Safe from any thread.
std::shared_ptr<const CameraTrack> load_camera_file(const std::filesystem::path&,
                                                    const Film&);
CameraTrack read_chan(const std::string& text, const std::string& where);
CameraTrack read_camera_json(const std::string& text, const Film&,
                             const std::string& where);

}  // namespace brume
