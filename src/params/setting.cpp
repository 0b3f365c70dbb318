// Values over frames: keys and what lies between them.

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "params/params.h"

namespace brume {
namespace {

using Keys = std::vector<Setting::Key>;

// The limited slopes of Fritsch and Carlson (1980), SIAM J. Numer. Anal. 17(2), at the
// ends of the interval [keys[i], keys[i+1]], for component c. Slopes of the data start as
// the mean of the two secants, 0 at an extremum; then each interval keeps (a, b) = slopes
// over its secant inside the circle a^2 + b^2 = 9, which is enough for monotonicity. The
// slope at a key is limited from both sides, so three intervals are looked at.
double secant(const Keys& k, std::size_t i, std::size_t c) {
  return (k[i + 1].value.numbers[c] - k[i].value.numbers[c]) /
         (k[i + 1].frame - k[i].frame);
}

double data_slope(const Keys& k, std::size_t i, std::size_t c) {
  if (i == 0) return secant(k, 0, c);
  if (i + 1 == k.size()) return secant(k, i - 1, c);
  const double before = secant(k, i - 1, c), after = secant(k, i, c);
  return before * after > 0 ? before / 2 + after / 2 : 0;
}

// What the interval beginning at key i allows of the slopes at its two ends: a factor.
double limit(const Keys& k, std::size_t i, std::size_t c) {
  const double s = secant(k, i, c);
  if (s == 0) return 0;
  const double a = data_slope(k, i, c) / s, b = data_slope(k, i + 1, c) / s;
  const double r = std::hypot(a, b);
  return r > 3 ? 3 / r : 1;
}

double slope(const Keys& k, std::size_t i, std::size_t c) {
  double factor = 1;
  if (i > 0) factor = std::min(factor, limit(k, i - 1, c));
  if (i + 1 < k.size()) factor = std::min(factor, limit(k, i, c));
  return factor * data_slope(k, i, c);
}

double between(const Keys& k, std::size_t i, std::size_t c, double frame, bool smooth) {
  const double a = k[i].value.numbers[c], b = k[i + 1].value.numbers[c];
  if (a == b) return a;
  if (!std::isfinite(a) || !std::isfinite(b)) return a;  // no way between: it steps
  const double h = k[i + 1].frame - k[i].frame;
  const double t = (frame - k[i].frame) / h;
  double y = a * (1 - t) + b * t;
  if (smooth) {
    // Hermite cubic as the straight line plus what the slopes add to it.
    const double s = secant(k, i, c);
    const double cubic =
        y +
        t * (1 - t) * h * ((1 - t) * (slope(k, i, c) - s) - t * (slope(k, i + 1, c) - s));
    if (std::isfinite(cubic)) y = cubic;  // overflow at values near 1e308
  }
  return std::clamp(y, std::min(a, b), std::max(a, b));
}

}  // namespace

std::string Location::text() const {
  if (line <= 0) return source;
  return source + ":" + std::to_string(line) + ":" + std::to_string(column);
}

Value default_value(const ParamSpec& s) {
  return {s.default_numbers, s.default_text, s.default_texts};
}

Value Setting::at(double frame) const {
  const auto after =
      std::upper_bound(keys.begin(), keys.end(), frame,
                       [](double f, const Key& key) { return f < key.frame; });
  if (after == keys.begin()) return keys.front().value;
  const std::size_t i = std::size_t(after - keys.begin()) - 1;
  Value v = keys[i].value;
  if (after == keys.end() || frame == keys[i].frame ||
      interpolation == Interpolation::step)
    return v;
  const std::size_t n = std::min(v.numbers.size(), after->value.numbers.size());
  for (std::size_t c = 0; c < n; ++c)
    v.numbers[c] = between(keys, i, c, frame, interpolation == Interpolation::smooth);
  return v;
}

Settings Settings::defaults(std::vector<ParamSpec> specs) {
  Settings s;
  s.values.reserve(specs.size());
  for (const ParamSpec& spec : specs)
    s.values.push_back({.keys = {{0, default_value(spec)}}, .where = {}});
  s.specs = std::move(specs);
  return s;
}

int Settings::find(std::string_view name) const {
  for (std::size_t i = 0; i < specs.size(); ++i)
    if (specs[i].name == name) return int(i);
  return -1;
}

std::vector<Value> Settings::at(double frame) const {
  std::vector<Value> out;
  out.reserve(values.size());
  for (const Setting& v : values) out.push_back(v.at(frame));
  return out;
}

bool Settings::animated() const {
  return std::any_of(values.begin(), values.end(),
                     [](const Setting& v) { return v.animated(); });
}

}  // namespace brume
