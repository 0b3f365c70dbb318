#include "stress/pixels.h"

#include <algorithm>
#include <limits>

#include "stress/draw.h"

namespace brume::stress {
namespace {

template <class F>
void each_plane(Pixels& p, F&& f) {
  for (auto* three : {p.rgb, p.d, p.o})
    for (int c = 0; c < 3; ++c)
      if (!three[c].empty()) f(three[c]);
  if (!p.t.empty()) f(p.t);
  f(p.alpha);
  for (auto& plane : p.channels)
    if (!plane.empty()) f(plane);
}

// A tile over a part of the pixels; `channels` holds what it points to.
brume_tile tile_of(Pixels& p, const Window& part, const brume_world* world,
                   std::vector<const float*>& channels) {
  const std::size_t at = p.at(part.x, part.y);
  const auto plane = [&](std::vector<float>& v) { return v.empty() ? nullptr : &v[at]; };
  brume_tile tile{};
  tile.size = sizeof tile;
  tile.x = part.x, tile.y = part.y, tile.width = part.width, tile.height = part.height;
  tile.row_stride = p.stride;
  tile.r = plane(p.rgb[0]), tile.g = plane(p.rgb[1]), tile.b = plane(p.rgb[2]);
  tile.a = plane(p.alpha);
  tile.distance = plane(p.t);
  tile.dx = plane(p.d[0]), tile.dy = plane(p.d[1]), tile.dz = plane(p.d[2]);
  tile.ox = plane(p.o[0]), tile.oy = plane(p.o[1]), tile.oz = plane(p.o[2]);
  for (auto& c : p.channels) channels.push_back(plane(c));
  tile.channels = channels.data();
  tile.world = world;
  return tile;
}

}  // namespace

void Pixels::resize(int width_, int height_, int around_, int wide) {
  width = width_, height = height_, around = around_;
  stride = width + 2 * around + wide;
  const std::size_t n = std::size_t(stride * (height + 2 * around));
  for (auto& plane : rgb) plane.assign(n, 0.f);
  alpha.assign(n, 1.f);
}

Pixels Pixels::moved(int wide) const {
  Pixels p = *this;
  p.stride = stride + wide;
  const std::size_t rows = std::size_t(height + 2 * around);
  each_plane(p, [&](std::vector<float>& plane) {
    std::vector<float> out(std::size_t(p.stride) * rows, -7.f);
    for (std::size_t y = 0; y < rows; ++y)
      std::copy_n(&plane[y * std::size_t(stride)], stride,
                  &out[y * std::size_t(p.stride)]);
    plane = std::move(out);
  });
  return p;
}

void Pixels::replicate() {
  each_plane(*this, [&](std::vector<float>& plane) {
    for (int y = -around; y < height + around; ++y)
      for (int x = -around; x < width + around; ++x)
        plane[at(x, y)] =
            plane[at(std::clamp(x, 0, width - 1), std::clamp(y, 0, height - 1))];
  });
}

std::pair<int, int> draw_size(Random& r) {
  constexpr std::pair<int, int> kSizes[] = {
      {1, 1},  {2, 1},  {1, 3},  {128, 1}, {1, 128}, {127, 1}, {11, 11},
      {16, 8}, {8, 16}, {7, 17}, {13, 9},  {32, 4},  {3, 41},  {64, 2}};
  // Small ones seldom: they hold few cases.
  const int k = integer(r, 32);
  return k < 3 ? kSizes[k] : kSizes[3 + integer(r, int(std::size(kSizes)) - 3)];
}

float draw_bad(Random& r) {
  constexpr float kBad[] = {std::numeric_limits<float>::quiet_NaN(),
                            std::numeric_limits<float>::infinity(),
                            -std::numeric_limits<float>::infinity(),
                            -1.f,
                            0.f,
                            1e-42f,
                            3e38f,
                            -1e-20f};
  return kBad[integer(r, int(std::size(kBad)))];
}

void draw_colors(Random& r, Pixels& p, bool spoilt) {
  const double exposure = integer(r, 2) ? 1 : log_uniform(r, 1e-6, 1e6);
  const double sparks = integer(r, 3) ? 0 : r.uniform(0, 0.2),
               brightest = log_uniform(r, 1, 1e9);
  const bool covered = integer(r, 2);
  for (int i = 0; i < p.size(); ++i) {
    const double spark = r.uniform() < sparks ? brightest * r.uniform() : 1;
    for (auto& plane : p.rgb) plane[p.at(i)] = float(exposure * spark * r.uniform());
    p.alpha[p.at(i)] = covered              ? 1
                       : integer(r, 4) == 0 ? float(integer(r, 2))
                                            : float(r.uniform());
    if (!spoilt || integer(r, 6)) continue;
    const int what = integer(r, 4);
    (what < 3 ? p.rgb[what] : p.alpha)[p.at(i)] = draw_bad(r);
  }
}

void run_on(const PixelStage& stage, Pixels& p, const Window& part,
            const brume_world* world) {
  std::vector<const float*> channels;
  stage.run(tile_of(p, part, world, channels));
}

void run_on(const PixelStage& stage, Pixels& p, const brume_world* world) {
  run_on(stage, p, {0, 0, p.width, p.height}, world);
}

std::array<double, 3> truth_of(const PixelStage& stage, Pixels& p, int i,
                               const brume_world* world) {
  std::vector<const float*> channels;
  std::array<double, 3> rgb{};
  const int xy[2] = {i % p.width, i / p.width};
  stage.truth(tile_of(p, {0, 0, p.width, p.height}, world, channels), xy, rgb.data());
  return rgb;
}

}  // namespace brume::stress
