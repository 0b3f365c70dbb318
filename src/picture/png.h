#pragma once
// Pictures as PNG in memory, for pages that carry their pictures inside them.

#include <string>

#include "picture/picture.h"

namespace brume {

/// Eight bits a channel, sRGB (PNG specification, third edition; compressed by
/// libdeflate). Empty for a picture without pixels.
std::string png(const Picture&);

/// RFC 4648.
std::string base64(const std::string& bytes);

}  // namespace brume
