#include "convolve.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace brume::glare {
namespace {

constexpr std::size_t kRows = 8;  // transformed together

// Pixels spread directly: at most so many, and only such as stand out of the rest by this
// factor over its root mean square. Each takes one trip over the frame, 1 ms at 1080p.
constexpr std::size_t kMostDirect = 16;
constexpr double kStandsOut = 256;

template <class F>
void for_chunks(std::size_t n, std::size_t chunk, F&& f) {
  tbb::parallel_for(std::size_t{0}, (n + chunk - 1) / chunk,
                    [&](std::size_t k) { f(k * chunk, std::min(chunk, n - k * chunk)); });
}

struct Point {
  std::size_t x, y;
  double value;
};

// The brightest pixels that stand out, and which rows hold light beside them.
struct Split {
  std::vector<Point> direct;
  std::vector<bool> lit;
  bool any = false;
};

Split split(const Bright& bright, const Layout& l) {
  const auto dimmer = [](const Point& a, const Point& b) { return a.value > b.value; };
  struct Row {
    double squares = 0;
    std::vector<Point> top;  // heap, dimmest first
    std::size_t lit = 0;
  };
  std::vector<Row> rows(l.height);
  tbb::parallel_for(std::size_t{0}, l.height, [&](std::size_t y) {
    Row& r = rows[y];
    for (std::size_t x = 0; x < l.width; ++x) {
      const double v = bright.value(x, y, l.width);
      if (v == 0) continue;
      ++r.lit;
      r.squares += v * v;
      if (r.top.size() < kMostDirect) {
        r.top.push_back({x, y, v});
        std::push_heap(r.top.begin(), r.top.end(), dimmer);
      } else if (v > r.top.front().value) {
        std::pop_heap(r.top.begin(), r.top.end(), dimmer);
        r.top.back() = {x, y, v};
        std::push_heap(r.top.begin(), r.top.end(), dimmer);
      }
    }
  });
  std::vector<Point> top;
  for (const Row& r : rows) top.insert(top.end(), r.top.begin(), r.top.end());
  std::sort(top.begin(), top.end(), [](const Point& a, const Point& b) {
    return a.value != b.value ? a.value > b.value : a.y != b.y ? a.y < b.y : a.x < b.x;
  });
  // The rest's squares without cancellation: from the dim end.
  const std::size_t count = std::min(top.size(), kMostDirect);
  std::vector<std::size_t> taken(l.height);
  for (std::size_t i = 0; i < count; ++i) ++taken[top[i].y];
  double rest = 0;
  for (std::size_t y = 0; y < l.height; ++y) {
    if (!taken[y]) {
      rest += rows[y].squares;
      continue;
    }
    for (std::size_t x = 0; x < l.width; ++x) {
      bool direct = false;
      for (std::size_t i = 0; i < count; ++i)
        direct = direct || (top[i].x == x && top[i].y == y);
      const double v = direct ? 0 : bright.value(x, y, l.width);
      rest += v * v;
    }
  }
  Split s;
  const double pixels = double(l.width) * double(l.height);
  std::size_t n = count;
  for (; n > 0; --n) {  // those that do not stand out go back, dimmest first
    if (top[n - 1].value > kStandsOut * std::sqrt(rest / pixels)) break;
    rest += top[n - 1].value * top[n - 1].value;
  }
  s.direct.assign(top.begin(), top.begin() + std::ptrdiff_t(n));
  s.lit.resize(l.height);
  for (const Point& p : s.direct) --rows[p.y].lit;
  for (std::size_t y = 0; y < l.height; ++y)
    s.any = (s.lit[y] = rows[y].lit > 0) || s.any;
  return s;
}

// One row of the kernel, reach_x to both sides, without the centre.
void kernel_row(const Kernel& k, int channel, int y, int reach, double* out) {
  for (int x = -reach; x <= reach; ++x) out[x + reach] = k.at(channel, x, y);
  if (y == 0) out[reach] = 0;
}

}  // namespace

double Bright::value(std::size_t x, std::size_t y, std::size_t width) const {
  const float v = plane[std::ptrdiff_t(y) * row_stride + std::ptrdiff_t(x)];
  if (!(v > 0) || !std::isfinite(v)) return 0;
  return weight ? double(v) * weight[y * width + x] : v;
}

KernelSpectrum::KernelSpectrum(const Kernel& k, int channel, const Layout& l, bool hold)
    : layout_(l),
      reach_y_(std::min<int>(k.reach_y, int(l.height) - 1)),
      symmetric_(k.symmetric),
      even_(k.quadrant) {
  const int reach = std::min<int>(k.reach_x, int(l.width) - 1);
  const int first = symmetric_ ? 0 : -reach_y_;
  const std::size_t count = std::size_t(reach_y_ - first + 1), wide = l.columns();
  const std::size_t numbers = even_ ? 1 : 2;
  rows_.resize(count * wide * numbers);
  for_chunks(count, kRows, [&](std::size_t r, std::size_t n) {
    std::vector<double> in(n * l.W), row(std::size_t(2 * reach + 1));
    for (std::size_t i = 0; i < n; ++i) {
      kernel_row(k, channel, first + int(r + i), reach, row.data());
      double* to = &in[i * l.W];  // x < 0 at the far end
      for (int x = -reach; x <= reach; ++x)
        to[x < 0 ? std::ptrdiff_t(l.W) + x : x] = row[std::size_t(x + reach)];
    }
    std::vector<Complex> out(n * wide);
    fft().forward_rows(in.data(), n, l.W, out.data(), wide);
    double* to = &rows_[r * wide * numbers];
    for (const Complex& v : out) {
      *to++ = v.real();
      if (!even_) *to++ = v.imag();
    }
  });
  if (!hold) return;
  if (symmetric_)
    real_.resize(wide * l.H);
  else
    complex_.resize(wide * l.H);
  for_chunks(wide, kStrip, [&](std::size_t u, std::size_t m) {
    const std::vector<Complex> strip = column_strip(u, m);
    if (symmetric_)
      for (std::size_t i = 0; i < strip.size(); ++i) real_[u * l.H + i] = strip[i].real();
    else
      std::copy(strip.begin(), strip.end(), complex_.begin() + std::ptrdiff_t(u * l.H));
  });
  rows_ = {};
}

std::vector<Complex> KernelSpectrum::column_strip(std::size_t u, std::size_t m) const {
  const Layout& l = layout_;
  const std::size_t wide = l.columns();
  const double scale = 1 / (double(l.W) * double(l.H));
  std::vector<Complex> strip(l.H * m);
  for (int y = -reach_y_; y <= reach_y_; ++y) {
    // Of a symmetric kernel, row -y is row y turned about: its transform's conjugate.
    const bool turned = symmetric_ && y < 0;
    const std::size_t r = std::size_t(symmetric_ ? std::abs(y) : y + reach_y_);
    Complex* to = &strip[(y < 0 ? l.H - std::size_t(-y) : std::size_t(y)) * m];
    for (std::size_t i = 0; i < m; ++i) {
      const std::size_t at = r * wide + u + i;
      const Complex v =
          even_ ? Complex(rows_[at]) : Complex(rows_[2 * at], rows_[2 * at + 1]);
      to[i] = scale * (turned ? std::conj(v) : v);
    }
  }
  fft().transform_columns(strip.data(), l.H, m, true);
  return strip;
}

void KernelSpectrum::multiply(std::size_t u, std::size_t m, Complex* strip) const {
  const std::size_t n = layout_.H * m;
  if (!real_.empty()) {
    const double* k = &real_[u * layout_.H];
    for (std::size_t i = 0; i < n; ++i) strip[i] *= k[i];
    return;
  }
  std::vector<Complex> made;
  if (complex_.empty()) made = column_strip(u, m);
  const Complex* k = complex_.empty() ? made.data() : &complex_[u * layout_.H];
  for (std::size_t i = 0; i < n; ++i)
    strip[i] = {strip[i].real() * k[i].real() - strip[i].imag() * k[i].imag(),
                strip[i].real() * k[i].imag() + strip[i].imag() * k[i].real()};
}

std::size_t KernelSpectrum::bytes() const {
  return complex_.size() * sizeof(Complex) +
         (rows_.size() + real_.size()) * sizeof(double);
}

std::size_t KernelSpectrum::bytes_held(const Layout& l, bool symmetric) {
  return l.columns() * l.H * (symmetric ? sizeof(double) : sizeof(Complex));
}

std::size_t Prepared::bytes() const {
  std::size_t b = 0;
  for (const auto& p : kernel.planes) b += p.size() * sizeof(float);
  for (const auto& s : spectra) b += s->bytes();
  return b;
}

std::shared_ptr<const Prepared> prepare(Kernel kernel, int width, int height,
                                        std::size_t budget) {
  const Layout layout(width, height, kernel);
  auto p = std::make_shared<Prepared>(Prepared{std::move(kernel), layout, {}});
  const std::size_t channels = p->kernel.planes.size();
  if (channels * KernelSpectrum::bytes_held(layout, p->kernel.symmetric) <= budget)
    for (std::size_t c = 0; c < channels; ++c)
      p->spectra.push_back(
          std::make_unique<KernelSpectrum>(p->kernel, int(c), layout, true));
  return p;
}

std::shared_ptr<const Prepared> Cache::get(
    const std::string& key,
    const std::function<std::shared_ptr<const Prepared>()>& make) const {
  const std::lock_guard lock(mutex_);
  for (auto i = held_.begin(); i != held_.end(); ++i)
    if (i->first == key) {
      held_.splice(held_.begin(), held_, i);
      return held_.front().second;
    }
  // Room first: what is kept and what is being made stay within bounds together.
  std::size_t bytes = 0;
  for (auto i = held_.begin(); i != held_.end();) {
    bytes += i->second->bytes();
    i = bytes > kCacheBytes / 3 ? held_.erase(i) : std::next(i);
  }
  std::shared_ptr<const Prepared> made = make();
  held_.emplace_front(key, made);
  return made;
}

bool convolve(const Prepared& p, int channel, const Bright& bright,
              std::vector<Complex>& f,
              const std::function<void(std::size_t y, const double* c)>& row) {
  const Layout& l = p.layout;
  const Kernel& k = p.kernel;
  const std::size_t wide = l.columns();
  const Split light = split(bright, l);
  if (!light.any && light.direct.empty()) return false;

  std::vector<bool> direct_row(l.height);
  for (const Point& s : light.direct) direct_row[s.y] = true;

  // Rows forward, those without light 0; columns there, times the kernel, and back.
  if (light.any) {
    f.resize(l.height * wide);
    for_chunks(l.height, kRows, [&](std::size_t y0, std::size_t n) {
      if (std::none_of(light.lit.begin() + std::ptrdiff_t(y0),
                       light.lit.begin() + std::ptrdiff_t(y0 + n), std::identity{})) {
        std::fill_n(&f[y0 * wide], n * wide, Complex{});
        return;
      }
      std::vector<double> in(n * l.W);
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t x = 0; x < l.width; ++x)
          in[i * l.W + x] = bright.value(x, y0 + i, l.width);
      for (const Point& s : light.direct)
        if (s.y >= y0 && s.y < y0 + n) in[(s.y - y0) * l.W + s.x] = 0;
      fft().forward_rows(in.data(), n, l.W, &f[y0 * wide], wide);
    });
    std::unique_ptr<const KernelSpectrum> made;
    if (p.spectra.empty()) made = std::make_unique<KernelSpectrum>(k, channel, l, false);
    const KernelSpectrum& spectrum =
        made ? *made : *p.spectra[p.spectra.size() == 1 ? 0 : std::size_t(channel)];
    for_chunks(wide, kStrip, [&](std::size_t u, std::size_t m) {
      std::vector<Complex> strip(l.H * m);
      for (std::size_t y = 0; y < l.height; ++y)
        std::copy_n(&f[y * wide + u], m, &strip[y * m]);
      fft().transform_columns(strip.data(), l.H, m, true);
      spectrum.multiply(u, m, strip.data());
      fft().transform_columns(strip.data(), l.H, m, false);
      for (std::size_t y = 0; y < l.height; ++y)
        std::copy_n(&strip[y * m], m, &f[y * wide + u]);
    });
  }

  // Rows back, and the brightest pixels onto them.
  for_chunks(l.height, kRows, [&](std::size_t y0, std::size_t n) {
    std::vector<double> c(n * l.W);
    if (light.any) fft().backward_rows(&f[y0 * wide], n, l.W, wide, c.data());
    for (std::size_t i = 0; i < n; ++i) {
      double* to = &c[i * l.W];
      for (std::size_t x = 0; x < l.width; ++x) to[x] = std::max(to[x], 0.);
      for (const Point& s : light.direct) {
        const int dy = int(y0 + i) - int(s.y);
        if (std::abs(dy) > k.reach_y) continue;
        const std::size_t reach = std::size_t(k.reach_x);
        const std::size_t x0 = s.x > reach ? s.x - reach : 0,
                          x1 = std::min(l.width, s.x + reach + 1);
        const double own = to[s.x];
        if (k.quadrant) {  // outward from the middle, both ways
          const float* from =
              &k.plane(channel)[std::size_t(std::abs(dy)) * std::size_t(k.width())];
          for (std::size_t x = x0; x < s.x; ++x) to[x] += s.value * from[s.x - x];
          for (std::size_t x = s.x; x < x1; ++x) to[x] += s.value * from[x - s.x];
        } else {
          const float* from =
              &k.plane(channel)[std::size_t(dy + k.reach_y) * std::size_t(k.width())];
          for (std::size_t x = x0; x < x1; ++x) to[x] += s.value * from[x + reach - s.x];
        }
        if (dy == 0) to[s.x] = own;
      }
      row(y0 + i, to);
    }
  });
  return true;
}

}  // namespace brume::glare
