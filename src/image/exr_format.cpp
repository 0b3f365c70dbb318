#include "image/exr_format.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "num/error.h"

namespace brume::exr {
namespace {

const Attribute* find(const std::vector<NamedAttribute>& all, std::string_view name) {
  for (const NamedAttribute& a : all)
    if (a.name == name) return &a.value;
  return nullptr;
}

template <class T>
T load(const std::uint8_t* p) {
  T v;
  std::memcpy(&v, p, sizeof v);
  return v;
}

template <class T>
void append(std::vector<std::uint8_t>& bytes, T v) {
  bytes.resize(bytes.size() + sizeof v);
  std::memcpy(bytes.data() + bytes.size() - sizeof v, &v, sizeof v);
}

void append(std::vector<std::uint8_t>& bytes, const std::string& text) {
  bytes.insert(bytes.end(), text.begin(), text.end());
  bytes.push_back(0);
}

/// Attributes that ImageHeader holds as members of its own.
constexpr std::string_view kMembers[] = {
    "channels", "compression", "dataWindow", "displayWindow",       "pixelAspectRatio",
    "name",     "view",        "type",       "dwaCompressionLevel", "chunkCount"};

// The `channels` attribute: name, type, flags and samplings of each, ended by an empty
// name.
std::vector<Channel> parse_channels(const Attribute& a, const std::string& where) {
  std::vector<Channel> channels;
  const std::uint8_t *p = a.bytes.data(), *end = p + a.bytes.size();
  for (;;) {
    const auto* stop = std::find(p, end, 0);
    if (stop == end) throw Error(where, "the channel list ends early");
    if (stop == p) break;
    Channel c;
    c.name.assign(p, stop);
    p = stop + 1;
    if (end - p < 16) throw Error(where, "the channel list ends early");
    const auto type = load<std::uint32_t>(p);
    c.perceptually_linear = p[4] != 0;
    c.x_sampling = load<std::int32_t>(p + 8);
    c.y_sampling = load<std::int32_t>(p + 12);
    p += 16;
    if (type > 2)
      throw Error(where,
                  fmt::format("channel {} has unknown type {}", printable(c.name), type));
    c.type = static_cast<PixelType>(type);
    if (c.x_sampling < 1 || c.y_sampling < 1)
      throw Error(where, fmt::format("channel {} has sampling {} x {}", printable(c.name),
                                     c.x_sampling, c.y_sampling));
    channels.push_back(std::move(c));
  }
  if (channels.empty()) throw Error(where, "has no channels");
  std::sort(channels.begin(), channels.end(),
            [](const Channel& x, const Channel& y) { return x.name < y.name; });
  for (std::size_t i = 1; i < channels.size(); ++i)
    if (channels[i].name == channels[i - 1].name)
      throw Error(where,
                  fmt::format("channel {} occurs twice", printable(channels[i].name)));
  return channels;
}

Attribute channels_attribute(const std::vector<Channel>& channels) {
  Attribute a{"chlist", {}};
  for (const Channel& c : channels) {
    append(a.bytes, c.name);
    append<std::uint32_t>(a.bytes, static_cast<std::uint32_t>(c.type));
    append<std::uint32_t>(a.bytes, c.perceptually_linear);
    append<std::int32_t>(a.bytes, c.x_sampling);
    append<std::int32_t>(a.bytes, c.y_sampling);
  }
  a.bytes.push_back(0);
  return a;
}

Window parse_window(const Attribute& a, const std::string& name,
                    const std::string& where) {
  if (a.type != "box2i" || a.bytes.size() != 16) throw Error(where, name + " is corrupt");
  std::int64_t v[4];
  for (int i = 0; i < 4; ++i) v[i] = load<std::int32_t>(&a.bytes[4 * i]);
  constexpr std::int64_t kFarthest = 1 << 30;
  for (const std::int64_t c : v)
    if (c <= -kFarthest || c >= kFarthest)
      throw Error(where, fmt::format("{} reaches to {}", name, c));
  if (v[2] < v[0] || v[3] < v[1])
    throw Error(where, fmt::format("{} is empty ({} x {} pixels)", name, v[2] - v[0] + 1,
                                   v[3] - v[1] + 1));
  return {int(v[0]), int(v[1]), int(v[2] - v[0] + 1), int(v[3] - v[1] + 1)};
}

Attribute window_attribute(const Window& w) {
  Attribute a{"box2i", {}};
  for (const std::int32_t v : {w.x, w.y, w.right() - 1, w.bottom() - 1})
    append(a.bytes, v);
  return a;
}

Tiles parse_tiles(const Attribute* a, const std::string& where) {
  if (!a || a->type != "tiledesc" || a->bytes.size() != 9)
    throw Error(where, "tiled, but its tile description is missing or corrupt");
  Tiles t;
  t.width = load<std::uint32_t>(&a->bytes[0]);
  t.height = load<std::uint32_t>(&a->bytes[4]);
  const int levels = a->bytes[8] & 15, rounding = a->bytes[8] >> 4;
  constexpr std::uint32_t kLargest = 1u << 24;
  if (t.width == 0 || t.height == 0 || t.width > kLargest || t.height > kLargest)
    throw Error(where, fmt::format("tiles of {} x {} pixels", t.width, t.height));
  if (levels > 2 || rounding > 1) throw Error(where, "unknown kind of tile levels");
  t.levels = static_cast<Tiles::Levels>(levels);
  t.round_up = rounding == 1;
  return t;
}

}  // namespace

std::string printable(std::string_view name) {
  constexpr std::size_t kLongest = 80;
  std::string text(name.substr(0, kLongest));
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  return name.size() > kLongest ? text + "..." : text;
}

void understand(Part& part, std::uint32_t flags, const std::string& where) {
  ImageHeader& h = part.header;
  auto need = [&](const char* name, const char* type,
                  std::size_t size) -> const Attribute& {
    const Attribute* a = find(part.attributes, name);
    if (!a) throw Error(where, fmt::format("the header has no {}", name));
    if (a->type != type || (size && a->bytes.size() != size))
      throw Error(where, fmt::format("{} is corrupt", name));
    return *a;
  };
  auto text_of = [&](const char* name) {
    const Attribute* a = find(part.attributes, name);
    return a ? a->text().value_or("") : std::string();
  };
  h.part_name = text_of("name");
  h.view = text_of("view");

  // Scanline, tiled or deep: by the type attribute, else by the version flags.
  const std::string type = text_of("type");
  if (type.empty()) {
    if (flags & kMultiPartFlag) throw Error(where, "a part has no type");
    h.tiled = flags & kTiledFlag;
    h.deep = flags & kDeepFlag;
  } else if (type == "scanlineimage" || type == "tiledimage" || type == "deepscanline" ||
             type == "deeptile") {
    h.deep = type.starts_with("deep");
    h.tiled = type == "tiledimage" || type == "deeptile";
    // As OpenEXR reads single-part flat files: the flag decides.
    if (!(flags & (kMultiPartFlag | kDeepFlag)))
      h.tiled = flags & kTiledFlag, h.deep = false;
  } else {
    throw Error(where, fmt::format("part type {} is unknown", printable(type)));
  }

  h.channels = parse_channels(need("channels", "chlist", 0), where);
  h.data_window = parse_window(need("dataWindow", "box2i", 16), "data window", where);
  h.display_window =
      parse_window(need("displayWindow", "box2i", 16), "display window", where);
  const std::uint8_t compression = need("compression", "compression", 1).bytes[0];
  if (compression > 9)
    throw Error(where, fmt::format("compression {} is unknown", compression));
  h.compression = static_cast<Compression>(compression);
  const std::uint8_t order = need("lineOrder", "lineOrder", 1).bytes[0];
  if (order > 2) throw Error(where, fmt::format("line order {} is unknown", order));
  part.line_order = static_cast<LineOrder>(order);
  h.pixel_aspect = load<float>(need("pixelAspectRatio", "float", 4).bytes.data());
  if (!(h.pixel_aspect > 0) || !std::isfinite(h.pixel_aspect))
    throw Error(where, fmt::format("pixel aspect ratio {}", h.pixel_aspect));
  if (const Attribute* a = find(part.attributes, "dwaCompressionLevel"))
    if (a->type == "float" && a->bytes.size() == 4)
      h.dwa_level = load<float>(a->bytes.data());
  if (h.tiled) part.tiles = parse_tiles(find(part.attributes, "tiles"), where);

  // Every channel's samples must come out even, and a chunk stay below 2 GB.
  const Window& d = h.data_window;
  double row_bytes = 0;
  for (const Channel& c : h.channels) {
    if (h.tiled && (c.x_sampling != 1 || c.y_sampling != 1))
      throw Error(where, fmt::format("channel {} is subsampled in a tiled image",
                                     printable(c.name)));
    if (floor_mod(d.x, c.x_sampling) || d.width % c.x_sampling ||
        floor_mod(d.y, c.y_sampling) || d.height % c.y_sampling)
      throw Error(where, fmt::format("the sampling {} x {} of channel {} does not divide "
                                     "the data window",
                                     c.x_sampling, c.y_sampling, printable(c.name)));
    // OpenEXR's codecs want every chunk to begin on a row that has samples.
    if (h.compression >= Compression::piz && part.chunk_lines() % c.y_sampling)
      throw Error(where,
                  fmt::format("channel {} has vertical sampling {}, which {} "
                              "cannot hold",
                              printable(c.name), c.y_sampling, name(h.compression)));
    row_bytes += bytes_per_sample(c.type);
  }
  const double chunk_width =
      part.tiles ? std::min<double>(part.tiles->width, d.width) : d.width;
  const double chunk_lines = std::min<double>(part.chunk_lines(), d.height);
  if (row_bytes * chunk_width * chunk_lines > std::numeric_limits<std::int32_t>::max())
    throw Error(where, fmt::format("{} x {} pixels of {} channels are too large", d.width,
                                   d.height, h.channels.size()));

  for (const NamedAttribute& a : part.attributes)
    if (std::find(std::begin(kMembers), std::end(kMembers), a.name) == std::end(kMembers))
      h.attributes[a.name] = a.value;
}

std::vector<NamedAttribute> attributes_of(const ImageHeader& h,
                                          std::vector<NamedAttribute> keep,
                                          std::optional<std::int64_t> chunk_count) {
  auto set = [&](const std::string& name, Attribute value) {
    for (NamedAttribute& a : keep)
      if (a.name == name) return void(a.value = std::move(value));
    keep.push_back({name, std::move(value)});
  };
  auto set_default = [&](const std::string& name, Attribute value) {
    if (!find(keep, name)) keep.push_back({name, std::move(value)});
  };
  set("channels", channels_attribute(h.channels));
  set("compression", {"compression", {static_cast<std::uint8_t>(h.compression)}});
  set("dataWindow", window_attribute(h.data_window));
  set("displayWindow", window_attribute(h.display_window));
  set("pixelAspectRatio", Attribute::from_float(h.pixel_aspect));
  for (const auto& [name, value] : h.attributes) set(name, value);
  if (!h.part_name.empty()) set("name", Attribute::from_text(h.part_name));
  if (!h.view.empty()) set("view", Attribute::from_text(h.view));
  if (h.dwa_level) set("dwaCompressionLevel", Attribute::from_float(*h.dwa_level));
  set_default("lineOrder", {"lineOrder", {0}});
  set_default("screenWindowCenter",
              Attribute::from_floats("v2f", std::vector<float>{0.0f, 0.0f}));
  set_default("screenWindowWidth", Attribute::from_float(1));
  if (chunk_count && find(keep, "chunkCount")) {
    Attribute a{"int", {}};
    append(a.bytes, static_cast<std::int32_t>(*chunk_count));
    set("chunkCount", a);
  }
  return keep;
}

std::vector<std::uint8_t> serialize(const std::vector<std::vector<NamedAttribute>>& parts,
                                    std::uint32_t flags) {
  std::vector<std::uint8_t> bytes;
  append(bytes, kMagic);
  append(bytes, std::uint32_t(0));  // version and flags: known at the end
  constexpr std::size_t kShortName = 31;
  for (const auto& attributes : parts) {
    for (const NamedAttribute& a : attributes) {
      if (a.name.size() > kShortName || a.value.type.size() > kShortName)
        flags |= kLongNamesFlag;
      append(bytes, a.name);
      append(bytes, a.value.type);
      append(bytes, static_cast<std::uint32_t>(a.value.bytes.size()));
      bytes.insert(bytes.end(), a.value.bytes.begin(), a.value.bytes.end());
      if (a.name == "channels")
        for (const Channel& c : parse_channels(a.value, "channels"))
          if (c.name.size() > kShortName) flags |= kLongNamesFlag;
    }
    bytes.push_back(0);
  }
  if (flags & kMultiPartFlag) bytes.push_back(0);
  const std::uint32_t version = 2u | flags;
  std::memcpy(&bytes[4], &version, 4);
  return bytes;
}

}  // namespace brume::exr
