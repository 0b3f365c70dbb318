#pragma once
// One row of pixels through surface and air, in blocks that stay in the first-level
// cache: internal to src/pipeline.

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "pipeline/impl.h"

namespace brume {

/// Where rows of input pixels come from: memory, a band of a file, a whole file. One per
/// thread.
class RowFeed {
 public:
  virtual ~RowFeed() = default;
  /// The columns and rows there are (scaled display pixels).
  Window window;
  /// Row y of an input, contiguous, its first value at column window.x; valid until as
  /// many other rows of that input have been asked for as kRowsKept. Null when y is
  /// outside the frame.
  virtual const float* row(int input, int y) = 0;

  /// How many rows of one input stay valid: what a look around a pixel needs.
  static constexpr int kRowsKept = 40;
};

/// What surface stages are given to ask while they run; good as long as `frame`.
brume_world world_for_stages(const PreparedFrame::Impl& frame);

/// Works on rows of one prepared frame with one feed; holds the scratch memory. One per
/// thread.
class RowWorker {
 public:
  RowWorker(const PreparedFrame::Impl& frame, RowFeed& feed);
  ~RowWorker();

  /// Pixels [x0, x1) of row y: out[k] is where output k of column x0 goes (null: not
  /// wanted). All but the lens stages. Returns whether any pixel was touched. Throws
  /// Error when a stage fails.
  bool run(int y, int x0, int x1, std::span<float* const> out);

 private:
  struct Scratch;
  bool one_pass(int y, int x0, int x1, std::span<float* const> out);
  void block(int y, int x, int n, int offset, std::span<float* const> out);
  void leave(int y, int x, int end, int offset, std::span<float* const> out);
  void fill_block_rays(int y, int x, int n);
  void distances(int y, int x, int n, float* out);
  const float* distance_row(int y);
  void cover_edges(int y, int x, int n, float* out);
  void sample_distances(int y, int x, int n, float* out);
  const float* part_of_background(int n);

  // surface.cpp
  void surface(int y, int x, int n, int offset, std::span<float* const> out);
  const float* around_row(int y);
  const std::vector<float*>& halo(const RunningStage&, int y, int x, int n, int& stride);

  const PreparedFrame::Impl& f_;
  RowFeed& feed_;
  brume_world world_;
  std::pair<int, int> around_columns_;  ///< of the run and what surface stages see of it
  std::unique_ptr<Scratch> s_;
  bool touched_ = false;
};

}  // namespace brume
