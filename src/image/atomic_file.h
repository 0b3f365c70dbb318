#pragma once
// An output that is whole or absent: written beside its name and renamed at the end.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

namespace brume {

class AtomicFile {
 public:
  /// Opens `.<name>.<pid>.part` in the folder of `path`. A link is followed: what it
  /// points to is replaced. Throws Error{path, ...}: a directory, no such folder, no
  /// permission.
  explicit AtomicFile(const std::filesystem::path& path);
  /// Removes what was written, unless it was committed.
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  const std::filesystem::path& part() const { return part_; }  ///< being written
  std::uint64_t size() const { return size_; }                 ///< bytes appended

  /// Throw Error{path, ...} when the disk is full and the like.
  void append(const void* bytes, std::size_t n);
  void write_at(std::uint64_t offset, const void* bytes, std::size_t n);
  /// Appends n bytes of another file, from `offset` on. Throws Error{path, ...}, also
  /// where the other file ends before.
  void append_from(int fd, std::uint64_t offset, std::uint64_t n);

  /// Gives the file its name. Throws Error{path, ...}.
  void commit();

 private:
  std::filesystem::path path_, target_, part_;
  int fd_ = -1;
  bool replaces_ = false;  ///< there was one before
  std::uint64_t size_ = 0;
};

}  // namespace brume
