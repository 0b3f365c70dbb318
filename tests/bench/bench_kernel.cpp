// Height fog over pixels in memory, one thread, against the same memory traffic without
// arithmetic, turn by turn. A line each: what, ns per pixel.
//
//   bench_kernel            BRUME_ISA chooses the instruction set

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <limits>
#include <vector>

#include "num/isa.h"
#include "pipeline/pipeline.h"
#include "stage/registry.h"

namespace {

using namespace brume;

const char* const kScene = R"(
[camera]
position = [0, 0, 50]
look_at = [0, 1000, 20]
[[stage]]
type = "height_fog"
)";

/// A frame of R, G, B, A, Z, its planes apart, and the planes written.
struct Frame {
  Window window;
  std::vector<float> in[5], out[4];

  Frame(int width, int height) : window{0, 0, width, height} {
    for (auto& plane : in) plane.assign(std::size_t(width) * std::size_t(height), 0.f);
    for (auto& plane : out) plane.assign(in[0].size(), 0.f);
    for (std::size_t i = 0; i < in[0].size(); ++i) {
      for (int c = 0; c < 3; ++c) in[c][i] = 0.1f * float(c) + float(i % 97) / 97;
      in[3][i] = 1;
      in[4][i] = 10 + 40 * float(i % 251);
    }
  }
};

double nanoseconds_per_pixel(const Frame& f, int repeats, auto&& work) {
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < repeats; ++i) work();
  const std::chrono::duration<double, std::nano> took =
      std::chrono::steady_clock::now() - begin;
  return took.count() / repeats / double(f.in[0].size());
}

[[gnu::noinline]] void same_traffic(Frame& f) {
  const float *r = f.in[0].data(), *g = f.in[1].data(), *b = f.in[2].data(),
              *a = f.in[3].data(), *z = f.in[4].data();
  float *R = f.out[0].data(), *G = f.out[1].data(), *B = f.out[2].data(),
        *A = f.out[3].data();
  for (std::size_t i = 0; i < f.in[0].size(); ++i)
    R[i] = r[i] + z[i], G[i] = g[i] + z[i], B[i] = b[i] + z[i], A[i] = a[i];
}

void compare(Registry& registry, const char* what, int width, int height, int repeats) {
  Frame f(width, height);
  const Session session(parse_scene(kScene, "bench",
                                    [&](const std::string& type, const Location& where) {
                                      return registry.specs(type, where);
                                    }),
                        registry);
  FrameSource source;
  source.name = "memory";
  source.header.data_window = source.header.display_window = f.window;
  for (const char* channel : {"A", "B", "G", "R", "Z"})
    source.header.channels.push_back({channel, PixelType::float32});
  const PreparedFrame frame = session.prepare(source);
  const auto plane = [](const std::string& channel) {
    return channel == "R"   ? 0
           : channel == "G" ? 1
           : channel == "B" ? 2
           : channel == "A" ? 3
                            : 4;
  };
  std::vector<PlaneIn> in;
  std::vector<PlaneOut> out;
  for (const auto& channel : frame.inputs())
    in.push_back({f.in[plane(channel.channel)].data(), 1, width});
  for (const auto& channel : frame.outputs())
    out.push_back({f.out[plane(channel.channel.name)].data(), 1, width});
  double fog = std::numeric_limits<double>::infinity(), traffic = fog;
  for (int round = 0; round < 40; ++round) {
    traffic =
        std::min(traffic, nanoseconds_per_pixel(f, repeats, [&] { same_traffic(f); }));
    fog = std::min(fog, nanoseconds_per_pixel(f, repeats, [&] {
                     frame.apply({f.window, false, in, out}, f.window);
                   }));
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
