// PreparedFrame::apply: pixels in the caller's memory.

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <cstring>

#include "num/error.h"
#include "pipeline/composite.h"
#include "pipeline/lens.h"
#include "pipeline/rows.h"

namespace brume {
namespace {

/// Rows out of the caller's planes; those whose pixels are not neighbours are gathered.
class MemoryFeed final : public RowFeed {
 public:
  MemoryFeed(const FrameBuffers& buffers)
      : buffers_(buffers), gathered_(buffers.in.size()) {
    window = buffers.window;
  }

  const float* row(int input, int y) override {
    if (y < window.y || y >= window.bottom()) return nullptr;
    const PlaneIn& plane = buffers_.in[std::size_t(input)];
    const std::ptrdiff_t r =
        buffers_.bottom_left ? window.bottom() - 1 - y : y - window.y;
    const float* p = plane.data + r * plane.row_stride;
    if (plane.pixel_stride == 1) return p;
    auto& kept = gathered_[std::size_t(input)];
    kept.resize(kRowsKept);
    Gathered& g = kept[std::size_t(y - window.y) % kRowsKept];
    if (g.y != y || g.values.empty()) {
      g.values.resize(std::size_t(window.width));
      for (int x = 0; x < window.width; ++x)
        g.values[std::size_t(x)] = p[x * plane.pixel_stride];
      g.y = y;
    }
    return g.values.data();
  }

 private:
  struct Gathered {
    int y = 0;
    std::vector<float> values;
  };
  const FrameBuffers& buffers_;
  std::vector<std::vector<Gathered>> gathered_;
};

/// Rows of outputs on their way to the caller's planes; straight into them where they lie
/// one after the other.
struct OutRows {
  std::vector<std::vector<float>> scratch;
  std::vector<float*> at;
};

void check(const PreparedFrame::Impl& f, const FrameBuffers& b, const Window& render) {
  const auto fail = [](const std::string& what, const std::string& hint) {
    throw Error("apply", what, hint);
  };
  if (b.in.size() != f.inputs.size())
    fail(std::to_string(b.in.size()) + " input planes",
         "the frame has " + std::to_string(f.inputs.size()) + " (PreparedFrame::inputs)");
  if (b.out.size() != f.outputs.size())
    fail(std::to_string(b.out.size()) + " output planes",
         "the frame has " + std::to_string(f.outputs.size()) +
             " (PreparedFrame::outputs)");
  if (intersect(b.window, render) != render || render.empty())
    fail("the window to render is not inside the pixels given", "");
  for (const PlaneIn& p : b.in)
    if (!p.data) fail("an input plane is null", "");
}

}  // namespace

ApplyCounts PreparedFrame::apply(const FrameBuffers& buffers,
                                 const Window& render) const {
  const Impl& f = *impl_;
  check(f, buffers, render);
  if (f.has_lens()) return apply_with_lens(*this, buffers, render);
  return apply_rows(f, buffers, render);
}

ApplyCounts apply_rows(const PreparedFrame::Impl& f, const FrameBuffers& buffers,
                       const Window& render) {
  struct Local {
    MemoryFeed feed;
    RowWorker worker;
    OutRows rows;
    Local(const PreparedFrame::Impl& frame, const FrameBuffers& b)
        : feed(b), worker(frame, feed) {}
  };
  tbb::enumerable_thread_specific<std::unique_ptr<Local>> locals;
  std::atomic<std::uint64_t> touched{0};
  tbb::parallel_for(
      tbb::blocked_range<int>(render.y, render.bottom(), 16), [&](const auto& range) {
        auto& mine = locals.local();
        if (!mine) {
          mine = std::make_unique<Local>(f, buffers);
          mine->rows.scratch.resize(f.outputs.size());
          mine->rows.at.resize(f.outputs.size());
        }
        for (int y = range.begin(); y < range.end(); ++y) {
          const std::ptrdiff_t r =
              buffers.bottom_left ? render.bottom() - 1 - y : y - render.y;
          for (std::size_t k = 0; k < f.outputs.size(); ++k) {
            const PlaneOut& plane = buffers.out[k];
            auto& scratch = mine->rows.scratch[k];
            if (!plane.data || plane.pixel_stride == 1) {
              mine->rows.at[k] = plane.data ? plane.data + r * plane.row_stride : nullptr;
            } else {
              scratch.resize(std::size_t(render.width));
              mine->rows.at[k] = scratch.data();
            }
          }
          if (mine->worker.run(y, render.x, render.right(), mine->rows.at))
            touched += std::uint64_t(render.width);
          for (std::size_t k = 0; k < f.outputs.size(); ++k) {
            const PlaneOut& plane = buffers.out[k];
            if (!plane.data || plane.pixel_stride == 1) continue;
            float* p = plane.data + r * plane.row_stride;
            for (int x = 0; x < render.width; ++x)
              p[x * plane.pixel_stride] = mine->rows.scratch[k][std::size_t(x)];
          }
        }
      });
  return {std::uint64_t(render.pixels()), touched};
}

}  // namespace brume
