#pragma once
// The border between libbrume and its drawing module: both are built together, so C++
// types may cross.

#include <cstddef>

#include "picture/picture.h"

namespace brume {

/// extern "C" brume_picture_montage.
using MontageFunction = void (*)(const Tile* tiles, std::size_t count, const Montage&,
                                 Picture& out);

}  // namespace brume
