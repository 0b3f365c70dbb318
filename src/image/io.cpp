#include "image/io.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "image/exr_copy.h"
#include "image/exr_reader.h"
#include "image/foreign.h"
#include "num/error.h"

namespace brume {
namespace {

bool starts_as_exr(const std::filesystem::path& path) {
  std::error_code none;
  if (std::filesystem::is_directory(path, none))
    throw Error(path.string(), "is a directory");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(path.string(), std::strerror(errno));
  std::uint32_t magic = 0;
  file.read(reinterpret_cast<char*>(&magic), sizeof magic);
  return magic == exr::kMagic;
}

/// An Image as a source to write from.
class MemoryReader : public ImageReader {
 public:
  MemoryReader(const Image& image, const std::filesystem::path& path) : image_(image) {
    path_ = path;
    header_ = image.header;
    const auto pixels = static_cast<std::size_t>(header_.data_window.pixels());
    if (image.planes.size() != header_.channels.size())
      throw Error(path.string(),
                  fmt::format("{} channels but {} planes", header_.channels.size(),
                              image.planes.size()));
    for (std::size_t i = 0; i < image.planes.size(); ++i)
      if (image.planes[i].size() != pixels)
        throw Error(path.string(), fmt::format("channel {} has {} values for {} pixels",
                                               header_.channels[i].name,
                                               image.planes[i].size(), pixels));
  }
  int band_rows() const override { return 1; }
  bool streams() const override { return false; }
  void read(int y, int rows, std::span<const int> channels,
            std::span<float* const> out) const override {
    const Window& d = header_.data_window;
    for (std::size_t k = 0; k < channels.size(); ++k)
      std::copy_n(image_.planes[channels[k]].data() + std::size_t(y - d.y) * d.width,
                  std::size_t(rows) * d.width, out[k]);
  }
  std::uint64_t bytes_read() const override { return 0; }

 private:
  const Image& image_;
};

}  // namespace

std::vector<ImageHeader> read_headers(const std::filesystem::path& path) {
  if (!starts_as_exr(path)) return foreign::read_headers(path);
  const exr::File file(path);
  std::vector<ImageHeader> headers;
  for (const exr::Part& part : file.parts()) headers.push_back(part.header);
  return headers;
}

std::unique_ptr<ImageReader> open_image(const std::filesystem::path& path, int part) {
  if (!starts_as_exr(path)) return foreign::open(path, part);
  return std::make_unique<exr::Reader>(std::make_shared<exr::File>(path), part);
}

CopyReport copy_edited(const ImageReader& source, const Edit& edit,
                       const std::filesystem::path& out,
                       const std::function<void(Band&)>& work,
                       const CopyOptions& options) {
  std::string extension = out.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), ::tolower);
  if (extension.size() < 2)
    throw Error(out.string(), "has no extension that names a format",
                "frame.exr, frame.png ...");
  if (extension == ".exr") return exr::copy(source, edit, out, work, options);
  return foreign::copy(source, edit, out, work, options);
}

Image read_image(const std::filesystem::path& path, int part,
                 std::span<const std::string> names) {
  const std::unique_ptr<ImageReader> reader = open_image(path, part);
  Image image{reader->header(), {}};
  std::vector<int> channels;
  if (names.empty()) {
    for (std::size_t i = 0; i < image.header.channels.size(); ++i)
      channels.push_back(static_cast<int>(i));
  } else {
    for (const std::string& name : names) {
      const int i = reader->header().find(name);
      if (i < 0) throw Error(path.string(), "has no channel " + name);
      if (std::find(channels.begin(), channels.end(), i) == channels.end())
        channels.push_back(i);
    }
    std::sort(channels.begin(), channels.end());
    image.header.channels.clear();
    for (const int i : channels)
      image.header.channels.push_back(reader->header().channels[i]);
  }
  const Window& d = image.header.data_window;
  image.planes.resize(channels.size());
  for (auto& plane : image.planes) plane.resize(static_cast<std::size_t>(d.pixels()));
  const int rows = reader->band_rows(), bands = (d.height + rows - 1) / rows;
  tbb::parallel_for(0, bands, [&](int b) {
    const int y = b * rows;
    std::vector<float*> out;
    for (auto& plane : image.planes)
      out.push_back(plane.data() + std::size_t(y) * d.width);
    reader->read(d.y + y, std::min(rows, d.height - y), channels, out);
  });
  return image;
}

CopyReport write_image(const Image& image, const std::filesystem::path& out) {
  const MemoryReader source(image, out);
  return copy_edited(source, {}, out, {});
}

}  // namespace brume
