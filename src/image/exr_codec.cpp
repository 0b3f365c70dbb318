#include "image/exr_codec.h"

#include <libdeflate.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "image/kernels.h"
#include "image/openexr_module.h"
#include "num/error.h"
#include "num/modules.h"

namespace brume::exr {
namespace {

// Rendered pixels hold little that a longer search finds. Level 1 against 4, time and
// size: hero frame -19 %, +0.2 %; street -40 %, +1.2 %; edges -20 to -30 %, +1.6 %; float
// T and L layers -24 %, +1.5 %. Level 4 packs as tightly as OpenEXR does.
constexpr int kDeflateLevel = 1;

struct Tools {
  struct Free {
    void operator()(libdeflate_compressor* c) const { libdeflate_free_compressor(c); }
    void operator()(libdeflate_decompressor* d) const { libdeflate_free_decompressor(d); }
  };
  std::unique_ptr<libdeflate_compressor, Free> compressor;
  std::unique_ptr<libdeflate_decompressor, Free> decompressor;
  std::vector<std::uint8_t> scratch, packed;  ///< as large as was ever needed
};
std::span<std::uint8_t> at_least(std::vector<std::uint8_t>& buffer, std::size_t n) {
  if (buffer.size() < n) buffer.resize(n);
  return std::span(buffer).first(n);
}
Tools& tools() {
  thread_local Tools t;
  return t;
}

bool inflate(std::span<const std::uint8_t> in, std::span<std::uint8_t> out) {
  auto& d = tools().decompressor;
  if (!d) d.reset(libdeflate_alloc_decompressor());
  return d && libdeflate_zlib_decompress(d.get(), in.data(), in.size(), out.data(),
                                         out.size(), nullptr) == LIBDEFLATE_SUCCESS;
}

// OpenEXR's run lengths: n < 0: -n bytes as they are; n >= 0: the next byte n + 1 times.
bool undo_runs(std::span<const std::uint8_t> in, std::span<std::uint8_t> out) {
  std::size_t i = 0, o = 0;
  while (i < in.size()) {
    const int n = static_cast<std::int8_t>(in[i++]);
    const std::size_t count = n < 0 ? -n : n + 1;
    if (count > out.size() - o || (n < 0 ? count : 1) > in.size() - i) return false;
    if (n < 0) {
      std::memcpy(&out[o], &in[i], count);
      i += count;
    } else {
      std::memset(&out[o], in[i++], count);
    }
    o += count;
  }
  return o == out.size();
}

void apply_runs(std::span<const std::uint8_t> in, std::vector<std::uint8_t>& out) {
  constexpr std::size_t kShortestRun = 3, kLongest = 127;
  out.clear();
  std::size_t i = 0;
  auto run_at = [&](std::size_t at) {
    std::size_t n = 1;
    while (at + n < in.size() && n < kLongest + 1 && in[at + n] == in[at]) ++n;
    return n;
  };
  while (i < in.size()) {
    std::size_t n = run_at(i);
    if (n >= kShortestRun) {
      out.push_back(static_cast<std::uint8_t>(n - 1));
      out.push_back(in[i]);
      i += n;
      continue;
    }
    const std::size_t start = i;
    while (i < in.size() && i - start < kLongest && run_at(i) < kShortestRun) ++i;
    out.push_back(static_cast<std::uint8_t>(-static_cast<int>(i - start)));
    out.insert(out.end(), in.begin() + start, in.begin() + i);
  }
}

// Linked in where stages are too (BRUME_LINK_PLUGINS), else in a module.
#ifdef BRUME_OPENEXR_LINKED
const OpenExrCodecs& openexr(Compression, const std::string&) {
  return *brume_openexr_codecs();
}
#else
const OpenExrCodecs& openexr(Compression c, const std::string& where) {
  static const OpenExrCodecs* const codecs = [&] {
    const auto entry = reinterpret_cast<decltype(&brume_openexr_codecs)>(
        module_symbol("openexr.so", "brume_openexr_codecs"));
    if (!entry)
      throw Error(
          where, std::string(name(c)) + " compression needs the module openexr.so",
          "it belongs beside the stages' modules; BRUME_PLUGIN_PATH names folders");
    if (entry()->version != OpenExrCodecs::kVersion)
      throw Error(where, "the module openexr.so belongs to another version of brume");
    return entry();
  }();
  return *codecs;
}
#endif

}  // namespace

void unpack(const ImageHeader& header, const Window& window,
            std::vector<std::uint8_t>& payload, std::span<std::uint8_t> pixels,
            const std::string& where) {
  if (pixels.empty()) return;
  const Compression c = header.compression;
  const bool b44 = c == Compression::b44 || c == Compression::b44a;
  if (payload.size() == pixels.size() && !b44) {  // did not shrink: stored as it is
    std::memcpy(pixels.data(), payload.data(), pixels.size());
    return;
  }
  const auto scratch = at_least(tools().scratch, pixels.size());
  switch (c) {
    case Compression::none:
      throw Error(where, "wrong number of bytes");
    case Compression::rle:
    case Compression::zips:
    case Compression::zip: {
      const bool ok =
          c == Compression::rle ? undo_runs(payload, scratch) : inflate(payload, scratch);
      if (!ok) throw Error(where, std::string("corrupt ") + name(c) + " data");
      kernels().undo_predictor(scratch.data(), pixels.data(), pixels.size());
      return;
    }
    default:
      break;
  }
  const OpenExrCodecs& codecs = openexr(c, where);
  try {
    codecs.unpack(header, window, payload, pixels);
  } catch (const std::exception&) {
    throw Error(where, std::string("corrupt ") + name(c) + " data");
  }
}

void pack(const ImageHeader& header, const Window& window,
          std::span<const std::uint8_t> pixels, std::vector<std::uint8_t>& payload,
          const std::string& where) {
  payload.clear();
  if (pixels.empty()) return;
  const Compression c = header.compression;
  const auto scratch = at_least(tools().scratch, pixels.size());
  switch (c) {
    case Compression::none:
      break;
    case Compression::rle:
      kernels().apply_predictor(pixels.data(), scratch.data(), pixels.size());
      apply_runs(scratch, payload);
      if (payload.size() < pixels.size()) return;
      break;
    case Compression::zips:
    case Compression::zip: {
      auto& z = tools().compressor;
      if (!z) z.reset(libdeflate_alloc_compressor(kDeflateLevel));
      if (!z) throw std::bad_alloc();
      kernels().apply_predictor(pixels.data(), scratch.data(), pixels.size());
      // Room for one byte less than the pixels: 0 comes back when it does not shrink.
      const auto packed = at_least(tools().packed, pixels.size() - 1);
      const std::size_t n = libdeflate_zlib_compress(
          z.get(), scratch.data(), scratch.size(), packed.data(), packed.size());
      if (n == 0) break;
      payload.assign(packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(n));
      return;
    }
    default: {
      const OpenExrCodecs& codecs = openexr(c, where);
      try {
        codecs.pack(header, window, pixels, payload);
      } catch (const std::exception& e) {
        throw Error(where, std::string("cannot be packed as ") + name(c), e.what());
      }
      return;
    }
  }
  payload.assign(pixels.begin(), pixels.end());
}

}  // namespace brume::exr
