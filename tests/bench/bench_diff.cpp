// How long `brume diff` takes beside reading both files, medians of 5:
//   bench_diff A.exr B.exr

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <numeric>

#include "image/io.h"
#include "truth/difference.h"

namespace {

using namespace brume;

// All channels of all bands on all cores, into memory that is thrown away.
void read(const char* path) {
  const auto reader = open_image(path);
  const Window w = reader->header().data_window;
  const int rows = std::max(1, reader->band_rows());
  std::vector<int> all(reader->header().channels.size());
  std::iota(all.begin(), all.end(), 0);
  tbb::parallel_for(0, (w.height + rows - 1) / rows, [&](int band) {
    static thread_local std::vector<float> room;
    const std::size_t plane = std::size_t(w.width) * std::size_t(rows);
    room.resize(plane * all.size());
    std::vector<float*> to;
    for (std::size_t k = 0; k < all.size(); ++k) to.push_back(room.data() + k * plane);
    const int y = w.y + band * rows;
    reader->read(y, std::min(rows, w.bottom() - y), all, to);
  });
}

template <class F>
double median_seconds(const F& f) {
  std::vector<double> s;
  for (int i = 0; i < 5; ++i) {
    const auto start = std::chrono::steady_clock::now();
    f();
    s.push_back(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  std::nth_element(s.begin(), s.begin() + 2, s.end());
  return s[2];
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return std::fputs("usage: bench_diff A.exr B.exr\n", stderr), 2;
  DifferenceOptions o;
  o.ignore_attributes = {"*"};
  const double reading = median_seconds([&] { read(argv[1]), read(argv[2]); });
  const double diff = median_seconds([&] { compare_files(argv[1], argv[2], o); });
  std::printf("reading both %.3f s, diff %.3f s, ratio %.2f\n", reading, diff,
              diff / reading);
}
