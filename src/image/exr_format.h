#pragma once
// The EXR container: version, headers, offset tables, where each chunk lies and which
// pixels it holds. Everything is checked against the file's size before it is believed.
// Layout: openexr.com, "OpenEXR File Layout".

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "image/atomic_file.h"
#include "image/image.h"

namespace brume::exr {

constexpr std::uint32_t kMagic = 20000630;
enum Flag : std::uint32_t {
  kTiledFlag = 0x200,  ///< single-part tiled
  kLongNamesFlag = 0x400,
  kDeepFlag = 0x800,
  kMultiPartFlag = 0x1000,
};

struct NamedAttribute {
  std::string name;
  Attribute value;
};

enum class LineOrder : std::uint8_t { increasing, decreasing, random };

/// The `tiles` attribute.
struct Tiles {
  std::uint32_t width = 64, height = 64;
  enum class Levels : std::uint8_t { one, mipmap, ripmap } levels = Levels::one;
  bool round_up = false;
};

/// One part: its attributes as they lie in the file, the same understood, and its chunks.
struct Part {
  std::vector<NamedAttribute> attributes;  ///< all, in the file's order
  ImageHeader header;
  LineOrder line_order = LineOrder::increasing;
  std::optional<Tiles> tiles;
  std::vector<std::uint64_t> offsets;  ///< of each chunk in the file; 0 is missing

  int chunk_lines() const;   ///< rows of a scanline chunk (1, 16, 32, 256) or of a tile
  int tiles_across() const;  ///< chunks side by side: 1 unless tiled
  std::int64_t chunk_rows() const;     ///< rows of chunks of the full-size level
  std::int64_t chunk_count() const;    ///< in the offset table, all levels
  std::int64_t level_chunks() const {  ///< of the full-size level, the table's first
    return chunk_rows() * tiles_across();
  }
  /// Pixels of chunk i of the full-size level.
  Window chunk_window(std::int64_t i) const;
};

/// Where the channels of a window's pixels lie in an unpacked chunk: row after row, in
/// each row channel after channel, in each channel the samples that exist there.
class ChunkLayout {
 public:
  ChunkLayout(const std::vector<Channel>&, const Window&);

  std::size_t size() const { return size_; }  ///< bytes
  /// Byte offset of a channel's samples in row r (0 first), and how many they are.
  std::size_t offset(std::size_t channel, int row) const;
  std::size_t row_offset(int row) const {
    return regular_ ? row * row_bytes_ : row_offsets_[row];
  }
  int samples(std::size_t channel, int row) const;
  bool regular() const { return regular_; }  ///< no channel skips rows

 private:
  const std::vector<Channel>* channels_;
  Window window_;
  bool regular_ = true;
  std::size_t row_bytes_ = 0, size_ = 0;
  std::vector<int> width_;                ///< samples of each channel in a row
  std::vector<std::size_t> offset_;       ///< in a row, when regular
  std::vector<std::size_t> row_offsets_;  ///< when not
};

int lines_per_chunk(Compression);
inline int bytes_per_sample(PixelType t) { return t == PixelType::half ? 2 : 4; }
inline int floor_mod(int a, int b) { return ((a % b) + b) % b; }
inline int floor_div(int a, int b) { return (a - floor_mod(a, b)) / b; }
/// Samples with x % sampling == 0 in [x, x + width).
inline int sample_count(int x, int width, int sampling) {
  return floor_div(x + width - 1, sampling) - floor_div(x - 1, sampling);
}

/// An open EXR file. Reading is thread-safe.
class File {
 public:
  /// Opens and parses; throws Error{path, what}.
  explicit File(const std::filesystem::path&);
  ~File();
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  const std::filesystem::path& path() const { return path_; }
  const std::vector<Part>& parts() const { return parts_; }
  bool multi_part() const { return flags_ & kMultiPartFlag; }
  std::uint32_t flags() const { return flags_; }
  std::uint64_t size() const { return size_; }
  std::uint64_t bytes_read() const { return bytes_read_; }

  /// Reads exactly n bytes; throws Error "the file ends early".
  void read_at(std::uint64_t offset, void* to, std::size_t n) const;

  /// Where a chunk lies: its head (part number in multi-part files, coordinates, size)
  /// and its payload (compressed pixels), one after the other.
  struct Extent {
    std::uint64_t offset = 0, head = 0, payload = 0;
    std::uint64_t size() const { return head + payload; }
  };
  /// Of chunk i of part p's full-size level, checked against table and window. Throws
  /// Error.
  Extent chunk_extent(int part, std::int64_t i) const;
  /// Of a chunk of any kind and level, of which little is known: for copying.
  Extent any_extent(int part, std::int64_t i) const;

  /// The payload at `where`, or of a chunk found by chunk_extent. Throw Error.
  void read_payload(const Extent& where, std::vector<std::uint8_t>& payload) const;
  void read_chunk(int part, std::int64_t i, std::vector<std::uint8_t>& payload) const {
    read_payload(chunk_extent(part, i), payload);
  }

  /// Appends these bytes to `out` as they lie.
  void copy(std::uint64_t offset, std::uint64_t n, AtomicFile& out) const;

 private:
  void parse();
  void read_offsets(std::uint64_t at);
  std::vector<NamedAttribute> read_header(std::uint64_t& at);
  void read_ahead(std::uint64_t offset, void* to, std::size_t n);

  std::filesystem::path path_;
  int fd_ = -1;
  std::uint32_t flags_ = 0;
  std::uint64_t size_ = 0;
  mutable std::atomic<std::uint64_t> bytes_read_ = 0;
  std::vector<Part> parts_;
  std::uint64_t page_at_ = 0;  ///< while parsing
  std::vector<std::uint8_t> page_;
};

/// Fills header, line order and tiles of `part` from its attributes. `flags` are the
/// file's. Throws Error{where, what} when one is missing or absurd.
void understand(Part& part, std::uint32_t flags, const std::string& where);

/// The inverse for headers we make: the attributes of a part that holds what `header`
/// says, `keep` first in their order (with changed values where the header differs).
std::vector<NamedAttribute> attributes_of(const ImageHeader& header,
                                          std::vector<NamedAttribute> keep,
                                          std::optional<std::int64_t> chunk_count);

/// Magic, version, flags (long names as needed) and all headers as bytes.
std::vector<std::uint8_t> serialize(const std::vector<std::vector<NamedAttribute>>& parts,
                                    std::uint32_t flags);

/// A name out of a file for a message of one line: cut short, odd bytes as '?'.
std::string printable(std::string_view name);

/// "rows 16 to 31" or "tile 3 of row 2", for messages.
std::string chunk_text(const Part&, std::int64_t chunk);

}  // namespace brume::exr
