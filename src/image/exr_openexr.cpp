// The module openexr.so: OpenEXR's own codecs on single chunks. The C++ library is asked
// through files in memory that hold one chunk each: OpenEXRCore 3.1 has no DWA.

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfTiledInputFile.h>
#include <ImfTiledOutputFile.h>

#include <cstring>
#include <stdexcept>

#include "image/openexr_module.h"

namespace brume::exr {
namespace {

class MemoryInput : public Imf::IStream {
 public:
  explicit MemoryInput(std::vector<std::uint8_t> bytes)
      : Imf::IStream("chunk"), bytes_(std::move(bytes)) {}
  bool read(char c[], int n) override {
    if (n < 0 || static_cast<std::size_t>(n) > bytes_.size() - at_)
      throw std::runtime_error("ends early");
    std::memcpy(c, &bytes_[at_], n);
    at_ += n;
    return at_ < bytes_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t at) override {
    if (at > bytes_.size()) throw std::runtime_error("ends early");
    at_ = at;
  }

 private:
  std::vector<std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

class MemoryOutput : public Imf::OStream {
 public:
  explicit MemoryOutput(std::vector<std::uint8_t>& bytes)
      : Imf::OStream("chunk"), bytes_(bytes) {}
  void write(const char c[], int n) override {
    if (at_ + n > bytes_.size()) bytes_.resize(at_ + n);
    std::memcpy(&bytes_[at_], c, n);
    at_ += n;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t at) override { at_ = at; }

 private:
  std::vector<std::uint8_t>& bytes_;
  std::size_t at_ = 0;
};

/// The chunk as an image of its own: scanline where its rows are one chunk's, else one
/// tile.
bool as_tile(const ImageHeader& h, const Window& w) {
  return h.tiled || w.height > lines_per_chunk(h.compression);
}

Imf::Header chunk_header(const ImageHeader& h, const Window& w) {
  const Imath::Box2i box({w.x, w.y}, {w.right() - 1, w.bottom() - 1});
  Imf::Header header(box, box);
  header.compression() = static_cast<Imf::Compression>(h.compression);
  for (const Channel& c : h.channels)
    header.channels().insert(
        c.name, Imf::Channel(static_cast<Imf::PixelType>(c.type), c.x_sampling,
                             c.y_sampling, c.perceptually_linear));
  if (h.dwa_level) header.dwaCompressionLevel() = *h.dwa_level;
  if (as_tile(h, w)) header.setTileDescription(Imf::TileDescription(w.width, w.height));
  return header;
}

/// Slices into planes, one per channel, one after the other (the layout of the chunk
/// where every row has every channel differs only in strides).
struct Planes {
  std::vector<std::size_t> start, row_bytes;
  Imf::FrameBuffer buffer;
  std::vector<char> memory;

  Planes(const ImageHeader& h, const Window& w, char* pixels, const ChunkLayout& layout) {
    std::size_t at = 0;
    for (std::size_t i = 0; i < h.channels.size(); ++i) {
      const Channel& c = h.channels[i];
      start.push_back(at);
      row_bytes.push_back(std::size_t(sample_count(w.x, w.width, c.x_sampling)) *
                          bytes_per_sample(c.type));
      at += row_bytes.back() * sample_count(w.y, w.height, c.y_sampling);
    }
    if (!layout.regular()) memory.resize(at);
    for (std::size_t i = 0; i < h.channels.size(); ++i) {
      const Channel& c = h.channels[i];
      const auto x_stride = static_cast<std::ptrdiff_t>(bytes_per_sample(c.type));
      const auto y_stride = static_cast<std::ptrdiff_t>(
          layout.regular() ? layout.row_offset(1) : row_bytes[i]);
      char* base =
          layout.regular() ? pixels + layout.offset(i, 0) : memory.data() + start[i];
      base -= floor_div(w.x, c.x_sampling) * x_stride;
      base -= floor_div(w.y, c.y_sampling) * y_stride;
      buffer.insert(c.name, Imf::Slice(static_cast<Imf::PixelType>(c.type), base,
                                       x_stride, y_stride, c.x_sampling, c.y_sampling));
    }
  }

  /// Between planes and the chunk's order, for chunks with channels that skip rows.
  void copy(const ImageHeader& h, const Window& w, char* pixels,
            const ChunkLayout& layout, bool to_chunk) {
    for (std::size_t i = 0; i < h.channels.size(); ++i)
      for (int r = 0, n = 0; r < w.height; ++r) {
        if (layout.samples(i, r) == 0) continue;
        char* plane = memory.data() + start[i] + row_bytes[i] * n++;
        char* chunk = pixels + layout.offset(i, r);
        std::memcpy(to_chunk ? chunk : plane, to_chunk ? plane : chunk, row_bytes[i]);
      }
  }
};

void unpack(const ImageHeader& h, const Window& w, std::span<const std::uint8_t> payload,
            std::span<std::uint8_t> pixels) {
  // Header, a table of one offset, the chunk's coordinates and size, the chunk.
  std::vector<std::uint8_t> file;
  const bool tile = as_tile(h, w);
  {
    MemoryOutput out(file);
    const char start[8] = {0x76, 0x2f, 0x31, 0x01, 2, static_cast<char>(tile ? 2 : 0),
                           0,    0};
    out.write(start, 8);
    Imf::Header header = chunk_header(h, w);
    header.writeTo(out, tile);
    for (const Channel& c : h.channels)
      if (c.name.size() > 31) file[5] |= kLongNamesFlag >> 8;
  }
  auto append = [&](auto value) {
    const auto* p = reinterpret_cast<const std::uint8_t*>(&value);
    file.insert(file.end(), p, p + sizeof value);
  };
  append(static_cast<std::uint64_t>(file.size() + 8));
  if (tile)
    for (int i = 0; i < 4; ++i) append(std::int32_t(0));
  else
    append(static_cast<std::int32_t>(w.y));
  append(static_cast<std::int32_t>(payload.size()));
  file.insert(file.end(), payload.begin(), payload.end());

  MemoryInput in(std::move(file));
  const ChunkLayout layout(h.channels, w);
  Planes planes(h, w, reinterpret_cast<char*>(pixels.data()), layout);
  if (tile) {
    Imf::TiledInputFile image(in, 0);
    image.setFrameBuffer(planes.buffer);
    image.readTile(0, 0);
  } else {
    Imf::InputFile image(in, 0);
    image.setFrameBuffer(planes.buffer);
    image.readPixels(w.y, w.bottom() - 1);
  }
  if (!layout.regular())
    planes.copy(h, w, reinterpret_cast<char*>(pixels.data()), layout, true);
}

void pack(const ImageHeader& h, const Window& w, std::span<const std::uint8_t> pixels,
          std::vector<std::uint8_t>& payload) {
  const bool tile = as_tile(h, w);
  const ChunkLayout layout(h.channels, w);
  auto* memory = const_cast<char*>(reinterpret_cast<const char*>(pixels.data()));
  Planes planes(h, w, memory, layout);
  if (!layout.regular()) planes.copy(h, w, memory, layout, false);
  std::vector<std::uint8_t> file;
  std::uint64_t table = 0;
  {
    MemoryOutput out(file);
    if (tile) {
      Imf::TiledOutputFile image(out, chunk_header(h, w), 0);
      table = file.size() - 8;
      image.setFrameBuffer(planes.buffer);
      image.writeTile(0, 0);
    } else {
      Imf::OutputFile image(out, chunk_header(h, w), 0);
      table = file.size() - 8;
      image.setFrameBuffer(planes.buffer);
      image.writePixels(w.height);
    }
  }
  std::uint64_t at;
  std::memcpy(&at, &file[table], 8);
  payload.assign(file.begin() + static_cast<std::ptrdiff_t>(at) + (tile ? 20 : 8),
                 file.end());
}

}  // namespace
}  // namespace brume::exr

extern "C" const brume::exr::OpenExrCodecs* brume_openexr_codecs() {
  static const brume::exr::OpenExrCodecs codecs{.unpack = brume::exr::unpack,
                                                .pack = brume::exr::pack};
  return &codecs;
}
