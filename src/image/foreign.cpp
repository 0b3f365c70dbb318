#include "image/foreign.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <mutex>

#include "image/atomic_file.h"
#include "image/foreign_abi.h"
#include "num/error.h"
#include "num/modules.h"

namespace brume::foreign {
namespace {
namespace fs = std::filesystem;

/// The module's table. `where` is for errors.
const brume_image_io& module(const std::string& where) {
  static std::mutex mutex;
  static const brume_image_io* table = nullptr;
  const std::lock_guard lock(mutex);
  if (table) return *table;
  void* entry = module_symbol("image_io.so", "brume_image_io_table");
  if (!entry)
    throw Error(where, "is not an EXR file, and other formats need the image_io module",
                "build with BRUME_WITH_OIIO, or set BRUME_PLUGIN_PATH");
  const brume_image_io* found = reinterpret_cast<brume_image_io_fn>(entry)();
  if (!found || found->version != BRUME_IMAGE_IO_VERSION)
    throw Error(where, "the image_io module belongs to another version of brume");
  return *(table = found);
}

std::string one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

/// An open file of the module.
class Handle {
 public:
  explicit Handle(const fs::path& path) : io_(module(path.string())) {
    char error[512] = "";
    if (io_.open(path.c_str(), &handle_, error, sizeof error) != 0)
      throw Error(path.string(), "cannot be read as an image", one_line(error));
  }
  ~Handle() { io_.close(handle_); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  int parts() const { return io_.parts(handle_); }
  const brume_io_header& header(int part) const { return *io_.header(handle_, part); }
  void read(const fs::path& path, int part, float* const* planes) const {
    char error[512] = "";
    if (io_.read(handle_, part, planes, error, sizeof error) != 0)
      throw Error(path.string(), "is corrupt", one_line(error));
  }

 private:
  const brume_image_io& io_;
  void* handle_ = nullptr;
};

/// `order[i]` is the file's channel that is the header's channel i.
ImageHeader header_of(const brume_io_header& h, const fs::path& path,
                      std::vector<int>& order) {
  ImageHeader out;
  out.data_window = {h.data[0], h.data[1], h.data[2], h.data[3]};
  out.display_window = {h.display[0], h.display[1], h.display[2], h.display[3]};
  out.pixel_aspect = h.pixel_aspect;
  order.clear();
  for (int i = 0; i < h.channel_count; ++i) order.push_back(i);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return std::strcmp(h.channels[a], h.channels[b]) < 0; });
  for (const int i : order) {
    Channel c;
    c.name = h.channels[i];
    c.type = static_cast<PixelType>(h.types[i]);
    out.channels.push_back(std::move(c));
  }
  for (int i = 0; i < h.attribute_count; ++i) {
    const brume_io_attribute& a = h.attributes[i];
    out.attributes[a.name] = {a.type, {a.bytes, a.bytes + a.size}};
  }
  // A small file cannot hold an absurd size: no format packs tighter than this by far.
  constexpr double kBestRatio = 4000, kAlwaysAllowed = 64 << 20;
  std::error_code none;
  const double size = double(fs::file_size(path, none));
  const double pixels = double(out.data_window.width) * out.data_window.height;
  if (out.data_window.empty() || h.channel_count < 1)
    throw Error(path.string(), "holds no pixels");
  if (pixels * h.channel_count > std::max(kAlwaysAllowed, kBestRatio * size))
    throw Error(path.string(), "the file cannot hold the declared size",
                fmt::format("{} x {} pixels declared, {} bytes in the file",
                            out.data_window.width, out.data_window.height, size));
  return out;
}

class Reader : public ImageReader {
 public:
  Reader(const fs::path& path, int part) : handle_(path), part_(part) {
    path_ = path;
    if (part < 0 || part >= handle_.parts())
      throw Error(path.string(), fmt::format("has no part {}", part),
                  fmt::format("{} parts, counted from 0", handle_.parts()));
    header_ = header_of(handle_.header(part), path, order_);
  }
  int band_rows() const override { return 16; }
  bool streams() const override { return false; }
  std::uint64_t bytes_read() const override { return bytes_read_; }

  void read(int y, int rows, std::span<const int> channels,
            std::span<float* const> out) const override {
    std::call_once(once_, [&] { read_all(); });
    const Window& d = header_.data_window;
    for (std::size_t k = 0; k < channels.size(); ++k)
      std::copy_n(planes_[channels[k]].data() + std::size_t(y - d.y) * d.width,
                  std::size_t(rows) * d.width, out[k]);
  }

 private:
  void read_all() const {
    const auto pixels = static_cast<std::size_t>(header_.data_window.pixels());
    planes_.assign(order_.size(), std::vector<float>(pixels));
    std::vector<float*> out(order_.size());
    for (std::size_t i = 0; i < order_.size(); ++i) out[order_[i]] = planes_[i].data();
    handle_.read(path_, part_, out.data());
    std::error_code none;
    bytes_read_ = fs::file_size(path_, none);
  }

  Handle handle_;
  int part_;
  std::vector<int> order_;
  mutable std::once_flag once_;
  mutable std::vector<std::vector<float>> planes_;
  mutable std::atomic<std::uint64_t> bytes_read_ = 0;
};

/// The channels that go into a file of this format, in its order; indices into
/// `channels`.
std::vector<int> order_for(const std::string& format,
                           const std::vector<Channel>& channels,
                           const std::string& where) {
  auto find = [&](std::string_view name) {
    for (std::size_t i = 0; i < channels.size(); ++i)
      if (channels[i].name == name) return static_cast<int>(i);
    return -1;
  };
  std::vector<int> order;
  for (const char* name : {"R", "G", "B", "A"})
    if (const int i = find(name); i >= 0) order.push_back(i);
  const bool rgb =
      order.size() >= 3 && find("R") >= 0 && find("G") >= 0 && find("B") >= 0;
  const bool any_channels = format == "tif" || format == "tiff";
  if (any_channels) {
    for (std::size_t i = 0; i < channels.size(); ++i)
      if (std::find(order.begin(), order.end(), int(i)) == order.end())
        order.push_back(static_cast<int>(i));
    return order;
  }
  const bool no_alpha = format == "jpg" || format == "jpeg" || format == "hdr";
  if (rgb) {
    if (no_alpha) order.resize(3);
    return order;
  }
  if (const int i = find("Y"); i >= 0) return {i};
  if (channels.size() == 1) return {0};
  throw Error(where, "the format ." + format + " holds R, G, B and A",
              "the image has neither these nor a single channel");
}

}  // namespace

std::vector<ImageHeader> read_headers(const fs::path& path) {
  const Handle handle(path);
  std::vector<ImageHeader> headers;
  std::vector<int> order;
  for (int p = 0; p < handle.parts(); ++p)
    headers.push_back(header_of(handle.header(p), path, order));
  return headers;
}

std::unique_ptr<ImageReader> open(const fs::path& path, int part) {
  return std::make_unique<Reader>(path, part);
}

CopyReport copy(const ImageReader& source, const Edit& edit, const fs::path& out,
                const std::function<void(Band&)>& work, const CopyOptions& options) {
  const std::string where = out.string();
  auto stop_if_cancelled = [&] {
    if (options.cancel && *options.cancel) throw Error(where, "interrupted");
  };
  const brume_image_io& io = module(where);
  std::string format = out.extension().string().substr(1);
  std::transform(format.begin(), format.end(), format.begin(), ::tolower);

  // All channels of the output as planes: the edit's first, then those of the source.
  const ImageHeader& from = source.header();
  const Window& d = from.data_window;
  const std::uint64_t bytes_before = source.bytes_read();
  std::vector<Channel> channels;
  std::vector<int> sources;
  for (const Channel& c : edit.channels) {
    sources.push_back(from.find(c.name));
    channels.push_back(sources.back() >= 0 && !edit.retype ? from.channels[sources.back()]
                                                           : c);
  }
  for (std::size_t i = 0; i < from.channels.size() && !edit.only_these; ++i) {
    const auto known =
        std::find_if(channels.begin(), channels.end(),
                     [&](const Channel& c) { return c.name == from.channels[i].name; });
    if (known != channels.end()) continue;
    channels.push_back(from.channels[i]);
    sources.push_back(static_cast<int>(i));
  }
  const std::vector<int> order = order_for(format, channels, where);
  AtomicFile file(out);  // before the work: whether it can be written shows now

  const auto pixels = static_cast<std::size_t>(d.pixels());
  std::vector<std::vector<float>> planes(channels.size(), std::vector<float>(pixels));
  std::vector<std::vector<float>> inputs(edit.read.size(), std::vector<float>(pixels));
  std::vector<int> wanted;
  std::vector<float*> to;
  for (std::size_t i = 0; i < planes.size(); ++i)
    if (sources[i] >= 0) wanted.push_back(sources[i]), to.push_back(planes[i].data());
  for (std::size_t i = 0; i < inputs.size(); ++i)
    wanted.push_back(edit.read[i]), to.push_back(inputs[i].data());
  stop_if_cancelled();
  if (!wanted.empty()) source.read(d.y, d.height, wanted, to);
  if (work && !edit.channels.empty()) {
    constexpr int kRows = 64;  // a band is what one call of `work` sees
    const int rows = options.whole_frame ? d.height : kRows;
    for (int y = 0; y < d.height; y += rows) {
      stop_if_cancelled();
      std::vector<float*> band_out;
      std::vector<const float*> band_in;
      for (std::size_t i = 0; i < edit.channels.size(); ++i)
        band_out.push_back(planes[i].data() + std::size_t(y) * d.width);
      for (const auto& plane : inputs)
        band_in.push_back(plane.data() + std::size_t(y) * d.width);
      Band band{d.y + y, std::min(rows, d.height - y), band_out, band_in, true};
      work(band);
      if (options.progress) options.progress(double(y + band.rows) / d.height);
    }
  }

  std::vector<const char*> names;
  std::vector<std::uint8_t> types;
  std::vector<const float*> data;
  for (const int i : order) {
    names.push_back(channels[i].name.c_str());
    types.push_back(channels[i].type == PixelType::half ? 1 : 2);
    data.push_back(planes[i].data());
  }
  Attributes all = from.attributes;
  for (const auto& [name, value] : edit.attributes) all[name] = value;
  std::vector<brume_io_attribute> attributes;
  for (const auto& [name, value] : all)
    attributes.push_back(
        {name.c_str(), value.type.c_str(), value.bytes.data(), value.bytes.size()});
  const Window& s = from.display_window;
  const brume_io_header header{{d.x, d.y, d.width, d.height},
                               {s.x, s.y, s.width, s.height},
                               from.pixel_aspect,
                               static_cast<std::int32_t>(names.size()),
                               names.data(),
                               types.data(),
                               static_cast<std::int32_t>(attributes.size()),
                               attributes.data()};
  char error[512] = "";
  if (io.write(file.part().c_str(), format.c_str(), &header, data.data(), error,
               sizeof error) != 0)
    throw Error(where, "cannot be written", one_line(error));
  stop_if_cancelled();
  std::error_code none;
  CopyReport report;
  report.bytes_written = fs::file_size(file.part(), none);
  file.commit();
  report.bytes_read = source.bytes_read() - bytes_before;
  return report;
}

}  // namespace brume::foreign
