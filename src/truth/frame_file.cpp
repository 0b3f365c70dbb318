// A frame by the truth as a file: the same layers, the same provenance.

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "num/error.h"
#include "pipeline/impl.h"
#include "pipeline/sources.h"
#include "truth/frame.h"

namespace brume::truth {
namespace {

/// Where a pixel's values go among the planes of the outputs.
class Writer {
 public:
  Writer(const PreparedFrame::Impl& f, const Window& w) : f_(f) {
    planes.assign(f.outputs.size(), std::vector<float>(std::size_t(w.pixels())));
    const auto fill = [&](const std::vector<OutputRgb>& layers, float value) {
      for (const OutputRgb& layer : layers)
        for (int c = 0; c < 3; ++c)
          std::ranges::fill(planes[std::size_t(layer.first + c)], value);
    };
    fill(f.idle_T_out, 1);
    if (f.T_out.wanted()) fill({f.T_out}, 1);
  }

  void put(const Pixel& p, std::size_t i) {
    put(f_.color_out, p.C, i);
    put(f_.T_out, p.T, i);
    put(f_.L_out, p.L, i);
    put(f_.S_out, p.S, i);
    for (std::size_t k = 0; k < p.stage_T.size(); ++k) {
      put(f_.stage_T_out[k], p.stage_T[k], i);
      put(f_.stage_L_out[k], p.stage_L[k], i);
    }
    for (std::size_t k = 0; k < p.added.size(); ++k)
      put(f_.stage_added_out[k], p.added[k], i);
    if (f_.alpha_out >= 0) planes[std::size_t(f_.alpha_out)][i] = float(p.alpha);
  }

  std::vector<std::vector<float>> planes;

 private:
  void put(OutputRgb layer, const Rgb& v, std::size_t i) {
    for (int c = 0; layer.wanted() && c < 3; ++c)
      planes[std::size_t(layer.first + c)][i] = float(v[c]);
  }
  const PreparedFrame::Impl& f_;
};

}  // namespace

Rendered apply_frame(const Session& session, double number,
                     const std::filesystem::path& in, const std::filesystem::path& out,
                     const ApplyOptions& options, const PixelOptions& pixel_options) {
  const Frame frame(session, number, in);
  const PreparedFrame::Impl& f = frame.prepared().impl();
  const Window w = frame.window();
  PixelOptions asked = pixel_options;
  asked.stages = f.wants_shares;
  Writer writer(f, w);
  std::vector<Rendered> rows(std::size_t(w.height));
  std::atomic<int> done{0};
  const auto render_row = [&](int row) {
    if (options.cancel && *options.cancel) return;
    Rendered& r = rows[std::size_t(row)];
    for (int x = 0; x < w.width; ++x) {
      const Pixel p = frame.pixel(w.x + x, w.y + row, asked);
      writer.put(p, std::size_t(row) * std::size_t(w.width) + std::size_t(x));
      const bool undecided = p.undecided(session.scene().tolerance, asked.white);
      for (int c = 0; c < 3 && !undecided; ++c)
        r.error = std::max(r.error, p.C_error[c] / (asked.white + std::abs(p.C[c])));
      r.unconverged += !p.converged;
      r.undecided += undecided;
    }
    if (options.progress) options.progress(double(++done) / w.height);
  };
  tbb::task_arena cores(options.threads > 0 ? options.threads
                                            : int(tbb::task_arena::automatic));
  if (!f.stages.empty())
    cores.execute([&] { tbb::parallel_for(0, w.height, render_row); });
  if (options.cancel && *options.cancel) throw Error(in.string(), "interrupted");

  const Edit edit = edit_of(frame.prepared(), session.scene(), options);
  copy_edited(frame.source(), edit, out, [&](Band& band) {
    for (std::size_t k = 0; k < band.out.size(); ++k)
      std::copy_n(
          writer.planes[k].data() + std::size_t(band.y - w.y) * std::size_t(w.width),
          std::size_t(band.rows) * std::size_t(w.width), band.out[k]);
  });
  Rendered all;
  all.unproven = frame.unproven();
  for (const Rendered& r : rows) {
    all.error = std::max(all.error, r.error);
    all.unconverged += r.unconverged;
    all.undecided += r.undecided;
  }
  return all;
}

}  // namespace brume::truth
