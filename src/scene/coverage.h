#pragma once
// Pixels that are partly covered (alpha > 0) but whose one depth sample met nothing: the
// anti-aliased edges of things before the sky. They take the distance of the nearest
// pixel that has one (DESIGN "Exact meanings").

#include <cstddef>

namespace brume {

/// How far such a pixel looks for a neighbour [pixels, Euclidean]. Filters of renderers
/// are narrower; what lies beyond, smoke without depth before the sky, stays background.
inline constexpr int kCoverageReach = 8;

/// Whether a run of pixels has one with alpha > 0 and distance +inf. SIMD, 0.1 ns a
/// pixel; stops at the first. NaN alpha counts as none.
bool has_uncovered(int n, const float* alpha, const float* distance) noexcept;

/// A band of whole rows and the rows of distances around it. For the same result however
/// a frame is cut, `above` and `below` are kCoverageReach, less only where the frame
/// ends.
struct CoverageBand {
  int width = 0;                       ///< pixels a row, all of the frame's
  int above = 0, rows = 0, below = 0;  ///< rows before the band, in it, after it
  const float* alpha = nullptr;        ///< the band's first row
  std::ptrdiff_t alpha_stride = 0;     ///< floats from row to row
  float* distance = nullptr;  ///< the first row *above* the band; >= 0 or +inf [m]
  std::ptrdiff_t distance_stride = 0;
};

/// Fills, in place, the band's distances where alpha > 0 and the distance is +inf: with
/// that of the nearest pixel within kCoverageReach whose distance was finite before; of
/// equally near ones the one nearer to the eye. Rows above and below are only read.
/// Returns whether anything changed.
bool fill_uncovered(const CoverageBand&) noexcept;

}  // namespace brume
