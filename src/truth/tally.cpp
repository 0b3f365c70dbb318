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
// Of the histogram: neighbours, often alike, do not wait for each other.
constexpr std::size_t kCopies = 4;

// Differences are floats, as the values are.
float distance(float p, float q, const TallyLimits& l) {
  const float d = std::abs(p - q);
  if (!(l.floor > 0)) return d;
  return d / std::max({std::abs(p), std::abs(q), float(l.floor)});
}

// The largest float that is not above x: a float is above x where it is above that.
float float_below(double x) {
  const float f = float(x);
  return double(f) > x ? std::nextafter(f, -std::numeric_limits<float>::infinity()) : f;
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
  if (histogram.empty()) histogram.resize(kCopies * kBins);
  ++histogram[std::bit_cast<std::uint32_t>(float(d)) >> kShift];
}

void Tally::sample(float p, float q, int x0, int y0, const TallyLimits& l) {
  if (p == q) return;
  const bool nan_p = std::isnan(p), nan_q = std::isnan(q);
  if (nan_p && nan_q && l.nan_equal) return;
  const bool number = std::isfinite(p) && std::isfinite(q);
  differs(number ? double(distance(p, q, l)) : kInfinity, p, q, x0, y0, l);
}

// Blocks of numbers, in loops that a compiler makes vectors of. What is not finite, or so
// large or small that its square is no float, goes sample by sample.
bool Tally::block(const float* p, const float* q, int x0, int y0, const TallyLimits& l) {
  float d[kBlock];
  for (int k = 0; k < kBlock; ++k) d[k] = std::abs(p[k] - q[k]);
  if (l.floor > 0) {
    const float floor = float(l.floor);
    for (int k = 0; k < kBlock; ++k) {
      const float m = std::abs(p[k]) > std::abs(q[k]) ? std::abs(p[k]) : std::abs(q[k]);
      d[k] /= m > floor ? m : floor;
    }
  }
  constexpr int kLanes = 8;
  float sums[kLanes] = {}, squared[kLanes] = {}, leaning[kLanes] = {},
        largest[kLanes] = {};
  int odd[kLanes] = {}, unequal[kLanes] = {}, warned[kLanes] = {}, failed[kLanes] = {},
      hard[kLanes] = {};
  const float warn = float_below(l.warn), fail = float_below(l.fail),
              hardest = float_below(l.hard);
  for (int k = 0; k < kBlock; k += kLanes)
    for (int i = 0; i < kLanes; ++i) {
      const float v = d[k + i];
      odd[i] |= !(v < 1e18f);
      unequal[i] += v > 0;
      warned[i] += v > warn;
      failed[i] += v > fail;
      hard[i] += v > hardest;
      sums[i] += v;
      squared[i] += v * v;
      leaning[i] += q[k + i] - p[k + i];
      largest[i] = v > largest[i] ? v : largest[i];
    }
  const float most = *std::max_element(largest, largest + kLanes);
  if (std::any_of(odd, odd + kLanes, [](int o) { return o != 0; }) || most < 1e-15f)
    return false;
  int equal = kBlock;
  for (int i = 0; i < kLanes; ++i) {
    equal -= unequal[i];
    above_warn += std::uint64_t(warned[i]);
    above_fail += std::uint64_t(failed[i]);
    above_hard += std::uint64_t(hard[i]);
    sum += double(sums[i]);
    squares += double(squared[i]);
    bias += double(leaning[i]);
  }
  different += std::uint64_t(kBlock - equal);
  const double top = double(most);
  if (!any || top > max || (top == max && (y0 < y || (y0 == y && x0 < x)))) {
    const int k = int(std::find(d, d + kBlock, most) - d);
    any = true;
    max = top, x = x0 + k, y = y0, a = p[k], b = q[k];
  }
  if (histogram.empty()) histogram.resize(kCopies * kBins);
  std::uint32_t* const bins = histogram.data();
  for (std::size_t k = 0; k < kBlock; k += kCopies)
    for (std::size_t i = 0; i < kCopies; ++i)
      ++bins[i * kBins + (std::bit_cast<std::uint32_t>(d[k + i]) >> kShift)];
  // Equal ones have no bin. (Counts wrap; the sum of the copies does not.)
  histogram[0] -= std::uint32_t(equal);
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
  for (std::size_t i = 0; i < kBins && !histogram.empty(); ++i) {
    std::uint32_t count = 0;
    for (std::size_t copy = 0; copy < kCopies; ++copy)
      count += histogram[copy * kBins + i];
    if ((seen += count) >= rank)
      return std::min(max, double(std::bit_cast<float>(std::uint32_t(i) << kShift |
                                                       1u << (kShift - 1))));
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace brume
