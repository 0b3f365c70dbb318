#include "truth/tally.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace brume {
namespace {

constexpr int kBlock = 64;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kShift = 17;  // of a float's bits: 8 of exponent and 6 of mantissa are left
constexpr std::size_t kBins = std::size_t(1) << (31 - kShift);

double distance(float p, float q, const TallyLimits& l) {
  const double d = std::abs(double(p) - double(q));
  if (!(l.floor > 0)) return d;
  return d / std::max({std::abs(double(p)), std::abs(double(q)), l.floor});
}

}  // namespace

void Tally::differs(double d, float p, float q, int x0, int y0, const TallyLimits& l) {
  ++different;
  above_warn += d > l.warn;
  above_fail += d > l.fail;
  above_hard += d > l.hard;
  // The first of equal ones in reading order, so that threads do not matter.
  const bool before = y0 < y || (y0 == y && x0 < x);
  if (!any || d > max || (d == max && before)) {
    any = true;
    max = d, x = x0, y = y0, a = p, b = q;
  }
  if (!std::isfinite(d)) {
    ++broken;
    return;
  }
  sum += d;
  squares += d * d;
  bias += double(q) - double(p);
  if (histogram.empty()) histogram.resize(2 * kBins);
  ++histogram[std::bit_cast<std::uint32_t>(float(d)) >> kShift];
}

void Tally::sample(float p, float q, int x0, int y0, const TallyLimits& l) {
  if (p == q) return;
  const bool nan_p = std::isnan(p), nan_q = std::isnan(q);
  if (nan_p && nan_q && l.nan_equal) return;
  const bool number = std::isfinite(p) && std::isfinite(q);
  differs(number ? distance(p, q, l) : std::numeric_limits<double>::infinity(), p, q, x0,
          y0, l);
}

// Blocks of numbers, in loops that a compiler makes vectors of. What is not finite, and
// where the largest difference is, goes sample by sample.
bool Tally::block(const float* p, const float* q, int x0, int y0, const TallyLimits& l) {
  double d[kBlock];
  for (int k = 0; k < kBlock; ++k) d[k] = std::abs(double(p[k]) - double(q[k]));
  double most = 0;
  bool finite = true;
  for (int k = 0; k < kBlock; ++k) finite &= d[k] < kInfinity;
  if (!finite) return false;
  if (l.floor > 0)
    for (int k = 0; k < kBlock; ++k)
      d[k] /= std::max(std::max(std::abs(double(p[k])), std::abs(double(q[k]))), l.floor);
  constexpr int kLanes = 4;
  double sums[kLanes] = {}, squared[kLanes] = {}, leaning[kLanes] = {},
         largest[kLanes] = {};
  for (int k = 0; k < kBlock; k += kLanes)
    for (int i = 0; i < kLanes; ++i) {
      const double v = d[k + i];
      sums[i] += v;
      squared[i] += v * v;
      leaning[i] += double(q[k + i]) - double(p[k + i]);
      largest[i] = v > largest[i] ? v : largest[i];
    }
  int unequal = 0, warned = 0, failed = 0, hard = 0;
  for (int k = 0; k < kBlock; ++k) {
    unequal += d[k] > 0;
    warned += d[k] > l.warn;
    failed += d[k] > l.fail;
    hard += d[k] > l.hard;
  }
  for (int i = 0; i < kLanes; ++i) {
    sum += sums[i];
    squares += squared[i];
    bias += leaning[i];
    most = std::max(most, largest[i]);
  }
  different += std::uint64_t(unequal);
  above_warn += std::uint64_t(warned);
  above_fail += std::uint64_t(failed);
  above_hard += std::uint64_t(hard);
  if (!any || most > max || (most == max && (y0 < y || (y0 == y && x0 < x)))) {
    const int k = int(std::find(d, d + kBlock, most) - d);
    any = true;
    max = most, x = x0 + k, y = y0, a = p[k], b = q[k];
  }
  if (histogram.empty()) histogram.resize(2 * kBins);
  // Two copies: neighbours, often alike, do not wait for each other.
  for (std::size_t k = 0; k < kBlock; ++k)
    ++histogram[(k & 1) * kBins + (std::bit_cast<std::uint32_t>(float(d[k])) >> kShift)];
  // Equal ones have no bin. (Counts wrap; the sum of the copies does not.)
  histogram[0] -= std::uint32_t(kBlock - unequal);
  return true;
}

void Tally::row(const float* p, const float* q, int n, int x0, int y0,
                const TallyLimits& l) {
  samples += std::uint64_t(n);
  int i = 0;
  for (; i + kBlock <= n; i += kBlock) {
    // Equal blocks, which most are, at the speed of memory; a NaN is unequal to itself.
    unsigned unequal = 0;
    for (int k = 0; k < kBlock; ++k) unequal |= unsigned(!(p[i + k] == q[i + k]));
    if (!unequal || block(p + i, q + i, x0 + i, y0, l)) continue;
    for (int k = 0; k < kBlock; ++k) sample(p[i + k], q[i + k], x0 + i + k, y0, l);
  }
  for (; i < n; ++i) sample(p[i], q[i], x0 + i, y0, l);
}

void Tally::add(const Tally& t) {
  samples += t.samples, different += t.different, broken += t.broken;
  above_warn += t.above_warn, above_fail += t.above_fail, above_hard += t.above_hard;
  sum += t.sum, squares += t.squares, bias += t.bias;
  const bool before = t.y < y || (t.y == y && t.x < x);
  if (t.any && (!any || t.max > max || (t.max == max && before)))
    any = true, max = t.max, x = t.x, y = t.y, a = t.a, b = t.b;
  if (t.histogram.empty()) return;
  if (histogram.empty()) histogram.resize(t.histogram.size());
  for (std::size_t i = 0; i < histogram.size(); ++i) histogram[i] += t.histogram[i];
}

double Tally::percentile(double fraction) const {
  // Nearest rank; equal samples come first, then the bins.
  const std::uint64_t rank = std::uint64_t(std::ceil(fraction * double(samples)));
  std::uint64_t seen = samples - different;
  if (rank <= seen) return 0;
  for (std::size_t i = 0; i < histogram.size() / 2; ++i)
    if ((seen += std::uint32_t(histogram[i] + histogram[kBins + i])) >= rank)
      return std::min(max, double(std::bit_cast<float>(std::uint32_t(i) << kShift |
                                                       1u << (kShift - 1))));
  return std::numeric_limits<double>::infinity();
}

}  // namespace brume
