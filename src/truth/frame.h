#pragma once
// A picture by the truth: DESIGN "Exact meanings", pixel by pixel, in double.

#include <filesystem>
#include <memory>
#include <vector>

#include "pipeline/frame_file.h"
#include "truth/truth.h"

namespace brume::truth {

/// One pixel. L is what the layer L holds: a L_d + (1 - a)(L_inf + T_inf B); T = T_d.
struct Pixel {
  double distance = 0;  ///< of its sample [m]; inf: none
  double coverage = 1;
  Rgb S{}, T{1, 1, 1}, L{}, C{};
  double alpha = 1;
  /// How far from converged it may be. Of S: what the last bits of the floats decide that
  /// a surface stage is given (surface.h); C_error has its part of all.
  Rgb C_error{}, T_error{}, L_error{}, S_error{};
  bool converged = true;
  /// The last bits of what surface stages are given decide more than a quarter of
  /// |dC| <= tolerance (white + |C|): no truth can hold them to it here.
  bool undecided(double tolerance, double white) const;
  std::vector<Rgb> stage_T, stage_L;  ///< by running stage, where asked for
  std::vector<Rgb> added;  ///< by surface stage: to the colour, after mask and mix
};

/// What `pixel` is asked for.
struct PixelOptions {
  double tolerance = 1e-5, white = 1;  ///< of the march (Options)
  /// Of each ray (Options): 64 x 36 pixels take seconds of two cores.
  long evaluations = 1'000'000;
  double enough = 0;  ///< Options
  long ways = 8'000;
  bool stages = false;  ///< shares of single stages too
};

/// A frame in memory, ready to be asked. Taken from the pipeline: which channels are
/// read, the camera, and what stages publish. All else is worked out anew: distances,
/// coverage, weights, what surface stages make of the colour (their own truths; of those
/// that have none what they do), the air, how it is laid over the samples.
class Frame {
 public:
  /// Reads the frame. Throws Error as apply_frame does, and for lens stages: they mix
  /// pixels and are no part of the air.
  Frame(const Session&, double frame, const std::filesystem::path& in);
  ~Frame();
  Frame(Frame&&) noexcept;

  const PreparedFrame& prepared() const;
  const ImageReader& source() const;
  /// The pixels there are: the data window.
  Window window() const;

  /// Thread-safe.
  Pixel pixel(int x, int y, const PixelOptions&) const;

  /// Its sample's distance alone, inf for none; inside the window.
  double distance(int x, int y) const;
  double coverage(int x, int y) const;
  /// Vertical component of the pixel's ray: 0 at the horizon.
  double climb(int x, int y) const;

  /// Surface stages that are taken at their word, as they have no truth.
  std::vector<std::string> unproven() const;

  /// What the product makes of the same frame: a plane of window() per
  /// prepared().outputs(), before it becomes half.
  std::vector<std::vector<float>> product() const;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

/// How a frame came out.
struct Rendered {
  /// Largest of a pixel's colour, relative to white + |C|; of those that are decided.
  double error = 0;
  std::size_t unconverged = 0;  ///< pixels that did not converge within the evaluations
  std::size_t undecided = 0;    ///< Pixel::undecided at the scene's tolerance
  std::vector<std::string> unproven;  ///< Frame::unproven
};

/// Renders the frame by the truth into `out`, a copy of `in` as apply_frame makes it, on
/// all cores.
Rendered apply_frame(const Session&, double frame, const std::filesystem::path& in,
                     const std::filesystem::path& out, const ApplyOptions&,
                     const PixelOptions&);

}  // namespace brume::truth
