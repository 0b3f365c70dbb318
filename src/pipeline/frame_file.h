#pragma once
// Frames in files: what `brume apply` does with one frame, on top of Session and
// copy_edited.

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>

#include "image/io.h"
#include "pipeline/pipeline.h"

namespace brume {

struct ApplyOptions {
  int threads = 0;
  std::optional<Window> region;  ///< display pixels; the output's data window
  int proxy =
      1;  ///< every n-th pixel in x and y; colour averaged, depth taken at the centre
  std::string provenance_scene;  ///< resolved scene text for brume/scene; "" leaves
                                 ///< provenance out
  const std::atomic<bool>* cancel = nullptr;
  std::function<void(double)> progress;
};

/// What one frame took; `--report` writes it as JSON.
struct FrameReport {
  std::filesystem::path in, out;
  double frame = 0;
  Plan plan;
  CopyReport copy;
  ApplyCounts counts;
  double prepare_seconds = 0, work_seconds = 0,
         wall_seconds = 0;  ///< work: summed over threads
};

/// Reads the frame (and the scene's further files), applies the scene, writes `out`.
FrameReport apply_frame(const Session&, double frame, const std::filesystem::path& in,
                        const std::filesystem::path& out, const ApplyOptions&);

/// Opens what the frame needs and plans it, without reading pixels.
Plan plan_frame(const Session&, double frame, const std::filesystem::path& in,
                const ApplyOptions& = {});

/// The reports as one JSON document: per frame what ran, what was left out and why,
/// seconds, ns per pixel and step, bytes, peak memory.
std::string report_json(std::span<const FrameReport>, double wall_seconds);

}  // namespace brume
