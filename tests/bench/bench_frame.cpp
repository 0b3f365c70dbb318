// Frames to measure on: a sample frame mirrored until it fills the size, so that it packs
// as a render of that size does.
//
//   bench_frame IN OUT WIDTH HEIGHT     writes ZIP, half R G B A and float Z

#include <cstdio>
#include <cstdlib>
#include <exception>

#include "image/io.h"

namespace {

// ... 2 1 0 0 1 2 ... n-1 n-1 n-2 ...
int mirrored(int i, int n) {
  const int k = i % (2 * n);
  return k < n ? k : 2 * n - 1 - k;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 5) {
    std::fputs("usage: bench_frame IN OUT WIDTH HEIGHT\n", stderr);
    return 2;
  }
  const brume::Image in = brume::read_image(argv[1]);
  const int width = std::atoi(argv[3]), height = std::atoi(argv[4]);
  const brume::Window from = in.header.data_window;
  brume::Image out;
  out.header = in.header;
  out.header.data_window = out.header.display_window = {0, 0, width, height};
  out.header.compression = brume::Compression::zip;
  for (const std::vector<float>& plane : in.planes) {
    auto& big = out.planes.emplace_back(std::size_t(width) * std::size_t(height));
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        big[std::size_t(y) * width + x] =
            plane[std::size_t(mirrored(y, from.height)) * from.width +
                  mirrored(x, from.width)];
  }
  brume::write_image(out, argv[2]);
  return 0;
} catch (const std::exception& e) {
  std::fprintf(stderr, "bench_frame: %s\n", e.what());
  return 1;
}
