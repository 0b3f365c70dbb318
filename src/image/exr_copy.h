#pragma once
// Making one EXR from another, or from floats: bands through `work` on all threads,
// chunks written in order.

#include "image/io.h"

namespace brume::exr {

/// copy_edited for outputs that are EXR files; the source may be any reader.
CopyReport copy(const ImageReader& source, const Edit&, const std::filesystem::path& out,
                const std::function<void(Band&)>& work, const CopyOptions&);

}  // namespace brume::exr
