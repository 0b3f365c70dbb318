#pragma once
// What a picture of a difference becomes in a format that holds no negative numbers.

#include <filesystem>

#include "image/image.h"

namespace brume::cli {

/// Whether a file of this name holds any float (EXR, TIFF).
bool keeps_numbers(const std::filesystem::path&);

/// Leaves alpha out, unless it is alone. Of a signed difference: 0.5 where there is none,
/// 1 and 0 at plus and minus the largest finite one of the picture (R, G, B, Y; all
/// channels where there are none of these), 1 for NaN; infinite ones are cut.
void draw_for_eyes(Image&, bool is_signed);

}  // namespace brume::cli
