#pragma once
// The camera: where each pixel's ray starts and where it goes. Transforms are double
// (GLM); what reaches the pixels is float, relative to the eye, so that a planet-sized
// world costs no precision.

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "image/image.h"
#include "scene/scene_file.h"

namespace brume {

enum class Projection { perspective, orthographic, latlong };  // as brume_projection

/// A camera looking at one frame. World is right-handed, metres. Pixel coordinates are
/// those of the image, in which display and data windows lie (continuous, pixel (i, j)
/// has its centre at (i + .5, j + .5)), so that any sub-window, tile or overscan sees the
/// same rays.
///
/// perspective: the world point of (x, y) at planar depth Z is eye + Z (corner + x across
/// + y down): one multiply-add per pixel along a row (SOURCES W1). orthographic: origin
/// eye + corner + x across + y down, direction `forward`, planar depth along it. latlong:
/// a ray's longitude is corner.x + x across.x turns, from `forward` towards `right`, its
/// elevation corner.y + y down.y turns towards `up`; depth is distance.
struct View {
  Projection projection = Projection::perspective;
  glm::dvec3 eye{0};
  glm::dvec3 corner{0};           ///< at the pixel coordinates (0, 0)
  glm::dvec3 across{0}, down{0};  ///< per pixel to the right, per pixel down
  glm::dvec3 right{1, 0, 0}, up{0, 0, 1},
      forward{0, 1, 0};  ///< orthonormal camera axes in the world
  Window display;        ///< the display window
  std::string source;    ///< where it came from, for `brume plan`: "worldToCamera,
                         ///< worldToNDC of shot.exr"

  /// Unit direction, and the planar depth of a point at distance 1 along it, for
  /// continuous pixel coordinates. Double; the slow, plain way.
  struct RayAt {
    glm::dvec3 origin, direction;
    double planar_per_distance;
  };
  RayAt ray(double x, double y) const;

  /// Side of the square pixel of equal area at the middle of the frame: angle between
  /// neighbouring rays [rad] (perspective, latlong) or distance [m] (orthographic).
  double pixel_footprint() const;

  /// The view of a proxy or render scale: pixel coordinates shrink by `scale` (0.25 for
  /// --proxy 4). The display window becomes the smallest that holds the shrunk one.
  View scaled(double scale_x, double scale_y) const;
};

/// The world's up direction, from `[input] up`.
glm::dvec3 world_up(const InputSection&);

/// The rays of a run of pixels of one row, ready for kernels: n = count, floats, relative
/// to the eye. ox, oy, oz: origin - eye [m] (all zero but for orthographic); dx, dy, dz:
/// unit direction; per_planar: distance along the ray per unit of planar depth (1 for
/// latlong).
struct RaySpan {
  float *ox, *oy, *oz, *dx, *dy, *dz, *per_planar;
};
/// Fills rays of pixels (x..x+n-1, y) (image coordinates, integers; centres are added
/// here). SIMD, run-time ISA; a pixel's bits do not depend on where a run starts or ends.
/// n may be anything; writes exactly n values. Returns whether origins are all zero.
/// Error against double, per component, for pixels within 2^22 of the frame's middle
/// (tests/scene/view_test.cpp): directions 2e-7, of a latlong 6e-7; per_planar 2e-7
/// relative; origins 2e-7 of the window's size.
bool fill_rays(const View&, int x, int y, int n, const RaySpan&) noexcept;

/// Finds the camera of a frame: [camera] of the scene if present (its .chan / .json file,
/// or its keys), else the file's worldToCamera + worldToNDC, else a renderer's attributes
/// (EXR_CONVENTIONS). Empty when there is none: brume never guesses. Throws Error for one
/// that is present but broken (singular, non-finite, zero focal length).
std::optional<View> find_view(const ImageHeader&, const SceneFile&, double frame,
                              const std::string& where);

// ---- depth
// ---------------------------------------------------------------------------------------
enum class DepthKind { planar, distance, inverse, normalised };

/// How depth values become distances along the ray [m].
struct DepthRule {
  DepthKind kind = DepthKind::planar;
  double metres = 1;         ///< metres per unit
  double near = 0, far = 0;  ///< normalised [m]
  bool white_near = false;
  double background_from = 1e9;  ///< in the channel's own units (kind planar, distance);
                                 ///< normalised: the far end is background
};
DepthRule depth_rule(const InputSection&);

/// distance[i] = distance along the ray [m], +inf where the depth means background (<= 0,
/// >= background_from, inf, NaN). SIMD; in place allowed.
void distances_from_depth(const DepthRule&, int n, const float* depth,
                          const float* per_planar, float* distance) noexcept;

/// The same from a position pass: world positions [scene units], `metres` per unit;
/// background where `alpha` (may be null) is not > 0, where the position is non-finite or
/// exactly (0,0,0), which is what renderers write where their one sample met nothing.
/// Distance is the projection of P - origin on the ray, never negative. P - eye is formed
/// without cancellation: a world far from its origin costs no more than the pass's own
/// floats do.
void distances_from_position(const View&, double metres, int n, const float* px,
                             const float* py, const float* pz, const float* alpha,
                             const RaySpan&, float* distance) noexcept;

/// The channel taken for depth, in EXR_CONVENTIONS order: index into header.channels and
/// why; -1 when none.
struct DepthChoice {
  int channel = -1;
  std::string why;
};
DepthChoice find_depth(const ImageHeader&);

}  // namespace brume
