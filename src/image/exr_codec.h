#pragma once
// Chunks packed and unpacked: none, RLE, ZIP and ZIPS by ourselves (libdeflate), the rest
// by OpenEXR. Buffers and compressors are kept per thread.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "image/exr_format.h"

namespace brume::exr {

/// Unpacks `payload`, a chunk of the pixels `window`, into `pixels`
/// (ChunkLayout(header.channels, window).size() bytes). `payload` may be overwritten.
/// Throws Error{where, ...} when it is corrupt.
void unpack(const ImageHeader&, const Window& window, std::vector<std::uint8_t>& payload,
            std::span<std::uint8_t> pixels, const std::string& where);

/// Packs `pixels`; the payload is the pixels themselves where packing does not help.
/// Throws Error{where, ...} when OpenEXR's codec refuses.
void pack(const ImageHeader&, const Window& window, std::span<const std::uint8_t> pixels,
          std::vector<std::uint8_t>& payload, const std::string& where);

/// The codecs of OpenEXR itself (any compression), by files in memory that hold one
/// chunk. Throw std::exception.
void unpack_with_openexr(const ImageHeader&, const Window&, std::span<const std::uint8_t>,
                         std::span<std::uint8_t> pixels);
void pack_with_openexr(const ImageHeader&, const Window&, std::span<const std::uint8_t>,
                       std::vector<std::uint8_t>& payload);

}  // namespace brume::exr
