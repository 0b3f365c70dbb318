#pragma once
// What a surface or lens stage is given of a frame. Internal to src/study.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/rows.h"
#include "plugin.h"
#include "study/subject.h"

namespace brume::study {

/// A frame's planes with `around` copies of its edge on each side.
struct Sheet {
  int width = 0, height = 0, around = 0;
  std::ptrdiff_t stride = 0;
  std::vector<float> rgb[3], alpha, t, d[3], o[3];
  std::vector<std::vector<float>> channels;
  std::vector<const float*> channels_at;

  std::size_t at(int x, int y) const {
    return std::size_t((y + around) * stride + x + around);
  }
  std::size_t at(std::uint32_t i) const { return at(int(i) % width, int(i) / width); }
  std::size_t pixels() const { return std::size_t(width) * std::size_t(height); }

  /// A plane of width x height, laid out; empty stays empty.
  std::vector<float> lay(const std::vector<float>& plane) const;
  /// All of it as one tile, valid while the sheet stays as it is.
  brume_tile tile(const brume_world* world);
};

/// The stage of that name among those that run; null: none.
const RunningStage* find_stage(const Prepared&, const std::string& name);

/// What the stage reads; nothing, and why in `why_not`, where that cannot be had.
std::optional<Sheet> sheet_of(const Context&, const RunningStage&,
                              const std::string& name, const SceneFile&, Registry&,
                              const FrameFiles&, std::string& why_not);

}  // namespace brume::study
