#include "image/exr_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <thread>

#include "image/exr_codec.h"
#include "image/kernels.h"
#include "num/error.h"

namespace brume::exr {
namespace {

void convert(PixelType type, const std::uint8_t* samples, float* out, std::size_t n) {
  switch (type) {
    case PixelType::half:
      return kernels().float_from_half(samples, out, n);
    case PixelType::float32:
      std::copy_n(samples, 4 * n, reinterpret_cast<std::uint8_t*>(out));
      return;
    case PixelType::uint32:
      return kernels().float_from_uint(samples, out, n);
  }
}

/// Memory for chunks held only because they were read lately.
constexpr std::size_t kLatestBytes = 4 << 20;

}  // namespace

void expand_row(const Channel& c, const std::uint8_t* samples, int width, float* out) {
  const int n = sample_count(0, width, c.x_sampling);
  convert(c.type, samples, out, n);
  if (c.x_sampling == 1) return;
  for (int x = width; x-- > 0;) out[x] = out[x / c.x_sampling];
}

Reader::Reader(std::shared_ptr<const File> file, int part)
    : file_(std::move(file)), index_(part) {
  path_ = file_->path();
  const auto count = static_cast<int>(file_->parts().size());
  if (part < 0 || part >= count)
    throw Error(path_.string(), fmt::format("has no part {}", part),
                fmt::format("{} parts, counted from 0", count));
  part_ = &file_->parts()[part];
  header_ = part_->header;
  if (header_.deep) throw Error(path_.string(), "deep files are not supported yet");
  const std::size_t threads = std::max(1u, std::thread::hardware_concurrency());
  alive_.resize(part_->level_chunks());
  const std::size_t bytes =
      ChunkLayout(header_.channels, part_->chunk_window(0)).size() + 1;
  latest_.resize(std::clamp<std::size_t>(kLatestBytes / bytes, 1, 4 * threads));
}

std::shared_ptr<const Chunk> Reader::unpack_chunk(std::int64_t i) const {
  const Window window = part_->chunk_window(i);
  thread_local std::vector<std::uint8_t> payload;
  file_->read_chunk(index_, i, payload);
  auto chunk = std::make_shared<Chunk>(
      Chunk{window, ChunkLayout(part_->header.channels, window), {}});
  const std::size_t size = chunk->layout.size();
  chunk->pixels = std::make_unique_for_overwrite<std::uint8_t[]>(size);
  unpack(part_->header, window, payload, {chunk->pixels.get(), size},
         path_.string() + ": " + chunk_text(*part_, i));
  return chunk;
}

std::shared_ptr<const Chunk> Reader::chunk(std::int64_t i) const {
  {
    const std::lock_guard lock(mutex_);
    if (auto alive = alive_[i].lock()) return alive;
  }
  // Two threads may unpack the same chunk; both get the same pixels.
  auto fresh = unpack_chunk(i);
  std::shared_ptr<const Chunk> dropped;  // freed outside the lock
  const std::lock_guard lock(mutex_);
  alive_[i] = fresh;
  dropped = std::exchange(latest_[next_++ % latest_.size()], fresh);
  return fresh;
}

void Reader::read(int y, int rows, std::span<const int> channels,
                  std::span<float* const> out) const {
  const Window& d = header_.data_window;
  if (rows < 1) return;
  if (y < d.y || rows > d.bottom() - y)
    throw Error(path_.string(), fmt::format("rows {} to {} are outside the data window",
                                            y, std::int64_t(y) + rows - 1));
  const int lines = part_->chunk_lines(), across = part_->tiles_across();
  // Chunk row by chunk row; a channel that skips rows may find its sample one row of
  // chunks higher.
  for (int row = y; row < y + rows;) {
    const int chunk_row = (row - d.y) / lines;
    const int stop = std::min({y + rows, d.bottom(), d.y + (chunk_row + 1) * lines});
    for (int a = 0; a < across; ++a) {
      auto current = chunk(std::int64_t(chunk_row) * across + a);
      for (int r = row; r < stop; ++r)
        for (std::size_t k = 0; k < channels.size(); ++k) {
          const Channel& c = header_.channels[channels[k]];
          const int sample_row = r - floor_mod(r, c.y_sampling);
          const Window& w = current->window;
          float* to = out[k] + std::size_t(r - y) * d.width + (w.x - d.x);
          if (sample_row >= w.y) {
            expand_row(c, current->row(channels[k], sample_row), w.width, to);
          } else {
            const auto above = chunk((sample_row - d.y) / lines);
            expand_row(c, above->row(channels[k], sample_row), w.width, to);
          }
        }
    }
    row = stop;
  }
}

}  // namespace brume::exr
