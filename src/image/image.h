#pragma once
// Planar float32 channels by name: the only pixel type of brume.

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace brume {

/// A rectangle of pixels: x grows to the right, y grows downward; [x, x+width) x [y,
/// y+height). Empty when a side is <= 0.
struct Window {
  int x = 0, y = 0, width = 0, height = 0;

  bool empty() const { return width <= 0 || height <= 0; }
  int right() const { return x + width; }    ///< one past the last column
  int bottom() const { return y + height; }  ///< one past the last row
  std::int64_t pixels() const { return empty() ? 0 : std::int64_t(width) * height; }
  bool operator==(const Window&) const = default;
};
Window intersect(const Window& a, const Window& b);
Window unite(const Window& a, const Window& b);

/// How a channel's values lie in a file. In memory they are float32 always: half exactly,
/// uint to the nearest float (a uint channel nobody changes is never converted, it passes
/// through by its bits).
enum class PixelType : std::uint8_t {
  uint32 = 0,
  half = 1,
  float32 = 2
};  // OpenEXR's numbering

struct Channel {
  std::string name;  ///< full name, "depth.Z"
  PixelType type = PixelType::half;
  int x_sampling = 1, y_sampling = 1;
  bool perceptually_linear = false;
  bool operator==(const Channel&) const = default;
};

/// One metadata attribute as it lies in the file: OpenEXR type name and its bytes,
/// little-endian, so that a type nobody knows survives too. The helpers read and make the
/// usual ones.
struct Attribute {
  std::string type;  ///< "float", "m44f", "string", "chromaticities" ...
  std::vector<std::uint8_t> bytes;

  std::optional<double> number() const;     ///< int, float, double, rational
  std::optional<std::string> text() const;  ///< string
  std::optional<std::vector<double>> numbers()
      const;  ///< v2*/v3*, m33*, m44* row by row, box2*, chromaticities, floatvector
  static Attribute from_text(std::string_view);
  static Attribute from_float(float);
  static Attribute from_floats(std::string type, std::span<const float>);
};
using Attributes = std::map<std::string, Attribute>;

enum class Compression : std::uint8_t {
  none,
  rle,
  zips,
  zip,
  piz,
  pxr24,
  b44,
  b44a,
  dwaa,
  dwab
};  // OpenEXR's numbering
const char* name(Compression);
std::optional<Compression> compression_from(
    std::string_view);  ///< "zip", "zips", ... as users write them

/// Whether a codec changes the values of such a channel to be seen: B44 every half one,
/// DWA those named R, G, B, Y, RY or BY, in any layer and of either type (OpenEXR 3.1's
/// rules). PXR24 keeps 24 bits of a float, 2^-17 of its value and finer than half: no.
bool is_lossy(Compression, const Channel&);

/// Everything a file says of one part (an EXR part, or a whole file of another format)
/// but its pixels.
struct ImageHeader {
  std::string part_name, view;  ///< may be empty
  Window data_window, display_window;
  std::vector<Channel> channels;  ///< sorted by name, as EXR wants them
  Compression compression = Compression::zip;
  std::optional<float> dwa_level;
  bool tiled = false, deep = false;
  float pixel_aspect = 1;
  Attributes attributes;  ///< all others, line order and tile description included

  /// Index in `channels`, or -1.
  int find(std::string_view channel) const;
};

/// Pixels in memory: one float plane per channel, rows of `window.width` floats, top row
/// first, no padding.
struct Image {
  ImageHeader header;
  std::vector<std::vector<float>>
      planes;  ///< same order as header.channels; subsampled channels are stored expanded

  std::span<float> plane(int channel) { return planes[channel]; }
  std::span<const float> plane(int channel) const { return planes[channel]; }
};

}  // namespace brume
