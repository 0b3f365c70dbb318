#include "pipeline/proxy.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "num/error.h"
#include "pipeline/impl.h"

namespace brume {
namespace {

int floor_div(int a, int n) { return a >= 0 ? a / n : -((-a + n - 1) / n); }
int ceil_div(int a, int n) { return -floor_div(-a, n); }

/// The proxy pixels that a window of the frame holds whole.
Window shrink(const Window& w, int n) {
  const int x = ceil_div(w.x, n), y = ceil_div(w.y, n);
  return {x, y, floor_div(w.right(), n) - x, floor_div(w.bottom(), n) - y};
}

std::vector<float> resample(const std::vector<float>& from, const Window& w,
                            const Window& to, int n, bool mean) {
  if (n == 1) return from;
  std::vector<float> out(std::size_t(to.pixels()));
  const auto at = [&](int x, int y) {
    return from[std::size_t(y - w.y) * std::size_t(w.width) + std::size_t(x - w.x)];
  };
  for (int Y = 0; Y < to.height; ++Y)
    for (int X = 0; X < to.width; ++X) {
      const int x0 = (to.x + X) * n, y0 = (to.y + Y) * n;
      double sum = 0;
      if (mean)
        for (int y = y0; y < y0 + n; ++y)
          for (int x = x0; x < x0 + n; ++x) sum += at(x, y);
      out[std::size_t(Y) * std::size_t(to.width) + std::size_t(X)] =
          mean ? float(sum / (double(n) * n)) : at(x0 + n / 2, y0 + n / 2);
    }
  return out;
}

}  // namespace

Image render_part(const PreparedFrame& frame, const FrameFiles& files,
                  const ApplyOptions& options, FrameReport& report) {
  const PreparedFrame::Impl& f = frame.impl();
  const ImageHeader& header = files.main().header();
  const Window data = header.data_window;
  const int n = std::max(1, options.proxy);

  // What is wanted, and what must be at hand around it for the same pixels as in the
  // whole.
  Window wanted = data;
  if (options.region) {
    Window r = *options.region;
    r.x += header.display_window.x, r.y += header.display_window.y;
    wanted = intersect(data, r);
    if (wanted.empty())
      throw Error("--region", "it lies outside the picture",
                  "the data window is " + std::to_string(data.width) + "x" +
                      std::to_string(data.height) + " at " +
                      std::to_string(data.x - header.display_window.x) + "," +
                      std::to_string(data.y - header.display_window.y));
  }
  const Window render = n == 1 ? wanted : shrink(wanted, n);
  if (render.empty())
    throw Error("--proxy", std::to_string(n) + " leaves no pixel of the picture", "");
  Window at_hand = data;
  if (f.around >= 0) {
    const int around = f.around * n;
    at_hand = intersect(data, {wanted.x - around, wanted.y - around,
                               wanted.width + 2 * around, wanted.height + 2 * around});
  }
  const Window grid = n == 1 ? at_hand : shrink(at_hand, n);

  // Every channel of the file, and those of others.
  Image image;
  image.header = header;
  image.header.data_window = render;
  image.header.tiled = false;
  if (n > 1) {
    const Window& d = header.display_window;
    const int x = floor_div(d.x, n), y = floor_div(d.y, n);
    image.header.display_window = {x, y, ceil_div(d.right(), n) - x,
                                   ceil_div(d.bottom(), n) - y};
  }
  const auto is_point = [&](const std::string& channel) {
    for (const int k : {f.depth, f.position[0], f.position[1], f.position[2]})
      if (k >= 0 && f.inputs[std::size_t(k)].channel == channel) return true;
    const int k = header.find(channel);
    return k >= 0 && header.channels[std::size_t(k)].type != PixelType::half &&
           find_depth(header).channel == k;
  };
  const auto crop = [&](const std::vector<float>& plane) {
    std::vector<float> out(std::size_t(render.pixels()));
    for (int y = 0; y < render.height; ++y)
      std::copy_n(plane.data() + std::ptrdiff_t(render.y - grid.y + y) * grid.width +
                      (render.x - grid.x),
                  render.width, out.data() + std::ptrdiff_t(y) * render.width);
    return out;
  };
  for (const Channel& c : header.channels)
    image.planes.push_back(crop(resample(files.read_all({"", c.name, ""}, at_hand, false),
                                         at_hand, grid, n, !is_point(c.name))));

  std::vector<std::vector<float>> in_planes, out_planes;
  std::vector<PlaneIn> in;
  std::vector<PlaneOut> out;
  for (std::size_t i = 0; i < f.inputs.size(); ++i) {
    in_planes.push_back(resample(files.read_all(f.inputs[i], at_hand, int(i) == f.depth),
                                 at_hand, grid, n, !is_point(f.inputs[i].channel)));
    in.push_back({in_planes.back().data(), 1, grid.width});
  }
  for (std::size_t k = 0; k < f.outputs.size(); ++k) {
    out_planes.emplace_back(std::size_t(render.pixels()));
    out.push_back({out_planes.back().data(), 1, render.width});
  }
  FrameBuffers buffers;
  buffers.window = grid;
  buffers.in = in;
  buffers.out = out;
  const auto work = std::chrono::steady_clock::now();
  tbb::task_arena arena(options.threads > 0 ? options.threads
                                            : int(tbb::task_arena::automatic));
  arena.execute([&] { report.counts = frame.apply(buffers, render); });
  report.work_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - work).count();

  for (std::size_t k = 0; k < f.outputs.size(); ++k) {
    const Channel& c = f.outputs[k].channel;
    const int at = image.header.find(c.name);
    if (at >= 0) {
      image.planes[std::size_t(at)] = std::move(out_planes[k]);
      continue;
    }
    const auto place = std::lower_bound(
        image.header.channels.begin(), image.header.channels.end(), c.name,
        [](const Channel& a, const std::string& b) { return a.name < b; });
    image.planes.insert(image.planes.begin() + (place - image.header.channels.begin()),
                        std::move(out_planes[k]));
    image.header.channels.insert(place, c);
  }
  return image;
}

}  // namespace brume
