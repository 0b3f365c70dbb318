#pragma once
// What an edited copy will be, before a pixel is read: channels and where they come from,
// headers, bands.

#include <filesystem>
#include <vector>

#include "image/exr_reader.h"
#include "image/io.h"

namespace brume::exr {

/// Where an output channel comes from: the source's bits, or a float plane.
struct Origin {
  int source = -1, plane = -1;
};

struct CopyPlan {
  std::vector<Part> parts;         ///< of the output, without offsets
  int part = 0;                    ///< the one being edited
  std::uint32_t flags = 0;         ///< of the output file
  std::vector<Channel> channels;   ///< of the output, sorted
  std::vector<Origin> origins;     ///< of them
  std::vector<int> plane_sources;  ///< source channel that a plane starts as, or -1; the
                                   ///< first planes are those of Edit::channels
  bool copyable = false;           ///< an untouched chunk may be copied as it is
  bool descending = false;         ///< bands are written last first
  int band_rows = 1, bands = 1;

  const Part& edited() const { return parts[part]; }
  Window band_window(int b) const;
  /// The output's chunks of these rows (whole chunks), in the order they are written.
  std::vector<std::int64_t> chunks_of(const Window& rows) const;
};

/// Throws Error: a channel twice, attributes that are not the edit's to set, levels that
/// would not follow.
CopyPlan plan_copy(const ImageReader& source, const Edit&,
                   const std::filesystem::path& out, bool whole_frame);

}  // namespace brume::exr
