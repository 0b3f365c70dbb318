// OpenImageIO behind the C table of image/foreign_abi.h.

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstring>
#include <deque>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "image/foreign_abi.h"

namespace {

using OIIO::ImageInput;
using OIIO::ImageOutput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

void say(char* error, std::size_t size, const std::string& text) {
  if (size) std::snprintf(error, size, "%s", text.c_str());
}

/// An attribute in EXR's words; the strings it points to live here.
struct OwnedAttribute {
  std::string name, type;
  std::vector<std::uint8_t> bytes;
};

struct Part {
  ImageSpec spec;
  std::vector<const char*> names;
  std::vector<std::uint8_t> types;
  std::deque<OwnedAttribute> owned;
  std::vector<brume_io_attribute> attributes;
  brume_io_header header{};
};

struct File {
  std::unique_ptr<ImageInput> input;
  std::vector<std::unique_ptr<Part>> parts;
};

void add_attribute(Part& part, const OIIO::ParamValue& p) {
  const TypeDesc t = p.type();
  const char* type = nullptr;
  if (t == TypeDesc::STRING)
    type = "string";
  else if (t == TypeDesc::INT)
    type = "int";
  else if (t == TypeDesc::FLOAT)
    type = "float";
  else if (t.basetype == TypeDesc::FLOAT && t.aggregate == TypeDesc::MATRIX44 &&
           !t.arraylen)
    type = "m44f";
  else if (t.basetype == TypeDesc::FLOAT && t.aggregate == TypeDesc::VEC3 && !t.arraylen)
    type = "v3f";
  if (!type) return;
  OwnedAttribute a{std::string(p.name()), type, {}};
  // OpenImageIO's spelling of the two that EXR writes otherwise.
  if (a.name == "worldtocamera") a.name = "worldToCamera";
  if (a.name == "worldtoNDC") a.name = "worldToNDC";
  if (t == TypeDesc::STRING) {
    const std::string text = p.get_string();
    a.bytes.assign(text.begin(), text.end());
  } else {
    const auto* bytes = static_cast<const std::uint8_t*>(p.data());
    a.bytes.assign(bytes, bytes + p.datasize());
  }
  part.owned.push_back(std::move(a));
  const OwnedAttribute& kept = part.owned.back();
  part.attributes.push_back(
      {kept.name.c_str(), kept.type.c_str(), kept.bytes.data(), kept.bytes.size()});
}

std::unique_ptr<Part> describe(const ImageSpec& spec) {
  auto part = std::make_unique<Part>();
  part->spec = spec;
  for (int c = 0; c < spec.nchannels; ++c) {
    part->names.push_back(part->spec.channelnames[c].c_str());
    const TypeDesc t = spec.channelformat(c);
    const bool small = t == TypeDesc::UINT8 || t == TypeDesc::INT8 || t == TypeDesc::HALF;
    part->types.push_back(small ? 1 : 2);
  }
  for (const OIIO::ParamValue& p : spec.extra_attribs) add_attribute(*part, p);
  part->header = {{spec.x, spec.y, spec.width, spec.height},
                  {spec.full_x, spec.full_y, spec.full_width, spec.full_height},
                  spec.get_float_attribute("PixelAspectRatio", 1),
                  spec.nchannels,
                  part->names.data(),
                  part->types.data(),
                  static_cast<std::int32_t>(part->attributes.size()),
                  part->attributes.data()};
  return part;
}

int open_file(const char* path, void** handle, char* error, std::size_t size) try {
  auto file = std::make_unique<File>();
  file->input = ImageInput::open(path);
  if (!file->input) {
    say(error, size, OIIO::geterror());
    return -1;
  }
  constexpr int kMostParts = 1000;
  for (int i = 0; i < kMostParts && file->input->seek_subimage(i, 0); ++i) {
    const ImageSpec spec = file->input->spec();
    if (spec.deep || spec.depth > 1) {
      say(error, size, "volumes and deep images are not supported");
      return -1;
    }
    file->parts.push_back(describe(spec));
  }
  (void)file->input->geterror();  // the seek past the last part
  if (file->parts.empty()) {
    say(error, size, "holds no image");
    return -1;
  }
  *handle = file.release();
  return 0;
} catch (const std::exception& e) {
  say(error, size, e.what());
  return -1;
}

void close_file(void* handle) { delete static_cast<File*>(handle); }

std::int32_t parts(void* handle) {
  return static_cast<std::int32_t>(static_cast<File*>(handle)->parts.size());
}

const brume_io_header* header(void* handle, std::int32_t part) {
  return &static_cast<File*>(handle)->parts[part]->header;
}

int read_pixels(void* handle, std::int32_t p, float* const* planes, char* error,
                std::size_t size) try {
  auto* file = static_cast<File*>(handle);
  const ImageSpec& spec = file->parts[p]->spec;
  const auto n = static_cast<std::size_t>(spec.nchannels);
  std::vector<float> pixels(std::size_t(spec.width) * spec.height * n);
  if (!file->input->read_image(p, 0, 0, spec.nchannels, TypeDesc::FLOAT, pixels.data())) {
    say(error, size, file->input->geterror());
    return -1;
  }
  for (std::size_t i = 0, count = pixels.size() / n; i < count; ++i)
    for (std::size_t c = 0; c < n; ++c) planes[c][i] = pixels[i * n + c];
  return 0;
} catch (const std::exception& e) {
  say(error, size, e.what());
  return -1;
}

/// Whether the format holds floats; the others hold integers.
bool holds_floats(const std::string& format) {
  for (const char* f : {"tif", "tiff", "hdr", "rgbe", "pfm", "tx", "fits", "zfile"})
    if (format == f) return true;
  return false;
}

int write_pixels(const char* path, const char* format, const brume_io_header* h,
                 const float* const* planes, char* error, std::size_t size) try {
  // By the format's name: the file may have another while it is written.
  const auto out = ImageOutput::create(format);
  if (!out) {
    say(error, size, OIIO::geterror());
    return -1;
  }
  const bool all_half = std::all_of(h->types, h->types + h->channel_count,
                                    [](std::uint8_t t) { return t == 1; });
  const TypeDesc type = holds_floats(format)
                            ? (all_half ? TypeDesc::HALF : TypeDesc::FLOAT)
                            : (all_half ? TypeDesc::UINT8 : TypeDesc::UINT16);
  const int width = h->data[2], height = h->data[3], n = h->channel_count;
  ImageSpec spec(width, height, n, type);
  spec.channelnames.assign(h->channels, h->channels + n);
  spec.alpha_channel = -1;
  for (int c = 0; c < n; ++c)
    if (spec.channelnames[c] == "A") spec.alpha_channel = c;
  if (out->supports("displaywindow")) {
    spec.x = h->data[0], spec.y = h->data[1];
    spec.full_x = h->display[0], spec.full_y = h->display[1];
    spec.full_width = h->display[2], spec.full_height = h->display[3];
  }
  spec.attribute("PixelAspectRatio", h->pixel_aspect);
  for (int i = 0; i < h->attribute_count; ++i) {
    const brume_io_attribute& a = h->attributes[i];
    const std::string name = a.name, kind = a.type;
    if (kind == "string") {
      spec.attribute(name, std::string(reinterpret_cast<const char*>(a.bytes), a.size));
    } else if (kind == "float" && a.size == 4) {
      spec.attribute(name, TypeDesc::FLOAT, a.bytes);
    } else if (kind == "m44f" && a.size == 64) {
      spec.attribute(name, TypeDesc(TypeDesc::FLOAT, TypeDesc::MATRIX44), a.bytes);
    }
  }
  if (!out->open(path, spec)) {
    say(error, size, out->geterror());
    return -1;
  }
  std::vector<float> row(std::size_t(width) * n);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < n; ++c)
        row[std::size_t(x) * n + c] = planes[c][std::size_t(y) * width + x];
    if (!out->write_scanline(y + spec.y, 0, TypeDesc::FLOAT, row.data())) {
      say(error, size, out->geterror());
      return -1;
    }
  }
  if (!out->close()) {
    say(error, size, out->geterror());
    return -1;
  }
  return 0;
} catch (const std::exception& e) {
  say(error, size, e.what());
  return -1;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) const brume_image_io*
brume_image_io_table(void) {
  static const brume_image_io table = {BRUME_IMAGE_IO_VERSION,
                                       open_file,
                                       close_file,
                                       parts,
                                       header,
                                       read_pixels,
                                       write_pixels};
  return &table;
}
