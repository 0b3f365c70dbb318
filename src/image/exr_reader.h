#pragma once
// Rows of an EXR part as floats, chunk by chunk.

#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "image/exr_format.h"
#include "image/io.h"

namespace brume::exr {

/// A chunk's pixels as they lie in the file once unpacked.
struct Chunk {
  Window window;
  ChunkLayout layout;
  std::unique_ptr<std::uint8_t[]> pixels;  ///< layout.size() bytes

  /// First sample of a channel in row y.
  const std::uint8_t* row(std::size_t channel, int y) const {
    return pixels.get() + layout.offset(channel, y - window.y);
  }
};

class Reader : public ImageReader {
 public:
  /// Throws Error for deep parts and parts the file does not have.
  Reader(std::shared_ptr<const File>, int part);

  int band_rows() const override { return part_->chunk_lines(); }
  bool streams() const override { return true; }
  void read(int y, int rows, std::span<const int> channels,
            std::span<float* const> out) const override;
  std::uint64_t bytes_read() const override { return file_->bytes_read(); }

  const File& file() const { return *file_; }
  const Part& part() const { return *part_; }
  int part_index() const { return index_; }

  /// Chunk i, unpacked. A chunk somebody holds is not unpacked again, and the latest few
  /// are held, so that many reads of few rows stay cheap. Thread-safe.
  std::shared_ptr<const Chunk> chunk(std::int64_t i) const;

 private:
  std::shared_ptr<const Chunk> unpack_chunk(std::int64_t i) const;

  std::shared_ptr<const File> file_;
  const Part* part_;
  int index_;
  mutable std::mutex mutex_;
  mutable std::vector<std::weak_ptr<const Chunk>> alive_;     ///< held by somebody
  mutable std::vector<std::shared_ptr<const Chunk>> latest_;  ///< kept alive, a ring
  mutable std::size_t next_ = 0;
};

/// The samples of a row that fall in [x, x+width), as floats; subsampled ones repeated.
/// `samples` is the sample of column x (x is a multiple of the sampling).
void expand_row(const Channel&, const std::uint8_t* samples, int width, float* out);

}  // namespace brume::exr
