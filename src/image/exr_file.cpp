#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "image/exr_format.h"
#include "num/error.h"

namespace brume::exr {
namespace {

/// Most unpacked bytes that one file byte can stand for, generously. A declared size
/// beyond it is refused before memory is taken. Deflate: 1032 (zlib's own statement: a
/// match of 258 costs 2 bits). RLE: 128 from 2. PIZ: a run of 255 values costs at least
/// 9 bits. PXR24 stores 3 of 4 bytes, deflated. B44A: 32 bytes from 3; raw floats. DWA:
/// 64 halves of a flat block leave one AC byte pair and one DC, both deflated.
double best_ratio(Compression c) {
  switch (c) {
    case Compression::none:
      return 1;
    case Compression::rle:
      return 64;
    case Compression::zips:
    case Compression::zip:
      return 1032;
    case Compression::pxr24:
      return 1032 * 4 / 3.0;
    case Compression::piz:
      return 1000;
    case Compression::b44:
    case Compression::b44a:
      return 16;
    case Compression::dwaa:
    case Compression::dwab:
      return 1032 * 64;
  }
  return 1;
}

std::uint32_t u32(const std::uint8_t* p) {
  std::uint32_t v;
  std::memcpy(&v, p, 4);
  return v;
}

}  // namespace

File::File(const std::filesystem::path& path) : path_(path) {
  fd_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd_ < 0) throw Error(path.string(), std::strerror(errno));
  try {
    struct stat info {};
    if (::fstat(fd_, &info) != 0) throw Error(path.string(), std::strerror(errno));
    if (S_ISDIR(info.st_mode)) throw Error(path.string(), "is a directory");
    size_ = static_cast<std::uint64_t>(info.st_size);
    parse();
  } catch (...) {
    ::close(fd_);
    throw;
  }
}

File::~File() { ::close(fd_); }

void File::read_at(std::uint64_t offset, void* to, std::size_t n) const {
  auto* p = static_cast<char*>(to);
  if (offset > size_ || n > size_ - offset)
    throw Error(path_.string(), "the file ends early",
                fmt::format("{} bytes long, {} wanted", size_, offset + n));
  bytes_read_ += n;
  while (n > 0) {
    const ssize_t got = ::pread(fd_, p, n, static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw Error(path_.string(), std::strerror(errno));
    if (got == 0) throw Error(path_.string(), "the file ends early");
    p += got, offset += got, n -= got;
  }
}

// Headers and tables are many small things one after the other: by pages, each asked for
// once.
void File::read_ahead(std::uint64_t offset, void* to, std::size_t n) {
  constexpr std::size_t kPage = 8192;
  if (offset < page_at_ || offset + n > page_at_ + page_.size()) {
    if (n > kPage || offset + n > size_) return read_at(offset, to, n);
    page_at_ = offset;
    page_.resize(std::min<std::uint64_t>(kPage, size_ - offset));
    read_at(offset, page_.data(), page_.size());
  }
  if (n > 0) std::memcpy(to, page_.data() + (offset - page_at_), n);
}

// One header: name, type, size and bytes of each attribute until an empty name.
std::vector<NamedAttribute> File::read_header(std::uint64_t& at) {
  const std::string where = path_.string();
  constexpr std::size_t kLongestName = 255;
  std::vector<NamedAttribute> attributes;
  auto read_name = [&] {
    std::uint8_t buffer[kLongestName + 1];
    const auto n = std::min<std::uint64_t>(sizeof buffer, size_ - std::min(at, size_));
    read_ahead(at, buffer, n);
    const std::uint8_t* end = std::find(buffer, buffer + n, 0);
    if (end == buffer + n)
      throw Error(where,
                  n < sizeof buffer ? "the header ends early" : "the header is corrupt",
                  "a name without end");
    at += end - buffer + 1;
    return std::string(reinterpret_cast<const char*>(buffer), end - buffer);
  };
  for (;;) {
    std::string name = read_name();
    if (name.empty()) return attributes;
    std::string type = read_name();
    std::uint8_t size_bytes[4];
    read_ahead(at, size_bytes, 4);
    at += 4;
    const std::uint32_t size = u32(size_bytes);
    if (size > 0x7fffffff || size > size_ - at)
      throw Error(where,
                  fmt::format("attribute {} is larger than the file", printable(name)));
    NamedAttribute a{std::move(name), {std::move(type), {}}};
    for (const NamedAttribute& other : attributes)
      if (other.name == a.name)
        throw Error(where, fmt::format("attribute {} occurs twice", printable(a.name)));
    a.value.bytes.resize(size);
    read_ahead(at, a.value.bytes.data(), size);
    at += size;
    attributes.push_back(std::move(a));
  }
}

void File::parse() {
  const std::string where = path_.string();
  std::uint8_t start[8];
  if (size_ < 8) throw Error(where, "the file ends early", "no EXR header");
  read_ahead(0, start, 8);
  if (u32(start) != kMagic) throw Error(where, "is not an EXR file");
  flags_ = u32(start + 4) & ~0xffu;
  const unsigned version = start[4];
  if (version != 2) throw Error(where, fmt::format("EXR version {} is unknown", version));
  constexpr std::uint32_t kKnown =
      kTiledFlag | kLongNamesFlag | kDeepFlag | kMultiPartFlag;
  if (flags_ & ~kKnown)
    throw Error(where, fmt::format("unknown EXR version flags {:#x}", flags_));

  std::uint64_t at = 8;
  do {
    Part part;
    part.attributes = read_header(at);
    if (multi_part() && part.attributes.empty()) break;
    understand(part, flags_, where);
    parts_.push_back(std::move(part));
  } while (multi_part());
  if (parts_.empty()) throw Error(where, "holds no image");
  read_offsets(at);
  page_ = {};
}

// The offset tables of all parts, one after the other. What they can hold bounds what the
// headers may declare: every chunk takes its offset and its own header of 8 bytes.
void File::read_offsets(std::uint64_t at) {
  for (Part& part : parts_) {
    const ImageHeader& h = part.header;
    const std::string where =
        path_.string() + (h.part_name.empty() ? "" : ":" + printable(h.part_name));
    const std::string size =
        fmt::format("{} x {} pixels declared, {} bytes in the file", h.data_window.width,
                    h.data_window.height, size_);
    const std::int64_t count = part.chunk_count();
    if (count > static_cast<std::int64_t>((size_ - at) / 8))
      throw Error(where, "the offset table does not fit in the file", size);
    double row_bytes = 0;
    for (const Channel& c : h.channels)
      row_bytes += double(bytes_per_sample(c.type)) / c.y_sampling *
                   sample_count(h.data_window.x, h.data_window.width, c.x_sampling);
    if (!h.deep &&
        row_bytes * h.data_window.height > double(size_) * best_ratio(h.compression))
      throw Error(where, "the file cannot hold the declared size", size);
    part.offsets.resize(count);
    read_ahead(at, part.offsets.data(), 8 * part.offsets.size());
    at += 8 * part.offsets.size();
  }
}

File::Extent File::chunk_extent(int p, std::int64_t i) const {
  const Part& part = parts_[p];
  const std::uint64_t offset = part.offsets[i];
  auto fail = [&](const std::string& what) {
    throw Error(path_.string(), chunk_text(part, i) + ": " + what);
  };
  if (offset == 0) fail("missing, the file is incomplete");
  // Coordinates as the file repeats them before the pixels.
  std::int32_t head[6];
  int ints = 0, want[6];
  if (multi_part()) want[ints++] = p;
  if (part.tiles) {
    const int across = part.tiles_across();
    want[ints++] = static_cast<int>(i % across);
    want[ints++] = static_cast<int>(i / across);
    want[ints++] = 0;
    want[ints++] = 0;
  } else {
    want[ints++] = part.chunk_window(i).y;
  }
  const std::size_t head_bytes = 4 * (ints + 1);
  if (offset > size_ || head_bytes > size_ - offset) fail("lies beyond the file's end");
  read_at(offset, head, head_bytes);
  if (!std::equal(want, want + ints, head)) fail("the chunk there is another one");
  const std::int32_t bytes = head[ints];
  if (bytes < 0) fail("negative size");
  if (static_cast<std::uint64_t>(bytes) > size_ - offset - head_bytes)
    fail("the file ends early");
  const std::size_t whole =
      ChunkLayout(part.header.channels, part.chunk_window(i)).size();
  if (static_cast<std::size_t>(bytes) > whole) fail("larger than its pixels");
  if (double(whole) > best_ratio(part.header.compression) * bytes + 4096)
    fail(fmt::format("{} bytes cannot hold its pixels", bytes));
  return {offset, head_bytes, static_cast<std::uint64_t>(bytes)};
}

File::Extent File::any_extent(int p, std::int64_t i) const {
  const Part& part = parts_[p];
  const std::string where = path_.string();
  Extent at{part.offsets[i]};
  auto corrupt = [&] {
    throw Error(where, fmt::format("chunk {} of part {} is corrupt", i, p));
  };
  if (at.offset == 0)
    throw Error(
        where,
        fmt::format("chunk {} of part {} is missing, the file is incomplete", i, p));
  // Part number, coordinates (1 or 4 ints), then one size, or the three 64-bit ones of
  // deep data of which the last is the unpacked one.
  if (multi_part()) {
    std::int32_t number;
    read_at(at.offset, &number, 4);
    if (number != p) corrupt();
    at.head = 4;
  }
  at.head += part.tiles ? 16 : 4;
  if (part.header.deep) {
    std::uint64_t sizes[3];
    read_at(at.offset + at.head, sizes, sizeof sizes);
    if (sizes[0] > size_ || sizes[1] > size_) corrupt();
    at.head += sizeof sizes;
    at.payload = sizes[0] + sizes[1];
  } else {
    std::uint32_t n;
    read_at(at.offset + at.head, &n, 4);
    at.head += 4;
    at.payload = n;
  }
  if (at.size() > size_ - at.offset) corrupt();
  return at;
}

void File::read_payload(const Extent& where, std::vector<std::uint8_t>& payload) const {
  payload.resize(where.payload);
  read_at(where.offset + where.head, payload.data(), payload.size());
}

void File::copy(std::uint64_t offset, std::uint64_t n, AtomicFile& out) const {
  out.append_from(fd_, offset, n);
  bytes_read_ += n;
}

}  // namespace brume::exr
