#include "scene/coverage.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "scene/depth_run.h"

namespace brume {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Offset {
  int dx, dy, square;
};

constexpr int half_width(int dy) {
  int dx = 0;
  while ((dx + 1) * (dx + 1) + dy * dy <= kCoverageReach * kCoverageReach) ++dx;
  return dx;
}
constexpr int disc_size() {
  int n = -1;  // without the pixel itself
  for (int dy = -kCoverageReach; dy <= kCoverageReach; ++dy) n += 2 * half_width(dy) + 1;
  return n;
}
template <std::size_t n>
constexpr std::array<Offset, n> nearest_first(std::array<Offset, n> a) {
  std::sort(a.begin(), a.end(),
            [](const Offset& p, const Offset& q) { return p.square < q.square; });
  return a;
}

// All neighbours within reach.
constexpr auto kDisc = [] {
  std::array<Offset, disc_size()> a{};
  std::size_t n = 0;
  for (int dy = -kCoverageReach; dy <= kCoverageReach; ++dy)
    for (int dx = -half_width(dy); dx <= half_width(dy); ++dx)
      if (dx || dy) a[n++] = {dx, dy, dx * dx + dy * dy};
  return nearest_first(a);
}();
// Of them the nearest, where an edge's neighbour nearly always is: 5 x 5 pixels.
constexpr std::size_t kNear = 24;
static_assert(kDisc[kNear - 1].square == 8 && kDisc[kNear].square == 9);

// Columns that are asked at once whether anything is near them.
constexpr int kBlock = 32;

const DepthKernels& kernels() noexcept {
  static const DepthKernels& chosen = BRUME_ISA_SELECT(depth_kernels);
  return chosen;
}

// Finite and not yet marked: a filled distance carries its sign bit until the band is
// done, so that it is no neighbour to others.
bool is_source(float distance) {
  return std::bit_cast<std::uint32_t>(distance) < std::bit_cast<std::uint32_t>(kInfinity);
}

float nearest(std::span<const Offset> offsets, const CoverageBand& b, int x,
              int row) noexcept {
  const int rows = b.above + b.rows + b.below;
  float found = kInfinity;
  int square = std::numeric_limits<int>::max();
  for (const Offset& o : offsets) {
    if (o.square > square) break;
    const int column = x + o.dx, line = row + o.dy;
    if (column < 0 || column >= b.width || line < 0 || line >= rows) continue;
    const float d = b.distance[line * b.distance_stride + column];
    if (!is_source(d)) continue;
    found = std::min(found, d);
    square = o.square;
  }
  return found;
}

// Whether no pixel within reach of the block of columns from x has a distance. Filled
// ones count as having one: they only cost a search.
bool nothing_near(const CoverageBand& b, int x, int row) noexcept {
  const int left = std::max(0, x - kCoverageReach);
  const int right = std::min(b.width, x + kBlock + kCoverageReach);
  const int top = std::max(0, row - kCoverageReach);
  const int bottom = std::min(b.above + b.rows + b.below, row + kCoverageReach + 1);
  for (int line = top; line < bottom; ++line)
    if (kernels().any_finite(right - left, b.distance + line * b.distance_stride + left))
      return false;
  return true;
}

}  // namespace

bool has_uncovered(int n, const float* alpha, const float* distance) noexcept {
  return kernels().uncovered(n, alpha, distance);
}

bool fill_uncovered(const CoverageBand& b) noexcept {
  bool changed = false;
  for (int i = 0; i < b.rows; ++i) {
    const int row = b.above + i;
    const float* alpha = b.alpha + i * b.alpha_stride;
    float* distance = b.distance + row * b.distance_stride;
    if (!has_uncovered(b.width, alpha, distance)) continue;
    bool in_vain = false;  // the last search found nothing
    int block = -1;        // the block of columns that `empty` speaks of
    bool empty = false;
    for (int x = 0; x < b.width; ++x) {
      if (!(alpha[x] > 0 && distance[x] == kInfinity)) continue;
      float d = in_vain ? kInfinity : nearest(std::span(kDisc).first(kNear), b, x, row);
      if (d == kInfinity) {
        if (block != x / kBlock) {
          block = x / kBlock;
          empty = nothing_near(b, block * kBlock, row);
        }
        if (!empty) d = nearest(kDisc, b, x, row);
      }
      in_vain = d == kInfinity;
      if (in_vain) continue;
      distance[x] = -d;
      changed = true;
    }
  }
  if (changed)
    for (int i = 0; i < b.rows; ++i) {
      float* distance = b.distance + (b.above + i) * b.distance_stride;
      for (int x = 0; x < b.width; ++x) distance[x] = std::abs(distance[x]);
    }
  return changed;
}

}  // namespace brume
