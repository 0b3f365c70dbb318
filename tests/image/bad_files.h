#pragma once
// A small file for the tests of what is broken.

#include "image/oracle.h"

namespace brume::oracle {

inline Spec small(Compression c, bool tiled) {
  Spec s;
  s.channels = {{"B", PixelType::half},
                {"R", PixelType::half},
                {"Z", PixelType::float32},
                {"id", PixelType::uint32}};
  s.compression = c;
  s.tiled = tiled;
  s.data = {0, 0, 30, 40};
  return s;
}

}  // namespace brume::oracle
