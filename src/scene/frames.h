#pragma once
// Sequences: which frames, and which file is a frame's. A path may hold tokens:
//   ####      the frame, padded with zeros to as many digits as there are #
//   %04d, %d  the same, as printf writes it (so "#" is %d and "####" is %04d)
//   %V, %v    the view of a stereo sequence: left, right; l, r
// A sign counts as a digit of the padding, as in printf: frame -5 of #### is -005. Any
// other % stands for itself.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "num/error.h"

namespace brume {

/// Most frames of one command, and the largest frame number either way.
inline constexpr int kMostFrames = 1'000'000;
inline constexpr int kLargestFrame = 999'999'999;

/// "1-100x2,200,-5--1" to frames: ascending, each once. Ranges include both ends; x2
/// takes every second, from the first. Throws Error (`where` stands before it) for
/// anything else, for ranges that run backwards and for more than kMostFrames frames.
std::vector<int> parse_frames(std::string_view text,
                              const std::string& where = "--frames");

/// Frames as the shortest such text: "1-100x2,200".
std::string frames_text(std::span<const int> ascending);

/// A path with tokens, or without any: then it is the one file.
class FramePattern {
 public:
  FramePattern() = default;
  /// Throws Error for a token that cannot be: a padding beyond 9, frame tokens of
  /// different widths, a NUL or more than 4096 bytes.
  explicit FramePattern(std::string_view path);

  const std::string& text() const { return text_; }
  bool has_frame() const { return has_frame_; }
  bool has_view() const { return has_view_; }

  /// The path of a frame. `view` replaces %V, its first letter %v. Throws Error when the
  /// pattern asks for a view and none is given, or one that cannot be part of a file
  /// name.
  std::filesystem::path path(int frame, std::string_view view = {}) const;

  /// The frame that a path written by path() carries; empty when the pattern did not
  /// write it.
  std::optional<int> frame_of(const std::filesystem::path&,
                              std::string_view view = {}) const;

  /// The frames whose files exist, ascending. Empty without a frame token. Throws Error
  /// when a folder cannot be read or holds more than kMostFrames matching files.
  std::vector<int> existing(std::string_view view = {}) const;

 private:
  struct Piece {
    enum class Is { text, frame, view, view_letter } is;
    std::string text;
  };
  std::vector<Piece> pieces_;
  std::string text_;
  int width_ = 1;  ///< digits of the frame, 1: no padding
  bool has_frame_ = false, has_view_ = false;

  std::string expanded(const std::string& frame, std::string_view view) const;
  std::string frame_text(int frame) const;
};

/// Whether a path holds a token.
bool is_frame_pattern(std::string_view path);

/// The frame number in the name of one file: the digits before its extension, set apart
/// by a dot, an underscore or a minus ("shot.1001.exr", "shot_1001.exr", "1001.exr"),
/// negative after ".-" or "_-". Empty for "shot.exr", "shot_v02.exr".
std::optional<int> frame_in_name(const std::filesystem::path&);

/// Checks that `out` can hold what `in` names: frame token for more than one frame, view
/// token for more than one view, and no file that is written over itself. Throws Error
/// "-o out.exr: 24 frames into one file; write out.####.exr".
void check_output(const FramePattern& in, const FramePattern& out, std::size_t frames,
                  std::size_t views = 1, const std::string& where = "-o");

}  // namespace brume
