#include "study/measure.h"

#include <tbb/parallel_for.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace brume::study {

namespace {

double seconds_of(clockid_t clock) {
  timespec t{};
  ::clock_gettime(clock, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

// Where block k of `of` begins when they are spread evenly over n rays.
std::size_t place(std::size_t k, std::size_t of, std::size_t n) {
  const std::size_t last = n > kBlock ? n - kBlock : 0;
  return of < 2 ? 0 : last * k / (of - 1) / 16 * 16;
}

void run_block(const Way& way, const Rays& rays, std::size_t begin, std::size_t n,
               float* const T[3], float* const L[3]) {
  thread_local std::vector<const float*> weights;
  const RaySpans spans = rays.spans(begin, n, weights);
  way(spans, weights, T, L);
}

// A NaN is as wrong as can be.
double gap(double a, double b) {
  const double d = std::abs(a - b);
  return std::isnan(d) ? std::numeric_limits<double>::infinity() : d;
}

double color_error(double S, double T, double L, double true_T, double true_L,
                   double white) {
  const double C = S * true_T + true_L;
  return gap(S * (T - true_T) + (L - true_L), 0) / (white + std::abs(C));
}

}  // namespace

double thread_seconds() { return seconds_of(CLOCK_THREAD_CPUTIME_ID); }
double process_seconds() { return seconds_of(CLOCK_PROCESS_CPUTIME_ID); }

Answers::Answers(const Rays& rays) {
  for (std::size_t c = 0; c < 3; ++c)
    T[c].resize(rays.t.size()), L[c].resize(rays.t.size());
}

Answers evaluate(const Way& way, const Rays& rays) {
  Answers a(rays);
  const std::size_t n = rays.t.size(), blocks = (n + kBlock - 1) / kBlock;
  tbb::parallel_for(std::size_t(0), blocks, [&](std::size_t k) {
    const std::size_t begin = k * kBlock;
    float* const T[3] = {&a.T[0][begin], &a.T[1][begin], &a.T[2][begin]};
    float* const L[3] = {&a.L[0][begin], &a.L[1][begin], &a.L[2][begin]};
    run_block(way, rays, begin, std::min<std::size_t>(kBlock, n - begin), T, L);
  });
  return a;
}

ErrorOf error_of(std::vector<double> d) {
  ErrorOf e;
  if (d.empty()) return e;
  double squares = 0;
  for (const double x : d) {
    e.mean += x / double(d.size());
    squares += x * x / double(d.size());
  }
  e.rms = std::sqrt(squares);
  const auto rank = std::ptrdiff_t(std::ceil(0.99 * double(d.size()))) - 1;
  std::nth_element(d.begin(), d.begin() + rank, d.end());
  e.p99 = d[std::size_t(rank)];
  e.max = *std::max_element(d.begin() + rank, d.end());
  return e;
}

Deviation deviation(const Rays& rays, const Answers& a, const Reference& right,
                    double white, std::size_t even) {
  Deviation out;
  std::vector<double> color(rays.count), T(rays.count), L(rays.count);
  for (std::size_t i = 0; i < rays.count; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double t = double(a.T[c][i]), l = double(a.L[c][i]);
      const double true_T = right.T[i][c], true_L = right.L[i][c];
      const double S = std::isfinite(rays.S[c][i]) ? double(rays.S[c][i]) : 0;
      color[i] = std::max(color[i], color_error(S, t, l, true_T, true_L, white));
      T[i] = std::max(T[i], gap(t, true_T));
      L[i] = std::max(L[i], gap(l, true_L) / (white + std::abs(true_L)));
    }
    if (color[i] > color[out.worst]) out.worst = i;
    out.color_by_ray.push_back(float(color[i]));
  }
  const auto both = [&](const std::vector<double>& d) {
    ErrorOf e = error_of({d.begin(), d.begin() + std::ptrdiff_t(even)});
    e.max = d.empty() ? 0 : *std::max_element(d.begin(), d.end());
    return e;
  };
  out.color = both(color);
  out.T = both(T);
  out.L = both(L);
  return out;
}

std::vector<std::uint32_t> farthest_apart(const Rays& rays, const Answers& a,
                                          const Answers& b, double white,
                                          std::size_t most) {
  std::vector<std::pair<float, std::uint32_t>> apart;
  apart.reserve(rays.count);
  for (std::size_t i = 0; i < rays.count; ++i) {
    double worst = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double S = std::isfinite(rays.S[c][i]) ? double(rays.S[c][i]) : 0;
      worst = std::max(worst,
                       color_error(S, a.T[c][i], a.L[c][i], b.T[c][i], b.L[c][i], white));
    }
    if (worst > 0) apart.emplace_back(float(worst), std::uint32_t(i));
  }
  const std::size_t look = std::min(apart.size(), 256 * most);
  std::partial_sort(apart.begin(), apart.begin() + std::ptrdiff_t(look), apart.end(),
                    std::greater<>());
  std::vector<std::uint32_t> out;
  std::set<std::pair<int, int>> seen;
  for (std::size_t k = 0; k < look && out.size() < most; ++k) {
    const std::uint32_t i = apart[k].second;
    if (seen.emplace(rays.x[i] >> 4, rays.y[i] >> 4).second) out.push_back(i);
  }
  return out;
}

double Stopwatch::run(const Way& way, std::size_t blocks) const {
  alignas(64) float out[6][kBlock];
  float* const T[3] = {out[0], out[1], out[2]};
  float* const L[3] = {out[3], out[4], out[5]};
  const std::size_t n = rays_.t.size();
  const double begin = thread_seconds();
  for (std::size_t k = 0; k < blocks; ++k)
    run_block(way, rays_, place(k, blocks, n), std::min<std::size_t>(kBlock, n), T, L);
  return thread_seconds() - begin;
}

void Stopwatch::add(const Way& way, double seconds) {
  Entry e{&way, 1, 0, {}};
  const double first = process_seconds();
  run(way, 1);
  e.first = process_seconds() - first;
  const double one = std::max(run(way, 1), 1e-7);
  e.first = e.first > 10 * one ? e.first - one : 0;
  const auto all = double((rays_.t.size() + kBlock - 1) / kBlock);
  e.blocks = std::size_t(std::clamp(seconds / one, 1., std::min(all, 1024.)));
  entries_.push_back(e);
}

void Stopwatch::round() {
  const std::size_t n = std::min<std::size_t>(kBlock, rays_.t.size());
  for (Entry& e : entries_)
    e.seconds.push_back(run(*e.way, e.blocks) / double(e.blocks * n));
}

}  // namespace brume::study
