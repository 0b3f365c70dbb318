#pragma once
// Frames made for tests of the pipeline: pixels in memory with a camera, and a scene from
// text.

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "pipeline/pipeline.h"
#include "stage/registry.h"

namespace brume::test {

inline constexpr float kInf = std::numeric_limits<float>::infinity();

inline SceneFile scene_of(Registry& registry, const std::string& toml) {
  return parse_scene(toml, "test.toml",
                     [&](const std::string& type, const Location& where) {
                       return registry.specs(type, where);
                     });
}

/// A camera 50 m up that looks north and a little down: half of the frame sees the
/// ground, half the sky.
inline const char* const kCamera = R"(
[camera]
position = [0, 0, 50]
look_at = [0, 1000, 20]
focal = 30
)";

/// Pixels with everything that makes trouble: coverage from 0 to 1, background, edges
/// without depth, bright and dark colour.
struct Pixels {
  Window window;
  std::vector<float> r, g, b, a, z;
};

inline Pixels make_pixels(int width, int height, int x = 0, int y = 0) {
  Pixels p;
  p.window = {x, y, width, height};
  std::uint32_t state = 12345;
  const auto random = [&] {  // Numerical Recipes' linear congruence: any will do here
    state = state * 1664525u + 1013904223u;
    return float(state >> 8) / 16777216.f;
  };
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      // A ridge in the middle, background above it, a soft edge of two pixels whose upper
      // one has no depth.
      const float edge = 0.5f * float(height) + 3.f * std::sin(0.3f * float(i + x));
      const float cover = std::min(std::max((float(j) - edge) / 2.f + 0.5f, 0.f), 1.f);
      const bool has_depth = float(j) > edge;
      p.a.push_back(cover);
      p.z.push_back(has_depth ? 20.f + 4000.f * random() * random()
                    : j % 2   ? 1e10f
                              : kInf);
      p.r.push_back(cover * random());
      p.g.push_back(cover * random() * (i % 17 == 3 ? 1000.f : 1.f));
      p.b.push_back(cover * random());
    }
  return p;
}

inline FrameSource source_of(const Pixels& p, const Window& display,
                             std::vector<std::string> names = {}) {
  FrameSource s;
  s.frame = 1;
  s.name = "memory";
  s.header.data_window = p.window;
  s.header.display_window = display;
  if (names.empty()) names = {"A", "B", "G", "R", "Z"};
  for (const std::string& n : names)
    s.header.channels.push_back({n, n == "Z" ? PixelType::float32 : PixelType::half});
  return s;
}

inline const std::vector<float>& plane_of(const Pixels& p, const std::string& channel) {
  return channel == "R"   ? p.r
         : channel == "G" ? p.g
         : channel == "B" ? p.b
         : channel == "A" ? p.a
                          : p.z;
}

/// Outputs by name.
struct Result {
  std::vector<std::string> names;
  std::vector<std::vector<float>> planes;
  const std::vector<float>& operator[](const std::string& name) const {
    for (std::size_t k = 0; k < names.size(); ++k)
      if (names[k] == name) return planes[k];
    throw std::runtime_error("no output " + name);
  }
};

inline Result apply_whole(const PreparedFrame& frame, const Pixels& p,
                          const Window& render) {
  Result out;
  std::vector<PlaneIn> in;
  for (const InputChannel& c : frame.inputs())
    in.push_back({plane_of(p, c.channel).data(), 1, p.window.width});
  std::vector<PlaneOut> to;
  for (const OutputChannel& c : frame.outputs()) {
    out.names.push_back(c.channel.name);
    out.planes.emplace_back(std::size_t(render.pixels()), -1.f);
  }
  for (auto& plane : out.planes) to.push_back({plane.data(), 1, render.width});
  FrameBuffers buffers;
  buffers.window = p.window;
  buffers.in = in;
  buffers.out = to;
  frame.apply(buffers, render);
  return out;
}

}  // namespace brume::test
