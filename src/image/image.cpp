#include "image/image.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace brume {

Window intersect(const Window& a, const Window& b) {
  const int x0 = std::max(a.x, b.x), x1 = std::min(a.right(), b.right());
  const int y0 = std::max(a.y, b.y), y1 = std::min(a.bottom(), b.bottom());
  return {x0, y0, std::max(0, x1 - x0), std::max(0, y1 - y0)};
}

Window unite(const Window& a, const Window& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  const int x0 = std::min(a.x, b.x), x1 = std::max(a.right(), b.right());
  const int y0 = std::min(a.y, b.y), y1 = std::max(a.bottom(), b.bottom());
  return {x0, y0, x1 - x0, y1 - y0};
}

namespace {

/// The attribute types that are rows of one number type.
struct NumberLayout {
  const char* type;
  char number;  ///< i(nt), u(nsigned), f(loat), d(ouble)
  int count;    ///< 0: as many as the bytes hold
};
constexpr std::array kLayouts = {
    NumberLayout{"int", 'i', 1},         NumberLayout{"float", 'f', 1},
    NumberLayout{"double", 'd', 1},      NumberLayout{"v2i", 'i', 2},
    NumberLayout{"v2f", 'f', 2},         NumberLayout{"v2d", 'd', 2},
    NumberLayout{"v3i", 'i', 3},         NumberLayout{"v3f", 'f', 3},
    NumberLayout{"v3d", 'd', 3},         NumberLayout{"m33f", 'f', 9},
    NumberLayout{"m33d", 'd', 9},        NumberLayout{"m44f", 'f', 16},
    NumberLayout{"m44d", 'd', 16},       NumberLayout{"box2i", 'i', 4},
    NumberLayout{"box2f", 'f', 4},       NumberLayout{"chromaticities", 'f', 8},
    NumberLayout{"floatvector", 'f', 0},
};

template <class T>
void append_as_double(const std::vector<std::uint8_t>& bytes, std::vector<double>& out) {
  for (std::size_t i = 0; i + sizeof(T) <= bytes.size(); i += sizeof(T)) {
    T value;
    std::memcpy(&value, &bytes[i], sizeof(T));
    out.push_back(double(value));
  }
}

constexpr std::array kCompressionNames = {"none",  "rle", "zips", "zip",  "piz",
                                          "pxr24", "b44", "b44a", "dwaa", "dwab"};

}  // namespace

std::optional<std::vector<double>> Attribute::numbers() const {
  for (const NumberLayout& layout : kLayouts) {
    if (type != layout.type) continue;
    const std::size_t size = layout.number == 'd' ? 8 : 4;
    if (bytes.size() % size || (layout.count && bytes.size() != size * layout.count))
      return std::nullopt;
    std::vector<double> out;
    if (layout.number == 'd') append_as_double<double>(bytes, out);
    if (layout.number == 'f') append_as_double<float>(bytes, out);
    if (layout.number == 'i') append_as_double<std::int32_t>(bytes, out);
    return out;
  }
  return std::nullopt;
}

std::optional<double> Attribute::number() const {
  if (type == "rational") {  // int32 numerator, uint32 denominator
    std::int32_t numerator;
    std::uint32_t denominator;
    if (bytes.size() != 8) return std::nullopt;
    std::memcpy(&numerator, &bytes[0], 4);
    std::memcpy(&denominator, &bytes[4], 4);
    if (denominator == 0) return std::nullopt;
    return double(numerator) / denominator;
  }
  const auto all = numbers();
  if (!all || all->size() != 1 || type == "floatvector") return std::nullopt;
  return all->front();
}

std::optional<std::string> Attribute::text() const {
  if (type != "string") return std::nullopt;
  return std::string(bytes.begin(), bytes.end());
}

Attribute Attribute::from_text(std::string_view text) {
  return {"string", {text.begin(), text.end()}};
}

Attribute Attribute::from_float(float value) {
  return from_floats("float", std::span(&value, 1));
}

Attribute Attribute::from_floats(std::string type, std::span<const float> values) {
  const auto* p = reinterpret_cast<const std::uint8_t*>(values.data());
  return {std::move(type), {p, p + values.size_bytes()}};
}

const char* name(Compression c) { return kCompressionNames[static_cast<std::size_t>(c)]; }

std::optional<Compression> compression_from(std::string_view text) {
  for (std::size_t i = 0; i < kCompressionNames.size(); ++i)
    if (text == kCompressionNames[i]) return static_cast<Compression>(i);
  return std::nullopt;
}

bool is_lossy(Compression compression, const Channel& channel) {
  switch (compression) {
    case Compression::b44:
    case Compression::b44a:
      return channel.type == PixelType::half;
    case Compression::dwaa:
    case Compression::dwab: {
      static constexpr std::array kColors = {"R", "G", "B", "Y", "RY", "BY"};
      const std::string_view name =
          std::string_view(channel.name).substr(channel.name.rfind('.') + 1);
      return channel.type != PixelType::uint32 &&
             std::find(kColors.begin(), kColors.end(), name) != kColors.end();
    }
    default:
      return false;
  }
}

int ImageHeader::find(std::string_view channel) const {
  for (std::size_t i = 0; i < channels.size(); ++i)
    if (channels[i].name == channel) return static_cast<int>(i);
  return -1;
}

}  // namespace brume
