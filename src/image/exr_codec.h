#pragma once
// Chunks packed and unpacked: none, RLE, ZIP and ZIPS by ourselves (libdeflate), the rest
// by OpenEXR, in a module that is opened when the first such chunk comes. Buffers and
// compressors are kept per thread.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "image/exr_format.h"

namespace brume::exr {

/// Unpacks `payload`, a chunk of the pixels `window`, into `pixels`
/// (ChunkLayout(header.channels, window).size() bytes). `payload` may be overwritten.
/// Throws Error{where, ...} when it is corrupt, or its codec's module is not there.
void unpack(const ImageHeader&, const Window& window, std::vector<std::uint8_t>& payload,
            std::span<std::uint8_t> pixels, const std::string& where);

/// Packs `pixels`; the payload is the pixels themselves where packing does not help.
/// Throws Error{where, ...} when OpenEXR's codec refuses, or its module is not there.
void pack(const ImageHeader&, const Window& window, std::span<const std::uint8_t> pixels,
          std::vector<std::uint8_t>& payload, const std::string& where);

}  // namespace brume::exr
