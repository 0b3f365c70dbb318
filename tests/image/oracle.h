#pragma once
// OpenEXR's C++ library as the other opinion on EXR files.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "image/image.h"

namespace brume::oracle {

/// In memory where there is such a folder: thousands of small files on a disk take long.
std::filesystem::path temp_folder();

/// A file beside the others of this test run, removed at the end.
struct TempFile {
  std::filesystem::path path;
  explicit TempFile(const std::string& name);
  ~TempFile();
};

/// What kind of file to write.
struct Spec {
  std::vector<Channel> channels;
  Compression compression = Compression::zip;
  Window data{0, 0, 67, 53}, display{0, 0, 67, 53};
  bool tiled = false;
  int tile_width = 16, tile_height = 24;
  int line_order = 0, levels = 0, rounding = 0;  ///< OpenEXR's numbering
  std::string part_name, view;
  struct Extra {
    std::string name, type, bytes;
  };
  std::vector<Extra> attributes;  ///< type "string", or one that nobody knows
};

using Planes = std::vector<std::vector<float>>;

/// Random content for each channel: smooth noise with rough patches, NaN and inf among
/// it where `special`. Bits depend on the seed only.
void write(const Spec&, const std::filesystem::path&, unsigned seed,
           bool special = false);

void write(const std::vector<Spec>& parts, const std::filesystem::path&, unsigned seed,
           bool special = false);

/// A small deep scanline file.
void write_deep(const std::filesystem::path&);

/// All channels of a part as floats, sorted by name, subsampled ones repeated.
Planes read(const std::filesystem::path&, int part = 0);

/// The same as the bytes of the samples that exist.
std::vector<std::vector<char>> read_raw(const std::filesystem::path&, int part = 0);

}  // namespace brume::oracle
