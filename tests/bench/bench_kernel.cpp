// Height fog over pixels in memory, one thread, against the same memory traffic without
// arithmetic, turn by turn. A line each: what, ns per pixel.
//
//   bench_kernel            BRUME_ISA chooses the instruction set

#include <algorithm>
#include <cstdio>
#include <exception>
#include <limits>

#include "memory_frame.h"
#include "num/isa.h"

namespace {

using namespace brume;
using namespace brume::bench;

const char* const kScene = R"(
[camera]
position = [0, 0, 50]
look_at = [0, 1000, 20]
[[stage]]
type = "height_fog"
)";

double nanoseconds_per_pixel(const MemoryFrame& f, int repeats, auto&& work) {
  const double took = seconds([&] {
    for (int i = 0; i < repeats; ++i) work();
  });
  return took * 1e9 / repeats / double(f.in[0].size());
}

[[gnu::noinline]] void same_traffic(MemoryFrame& f) {
  const float *r = f.in[0].data(), *g = f.in[1].data(), *b = f.in[2].data(),
              *a = f.in[3].data(), *z = f.in[4].data();
  float *R = f.out[0].data(), *G = f.out[1].data(), *B = f.out[2].data(),
        *A = f.out[3].data();
  for (std::size_t i = 0; i < f.in[0].size(); ++i)
    R[i] = r[i] + z[i], G[i] = g[i] + z[i], B[i] = b[i] + z[i], A[i] = a[i];
}

void compare(Registry& registry, const char* what, int width, int height, int repeats) {
  MemoryFrame f(width, height);
  OnFrame scene(registry, kScene, f);
  double fog = std::numeric_limits<double>::infinity(), traffic = fog;
  for (int round = 0; round < 40; ++round) {
    traffic =
        std::min(traffic, nanoseconds_per_pixel(f, repeats, [&] { same_traffic(f); }));
    fog = std::min(fog, nanoseconds_per_pixel(f, repeats, [&] { scene.apply(); }));
  }
  std::printf("%s %s: fog %.3f, traffic %.3f, ratio %.3f\n", brume::name(isa()), what,
              fog, traffic, fog / traffic);
}

}  // namespace

int main() try {
  Registry registry;
  compare(registry, "in cache", 2048, 2, 100);
  compare(registry, "1080p", 1920, 1080, 1);
  return 0;
} catch (const std::exception& e) {
  std::fprintf(stderr, "bench_kernel: %s\n", e.what());
  return 1;
}
