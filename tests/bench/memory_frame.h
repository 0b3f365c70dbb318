#pragma once
// A frame in memory for benchmarks, and a scene prepared for it.

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/pipeline.h"
#include "stage/registry.h"

namespace brume::bench {

/// R, G, B, A, Z, their planes apart, and the planes written. Depths from 10 m to 10 km.
struct MemoryFrame {
  Window window;
  std::vector<float> in[5], out[4];

  MemoryFrame(int width, int height) : window{0, 0, width, height} {
    for (auto& plane : in) plane.assign(std::size_t(width) * std::size_t(height), 0.f);
    for (auto& plane : out) plane.assign(in[0].size(), 0.f);
    for (std::size_t i = 0; i < in[0].size(); ++i) {
      for (int c = 0; c < 3; ++c) in[c][i] = 0.1f * float(c) + float(i % 97) / 97;
      in[3][i] = 1;
      in[4][i] = 10 + 40 * float(i % 251);
    }
  }
};

/// A scene, prepared for such a frame and applied to it, or in its place, as to the bands
/// of a file.
class OnFrame {
 public:
  OnFrame(Registry& registry, const std::string& scene, MemoryFrame& f,
          bool in_place = false)
      : frame_(f),
        session_(parse_scene(scene, "bench",
                             [&](const std::string& type, const Location& where) {
                               return registry.specs(type, where);
                             }),
                 registry) {
    prepare();
    for (const auto& channel : prepared_->inputs())
      in_.push_back({f.in[plane(channel.channel)].data(), 1, f.window.width});
    for (const auto& channel : prepared_->outputs())
      out_.push_back({(in_place ? f.in : f.out)[plane(channel.channel.name)].data(), 1,
                      f.window.width});
  }

  void prepare() {
    FrameSource source;
    source.name = "memory";
    source.header.data_window = source.header.display_window = frame_.window;
    for (const char* channel : {"A", "B", "G", "R", "Z"})
      source.header.channels.push_back({channel, PixelType::float32});
    prepared_.emplace(session_.prepare(source));
  }
  void apply() { prepared_->apply({frame_.window, false, in_, out_}, frame_.window); }

 private:
  static int plane(const std::string& channel) {
    return channel == "R"   ? 0
           : channel == "G" ? 1
           : channel == "B" ? 2
           : channel == "A" ? 3
                            : 4;
  }
  MemoryFrame& frame_;
  Session session_;
  std::optional<PreparedFrame> prepared_;
  std::vector<PlaneIn> in_;
  std::vector<PlaneOut> out_;
};

/// Seconds that it takes, by the wall.
double seconds(auto&& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace brume::bench
