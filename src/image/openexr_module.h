#pragma once
// The border between libbrume and its module openexr.so, which links OpenEXR's C++
// libraries: they take 1 ms to load, a third of a start, and most files never need them.
// Both are built together, so C++ types may cross.

#include <cstdint>
#include <span>
#include <vector>

#include "image/exr_format.h"

namespace brume::exr {

/// OpenEXR's own codecs (any compression), by files in memory that hold one chunk. Throw
/// std::exception.
struct OpenExrCodecs {
  int version = kVersion;
  void (*unpack)(const ImageHeader&, const Window&, std::span<const std::uint8_t> payload,
                 std::span<std::uint8_t> pixels);
  void (*pack)(const ImageHeader&, const Window&, std::span<const std::uint8_t> pixels,
               std::vector<std::uint8_t>& payload);

  static constexpr int kVersion = 1;  ///< to be raised when what crosses changes
};

}  // namespace brume::exr

/// The module's one symbol.
extern "C" __attribute__((visibility("default"))) const brume::exr::OpenExrCodecs*
brume_openexr_codecs();
