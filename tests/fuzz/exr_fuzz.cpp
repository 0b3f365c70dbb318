// libFuzzer: any bytes as an EXR file. They are read or refused with an Error; nothing
// else may happen.
//
//   exr_fuzz -max_len=8192 -rss_limit_mb=512 CORPUS

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "image/io.h"
#include "num/error.h"
#include "num/isa.h"

// The plainest kernels, on every machine (and clang 14 cannot ask for the others).
brume::Isa brume::isa() { return Isa::v2; }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // Files of other formats belong to OpenImageIO's readers, which are not ours to fuzz.
  constexpr std::uint8_t kMagic[4] = {0x76, 0x2f, 0x31, 0x01};
  if (size < 4 || !std::equal(kMagic, kMagic + 4, data)) return 0;
  const int file = ::memfd_create("fuzz", 0);
  if (file < 0 || ::write(file, data, size) != static_cast<ssize_t>(size)) std::abort();
  const std::string path = "/proc/self/fd/" + std::to_string(file);
  static const std::string out =
      "/dev/shm/brume_fuzz_" + std::to_string(::getpid()) + ".exr";
  try {
    const auto headers = brume::read_headers(path);
    for (std::size_t p = 0; p < headers.size(); ++p) {
      // Larger ones are only slower.
      constexpr std::int64_t kMostSamples = 1 << 18;
      const auto channels = static_cast<std::int64_t>(headers[p].channels.size());
      if (headers[p].data_window.pixels() > kMostSamples / channels) continue;
      try {
        brume::read_image(path, static_cast<int>(p));
        brume::Edit edit;
        edit.channels = {headers[p].channels.front(), {"added"}};
        const auto source = brume::open_image(path, static_cast<int>(p));
        brume::copy_edited(*source, edit, out, [](brume::Band&) {}, {.threads = 1});
        ::unlink(out.c_str());
      } catch (const brume::Error&) {
      }
    }
  } catch (const brume::Error&) {
  }
  ::close(file);
  return 0;
}
