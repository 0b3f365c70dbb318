#include "stage/sheet.h"

#include <algorithm>
#include <utility>

namespace brume {
namespace {

template <class F>
void each_plane(Sheet& s, F&& f) {
  const auto some = [&](std::vector<float>& plane) {
    if (!plane.empty()) f(plane);
  };
  for (auto* three : {s.rgb, s.d, s.o})
    for (int c = 0; c < 3; ++c) some(three[c]);
  some(s.alpha), some(s.t);
  for (auto& plane : s.channels) some(plane);
}

}  // namespace

void Sheet::resize(int width_, int height_, int around_, int wide) {
  Sheet s;
  s.x = x, s.y = y;
  s.width = width_, s.height = height_, s.around = around_;
  s.stride = width_ + 2 * around_ + wide;
  *this = std::move(s);
  const auto n = std::size_t(stride * (height + 2 * around));
  for (auto& plane : rgb) plane.assign(n, 0.f);
  alpha.assign(n, 1.f);
}

std::vector<float> Sheet::lay(const std::vector<float>& plane) const {
  std::vector<float> out;
  if (plane.empty()) return out;
  out.resize(std::size_t(stride * (height + 2 * around)));
  for (int row = -around; row < height + around; ++row)
    for (int column = -around; column < width + around; ++column)
      out[at(column, row)] =
          plane[std::size_t(std::clamp(row, 0, height - 1)) * std::size_t(width) +
                std::size_t(std::clamp(column, 0, width - 1))];
  return out;
}

void Sheet::replicate() {
  each_plane(*this, [&](std::vector<float>& plane) {
    for (int row = -around; row < height + around; ++row)
      for (int column = -around; column < width + around; ++column)
        plane[at(column, row)] =
            plane[at(std::clamp(column, 0, width - 1), std::clamp(row, 0, height - 1))];
  });
}

Sheet Sheet::moved(int wide) const {
  Sheet s = *this;
  s.stride = stride + wide;
  const auto rows = std::size_t(height + 2 * around);
  each_plane(s, [&](std::vector<float>& plane) {
    std::vector<float> out(std::size_t(s.stride) * rows, -7.f);
    for (std::size_t row = 0; row < rows; ++row)
      std::copy_n(&plane[row * std::size_t(stride)], stride,
                  &out[row * std::size_t(s.stride)]);
    plane = std::move(out);
  });
  return s;
}

Sheet::Tile::Tile(Sheet& s, const Window& part, const brume_world* world) {
  const std::size_t at = s.at(part.x, part.y);
  const auto plane = [at](std::vector<float>& v) { return v.empty() ? nullptr : &v[at]; };
  tile_.size = sizeof tile_;
  tile_.x = s.x + part.x, tile_.y = s.y + part.y;
  tile_.width = part.width, tile_.height = part.height;
  tile_.row_stride = s.stride;
  tile_.r = plane(s.rgb[0]), tile_.g = plane(s.rgb[1]), tile_.b = plane(s.rgb[2]);
  tile_.a = plane(s.alpha);
  tile_.distance = plane(s.t);
  tile_.dx = plane(s.d[0]), tile_.dy = plane(s.d[1]), tile_.dz = plane(s.d[2]);
  tile_.ox = plane(s.o[0]), tile_.oy = plane(s.o[1]), tile_.oz = plane(s.o[2]);
  for (auto& c : s.channels) channels_.push_back(plane(c));
  tile_.channels = channels_.data();
  tile_.world = world;
}

}  // namespace brume
