// Fog over a float buffer, from outside: all that a program needs to use brume.

#include <cstdio>
#include <vector>

#include "pipeline/pipeline.h"
#include "stage/registry.h"

int main() {
  brume::Registry registry;
  const char* scene =
      "[[stage]]\ntype = 'height_fog'\ndensity = 0.01\nfalloff = 0\ncolor = 1";
  brume::Session session(brume::parse_scene(scene, "scene",
                                            [&](auto& type, auto& where) {
                                              return registry.specs(type, where);
                                            }),
                         registry);
  brume::FrameSource source;
  source.header.data_window = source.header.display_window = {0, 0, 4, 1};
  for (const char* name : {"A", "B", "G", "R", "Z"})
    source.header.channels.push_back({.name = name, .type = brume::PixelType::float32});
  const brume::PreparedFrame frame = session.prepare(source);

  // Black pixels at 100 m: the fog adds 1 - exp(-1).
  std::vector<brume::PlaneIn> in;
  std::vector<brume::PlaneOut> out;
  std::vector<std::vector<float>> inputs, outputs(frame.outputs().size());
  for (const brume::InputChannel& c : frame.inputs())
    inputs.emplace_back(4, c.channel == "Z" ? 100.0f : c.channel == "A" ? 1.0f : 0.0f);
  for (const auto& plane : inputs) in.push_back({plane.data(), 1, 4});
  for (auto& plane : outputs) {
    plane.resize(4);
    out.push_back({plane.data(), 1, 4});
  }
  frame.apply({{0, 0, 4, 1}, false, in, out}, {0, 0, 4, 1});
  for (std::size_t i = 0; i < outputs.size(); ++i)
    std::printf("%s %.6f\n", frame.outputs()[i].channel.name.c_str(),
                double(outputs[i][3]));
}
