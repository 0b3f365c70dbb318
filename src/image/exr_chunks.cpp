// Which pixels a chunk holds, and where in it they lie.

#include <fmt/format.h>

#include <algorithm>

#include "image/exr_format.h"

namespace brume::exr {
namespace {

std::int64_t ceil_div(std::int64_t a, std::int64_t b) { return (a + b - 1) / b; }

}  // namespace

int lines_per_chunk(Compression c) {
  switch (c) {
    case Compression::none:
    case Compression::rle:
    case Compression::zips:
      return 1;
    case Compression::zip:
    case Compression::pxr24:
      return 16;
    case Compression::piz:
    case Compression::b44:
    case Compression::b44a:
    case Compression::dwaa:
      return 32;
    case Compression::dwab:
      return 256;
  }
  return 1;
}

int Part::chunk_lines() const {
  return tiles ? static_cast<int>(tiles->height) : lines_per_chunk(header.compression);
}

int Part::tiles_across() const {
  return tiles ? static_cast<int>(ceil_div(header.data_window.width, tiles->width)) : 1;
}

std::int64_t Part::chunk_rows() const {
  return ceil_div(header.data_window.height, chunk_lines());
}

std::int64_t Part::chunk_count() const {
  if (!tiles || tiles->levels == Tiles::Levels::one) return level_chunks();
  // Level sizes halve, rounded down or up, until the larger (mipmap) or each (ripmap)
  // side is 1.
  auto size_at = [&](std::int64_t side, int level) {
    const std::int64_t unit = std::int64_t(1) << level;
    return std::max<std::int64_t>(1,
                                  tiles->round_up ? ceil_div(side, unit) : side / unit);
  };
  auto levels_of = [&](std::int64_t side) {
    int n = 0;
    while (tiles->round_up ? (std::int64_t(1) << n) < side
                           : (std::int64_t(1) << (n + 1)) <= side)
      ++n;
    return n + 1;
  };
  const std::int64_t w = header.data_window.width, h = header.data_window.height;
  auto chunks = [&](int lx, int ly) {
    return ceil_div(size_at(w, lx), tiles->width) *
           ceil_div(size_at(h, ly), tiles->height);
  };
  std::int64_t count = 0;
  if (tiles->levels == Tiles::Levels::mipmap) {
    for (int l = 0; l < levels_of(std::max(w, h)); ++l) count += chunks(l, l);
  } else {
    for (int ly = 0; ly < levels_of(h); ++ly)
      for (int lx = 0; lx < levels_of(w); ++lx) count += chunks(lx, ly);
  }
  return count;
}

Window Part::chunk_window(std::int64_t i) const {
  const Window& d = header.data_window;
  const int across = tiles_across(), lines = chunk_lines();
  const int width = tiles ? static_cast<int>(tiles->width) : d.width;
  const int x = static_cast<int>(i % across) * width;
  const auto y = static_cast<int>(i / across * lines);
  return {d.x + x, d.y + y, std::min(width, d.width - x), std::min(lines, d.height - y)};
}

std::string chunk_text(const Part& part, std::int64_t i) {
  const Window w = part.chunk_window(i);
  if (part.tiles)
    return fmt::format("tile {} of tile row {}", i % part.tiles_across(),
                       i / part.tiles_across());
  if (w.height == 1) return fmt::format("row {}", w.y);
  return fmt::format("rows {} to {}", w.y, w.bottom() - 1);
}

ChunkLayout::ChunkLayout(const std::vector<Channel>& channels, const Window& window)
    : channels_(&channels), window_(window) {
  for (const Channel& c : channels) {
    width_.push_back(sample_count(window.x, window.width, c.x_sampling));
    offset_.push_back(row_bytes_);
    row_bytes_ += std::size_t(width_.back()) * bytes_per_sample(c.type);
    regular_ = regular_ && c.y_sampling == 1;
  }
  size_ = row_bytes_ * window.height;
  if (regular_) return;
  size_ = 0;
  for (int r = 0; r < window.height; ++r) {
    row_offsets_.push_back(size_);
    for (std::size_t c = 0; c < channels.size(); ++c)
      size_ += std::size_t(samples(c, r)) * bytes_per_sample(channels[c].type);
  }
}

int ChunkLayout::samples(std::size_t channel, int row) const {
  const int s = (*channels_)[channel].y_sampling;
  return s == 1 || floor_mod(window_.y + row, s) == 0 ? width_[channel] : 0;
}

std::size_t ChunkLayout::offset(std::size_t channel, int row) const {
  if (regular_) return row * row_bytes_ + offset_[channel];
  std::size_t at = row_offsets_[row];
  for (std::size_t c = 0; c < channel; ++c)
    at += std::size_t(samples(c, row)) * bytes_per_sample((*channels_)[c].type);
  return at;
}

}  // namespace brume::exr
