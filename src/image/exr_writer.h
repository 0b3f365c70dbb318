#pragma once
// An EXR file being written: header, room for the offset tables, chunks as they come.

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "image/atomic_file.h"
#include "image/exr_format.h"

namespace brume::exr {

class Writer {
 public:
  /// Writes the headers of `parts` (their attributes) and leaves room for the tables.
  /// `flags` as in the file; long names are found by themselves. Throws Error.
  Writer(const std::filesystem::path&, std::span<const Part> parts, std::uint32_t flags);

  /// Appends chunk i of the full-size level of a flat part.
  void add(int part, std::int64_t i, std::span<const std::uint8_t> payload);
  /// Appends a chunk as it lies in another file (whose part has this number), head and
  /// all. Chunks that follow one another there are copied together, so `from` must last.
  void copy(int part, std::int64_t i, const File& from, const File::Extent&);

  /// Writes the tables and names the file. Throws Error.
  void commit();
  /// Bytes written, once it is committed.
  std::uint64_t size() const { return file_.size(); }

 private:
  void flush();

  AtomicFile file_;
  std::span<const Part> parts_;
  bool multi_part_;
  std::uint64_t tables_at_ = 0;
  std::vector<std::vector<std::uint64_t>> offsets_;
  const File* from_ = nullptr;  ///< what is still to be copied, of it
  std::uint64_t from_begin_ = 0, from_end_ = 0;
};

}  // namespace brume::exr
