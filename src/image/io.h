#pragma once
// Reading and writing image files: rows of named channels in, an edited copy of a file
// out.
//
// EXR streams by chunks (raw chunk, libdeflate or OpenEXR's codec, planar floats), be it
// scanline or tiled, of one part or many; other formats are held whole. Callers cannot
// tell the difference but by memory and time.

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "image/image.h"

namespace brume {

/// An opened image file, one part of it. Reading is const and may be done from several
/// threads at once.
class ImageReader {
 public:
  virtual ~ImageReader() = default;

  const std::filesystem::path& path() const { return path_; }
  const ImageHeader& header() const { return header_; }

  /// Rows that are cheapest read together: bands of them start at header().data_window.y.
  /// (ZIP 16, ZIPS 1, tiled: a tile's height; held whole: any.)
  virtual int band_rows() const = 0;

  /// Whether bands stream from the file (true) or the whole part is held in memory after
  /// the first read (false).
  virtual bool streams() const = 0;

  /// Reads rows [y, y+rows), all inside the data window, of the channels (indices into
  /// header().channels); row r of channel k goes to out[k] + r * data_window.width. Only
  /// the channels asked for are converted; samples of a subsampled channel are repeated
  /// over the pixels they stand for. Throws Error{path, what is broken and at which
  /// chunk}.
  virtual void read(int y, int rows, std::span<const int> channels,
                    std::span<float* const> out) const = 0;

  /// Bytes read from the file so far, by all threads.
  virtual std::uint64_t bytes_read() const = 0;

 protected:
  std::filesystem::path path_;
  ImageHeader header_;
};

/// What the file holds: a header per part, without reading pixels. Throws Error when it
/// is no image brume can read.
std::vector<ImageHeader> read_headers(const std::filesystem::path&);

/// Opens part `part` (0 first). Which library reads it is chosen by the file's first
/// bytes, not its name: EXR here, the rest through the image_io module, which is opened
/// only then. Throws Error: no such file, not an image, truncated, a declared size the
/// file cannot hold (before memory is taken), deep data ("deep files are not supported
/// yet").
std::unique_ptr<ImageReader> open_image(const std::filesystem::path&, int part = 0);

/// How an output differs from the file it is made from.
struct Edit {
  /// Channels to write beyond or instead of the source's: a name the source has is a
  /// changed channel (its type is kept unless `retype`), a new one is added. Order is the
  /// order of `Band::out`.
  std::vector<Channel> channels;
  std::vector<int> read;    ///< source channels that `work` only looks at (Band::in, same
                            ///< order); decoded with the rest
  bool only_these = false;  ///< leave the source's other channels out
  bool retype = false;      ///< changed channels take the type given in `channels`
  Attributes attributes;    ///< set or replaced
  std::optional<Compression> compression;
  std::optional<float> dwa_level;
};

/// A band of rows on its way from source to output. One thread works on it.
struct Band {
  int y = 0, rows = 0;  ///< rows [y, y+rows) of the source's data window, full width
  std::span<float* const>
      out;  ///< one plane per Edit::channels; changed channels hold the source's values
  std::span<const float* const> in;  ///< one plane per Edit::read
  bool touched = true;  ///< set false: nothing was changed, `out` is ignored, the chunk
                        ///< may be copied as it is; added channels are 0 there
};

struct CopyOptions {
  int threads = 0;  ///< 0: all
  const std::atomic<bool>* cancel =
      nullptr;  ///< set by Ctrl-C: stops with Error{"...", "interrupted"}, no output left
  std::function<void(double)>
      progress;              ///< fraction of the rows written, from any thread
  bool whole_frame = false;  ///< one band: all rows (lens stages)
  /// Asked before rows [y, y+rows) are unpacked: false means that `work` would change
  /// nothing there and need not be called; where nothing else changes (compression, the
  /// list of channels) the chunk is copied unread. From several threads.
  std::function<bool(int y, int rows)> touches;
};

struct CopyReport {
  std::uint64_t bytes_read = 0, bytes_written = 0;
  std::uint64_t half_overflows = 0;  ///< pixels x channels that were larger than the
                                     ///< largest half; they were written as it
  std::uint64_t chunks = 0, chunks_copied = 0;  ///< copied: still compressed
  bool streamed = false;
  double read_seconds = 0, work_seconds = 0, write_seconds = 0;  ///< summed over threads
};

/// Makes `out`: a copy of `source` with `edit` applied; `work` fills or changes the
/// channels of each band (called from several threads, for different bands, in any order;
/// it reads further channels, rows around or other files through ImageReaders itself).
/// All else - other channels bit for bit, other parts, type, compression, windows, line
/// order, tiling, attributes - stays. (What a lossy codec makes of a chunk that holds a
/// changed channel is the codec's: B44 and DWA pack the others anew too.) A part with
/// mipmap or ripmap levels is refused where pixels could change: the smaller levels would
/// not follow. Other formats than EXR (by the name of `out`) go
/// through the image_io module. Written beside and renamed: `out` is whole or absent, and
/// an old `out` stays until then. Throws Error (full disk, a directory as output,
/// unreadable source ...).
CopyReport copy_edited(const ImageReader& source, const Edit& edit,
                       const std::filesystem::path& out,
                       const std::function<void(Band&)>& work, const CopyOptions& = {});

/// The whole of a part in memory, all channels or those named. Throws Error.
Image read_image(const std::filesystem::path&, int part = 0,
                 std::span<const std::string> channels = {});

/// Writes an image held in memory, atomically like copy_edited; planes in header order,
/// type and compression from the header.
CopyReport write_image(const Image&, const std::filesystem::path& out);

}  // namespace brume
