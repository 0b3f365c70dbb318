#include "image/exr_copy.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <mutex>
#include <optional>

#include "image/exr_codec.h"
#include "image/exr_plan.h"
#include "image/exr_reader.h"
#include "image/exr_writer.h"
#include "image/kernels.h"
#include "num/error.h"

namespace brume::exr {
namespace {

using Clock = std::chrono::steady_clock;

/// What one band needs, kept for the next.
struct Buffers {
  std::vector<std::vector<float>> planes;  ///< to be written, then those only read
  std::vector<std::shared_ptr<const Chunk>> held;  ///< the source's chunks of the band
  std::int64_t first_held = 0;
};

struct PackedChunk {
  std::int64_t index;
  std::vector<std::uint8_t> payload;
  std::optional<File::Extent> source;  ///< as it lies there, instead
};
struct PackedBand {
  int rows = 0;
  std::vector<PackedChunk> chunks;
};

/// Adds the time it lives to a sum over threads.
class Timer {
 public:
  explicit Timer(std::atomic<std::int64_t>& sum) : sum_(sum) {}
  ~Timer() { sum_ += (Clock::now() - start_).count(); }

 private:
  std::atomic<std::int64_t>& sum_;
  Clock::time_point start_ = Clock::now();
};

class Copy {
 public:
  Copy(const ImageReader& source, const Edit& edit, const std::filesystem::path& out,
       const std::function<void(Band&)>& work, const CopyOptions& options)
      : source_(source),
        reader_(dynamic_cast<const Reader*>(&source)),
        edit_(edit),
        out_path_(out),
        work_(work),
        options_(options),
        bytes_before_(source.bytes_read()),
        plan_(plan_copy(source, edit, out, options.whole_frame)) {}

  CopyReport run();

 private:
  void make_band(int b, PackedBand&);
  void copy_chunks(PackedBand&);
  void unpack(const Window& rows, Buffers&);
  bool work_on(const Window& rows, Buffers&);
  void pack_chunk(PackedChunk&, const Buffers&, const Window& rows, bool touched);
  void write_row(const Channel&, const float* plane_row, std::uint8_t* to, int width);
  void run_bands(const std::function<void(PackedBand&)>& write);
  int band_index(int step) const {
    return plan_.descending ? plan_.bands - 1 - step : step;
  }
  void for_each(std::int64_t n, const std::function<void(std::int64_t)>&) const;
  void stop_if_cancelled() const {
    if (options_.cancel && *options_.cancel)
      throw Error(out_path_.string(), "interrupted");
  }

  const ImageReader& source_;
  const Reader* reader_;  ///< the source where it is EXR: its bits can be copied
  const Edit& edit_;
  const std::filesystem::path& out_path_;
  const std::function<void(Band&)>& work_;
  const CopyOptions& options_;
  std::uint64_t bytes_before_;
  CopyPlan plan_;

  std::mutex mutex_;
  std::vector<std::unique_ptr<Buffers>> free_;
  std::atomic<std::int64_t> read_ns_ = 0, work_ns_ = 0, write_ns_ = 0;
  std::atomic<std::uint64_t> overflows_ = 0, copied_ = 0;
};

// Over the chunks of one band: by all threads where the band is the whole frame.
void Copy::for_each(std::int64_t n, const std::function<void(std::int64_t)>& body) const {
  if (options_.whole_frame && options_.threads != 1)
    tbb::parallel_for(std::int64_t(0), n, body);
  else
    for (std::int64_t i = 0; i < n; ++i) body(i);
}

void Copy::copy_chunks(PackedBand& band) {
  const Timer timer(read_ns_);
  for (PackedChunk& c : band.chunks)
    c.source = reader_->file().chunk_extent(plan_.part, c.index);
  copied_ += band.chunks.size();
}

// The source's chunks, held while the band is worked on (what `work` reads of them comes
// unpacked), and the planes: changed channels start as the source has them, added ones
// as 0. A large whole frame is not held: its chunks are unpacked a second time to be
// packed, which costs less than its memory.
void Copy::unpack(const Window& rows, Buffers& buffers) {
  const Timer timer(read_ns_);
  constexpr std::int64_t kMostHeld = 64 << 20;
  const int top = source_.header().data_window.y;
  const int lines = reader_ ? reader_->band_rows() : rows.height;
  if (reader_) {
    const Part& p = reader_->part();
    const std::int64_t across = p.tiles_across();
    const std::int64_t first = (rows.y - top) / lines * across;
    const std::int64_t count = (rows.bottom() - top + lines - 1) / lines * across - first;
    const auto bytes = static_cast<std::int64_t>(
        ChunkLayout(p.header.channels, p.chunk_window(first)).size());
    if (!options_.whole_frame || count * bytes <= kMostHeld) {
      buffers.first_held = first;
      buffers.held.resize(count);
      for_each(count,
               [&](std::int64_t i) { buffers.held[i] = reader_->chunk(first + i); });
    }
  }

  std::vector<int> from = plan_.plane_sources;
  from.insert(from.end(), edit_.read.begin(), edit_.read.end());
  buffers.planes.resize(from.size());
  std::vector<int> channels;
  std::vector<float*> out;
  for (std::size_t i = 0; i < from.size(); ++i) {
    std::vector<float>& plane = buffers.planes[i];
    plane.resize(static_cast<std::size_t>(rows.pixels()));
    if (from[i] < 0) {
      std::fill(plane.begin(), plane.end(), 0.0f);
    } else {
      channels.push_back(from[i]);
      out.push_back(plane.data());
    }
  }
  if (channels.empty()) return;
  for_each((rows.height + lines - 1) / lines, [&](std::int64_t i) {
    const int skip = static_cast<int>(i) * lines;
    std::vector<float*> to;
    for (float* plane : out) to.push_back(plane + std::size_t(skip) * rows.width);
    source_.read(rows.y + skip, std::min(lines, rows.height - skip), channels, to);
  });
}

bool Copy::work_on(const Window& rows, Buffers& buffers) {
  const Timer timer(work_ns_);
  std::vector<float*> out;
  for (std::size_t i = 0; i < edit_.channels.size(); ++i)
    out.push_back(buffers.planes[i].data());
  std::vector<const float*> in;
  for (std::size_t i = 0; i < edit_.read.size(); ++i)
    in.push_back(buffers.planes[plan_.plane_sources.size() + i].data());
  Band band{rows.y, rows.height, out, in, true};
  if (work_) work_(band);
  return band.touched;
}

void Copy::write_row(const Channel& c, const float* row, std::uint8_t* to, int width) {
  thread_local std::vector<float> picked;
  const int n = sample_count(0, width, c.x_sampling);
  if (c.x_sampling > 1) {
    picked.resize(n);
    for (int i = 0; i < n; ++i) picked[i] = row[i * c.x_sampling];
    row = picked.data();
  }
  switch (c.type) {
    case PixelType::half: {
      const std::size_t overflows = kernels().half_from_float(row, to, n);
      if (overflows) overflows_ += overflows;
      return;
    }
    case PixelType::float32:
      std::memcpy(to, row, std::size_t(n) * 4);
      return;
    case PixelType::uint32:
      return kernels().uint_from_float(row, to, n);
  }
}

void Copy::pack_chunk(PackedChunk& chunk, const Buffers& buffers, const Window& rows,
                      bool touched) {
  const Part& part = plan_.edited();
  const Window w = part.chunk_window(chunk.index);
  const ChunkLayout layout(plan_.channels, w);
  // Which channels come by their bits.
  std::vector<bool> by_bits;
  for (std::size_t c = 0; c < plan_.channels.size(); ++c) {
    const Origin& o = plan_.origins[c];
    by_bits.push_back(
        reader_ && o.source >= 0 &&
        (o.plane < 0 ||
         (!touched && plan_.channels[c] == source_.header().channels[o.source])));
  }
  const bool any = std::find(by_bits.begin(), by_bits.end(), true) != by_bits.end();

  thread_local std::vector<std::uint8_t> pixels;
  pixels.resize(layout.size());
  std::shared_ptr<const Chunk> from;
  std::int64_t from_index = -1;
  for (int r = 0; r < w.height; ++r) {
    const int y = w.y + r;
    if (any) {
      const std::int64_t i = part.tiles
                                 ? chunk.index
                                 : (y - part.header.data_window.y) / reader_->band_rows();
      if (i != from_index) {
        from = buffers.held.empty() ? reader_->chunk(i)
                                    : buffers.held[i - buffers.first_held];
        from_index = i;
      }
    }
    for (std::size_t c = 0; c < plan_.channels.size(); ++c) {
      const Channel& channel = plan_.channels[c];
      const Origin& o = plan_.origins[c];
      const int n = layout.samples(c, r);
      if (n == 0) continue;
      std::uint8_t* to = pixels.data() + layout.offset(c, r);
      if (by_bits[c])
        std::memcpy(to, from->row(o.source, y),
                    std::size_t(n) * bytes_per_sample(channel.type));
      else
        write_row(channel,
                  buffers.planes[o.plane].data() + std::size_t(y - rows.y) * rows.width +
                      (w.x - rows.x),
                  to, w.width);
    }
  }
  pack(part.header, w, pixels, chunk.payload, out_path_.string());
}

// Into `band`, whose memory may be that of an earlier one.
void Copy::make_band(int b, PackedBand& band) {
  stop_if_cancelled();
  const Window rows = plan_.band_window(b);
  const auto chunks = plan_.chunks_of(rows);
  band.rows = rows.height;
  band.chunks.resize(chunks.size());
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    band.chunks[i].index = chunks[i];
    band.chunks[i].source.reset();
  }

  bool touched = !edit_.channels.empty() &&
                 (!options_.touches || options_.touches(rows.y, rows.height));
  if (plan_.copyable && !touched) {
    copy_chunks(band);
    return;
  }
  std::unique_ptr<Buffers> buffers;
  {
    const std::lock_guard lock(mutex_);
    if (!free_.empty()) buffers = std::move(free_.back()), free_.pop_back();
  }
  if (!buffers) buffers = std::make_unique<Buffers>();
  unpack(rows, *buffers);
  if (touched) touched = work_on(rows, *buffers);
  stop_if_cancelled();
  if (!touched && plan_.copyable) {
    copy_chunks(band);
  } else {
    const Timer timer(write_ns_);
    for_each(static_cast<std::int64_t>(band.chunks.size()), [&](std::int64_t i) {
      pack_chunk(band.chunks[i], *buffers, rows, touched);
    });
  }
  buffers->held.clear();
  const std::lock_guard lock(mutex_);
  free_.push_back(std::move(buffers));
}

// Threads share bands; finished ones wait compressed for their turn in the file, no more
// than a few.
void Copy::run_bands(const std::function<void(PackedBand&)>& write) {
  const bool only_copies = plan_.copyable && edit_.channels.empty();
  int threads = only_copies            ? 1
                : options_.threads > 0 ? options_.threads
                                       : tbb::this_task_arena::max_concurrency();
  PackedBand one;
  if (threads == 1 || (plan_.bands == 1 && !options_.whole_frame)) {
    for (int step = 0; step < plan_.bands; ++step) {
      make_band(band_index(step), one);
      write(one);
    }
    return;
  }
  // More threads than processors only if somebody asks for them.
  using Control = tbb::global_control;
  std::optional<Control> more;
  if (std::size_t(threads) > Control::active_value(Control::max_allowed_parallelism))
    more.emplace(Control::max_allowed_parallelism, threads);
  threads =
      std::min(threads, int(Control::active_value(Control::max_allowed_parallelism)));
  tbb::task_arena arena(threads);
  arena.execute([&] {
    if (plan_.bands == 1) {
      make_band(0, one);
      return write(one);
    }
    int step = 0;
    tbb::parallel_pipeline(
        static_cast<std::size_t>(2 * threads),
        tbb::make_filter<void, int>(tbb::filter_mode::serial_in_order,
                                    [&](tbb::flow_control& flow) {
                                      if (step == plan_.bands) flow.stop();
                                      return step < plan_.bands ? step++ : 0;
                                    }) &
            tbb::make_filter<int, PackedBand>(tbb::filter_mode::parallel,
                                              [&](int s) {
                                                PackedBand band;
                                                make_band(band_index(s), band);
                                                return band;
                                              }) &
            tbb::make_filter<PackedBand, void>(tbb::filter_mode::serial_in_order,
                                               [&](PackedBand band) { write(band); }));
  });
}

CopyReport Copy::run() {
  CopyReport report;
  Writer writer(out_path_, plan_.parts, plan_.flags);
  int rows_done = 0;
  const int height = plan_.parts[plan_.part].header.data_window.height;
  for (int p = 0; p < static_cast<int>(plan_.parts.size()); ++p) {
    if (p != plan_.part ||
        (plan_.parts[p].tiles && plan_.parts[p].tiles->levels != Tiles::Levels::one)) {
      // Another part, or one with levels (which nothing changes): as it is.
      for (std::int64_t i = 0; i < plan_.parts[p].chunk_count(); ++i) {
        stop_if_cancelled();
        writer.copy(p, i, reader_->file(), reader_->file().any_extent(p, i));
        ++report.chunks;
        ++report.chunks_copied;
      }
      continue;
    }
    run_bands([&](PackedBand& band) {
      const Timer timer(write_ns_);
      for (const PackedChunk& c : band.chunks)
        c.source ? writer.copy(plan_.part, c.index, reader_->file(), *c.source)
                 : writer.add(plan_.part, c.index, c.payload);
      report.chunks += band.chunks.size();
      rows_done += band.rows;
      if (options_.progress) options_.progress(double(rows_done) / height);
    });
  }
  stop_if_cancelled();
  {
    const Timer timer(write_ns_);
    writer.commit();
  }
  auto seconds = [](std::int64_t ns) {
    return std::chrono::duration<double>(Clock::duration(ns)).count();
  };
  report.bytes_read = source_.bytes_read() - bytes_before_;
  report.bytes_written = writer.size();
  report.half_overflows = overflows_;
  report.chunks_copied += copied_;
  report.streamed = !options_.whole_frame && (!reader_ || reader_->streams());
  report.read_seconds = seconds(read_ns_);
  report.work_seconds = seconds(work_ns_);
  report.write_seconds = seconds(write_ns_);
  return report;
}

}  // namespace

CopyReport copy(const ImageReader& source, const Edit& edit,
                const std::filesystem::path& out, const std::function<void(Band&)>& work,
                const CopyOptions& options) {
  return Copy(source, edit, out, work, options).run();
}

}  // namespace brume::exr
