#pragma once
// Samples of two channels compared row by row: internal to src/truth.

#include <array>

#include "truth/difference.h"

namespace brume {

/// What the comparison of one channel asks for.
struct TallyLimits {
  double warn = 0, fail = 0, hard = 0;
  double floor = 0;  ///< > 0: relative differences
  bool nan_equal = false;
};

/// Counts and sums of a channel; one per thread, then added up.
struct Tally {
  std::uint64_t samples = 0, different = 0, above_warn = 0, above_fail = 0,
                above_hard = 0, broken = 0;
  double sum = 0, squares = 0, bias = 0, max = 0;
  int x = 0, y = 0;
  float a = 0, b = 0;
  bool any = false;  ///< x, y, a, b tell of a difference
  /// Differences by exponent and 7 bits of mantissa, so that percentiles are known to 1
  /// %.
  std::vector<std::uint32_t> histogram;

  void row(const float* p, const float* q, int n, int x0, int y0, const TallyLimits&);
  void add(const Tally&);
  double percentile(double fraction) const;

 private:
  bool block(const float* p, const float* q, int x0, int y0, const TallyLimits&);
  void sample(float p, float q, int x0, int y0, const TallyLimits&);
  void differs(double d, float p, float q, int x0, int y0, const TallyLimits&);
};

}  // namespace brume
