#include "image/oracle.h"

#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfStringAttribute.h>
#include <ImfTiledOutputPart.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <random>

namespace brume::oracle {

std::filesystem::path temp_folder() {
  const std::filesystem::path memory = "/dev/shm";
  std::error_code none;
  return std::filesystem::is_directory(memory, none)
             ? memory
             : std::filesystem::temp_directory_path();
}

TempFile::TempFile(const std::string& name)
    : path(temp_folder() / ("brume_" + std::to_string(::getpid()) + "_" + name)) {}

TempFile::~TempFile() {
  std::error_code none;
  std::filesystem::remove(path, none);
}

namespace {

int size_of(PixelType t) { return t == PixelType::half ? 2 : 4; }
int floor_div(int a, int b) { return (a - ((a % b) + b) % b) / b; }

/// Raw samples of a channel, as they are to lie in the file.
std::vector<char> samples(const Channel& c, const Window& w, std::mt19937& random,
                          bool special) {
  const int nx = w.width / c.x_sampling, ny = w.height / c.y_sampling;
  std::vector<char> bytes(std::size_t(nx) * ny * size_of(c.type));
  const float fx = 0.1f + 0.01f * float(random() % 50),
              fy = 0.1f + 0.01f * float(random() % 50);
  for (int y = 0; y < ny; ++y)
    for (int x = 0; x < nx; ++x) {
      char* to = &bytes[(std::size_t(y) * nx + x) * size_of(c.type)];
      float v = 2 + std::sin(fx * float(x)) + std::cos(fy * float(y));
      if (x > nx / 2) v += float(random() % 1000) * 1e-3f;
      if (c.type == PixelType::half) {
        Imath::half h(v);
        if (special && random() % 8 == 0)
          h.setBits(static_cast<unsigned short>(random()));
        std::memcpy(to, &h, 2);
      } else {
        std::uint32_t u;
        std::memcpy(&u, &v, 4);
        if (c.type == PixelType::uint32) u = x > nx / 2 ? random() : random() % 1000;
        if (special && random() % 8 == 0) u = random();
        std::memcpy(to, &u, 4);
      }
    }
  return bytes;
}

/// IEEE binary16 by its definition; NaN by their bits (a float register may quiet them).
float decode_half(std::uint32_t h) {
  const int exponent = h >> 10 & 31, mantissa = h & 1023;
  float v = exponent == 0 ? std::ldexp(float(mantissa), -24)
                          : std::ldexp(float(1024 + mantissa), exponent - 25);
  std::uint32_t bits;
  std::memcpy(&bits, &v, 4);
  if (exponent == 31) bits = 0x7f800000 | std::uint32_t(mantissa) << 13;
  bits |= (h & 0x8000) << 16;
  std::memcpy(&v, &bits, 4);
  return v;
}

/// An attribute of a type that OpenEXR does not know.
struct Unknown : Imf::Attribute {
  std::string type, bytes;
  Unknown(std::string t, std::string b) : type(std::move(t)), bytes(std::move(b)) {}
  const char* typeName() const override { return type.c_str(); }
  Attribute* copy() const override { return new Unknown(type, bytes); }
  void writeValueTo(Imf::OStream& out, int) const override {
    out.write(bytes.data(), int(bytes.size()));
  }
  void readValueFrom(Imf::IStream&, int, int) override {}
  void copyValueFrom(const Attribute&) override {}
};

Imf::Header header_of(const Spec& s) {
  auto box = [](const Window& w) {
    return Imath::Box2i({w.x, w.y}, {w.right() - 1, w.bottom() - 1});
  };
  Imf::Header h(box(s.display), box(s.data));
  h.compression() = static_cast<Imf::Compression>(s.compression);
  h.lineOrder() = static_cast<Imf::LineOrder>(s.line_order);
  for (const Channel& c : s.channels)
    h.channels().insert(c.name,
                        Imf::Channel(static_cast<Imf::PixelType>(c.type), c.x_sampling,
                                     c.y_sampling, c.perceptually_linear));
  if (s.tiled)
    h.setTileDescription(Imf::TileDescription(
        s.tile_width, s.tile_height, static_cast<Imf::LevelMode>(s.levels),
        static_cast<Imf::LevelRoundingMode>(s.rounding)));
  h.setType(s.tiled ? "tiledimage" : "scanlineimage");
  if (!s.part_name.empty()) h.setName(s.part_name);
  if (!s.view.empty()) h.setView(s.view);
  for (const Spec::Extra& a : s.attributes) {
    if (a.type == "string")
      h.insert(a.name, Imf::StringAttribute(a.bytes));
    else
      h.insert(a.name, Unknown(a.type, a.bytes));
  }
  return h;
}

}  // namespace

void write(const std::vector<Spec>& parts, const std::filesystem::path& path,
           unsigned seed, bool special) {
  std::mt19937 random(seed);
  std::vector<Imf::Header> headers;
  for (const Spec& s : parts) headers.push_back(header_of(s));
  Imf::MultiPartOutputFile file(path.c_str(), headers.data(), int(headers.size()));
  for (int p = 0; p < int(parts.size()); ++p) {
    const Spec& s = parts[p];
    std::vector<std::vector<char>> memory;
    Imf::FrameBuffer buffer;
    for (const Channel& c : s.channels) {
      memory.push_back(samples(c, s.data, random, special));
      const auto x_stride = std::ptrdiff_t(size_of(c.type));
      const auto y_stride = x_stride * (s.data.width / c.x_sampling);
      char* base = memory.back().data() - floor_div(s.data.x, c.x_sampling) * x_stride -
                   floor_div(s.data.y, c.y_sampling) * y_stride;
      buffer.insert(c.name, Imf::Slice(static_cast<Imf::PixelType>(c.type), base,
                                       x_stride, y_stride, c.x_sampling, c.y_sampling));
    }
    if (s.tiled) {
      Imf::TiledOutputPart part(file, p);
      part.setFrameBuffer(buffer);
      // Smaller levels are cut-outs of the first: what they show does not matter here.
      for (int ly = 0; ly < part.numYLevels(); ++ly)
        for (int lx = 0; lx < part.numXLevels(); ++lx)
          if (part.isValidLevel(lx, ly))
            part.writeTiles(0, part.numXTiles(lx) - 1, 0, part.numYTiles(ly) - 1, lx, ly);
    } else {
      Imf::OutputPart part(file, p);
      part.setFrameBuffer(buffer);
      part.writePixels(s.data.height);
    }
  }
}

void write_deep(const std::filesystem::path& path) {
  Imf::Header header(4, 4);
  header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
  header.compression() = Imf::ZIPS_COMPRESSION;
  header.setType("deepscanline");
  std::vector<unsigned> counts(16, 1);
  std::vector<float> z(16, 2.0f);
  std::vector<float*> samples;
  for (float& v : z) samples.push_back(&v);
  Imf::DeepFrameBuffer buffer;
  buffer.insertSampleCountSlice(
      Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()), 4, 16));
  buffer.insert("Z", Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(samples.data()),
                                    sizeof(float*), 4 * sizeof(float*), sizeof(float)));
  Imf::DeepScanLineOutputFile file(path.c_str(), header);
  file.setFrameBuffer(buffer);
  file.writePixels(4);
}

void write(const Spec& s, const std::filesystem::path& path, unsigned seed,
           bool special) {
  write(std::vector<Spec>{s}, path, seed, special);
}

namespace {

struct Raw {
  Imf::Channel channel;
  std::vector<char> samples;
};

std::vector<Raw> read_samples(const std::filesystem::path& path, int p, int& width,
                              int& height) {
  Imf::MultiPartInputFile file(path.c_str());
  Imf::InputPart part(file, p);
  const Imath::Box2i d = part.header().dataWindow();
  width = d.max.x - d.min.x + 1, height = d.max.y - d.min.y + 1;
  Imf::FrameBuffer buffer;
  std::vector<Raw> all;
  const Imf::ChannelList& channels = part.header().channels();
  for (auto i = channels.begin(); i != channels.end(); ++i) {
    const Imf::Channel& c = i.channel();
    const int nx = width / c.xSampling, ny = height / c.ySampling;
    const auto x_stride = std::ptrdiff_t(c.type == Imf::HALF ? 2 : 4);
    all.push_back({c, std::vector<char>(std::size_t(nx) * ny * x_stride)});
    char* base = all.back().samples.data() - floor_div(d.min.x, c.xSampling) * x_stride -
                 floor_div(d.min.y, c.ySampling) * x_stride * nx;
    buffer.insert(i.name(), Imf::Slice(c.type, base, x_stride, x_stride * nx, c.xSampling,
                                       c.ySampling));
  }
  part.setFrameBuffer(buffer);
  part.readPixels(d.min.y, d.max.y);
  return all;
}

}  // namespace

std::vector<std::vector<char>> read_raw(const std::filesystem::path& path, int part) {
  int width = 0, height = 0;
  std::vector<std::vector<char>> all;
  for (Raw& r : read_samples(path, part, width, height))
    all.push_back(std::move(r.samples));
  return all;
}

Planes read(const std::filesystem::path& path, int part) {
  int width = 0, height = 0;
  Planes planes;
  for (const Raw& r : read_samples(path, part, width, height)) {
    const Imf::Channel& c = r.channel;
    const std::size_t size = c.type == Imf::HALF ? 2 : 4;
    std::vector<float> plane(std::size_t(width) * height);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const std::size_t at =
            std::size_t(y / c.ySampling) * (width / c.xSampling) + x / c.xSampling;
        float& to = plane[std::size_t(y) * width + x];
        std::uint32_t u = 0;
        std::memcpy(&u, &r.samples[at * size], size);
        if (c.type == Imf::UINT)
          to = float(u);
        else if (c.type == Imf::FLOAT)
          std::memcpy(&to, &u, 4);
        else
          to = decode_half(u);
      }
    planes.push_back(std::move(plane));
  }
  return planes;
}

}  // namespace brume::oracle
