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
#include "image/exr_reader.h"
#include "image/exr_writer.h"
#include "image/kernels.h"
#include "num/error.h"

namespace brume::exr {
namespace {

using Clock = std::chrono::steady_clock;

/// Where an output channel comes from: the source's bits, or a float plane.
struct Origin {
  int source = -1, plane = -1;
};

/// What one band needs, kept for the next.
struct Buffers {
  std::vector<std::vector<float>> planes;  ///< to be written, then those only read
  std::vector<std::shared_ptr<const Chunk>> held;  ///< the source's chunks of the band
  std::int64_t first_held = 0;
};

struct PackedChunk {
  std::int64_t index;
  std::vector<std::uint8_t> payload;
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
        bytes_before_(source.bytes_read()) {
    plan_channels();
    plan_part();
    plan_bands();
  }

  CopyReport run();

 private:
  void plan_channels();
  void plan_part();
  void plan_bands();

  int band_index(int step) const { return descending_ ? bands_ - 1 - step : step; }
  Window band_window(int b) const;
  PackedBand make_band(int b);
  void copy_chunks(PackedBand&) const;
  void fill_planes(const Window& rows, Buffers&) const;
  void pack_chunk(PackedChunk&, const Buffers&, const Window& rows, bool touched);
  void write_row(const Channel&, const float* plane_row, std::uint8_t* to, int width);
  void run_bands(const std::function<void(PackedBand&)>& write);
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

  std::vector<Part> parts_;  ///< of the output
  int part_ = 0;             ///< the one being edited
  std::uint32_t flags_ = 0;
  std::vector<Channel> channels_;   ///< of the output, sorted
  std::vector<Origin> origins_;     ///< of them
  std::vector<int> plane_sources_;  ///< source channel that a plane starts as, or -1
  bool copyable_ = false;           ///< a chunk may be copied as it is
  bool descending_ = false;
  int band_rows_ = 1, bands_ = 1;

  std::mutex mutex_;
  std::vector<std::unique_ptr<Buffers>> free_;
  std::atomic<std::int64_t> read_ns_ = 0, work_ns_ = 0, write_ns_ = 0;
  std::atomic<std::uint64_t> overflows_ = 0, copied_ = 0;
};

// Output channels: the source's by their bits, the edit's as planes. A source that is no
// EXR has no bits to copy: its other channels become planes too.
void Copy::plan_channels() {
  const std::vector<Channel>& have = source_.header().channels;
  struct Planned {
    Channel channel;
    Origin origin;
  };
  std::vector<Planned> all;
  for (std::size_t i = 0; i < edit_.channels.size(); ++i) {
    Channel c = edit_.channels[i];
    const int source = source_.header().find(c.name);
    plane_sources_.push_back(source);
    if (source >= 0 && !edit_.retype) c = have[source];
    for (const Planned& other : all)
      if (other.channel.name == c.name)
        throw Error(out_path_.string(), "channel " + c.name + " is written twice");
    all.push_back({c, {source, static_cast<int>(i)}});
  }
  for (std::size_t i = 0; i < have.size() && !edit_.only_these; ++i) {
    const auto known = std::find_if(all.begin(), all.end(), [&](const Planned& p) {
      return p.channel.name == have[i].name;
    });
    if (known != all.end()) continue;
    Origin origin{static_cast<int>(i), -1};
    if (!reader_) {
      origin.plane = static_cast<int>(plane_sources_.size());
      plane_sources_.push_back(static_cast<int>(i));
    }
    all.push_back({have[i], origin});
  }
  std::sort(all.begin(), all.end(), [](const Planned& a, const Planned& b) {
    return a.channel.name < b.channel.name;
  });
  for (Planned& p : all) {
    channels_.push_back(p.channel);
    origins_.push_back(p.origin);
  }
}

// The output's headers: the source's bytes, but for what changes.
void Copy::plan_part() {
  const std::string where = out_path_.string();
  for (const auto& [name, value] : edit_.attributes)
    for (const char* fixed : {"channels", "compression", "dataWindow", "displayWindow",
                              "lineOrder", "tiles", "type", "chunkCount", "name"})
      if (name == fixed) throw Error(where, "attribute " + name + " cannot be set");
  ImageHeader header = source_.header();
  header.channels = channels_;
  if (edit_.compression) header.compression = *edit_.compression;
  if (edit_.dwa_level) header.dwa_level = edit_.dwa_level;

  std::vector<NamedAttribute> keep;
  if (reader_) {
    for (const Part& p : reader_->file().parts()) {
      parts_.push_back(p);
      parts_.back().offsets.clear();
    }
    part_ = reader_->part_index();
    flags_ = reader_->file().flags();
    keep = parts_[part_].attributes;
  } else {
    parts_.resize(1);
    header.deep = false;
    if (header.tiled) {
      flags_ |= kTiledFlag;
      // One level: the pixels of others are not ours to invent.
      Attribute& tiles = header.attributes["tiles"];
      if (tiles.type != "tiledesc" || tiles.bytes.size() != 9)
        tiles = {"tiledesc", {64, 0, 0, 0, 64, 0, 0, 0, 0}};
      tiles.bytes[8] = 0;
    }
  }
  for (const auto& [name, value] : edit_.attributes) header.attributes[name] = value;
  Part& part = parts_[part_];
  part.header = header;
  part.attributes = attributes_of(header, std::move(keep), std::nullopt);
  part.header = {};
  understand(part, flags_, where);
  part.attributes = attributes_of(part.header, part.attributes, part.chunk_count());

  copyable_ = reader_ && header.channels == source_.header().channels &&
              header.compression == source_.header().compression &&
              header.dwa_level == source_.header().dwa_level;
  if (reader_ && part.tiles && part.tiles->levels != Tiles::Levels::one &&
      (!copyable_ || !edit_.channels.empty()))
    throw Error(source_.path().string(),
                "holds mipmap or ripmap levels, which would not follow a change",
                "make a one-level copy first (exrmaketiled without -m or -r)");
}

// Bands hold whole chunks of source and output, and start where the data window does.
void Copy::plan_bands() {
  const Part& part = parts_[part_];
  const int height = part.header.data_window.height;
  band_rows_ = std::max(part.chunk_lines(), reader_ ? reader_->band_rows() : 1);
  if (!part.tiles) {
    // Work on single rows is all overhead.
    constexpr int kFewestRows = 16;
    band_rows_ = std::max(band_rows_, kFewestRows);
  }
  if (options_.whole_frame) band_rows_ = height;
  band_rows_ = std::min(band_rows_, height);
  bands_ = (height + band_rows_ - 1) / band_rows_;
  descending_ = part.line_order == LineOrder::decreasing;
}

Window Copy::band_window(int b) const {
  const Window& d = parts_[part_].header.data_window;
  const int y = b * band_rows_;
  return {d.x, d.y + y, d.width, std::min(band_rows_, d.height - y)};
}

void Copy::copy_chunks(PackedBand& band) const {
  for (PackedChunk& c : band.chunks)
    reader_->file().read_chunk(part_, c.index, c.payload);
}

// Changed channels start as the source has them, added ones as 0.
void Copy::fill_planes(const Window& rows, Buffers& buffers) const {
  std::vector<int> from = plane_sources_;
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
  if (!channels.empty()) source_.read(rows.y, rows.height, channels, out);
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
  const Part& part = parts_[part_];
  const Window w = part.chunk_window(chunk.index);
  const ChunkLayout layout(channels_, w);
  thread_local std::vector<std::uint8_t> pixels;
  pixels.resize(layout.size());
  for (int r = 0; r < w.height; ++r) {
    const int y = w.y + r;
    const Chunk* from = nullptr;
    if (reader_) {
      const int lines = reader_->part().chunk_lines();
      const std::int64_t i =
          part.tiles ? chunk.index : (y - part.header.data_window.y) / lines;
      from = buffers.held[i - buffers.first_held].get();
    }
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const int n = layout.samples(c, r);
      if (n == 0) continue;
      std::uint8_t* to = pixels.data() + layout.offset(c, r);
      const Origin& origin = origins_[c];
      const bool by_bits =
          origin.source >= 0 && reader_ &&
          (origin.plane < 0 ||
           (!touched && channels_[c] == source_.header().channels[origin.source]));
      if (by_bits)
        std::memcpy(to, from->row(origin.source, y),
                    std::size_t(n) * bytes_per_sample(channels_[c].type));
      else
        write_row(channels_[c],
                  buffers.planes[origin.plane].data() +
                      std::size_t(y - rows.y) * rows.width + (w.x - rows.x),
                  to, w.width);
    }
  }
  pack(part.header, w, pixels, chunk.payload, out_path_.string());
}

PackedBand Copy::make_band(int b) {
  stop_if_cancelled();
  const Part& part = parts_[part_];
  const Window rows = band_window(b);
  PackedBand band{rows.height, {}};
  const std::int64_t lines = part.chunk_lines(), across = part.tiles_across();
  const std::int64_t first = (rows.y - part.header.data_window.y) / lines;
  const std::int64_t stop = first + (rows.height + lines - 1) / lines;
  for (std::int64_t r = first; r < stop; ++r)
    for (std::int64_t a = 0; a < across; ++a)
      band.chunks.push_back(
          {(descending_ ? stop - 1 - (r - first) : r) * across + a, {}});

  bool touched = !edit_.channels.empty() &&
                 (!options_.touches || options_.touches(rows.y, rows.height));
  if (copyable_ && !touched) {
    const Timer timer(read_ns_);
    copy_chunks(band);
    copied_ += band.chunks.size();
    return band;
  }

  std::unique_ptr<Buffers> buffers;
  {
    const std::lock_guard lock(mutex_);
    if (!free_.empty()) buffers = std::move(free_.back()), free_.pop_back();
  }
  if (!buffers) buffers = std::make_unique<Buffers>();

  // The source's chunks are held while the band is worked on: what `work` reads of them
  // comes unpacked.
  const bool parallel = options_.whole_frame && options_.threads != 1;
  auto for_each = [&](std::int64_t n, auto&& body) {
    if (parallel)
      tbb::parallel_for(std::int64_t(0), n, body);
    else
      for (std::int64_t i = 0; i < n; ++i) body(i);
  };
  {
    const Timer timer(read_ns_);
    if (reader_) {
      const Part& p = reader_->part();
      const std::int64_t l = p.chunk_lines(), a = p.tiles_across();
      const std::int64_t from = (rows.y - p.header.data_window.y) / l * a;
      const std::int64_t to = ((rows.bottom() - p.header.data_window.y + l - 1) / l) * a;
      buffers->first_held = from;
      buffers->held.resize(to - from);
      for_each(to - from,
               [&](std::int64_t i) { buffers->held[i] = reader_->chunk(from + i); });
    }
    fill_planes(rows, *buffers);
  }
  if (touched) {
    const Timer timer(work_ns_);
    std::vector<float*> out;
    for (std::size_t i = 0; i < edit_.channels.size(); ++i)
      out.push_back(buffers->planes[i].data());
    std::vector<const float*> in;
    for (std::size_t i = 0; i < edit_.read.size(); ++i)
      in.push_back(buffers->planes[plane_sources_.size() + i].data());
    Band view{rows.y, rows.height, out, in, true};
    if (work_) work_(view);
    touched = view.touched;
  }
  stop_if_cancelled();
  if (!touched && copyable_) {
    const Timer timer(read_ns_);
    copy_chunks(band);
    copied_ += band.chunks.size();
  } else {
    const Timer timer(write_ns_);
    for_each(static_cast<std::int64_t>(band.chunks.size()), [&](std::int64_t i) {
      pack_chunk(band.chunks[i], *buffers, rows, touched);
    });
  }
  buffers->held.clear();
  const std::lock_guard lock(mutex_);
  free_.push_back(std::move(buffers));
  return band;
}

// Threads share bands; finished ones wait compressed for their turn in the file, no more
// than a few.
void Copy::run_bands(const std::function<void(PackedBand&)>& write) {
  int threads =
      options_.threads > 0 ? options_.threads : tbb::this_task_arena::max_concurrency();
  if (threads == 1 || (bands_ == 1 && !options_.whole_frame)) {
    for (int step = 0; step < bands_; ++step) {
      PackedBand band = make_band(band_index(step));
      write(band);
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
    if (bands_ == 1) {
      PackedBand band = make_band(0);
      return write(band);
    }
    int step = 0;
    tbb::parallel_pipeline(
        static_cast<std::size_t>(2 * threads),
        tbb::make_filter<void, int>(tbb::filter_mode::serial_in_order,
                                    [&](tbb::flow_control& flow) {
                                      if (step == bands_) flow.stop();
                                      return step < bands_ ? step++ : 0;
                                    }) &
            tbb::make_filter<int, PackedBand>(
                tbb::filter_mode::parallel,
                [&](int s) { return make_band(band_index(s)); }) &
            tbb::make_filter<PackedBand, void>(tbb::filter_mode::serial_in_order,
                                               [&](PackedBand band) { write(band); }));
  });
}

CopyReport Copy::run() {
  CopyReport report;
  Writer writer(out_path_, parts_, flags_);
  std::vector<std::uint8_t> raw;
  int rows_done = 0;
  const int height = parts_[part_].header.data_window.height;
  for (int p = 0; p < static_cast<int>(parts_.size()); ++p) {
    if (p != part_ ||
        (parts_[p].tiles && parts_[p].tiles->levels != Tiles::Levels::one)) {
      // Another part, or one with levels (which nothing changes): as it is.
      for (std::int64_t i = 0; i < parts_[p].chunk_count(); ++i) {
        stop_if_cancelled();
        reader_->file().read_raw_chunk(p, i, raw);
        writer.add_raw(p, i, raw);
        ++report.chunks;
        ++report.chunks_copied;
      }
      continue;
    }
    run_bands([&](PackedBand& band) {
      const Timer timer(write_ns_);
      for (const PackedChunk& c : band.chunks) writer.add(part_, c.index, c.payload);
      report.chunks += band.chunks.size();
      rows_done += band.rows;
      if (options_.progress) options_.progress(double(rows_done) / height);
    });
  }
  stop_if_cancelled();
  writer.commit();
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
