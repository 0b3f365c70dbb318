#include "picture/png.h"

#include <libdeflate.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <vector>

namespace brume {

namespace {

using Byte = std::uint8_t;

void put32(std::string& out, std::uint32_t v) {
  for (int shift = 24; shift >= 0; shift -= 8) out += char(v >> shift & 0xff);
}

void chunk(std::string& out, const char* type, const std::string& data) {
  put32(out, std::uint32_t(data.size()));
  const std::size_t begin = out.size();
  out.append(type, 4);
  out += data;
  put32(out, libdeflate_crc32(0, out.data() + begin, out.size() - begin));
}

// Section 9.4: the neighbour nearest to left + above - above left.
int paeth(int left, int above, int corner) {
  const int p = left + above - corner;
  const int a = std::abs(p - left), b = std::abs(p - above), c = std::abs(p - corner);
  return a <= b && a <= c ? left : b <= c ? above : corner;
}

// Each row by the filter that leaves the smallest sum of differences (section 12.7).
std::string filtered(const std::vector<Byte>& rgb, std::size_t width,
                     std::size_t height) {
  const std::size_t n = 3 * width;
  std::string out;
  std::vector<Byte> above(n, 0);
  std::array<std::string, 5> tried;
  for (std::size_t y = 0; y < height; ++y) {
    const Byte* row = &rgb[y * n];
    std::size_t best = 0;
    long least = -1;
    for (std::size_t f = 0; f < 5; ++f) {
      std::string& t = tried[f];
      t.assign(1, char(f));
      long sum = 0;
      for (std::size_t i = 0; i < n; ++i) {
        const int left = i < 3 ? 0 : row[i - 3], up = above[i],
                  corner = i < 3 ? 0 : above[i - 3];
        const int guess[5] = {0, left, up, (left + up) / 2, paeth(left, up, corner)};
        const auto d = Byte(row[i] - guess[f]);
        sum += std::abs(int(std::int8_t(d)));
        t += char(d);
      }
      if (least < 0 || sum < least) least = sum, best = f;
    }
    out += tried[best];
    above.assign(row, row + n);
  }
  return out;
}

}  // namespace

std::string png(const Picture& p) {
  if (p.width <= 0 || p.height <= 0) return {};
  std::vector<Byte> rgb;
  rgb.reserve(p.rgb.size());
  for (const float v : p.rgb) rgb.push_back(Byte(srgb_encoded(v) * 255 + 0.5f));
  const std::string raw = filtered(rgb, std::size_t(p.width), std::size_t(p.height));
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)>
      with(libdeflate_alloc_compressor(9), libdeflate_free_compressor);
  if (!with) throw std::bad_alloc();
  std::string packed(libdeflate_zlib_compress_bound(with.get(), raw.size()), '\0');
  packed.resize(libdeflate_zlib_compress(with.get(), raw.data(), raw.size(),
                                         packed.data(), packed.size()));
  std::string head;
  put32(head, std::uint32_t(p.width));
  put32(head, std::uint32_t(p.height));
  head += std::string("\x08\x02\x00\x00\x00", 5);  // 8 bits, RGB, no interlace
  std::string out("\x89PNG\r\n\x1a\n", 8);
  chunk(out, "IHDR", head);
  chunk(out, "sRGB", std::string(1, '\0'));
  chunk(out, "IDAT", packed);
  chunk(out, "IEND", {});
  return out;
}

std::string base64(const std::string& bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t v = 0;
    for (std::size_t k = 0; k < 3; ++k)
      v = v << 8 | (k < n ? std::uint32_t(Byte(bytes[i + k])) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      out += k <= n ? kDigits[v >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

}  // namespace brume
