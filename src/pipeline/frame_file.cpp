// Frames in files: the scene applied band by band while a file is copied.

#include "pipeline/frame_file.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <map>
#include <mutex>

#include "num/error.h"
#include "pipeline/impl.h"
#include "pipeline/proxy.h"
#include "pipeline/rows.h"
#include "pipeline/sources.h"

namespace brume {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point t) {
  return std::chrono::duration<double>(Clock::now() - t).count();
}

/// Where each input of the frame is found while a band is worked on.
struct BandLayout {
  std::vector<int> in_out;  ///< by input: index into Band::out, or -1
  std::vector<int> in_in;  ///< by input: index into Band::in, or -1 (then another file's)
  Edit edit;
};

BandLayout layout(const PreparedFrame::Impl& f, const ImageHeader& header, Edit edit) {
  BandLayout b;
  b.edit = std::move(edit);
  b.in_out.assign(f.inputs.size(), -1);
  b.in_in.assign(f.inputs.size(), -1);
  for (std::size_t i = 0; i < f.inputs.size(); ++i) {
    const InputChannel& in = f.inputs[i];
    if (!in.file.empty()) continue;
    // A channel that is changed in place is at hand already. Not the coverage beside a
    // position pass: rows are looked at again after they have changed.
    const bool looked_at_again = int(i) == f.alpha && f.position[0] >= 0;
    if (!looked_at_again)
      for (std::size_t k = 0; k < f.outputs.size(); ++k)
        if (f.outputs[k].channel.name == in.channel) b.in_out[i] = int(k);
    if (b.in_out[i] >= 0) continue;
    b.in_in[i] = int(b.edit.read.size());
    b.edit.read.push_back(header.find(in.channel));
  }
  return b;
}

/// Rows of a band, and of what lies around it where a pixel looks further.
class BandFeed final : public RowFeed {
 public:
  BandFeed(const PreparedFrame::Impl& f, const FrameFiles& files,
           const BandLayout& layout)
      : f_(f), files_(files), layout_(layout), kept_(f.inputs.size()) {
    window = files.main().header().data_window;
  }

  void start(const Band& band) {
    band_ = &band;
    for (auto& rows : kept_) rows.clear();
  }

  const float* row(int input, int y) override {
    if (y < window.y || y >= window.bottom()) return nullptr;
    const std::size_t i = std::size_t(input);
    if (y >= band_->y && y < band_->y + band_->rows) {
      const std::ptrdiff_t at = std::ptrdiff_t(y - band_->y) * window.width;
      if (const int k = layout_.in_out[i]; k >= 0) return band_->out[std::size_t(k)] + at;
      if (const int k = layout_.in_in[i]; k >= 0) return band_->in[std::size_t(k)] + at;
    }
    auto& rows = kept_[i];
    auto it = rows.find(y);
    if (it != rows.end()) return it->second.data();
    // Another file, or rows around the band: read as many as are read together.
    const FrameFiles::Rows got = files_.read(f_.inputs[i], y, input == f_.depth);
    for (int r = 0; r < got.rows; ++r)
      rows[got.y + r].assign(got.values.begin() + std::ptrdiff_t(r) * window.width,
                             got.values.begin() + std::ptrdiff_t(r + 1) * window.width);
    return rows.at(y).data();
  }

 private:
  const PreparedFrame::Impl& f_;
  const FrameFiles& files_;
  const BandLayout& layout_;
  const Band* band_ = nullptr;
  std::vector<std::map<int, std::vector<float>>> kept_;  // by input
};

/// Feed and worker of one thread, handed from band to band.
struct BandWorker {
  BandFeed feed;
  RowWorker worker;
  std::vector<float*> out;
  BandWorker(const PreparedFrame::Impl& f, const FrameFiles& files, const BandLayout& l)
      : feed(f, files, l), worker(f, feed), out(f.outputs.size()) {}

  bool run(Band& band) {
    feed.start(band);
    bool touched = false;
    const Window& w = feed.window;
    for (int y = band.y; y < band.y + band.rows; ++y) {
      for (std::size_t k = 0; k < out.size(); ++k)
        out[k] = band.out[k] + std::ptrdiff_t(y - band.y) * w.width;
      touched = worker.run(y, w.x, w.right(), out) || touched;
    }
    return touched;
  }
};

/// Workers at rest: as many as there were threads at the same time.
class BandWorkers {
 public:
  BandWorkers(const PreparedFrame::Impl& f, const FrameFiles& files, const BandLayout& l)
      : f_(f), files_(files), layout_(l) {}

  bool run(Band& band) {
    std::unique_ptr<BandWorker> worker;
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) worker = std::move(idle_.back()), idle_.pop_back();
    }
    if (!worker) worker = std::make_unique<BandWorker>(f_, files_, layout_);
    const bool touched = worker->run(band);
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(worker));
    return touched;
  }

 private:
  const PreparedFrame::Impl& f_;
  const FrameFiles& files_;
  const BandLayout& layout_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<BandWorker>> idle_;
};

/// The whole frame as one band, for lens stages.
ApplyCounts run_whole(const PreparedFrame& frame, const FrameFiles& files,
                      const BandLayout& layout, Band& band) {
  const PreparedFrame::Impl& f = frame.impl();
  const Window w = files.main().header().data_window;
  std::vector<std::vector<float>> others;
  std::vector<PlaneIn> in;
  for (std::size_t i = 0; i < f.inputs.size(); ++i) {
    if (layout.in_out[i] >= 0) {
      in.push_back({band.out[std::size_t(layout.in_out[i])], 1, w.width});
    } else if (layout.in_in[i] >= 0) {
      in.push_back({band.in[std::size_t(layout.in_in[i])], 1, w.width});
    } else {
      others.push_back(files.read_all(f.inputs[i], w, int(i) == f.depth));
      in.push_back({others.back().data(), 1, w.width});
    }
  }
  std::vector<PlaneOut> out;
  for (float* p : band.out) out.push_back({p, 1, w.width});
  FrameBuffers buffers;
  buffers.window = w;
  buffers.in = in;
  buffers.out = out;
  return frame.apply(buffers, w);
}

}  // namespace

FrameReport apply_frame(const Session& session, double frame,
                        const std::filesystem::path& in, const std::filesystem::path& out,
                        const ApplyOptions& options) {
  const auto start = Clock::now();
  FrameFiles files(session.scene(), frame, in);
  PreparedFrame prepared = session.prepare(files.source(options));
  const PreparedFrame::Impl& f = prepared.impl();

  FrameReport report;
  report.in = in, report.out = out, report.frame = frame;
  report.plan = prepared.plan();
  report.prepare_seconds = seconds_since(start);

  Edit edit = edit_of(prepared, session.scene(), options);
  if (options.region || options.proxy > 1) {
    Image image = render_part(prepared, files, options, report);
    for (auto& [name, value] : edit.attributes) image.header.attributes[name] = value;
    if (edit.compression) image.header.compression = *edit.compression;
    if (edit.dwa_level) image.header.dwa_level = edit.dwa_level;
    report.copy = write_image(image, out);
  } else {
    const BandLayout l = layout(f, files.main().header(), std::move(edit));
    BandWorkers workers(f, files, l);
    std::atomic<std::uint64_t> nanoseconds{0}, touched{0};
    const int width = files.main().header().data_window.width;
    CopyOptions copy;
    copy.threads = options.threads;
    copy.cancel = options.cancel;
    copy.progress = options.progress;
    copy.whole_frame = f.has_lens();
    // Rows in which no stage can matter are not even unpacked; new layers have to be
    // filled everywhere.
    const bool only_changes =
        std::all_of(f.outputs.begin(), f.outputs.end(),
                    [](const OutputChannel& o) { return o.changed; });
    if (only_changes && !f.plan.active.empty())
      copy.touches = [active = f.plan.active](int y, int rows) {
        return y < active.bottom() && y + rows > active.y;
      };
    report.copy = copy_edited(
        files.main(), l.edit, out,
        [&](Band& band) {
          const auto t = Clock::now();
          if (f.has_lens())
            run_whole(prepared, files, l, band);
          else
            band.touched = workers.run(band);
          if (band.touched) touched += std::uint64_t(band.rows) * std::uint64_t(width);
          nanoseconds += std::uint64_t(seconds_since(t) * 1e9);
        },
        copy);
    report.counts = {std::uint64_t(files.main().header().data_window.pixels()), touched};
    report.work_seconds = double(nanoseconds) * 1e-9;
  }
  report.wall_seconds = seconds_since(start);
  return report;
}

Plan plan_frame(const Session& session, double frame, const std::filesystem::path& in,
                const ApplyOptions& options) {
  FrameFiles files(session.scene(), frame, in);
  return session.prepare(files.source(options)).plan();
}

}  // namespace brume
