#pragma once
// Formats other than EXR, through the image_io module, which is opened at the first call.

#include <filesystem>
#include <memory>
#include <vector>

#include "image/io.h"

namespace brume::foreign {

/// Throw Error: no module (with the folders searched), no such format, corrupt.
std::vector<ImageHeader> read_headers(const std::filesystem::path&);
std::unique_ptr<ImageReader> open(const std::filesystem::path&, int part);

/// copy_edited for outputs of other formats: held whole, R G B A first where the file
/// holds no names. Formats of at most four channels take R, G, B, A (or Y, or a single
/// channel) and leave others out.
CopyReport copy(const ImageReader& source, const Edit&, const std::filesystem::path& out,
                const std::function<void(Band&)>& work, const CopyOptions&);

}  // namespace brume::foreign
