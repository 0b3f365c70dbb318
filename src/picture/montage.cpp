#include "num/error.h"
#include "num/modules.h"
#include "picture/module.h"

namespace brume {

Picture montage(std::span<const Tile> tiles, const Montage& how) {
  if (tiles.empty()) return {};
  if (tiles.size() == 1 && tiles[0].label.empty() && !tiles[0].has_range &&
      (how.width == 0 || how.width == tiles[0].picture.width))
    return tiles[0].picture;
  constexpr const char* kModule = "picture.so";
  if (void* draw = module_symbol(kModule, "brume_picture_montage")) {
    Picture out;
    reinterpret_cast<MontageFunction>(draw)(tiles.data(), tiles.size(), how, out);
    return out;
  }
  throw Error(kModule, "is not installed: it draws labels and scales pictures",
              "build with BRUME_WITH_OPENCV=ON");
}

}  // namespace brume
