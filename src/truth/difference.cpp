#include "truth/difference.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "image/io.h"
#include "num/error.h"
#include "truth/flip.h"
#include "truth/tally.h"

namespace brume {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

bool any_fits(const std::vector<std::string>& patterns, std::string_view name) {
  return std::any_of(patterns.begin(), patterns.end(),
                     [&](const std::string& p) { return fits(p, name); });
}

double limit_of(const std::vector<Limit>& limits, std::string_view channel, double none) {
  for (auto l = limits.rbegin(); l != limits.rend(); ++l)
    if (fits(l->channel, channel)) return l->value;
  return none;
}

void worsen(Verdict& v, Verdict to) { v = std::max(v, to); }

std::string text(const Window& w) {
  return fmt::format("{}x{} at {},{}", w.width, w.height, w.x, w.y);
}

// An attribute in a line: its value where it is short text or numbers.
std::string text(const Attribute& a) {
  if (const auto t = a.text()) return t->size() <= 60 ? '"' + *t + '"' : a.type;
  if (const auto n = a.number()) return fmt::format("{}", *n);
  if (const auto n = a.numbers(); n && n->size() <= 8)
    return fmt::format("{}", fmt::join(*n, " "));
  return fmt::format("{} of {} bytes", a.type, a.bytes.size());
}

/// A channel that both have: its name and its indices.
struct Pair {
  std::string name;
  int a, b;
};

class Parts {
 public:
  Parts(const ImageReader& a, const ImageReader& b, const DifferenceOptions& o)
      : a_(a), b_(b), o_(o) {}

  PartDifference compare() {
    d_.name = a_.header().part_name;
    attributes();
    windows();
    channels();
    if (!d_.mismatches.empty()) {
      worsen(d_.verdict, Verdict::mismatch);
      return std::move(d_);
    }
    if (!pairs_.empty() && !a_.header().data_window.empty()) pixels();
    if (o_.metric == Metric::ssim) similarity();
    if (o_.metric == Metric::flip) flip();
    for (ChannelDifference& c : d_.channels) {
      c.verdict = judge(c);
      worsen(d_.verdict, c.verdict);
    }
    return std::move(d_);
  }

 private:
  void attributes() {
    const Attributes &a = a_.header().attributes, &b = b_.header().attributes;
    std::set<std::string> names;
    for (const auto& [name, value] : a) names.insert(name);
    for (const auto& [name, value] : b) names.insert(name);
    for (const std::string& name : names) {
      if (any_fits(o_.ignore_attributes, name)) continue;
      const auto x = a.find(name), y = b.find(name);
      std::string line;
      if (y == b.end())
        line = fmt::format("{}: only A has it ({})", name, text(x->second));
      else if (x == a.end())
        line = fmt::format("{}: only B has it ({})", name, text(y->second));
      else if (x->second.type != y->second.type || x->second.bytes != y->second.bytes)
        line = fmt::format("{}: A {}, B {}", name, text(x->second), text(y->second));
      if (line.empty()) continue;
      d_.attributes.push_back(line);
      worsen(d_.verdict, Verdict::differ);
    }
  }

  void windows() {
    const ImageHeader &a = a_.header(), &b = b_.header();
    const auto same = [&](const char* what, const auto& x, const auto& y) {
      if (!(x == y)) d_.mismatches.push_back(fmt::format("{}: A {}, B {}", what, x, y));
    };
    same("data window", text(a.data_window), text(b.data_window));
    same("display window", text(a.display_window), text(b.display_window));
    same("pixel aspect", a.pixel_aspect, b.pixel_aspect);
    same("part name", a.part_name, b.part_name);
    same("view", a.view, b.view);
  }

  void channels() {
    const ImageHeader &a = a_.header(), &b = b_.header();
    static const char* const kTypes[] = {"uint", "half", "float"};
    for (std::size_t i = 0; i < a.channels.size(); ++i) {
      const Channel& x = a.channels[i];
      if (any_fits(o_.ignore_channels, x.name)) continue;
      const int k = b.find(x.name);
      if (k < 0) {
        d_.mismatches.push_back("channel " + x.name + ": only A has it");
        continue;
      }
      const Channel& y = b.channels[std::size_t(k)];
      if (x.type != y.type)
        d_.notes.push_back(fmt::format("channel {}: A {}, B {}", x.name,
                                       kTypes[int(x.type)], kTypes[int(y.type)]));
      pairs_.push_back({x.name, int(i), k});
    }
    for (const Channel& y : b.channels)
      if (a.find(y.name) < 0 && !any_fits(o_.ignore_channels, y.name))
        d_.mismatches.push_back("channel " + y.name + ": only B has it");
  }

  TallyLimits limits(const std::string& channel) const {
    TallyLimits l;
    l.fail = limit_of(o_.fail, channel, 0);
    l.warn = limit_of(o_.warn, channel, kInf);
    l.hard = o_.hard_fail.value_or(kInf);
    if (o_.metric != Metric::max) l = {kInf, kInf, kInf, 0, false};
    l.floor = o_.relative ? std::max(*o_.relative, 1e-37) : 0;
    l.nan_equal = o_.nan_equal;
    return l;
  }

  // Bands of both files on all cores.
  void pixels() {
    const Window w = a_.header().data_window;
    const int ra = std::max(1, a_.band_rows()), rb = std::max(1, b_.band_rows());
    const int together = std::lcm(ra, rb);
    const int rows = std::min(w.height, together <= 256 ? together : std::max(ra, rb));
    std::vector<int> of_a, of_b;
    std::vector<TallyLimits> limit;
    for (const Pair& p : pairs_) {
      of_a.push_back(p.a);
      of_b.push_back(p.b);
      limit.push_back(limits(p.name));
    }
    const std::size_t n = pairs_.size(), plane = std::size_t(w.width) * std::size_t(rows);
    struct Local {
      std::vector<float> values;
      std::vector<float*> a, b;
      std::vector<Tally> tally;
    };
    tbb::enumerable_thread_specific<Local> locals;
    const int bands = (w.height + rows - 1) / rows;
    tbb::parallel_for(0, bands, [&](int band) {
      Local& l = locals.local();
      if (l.values.empty()) {
        l.values.resize(2 * n * plane);
        l.tally.resize(n);
        for (std::size_t k = 0; k < n; ++k) {
          l.a.push_back(l.values.data() + 2 * k * plane);
          l.b.push_back(l.values.data() + (2 * k + 1) * plane);
        }
      }
      const int y = w.y + band * rows, count = std::min(rows, w.bottom() - y);
      a_.read(y, count, of_a, l.a);
      b_.read(y, count, of_b, l.b);
      for (std::size_t k = 0; k < n; ++k)
        for (int r = 0; r < count; ++r) {
          const std::size_t at = std::size_t(r) * std::size_t(w.width);
          l.tally[k].row(l.a[k] + at, l.b[k] + at, w.width, w.x, y + r, limit[k]);
        }
    });
    for (std::size_t k = 0; k < n; ++k) {
      Tally t;
      for (const Local& l : locals)
        if (!l.tally.empty()) t.add(l.tally[k]);
      d_.channels.push_back(summary(pairs_[k].name, t));
    }
  }

  ChannelDifference summary(const std::string& name, const Tally& t) const {
    ChannelDifference c;
    c.name = name;
    c.samples = t.samples, c.different = t.different, c.broken = t.broken;
    c.above_warn = t.above_warn, c.above_fail = t.above_fail;
    c.max = t.max, c.x = t.x, c.y = t.y, c.a = t.a, c.b = t.b;
    const double numbers = double(c.numbers());  // 0 / 0: NaN
    c.mean = t.sum / numbers;
    c.rms = std::sqrt(t.squares / numbers);
    c.bias = t.bias / numbers;
    c.p99 = t.percentile(.99);
    c.psnr = c.rms == 0 ? kInf : 20 * std::log10(o_.peak / c.rms);
    if (t.above_hard > 0) c.verdict = Verdict::differ;
    return c;
  }

  Verdict judge(const ChannelDifference& c) const {
    const auto against = [&](double value, double best, bool high_is_good) {
      const double fail = limit_of(o_.fail, c.name, best),
                   warn = limit_of(o_.warn, c.name, high_is_good ? -kInf : kInf);
      const double sign = high_is_good ? -1 : 1;
      return !(sign * value <= sign * fail)   ? Verdict::differ
             : !(sign * value <= sign * warn) ? Verdict::warn
                                              : Verdict::same;
    };
    if (c.verdict == Verdict::differ || c.broken > 0) return Verdict::differ;
    switch (o_.metric) {
      case Metric::rms:
        return against(c.rms, 0, false);
      case Metric::psnr:
        return against(c.psnr, kInf, true);
      case Metric::ssim:
        return against(*c.ssim, 1, true);
      case Metric::flip:
        return Verdict::same;  // of the colour, not of a channel
      case Metric::max:
        break;
    }
    const double percent = 100 / double(std::max<std::uint64_t>(c.samples, 1));
    if (double(c.above_fail) * percent > o_.fail_percent) return Verdict::differ;
    if (double(c.above_warn) * percent > o_.warn_percent) return Verdict::warn;
    return Verdict::same;
  }

  std::vector<float> plane(const ImageReader& from, int channel) const {
    const Window w = from.header().data_window;
    std::vector<float> out(std::size_t(w.pixels()));
    const int rows = std::max(1, from.band_rows());
    tbb::parallel_for(0, (w.height + rows - 1) / rows, [&](int band) {
      float* to =
          out.data() + std::size_t(band) * std::size_t(rows) * std::size_t(w.width);
      from.read(w.y + band * rows, std::min(rows, w.height - band * rows),
                std::span(&channel, 1), std::span(&to, 1));
    });
    return out;
  }

  void similarity() {
    const Window w = a_.header().data_window;
    for (std::size_t k = 0; k < d_.channels.size(); ++k) {
      const auto x = plane(a_, pairs_[k].a), y = plane(b_, pairs_[k].b);
      d_.channels[k].ssim = ssim({x, w.width, w.height}, {y, w.width, w.height}, o_.peak);
    }
  }

  void flip() {
    const FlipMap map = flip_map();
    d_.flip = map.mean;
    const double fail = limit_of(o_.fail, "", 0), warn = limit_of(o_.warn, "", kInf);
    if (map.mean > fail)
      worsen(d_.verdict, Verdict::differ);
    else if (map.mean > warn)
      worsen(d_.verdict, Verdict::warn);
  }

 public:
  FlipMap flip_map() {
    if (pairs_.empty()) channels();
    const Window w = a_.header().data_window;
    std::array<std::vector<float>, 6> planes;
    const char* const kNames[] = {"R", "G", "B"};
    for (std::size_t c = 0; c < 3; ++c) {
      const auto p = std::find_if(pairs_.begin(), pairs_.end(),
                                  [&](const Pair& x) { return x.name == kNames[c]; });
      if (p == pairs_.end())
        throw Error(a_.path().string(), "no R, G, B that FLIP could compare",
                    "--metric max, rms, psnr and ssim take any channel");
      planes[c] = plane(a_, p->a);
      planes[3 + c] = plane(b_, p->b);
    }
    return hdr_flip({{planes[0], planes[1], planes[2]}, w.width, w.height},
                    {{planes[3], planes[4], planes[5]}, w.width, w.height});
  }

  // The channels' differences as planes, `what` of each pair of values.
  template <class F>
  Image differences(const F& what) {
    channels();
    Image out;
    out.header.data_window = a_.header().data_window;
    out.header.display_window = a_.header().display_window;
    for (const Pair& p : pairs_) {
      auto x = plane(a_, p.a);
      const auto y = plane(b_, p.b);
      for (std::size_t i = 0; i < x.size(); ++i) x[i] = what(x[i], y[i]);
      out.header.channels.push_back({.name = p.name, .type = PixelType::float32});
      out.planes.push_back(std::move(x));
    }
    return out;
  }

 private:
  const ImageReader &a_, &b_;
  const DifferenceOptions& o_;
  std::vector<Pair> pairs_;
  PartDifference d_;
};

// Black, violet, orange, pale yellow: lightness rises evenly with the error.
std::array<float, 3> error_color(float t) {
  constexpr float kStops[5][3] = {{0, 0, 0},
                                  {.07f, .01f, .16f},
                                  {.45f, .03f, .19f},
                                  {.95f, .30f, .06f},
                                  {.97f, .97f, .52f}};
  const float x = std::clamp(t, 0.f, 1.f) * 4;
  const int k = std::min(3, int(x));
  std::array<float, 3> c;
  for (std::size_t i = 0; i < 3; ++i)
    c[i] = kStops[k][i] + (x - float(k)) * (kStops[k + 1][i] - kStops[k][i]);
  return c;
}

}  // namespace

const char* name(Verdict v) {
  static const char* const kNames[] = {"same", "warn", "differ", "mismatch", "trouble"};
  return kNames[int(v)];
}

bool fits(std::string_view pattern, std::string_view name) {
  if (pattern.empty()) return name.empty();
  if (pattern.front() == '*') {
    for (std::size_t i = 0; i <= name.size(); ++i)
      if (fits(pattern.substr(1), name.substr(i))) return true;
    return false;
  }
  return !name.empty() && pattern.front() == name.front() &&
         fits(pattern.substr(1), name.substr(1));
}

Difference compare_files(const std::filesystem::path& a, const std::filesystem::path& b,
                         const DifferenceOptions& o) {
  const auto of_a = read_headers(a), of_b = read_headers(b);
  Difference d;
  if (of_a.size() != of_b.size()) {
    d.mismatches.push_back(fmt::format("parts: A {}, B {}", of_a.size(), of_b.size()));
    d.verdict = Verdict::mismatch;
    return d;
  }
  for (std::size_t part = 0; part < of_a.size(); ++part) {
    const auto x = open_image(a, int(part)), y = open_image(b, int(part));
    d.parts.push_back(Parts(*x, *y, o).compare());
    worsen(d.verdict, d.parts.back().verdict);
  }
  return d;
}

Image difference_picture(const std::filesystem::path& a, const std::filesystem::path& b,
                         DifferencePicture kind, const DifferenceOptions& o) {
  const auto x = open_image(a), y = open_image(b);
  Parts parts(*x, *y, o);
  if (x->header().data_window != y->header().data_window)
    throw Error(b.string(), "another size than " + a.string(),
                "there is no picture of their difference");
  if (kind == DifferencePicture::absolute)
    return parts.differences([](float p, float q) { return std::abs(q - p); });
  if (kind == DifferencePicture::difference)
    return parts.differences([](float p, float q) { return q - p; });
  const FlipMap map = parts.flip_map();
  Image out;
  out.header.data_window = x->header().data_window;
  out.header.display_window = x->header().display_window;
  const char* const kNames[] = {"B", "G", "R"};
  for (std::size_t c = 0; c < 3; ++c) {
    out.header.channels.push_back({.name = kNames[c], .type = PixelType::half});
    out.planes.emplace_back(map.error.size());
    for (std::size_t i = 0; i < map.error.size(); ++i)
      out.planes[c][i] = error_color(map.error[i])[2 - c];
  }
  return out;
}

}  // namespace brume
