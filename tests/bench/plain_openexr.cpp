// The same job as people write it: the whole image through OpenEXR's C++ interface, fog
// over every pixel, the whole image out. It is what `brume apply` is measured against.
//
//   plain_openexr IN OUT [THREADS]      THREADS for OpenEXR's own pool, default 0: none
//
// Exponential height fog seen from above: optical depth sigma Z exprel(-c mu Z), with mu
// linear over the rows. R, G, B half, Z float; other channels and attributes pass
// through. Prints wall and CPU seconds of reading, fog and writing.

#include <ImfArray.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfThreading.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <map>
#include <string>
#include <vector>

namespace {

struct Plane {
  Imf::PixelType type;
  std::vector<char> memory;
};

struct Stopwatch {
  std::chrono::steady_clock::time_point wall = std::chrono::steady_clock::now();
  std::clock_t cpu = std::clock();

  void lap(const char* what) {
    const auto now = std::chrono::steady_clock::now();
    const std::clock_t cpu_now = std::clock();
    std::printf("%s %.4f s wall %.4f s CPU\n", what,
                std::chrono::duration<double>(now - wall).count(),
                double(cpu_now - cpu) / CLOCKS_PER_SEC);
    wall = now, cpu = cpu_now;
  }
};

void fog(std::map<std::string, Plane>& planes, int width, int height) {
  constexpr float kDensity = 2e-4f, kFalloff = 5e-3f, kColor[3] = {0.6f, 0.65f, 0.7f};
  Imath::half* rgb[3];
  const char* names[3] = {"R", "G", "B"};
  for (int k = 0; k < 3; ++k)
    rgb[k] = reinterpret_cast<Imath::half*>(planes.at(names[k]).memory.data());
  const auto* z = reinterpret_cast<const float*>(planes.at("Z").memory.data());
  for (int y = 0; y < height; ++y) {
    const float mu = 0.3f - 0.6f * float(y) / float(height);
    for (int x = 0; x < width; ++x) {
      const std::size_t i = std::size_t(y) * width + x;
      const float s = -kFalloff * mu * std::fmin(z[i], 1e5f);
      const float e = std::fabs(s) < 1e-4f ? 1 + s / 2 : std::expm1(s) / s;
      const float t = std::exp(-kDensity * z[i] * e);
      for (int k = 0; k < 3; ++k) rgb[k][i] = float(rgb[k][i]) * t + kColor[k] * (1 - t);
    }
  }
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 3) {
    std::fprintf(stderr, "usage: plain_openexr IN OUT [THREADS]\n");
    return 2;
  }
  Imf::setGlobalThreadCount(argc > 3 ? std::atoi(argv[3]) : 0);
  Stopwatch watch;
  Imf::InputFile in(argv[1]);
  const Imath::Box2i window = in.header().dataWindow();
  const int width = window.max.x - window.min.x + 1;
  const int height = window.max.y - window.min.y + 1;
  std::map<std::string, Plane> planes;
  Imf::FrameBuffer buffer;
  for (auto c = in.header().channels().begin(); c != in.header().channels().end(); ++c) {
    const std::size_t size = c.channel().type == Imf::HALF ? 2 : 4;
    Plane& plane = planes[c.name()];
    plane.type = c.channel().type;
    plane.memory.resize(size * width * height);
    char* base =
        plane.memory.data() -
        (std::ptrdiff_t(window.min.y) * width + window.min.x) * std::ptrdiff_t(size);
    buffer.insert(c.name(), Imf::Slice(plane.type, base, size, size * width));
  }
  in.setFrameBuffer(buffer);
  in.readPixels(window.min.y, window.max.y);
  watch.lap("read ");
  fog(planes, width, height);
  watch.lap("fog  ");
  {
    Imf::OutputFile out(argv[2], in.header());
    out.setFrameBuffer(buffer);
    out.writePixels(height);
  }
  watch.lap("write");
  return 0;
} catch (const std::exception& e) {
  std::fprintf(stderr, "plain_openexr: %s\n", e.what());
  return 1;
}
