#include "truth/tally.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace brume {
namespace {

constexpr int kBlock = 64;
constexpr int kShift = 16;  // of a float's bits: 8 of exponent and 7 of mantissa are left

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
  if (histogram.empty()) histogram.resize(std::size_t(1) << (31 - kShift));
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

void Tally::row(const float* p, const float* q, int n, int x0, int y0,
                const TallyLimits& l) {
  samples += std::uint64_t(n);
  int i = 0;
  for (; i + kBlock <= n; i += kBlock) {
    // Equal blocks, which most are, at the speed of memory; a NaN is unequal to itself.
    unsigned unequal = 0;
    for (int k = 0; k < kBlock; ++k) unequal |= unsigned(!(p[i + k] == q[i + k]));
    if (unequal)
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
  for (std::size_t i = 0; i < histogram.size(); ++i)
    if ((seen += histogram[i]) >= rank)
      return std::min(max, double(std::bit_cast<float>(std::uint32_t(i) << kShift |
                                                       1u << (kShift - 1))));
  return std::numeric_limits<double>::infinity();
}

}  // namespace brume
