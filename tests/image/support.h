#pragma once
// Small helpers of the image tests.

#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "image/image.h"
#include "image/oracle.h"

namespace brume {

inline bool same_bits(std::span<const float> a, std::span<const float> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

inline std::vector<Channel> all_types() {
  return {{"A", PixelType::half},    {"B", PixelType::half, 1, 1, true},
          {"G", PixelType::half},    {"R", PixelType::half},
          {"Z", PixelType::float32}, {"deep.layer.Position.X", PixelType::float32},
          {"id", PixelType::uint32}};
}

inline constexpr Compression kAllCompressions[] = {
    Compression::none, Compression::rle,   Compression::zips, Compression::zip,
    Compression::piz,  Compression::pxr24, Compression::b44,  Compression::b44a,
    Compression::dwaa, Compression::dwab};

inline std::vector<char> bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void write_bytes(const std::filesystem::path& path, std::span<const char> bytes) {
  std::ofstream(path, std::ios::binary)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// A folder of its own, removed at the end with all it holds.
struct TempFolder {
  std::filesystem::path path;
  explicit TempFolder(const std::string& name)
      : path(oracle::temp_folder() /
             ("brume_" + std::to_string(::getpid()) + "_" + name)) {
    std::filesystem::create_directories(path);
  }
  ~TempFolder() {
    std::error_code none;
    std::filesystem::remove_all(path, none);
  }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& entry : std::filesystem::directory_iterator(path))
      all.push_back(entry.path().filename().string());
    return all;
  }
};

}  // namespace brume
