#pragma once
// The files of one frame: its own and those that the scene names beside it. Internal to
// src/pipeline.

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "image/io.h"
#include "pipeline/frame_file.h"
#include "pipeline/pipeline.h"

namespace brume {

class FrameFiles {
 public:
  /// Opens the frame's own file: the part of [input], or that of its view. Throws Error.
  FrameFiles(const SceneFile&, double frame, const std::filesystem::path& in);

  const ImageReader& main() const { return *main_; }

  /// What Session::prepare asks; other files are opened when it asks for them.
  FrameSource source(const ApplyOptions&) const;

  /// Rows of one channel around row y (image coordinates of the frame's own file), as
  /// many as are read together, over the width of its data window. Another file lies
  /// under it with the upper left corners of the display windows together; outside its
  /// data window depth is background and all else 0.
  struct Rows {
    int y = 0, rows = 0;
    std::vector<float> values;
  };
  Rows read(const InputChannel&, int y, bool is_depth) const;
  /// The same for a whole window inside the frame's own data window.
  std::vector<float> read_all(const InputChannel&, const Window&, bool is_depth) const;

 private:
  const ImageReader& other(const std::string& file) const;

  const SceneFile& scene_;
  double frame_;
  std::unique_ptr<ImageReader> main_;
  mutable std::mutex mutex_;
  mutable std::map<std::string, std::unique_ptr<ImageReader>> others_;
};

/// What becomes of the frame's own file: its outputs, the compression that [output] asks
/// for, and where it came from (version, scene, plan; none where
/// options.provenance_scene is empty).
Edit edit_of(const PreparedFrame&, const SceneFile&, const ApplyOptions&);

}  // namespace brume
