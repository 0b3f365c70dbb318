// Surface stages on a block, with what lies around it.

#include <algorithm>
#include <cstring>

#include "pipeline/kernels.h"
#include "pipeline/scratch.h"

namespace brume {

using pipeline::kernels;

/// The block with what lies around it, for a stage that asked for rows or columns around:
/// rows of n + 2 columns, replicated at the frame's edges. `at` points at the block's own
/// first pixel in each plane; rows are `stride` apart.
struct RowWorker::Halo {
  int stride = 0;
  std::vector<float> planes;  // distance, dx, dy, dz, channels
  std::vector<float*> at;
};

RowWorker::Halo RowWorker::halo(const RunningStage& stage, int y, int x, int n) {
  const int rows = stage.needs.rows_around, columns = stage.needs.columns_around;
  const std::size_t planes = 4 + stage.channels.size();
  Halo h;
  h.stride = n + 2 * columns;
  const std::size_t size = std::size_t(h.stride) * std::size_t(2 * rows + 1);
  h.planes.resize(planes * size);
  const Window& w = feed_.window;
  Plane d;
  for (int r = -rows; r <= rows; ++r) {
    const int yy = std::clamp(y + r, w.y, w.bottom() - 1);
    const std::size_t row = std::size_t(r + rows) * std::size_t(h.stride);
    for (int i = 0; i < h.stride;) {
      // A run of columns inside the frame, or one column replicated.
      const int xx = x - columns + i;
      const int from = std::clamp(xx, w.x, w.right() - 1);
      const int run = xx == from ? std::min({kBlock, h.stride - i, w.right() - xx}) : 1;
      distances(yy, from, run, d.v);
      const float* rays[] = {d.v, s_->dx.v, s_->dy.v, s_->dz.v};
      for (std::size_t p = 0; p < 4; ++p)
        std::memcpy(&h.planes[p * size + row + std::size_t(i)], rays[p],
                    sizeof(float) * std::size_t(run));
      for (std::size_t p = 0; p < stage.channels.size(); ++p)
        if (stage.channels[p] >= 0)
          std::memcpy(&h.planes[(4 + p) * size + row + std::size_t(i)],
                      feed_.row(stage.channels[p], yy) + (from - w.x),
                      sizeof(float) * std::size_t(run));
      i += run;
    }
  }
  for (std::size_t p = 0; p < planes; ++p)
    h.at.push_back(h.planes.data() + p * size +
                   std::size_t(rows) * std::size_t(h.stride) + std::size_t(columns));
  distances(y, x, n, d.v);  // the block's own rays again
  return h;
}

void RowWorker::surface(int y, int x, int n) {
  Scratch& s = *s_;
  for (int k = 0; k < f_.surface_end; ++k) {
    const RunningStage& stage = f_.stages[std::size_t(k)];
    const float* w = s.weights[std::size_t(k)];
    if (w)
      for (int c = 0; c < 3; ++c)
        std::memcpy(s.before[c].v, s.S[c].v, sizeof(float) * std::size_t(n));

    brume_tile tile{};
    tile.size = sizeof tile;
    tile.x = x, tile.y = y, tile.width = n, tile.height = 1;
    tile.row_stride = kBlock;
    tile.r = s.S[0].v, tile.g = s.S[1].v, tile.b = s.S[2].v, tile.a = s.alpha.v;
    tile.distance = s.distance.v;
    tile.dx = s.dx.v, tile.dy = s.dy.v, tile.dz = s.dz.v;
    std::vector<const float*> channels;
    Halo around;
    if (stage.needs.rows_around > 0 || stage.needs.columns_around > 0) {
      around = halo(stage, y, x, n);
      tile.row_stride = around.stride;
      tile.distance = around.at[0];
      tile.dx = around.at[1], tile.dy = around.at[2], tile.dz = around.at[3];
      for (std::size_t p = 0; p < stage.channels.size(); ++p)
        channels.push_back(stage.channels[p] < 0 ? nullptr : around.at[4 + p]);
    } else {
      for (int c : stage.channels)
        channels.push_back(c < 0 ? nullptr : feed_.row(c, y) + (x - feed_.window.x));
    }
    tile.channels = channels.data();
    stage.instance->run(tile);

    if (w)
      for (int c = 0; c < 3; ++c)
        kernels().blend(n, s.before[c].v, s.S[c].v, w, s.S[c].v);
  }
}

}  // namespace brume
