#include "pipeline/lens.h"

#include <algorithm>
#include <functional>

#include "pipeline/kernels.h"

namespace brume {
namespace {

using pipeline::kernels;

/// An input plane as contiguous rows, top row first.
std::vector<float> gather(const FrameBuffers& b, int input) {
  const Window& w = b.window;
  const PlaneIn& p = b.in[std::size_t(input)];
  std::vector<float> plane(std::size_t(w.pixels()));
  for (int y = 0; y < w.height; ++y) {
    const float* row = p.data + (b.bottom_left ? w.height - 1 - y : y) * p.row_stride;
    for (int x = 0; x < w.width; ++x)
      plane[std::size_t(y) * std::size_t(w.width) + std::size_t(x)] =
          row[x * p.pixel_stride];
  }
  return plane;
}

/// Whether the caller's planes can be worked in: whole, of the same layout, and none of
/// them an input that a lens stage looks at after the air has changed it.
bool may_work_in(const PreparedFrame::Impl& f, const FrameBuffers& b,
                 const Window& render) {
  if (b.bottom_left || render != b.window) return false;
  for (const PlaneOut& p : b.out)
    if (!p.data || p.pixel_stride != 1 || p.row_stride != render.width) return false;
  const auto written = [&](int input) {
    return input >= 0 && std::any_of(b.out.begin(), b.out.end(), [&](const PlaneOut& p) {
             return p.data == b.in[std::size_t(input)].data;
           });
  };
  for (std::size_t k = std::size_t(f.air_end); k < f.stages.size(); ++k) {
    const RunningStage& s = f.stages[k];
    if (written(s.mask) || std::any_of(s.channels.begin(), s.channels.end(), written))
      return false;
  }
  return true;
}

/// Mask and mix: after = before + weight (after - before).
void blend(const RunningStage& stage, const FrameBuffers& b,
           const std::vector<float> (&before)[3],
           const std::function<float*(int)>& after) {
  const Window& w = b.window;
  std::vector<float> weight(std::size_t(w.pixels()), stage.mix);
  if (stage.mask >= 0) {
    const std::vector<float> mask = gather(b, stage.mask);
    for (int y = 0; y < w.height; ++y) {
      const std::size_t row = std::size_t(y) * std::size_t(w.width);
      kernels().weight(w.width, &mask[row], stage.mix, &weight[row]);
    }
  }
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < w.height; ++y) {
      const std::size_t row = std::size_t(y) * std::size_t(w.width);
      kernels().blend(w.width, &before[c][row], after(c) + row, &weight[row],
                      after(c) + row);
    }
}

}  // namespace

ApplyCounts apply_with_lens(const PreparedFrame& frame, const FrameBuffers& buffers,
                            const Window& render) {
  const PreparedFrame::Impl& f = frame.impl();
  const Window& w = buffers.window;
  const std::size_t pixels = std::size_t(w.pixels());

  // Surface and air over everything there is: in the caller's planes, or in own ones of
  // which `render` is copied in the end.
  const bool in_place = may_work_in(f, buffers, render);
  std::vector<std::vector<float>> own(in_place ? 0 : f.outputs.size());
  std::vector<PlaneOut> out(buffers.out.begin(), buffers.out.end());
  for (std::size_t k = 0; k < own.size(); ++k) {
    own[k].resize(pixels);
    out[k] = {own[k].data(), 1, w.width};
  }
  FrameBuffers whole = buffers;
  whole.out = out;
  const bool flipped = buffers.bottom_left;
  const ApplyCounts counts = apply_rows(f, whole, w);
  if (flipped)  // rows of ours count downward from here on
    for (auto& plane : own)
      for (int y = 0; y < w.height / 2; ++y)
        std::swap_ranges(plane.begin() + std::ptrdiff_t(y) * w.width,
                         plane.begin() + std::ptrdiff_t(y + 1) * w.width,
                         plane.begin() + std::ptrdiff_t(w.height - 1 - y) * w.width);

  // Coverage that no stage before changed is the input's.
  std::vector<float> alpha;
  if (f.alpha_out < 0)
    alpha = f.alpha >= 0 ? gather(buffers, f.alpha) : std::vector<float>(pixels, 1.f);
  float* const a = f.alpha_out >= 0 ? out[std::size_t(f.alpha_out)].data : alpha.data();
  const auto color = [&](int c) { return out[std::size_t(f.color_out.first + c)].data; };

  for (std::size_t k = std::size_t(f.air_end); k < f.stages.size(); ++k) {
    const RunningStage& stage = f.stages[k];
    std::vector<float> before[3];
    const bool blended = stage.mask >= 0 || stage.mix != 1;
    const OutputRgb added = f.stage_added_out[k];
    if (blended || added.wanted())
      for (int c = 0; c < 3; ++c) before[c].assign(color(c), color(c) + pixels);

    std::vector<std::vector<float>> channels;
    std::vector<const float*> at;
    for (int c : stage.channels) {
      if (c >= 0) channels.push_back(gather(buffers, c));
      at.push_back(c >= 0 ? channels.back().data() : nullptr);
    }
    brume_tile tile{};
    tile.size = sizeof tile;
    tile.x = w.x, tile.y = w.y, tile.width = w.width, tile.height = w.height;
    tile.row_stride = w.width;
    tile.r = color(0), tile.g = color(1), tile.b = color(2), tile.a = a;
    tile.channels = at.data();
    stage.instance->run(tile);

    if (blended) blend(stage, buffers, before, color);
    for (int c = 0; added.wanted() && c < 3; ++c)
      kernels().difference(int(pixels), color(c), before[c].data(),
                           out[std::size_t(added.first + c)].data);
  }

  // What was asked for.
  for (std::size_t k = 0; k < own.size(); ++k) {
    const PlaneOut& p = buffers.out[k];
    if (!p.data) continue;
    for (int y = 0; y < render.height; ++y) {
      const float* from = &own[k][std::size_t(render.y - w.y + y) * std::size_t(w.width) +
                                  std::size_t(render.x - w.x)];
      float* to = p.data + (flipped ? render.height - 1 - y : y) * p.row_stride;
      for (int x = 0; x < render.width; ++x) to[x * p.pixel_stride] = from[x];
    }
  }
  return {std::uint64_t(render.pixels()), counts.touched};
}

}  // namespace brume
