#include "truth/segments.h"

#include <algorithm>
#include <cmath>

namespace brume::truth {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kFarthest = 1e300;
// A piece of twice so many natural lengths still has a node within a fifth of one of its
// ends: the march sees that it must be cut.
constexpr double kSeen = 8;

// The length over which density changes by a factor, of the media that name one.
double natural_length(const Present& here, const Ray& ray) {
  double s = kInf;
  for (const OnRay* on : here) {
    const brume_medium& m = *on->medium;
    if (m.falloff == 0) continue;
    if (m.profile == BRUME_LORENTZIAN) s = std::min(s, 1 / std::sqrt(m.falloff));
    if (m.profile != BRUME_EXPONENTIAL && m.profile != BRUME_CUSTOM) continue;
    const glm::dvec3 up(m.direction[0], m.direction[1], m.direction[2]);
    s = std::min(s, 1 / std::abs(m.falloff * glm::dot(up, ray.d)));
  }
  return s;
}

bool any_custom(const Present& here) {
  return std::any_of(here.begin(), here.end(), [](const OnRay* on) {
    return on->medium->profile == BRUME_CUSTOM ||
           on->medium->source == BRUME_SOURCE_CUSTOM;
  });
}

// Pieces that grow from both ends inward, from the natural length on: a dense layer near
// one end, thinner than the distance between nodes, is seen. Media that say nothing of
// their detail are looked at in 16 parts at least.
std::vector<double> cuts_of(double a, double b, const Present& here, const Ray& ray) {
  std::vector<double> t = {a, b};
  const double length = b - a, s = natural_length(here, ray);
  for (double x = length / 2; x > kSeen * s; x /= 2) {
    t.push_back(a + x);
    t.push_back(b - x);
  }
  if (any_custom(here))
    for (int i = 1; i < 16; ++i) t.push_back(a + length * i / 16);
  std::sort(t.begin(), t.end());
  return t;
}

// Pieces of doubling length until nothing more comes: three in a row that fall and add
// less than rounding, or 64 in a row without anything.
template <int N>
void march_on_forever(March<N>& march, const AlongRay<N>& f, double a,
                      const Present& here, const Ray& ray) {
  const double s = natural_length(here, ray);
  const int parts = any_custom(here) ? 4 : 1;
  int faint = 0, empty = 0;
  double before = 0;
  for (double length = std::min(s, 1e-3); a < kFarthest && !march.done(); length *= 2) {
    const auto tau = march.tau, L = march.L;
    for (int i = 0; i < parts; ++i)
      march.over(f, a + length * i / parts, a + length * (i + 1) / parts);
    a += length;
    double gain = 0;
    for (std::size_t c = 0; c < N; ++c) {
      gain = std::max(gain, march.tau[c] - tau[c]);
      if (march.L[c] != L[c])
        gain = std::max(gain, std::abs((march.L[c] - L[c]) / march.L[c]));
    }
    faint = gain > 0 && gain < 1e-17 && gain < 0.75 * before ? faint + 1 : 0;
    empty = gain == 0 ? empty + 1 : 0;
    if (faint == 3 || empty == 64) return;
    before = gain;
  }
}

// Where the optical depth of one medium alone reaches `limit`; inf where it never does,
// or where nobody knows: its march did not converge. (Limits are at most 37.)
double reach(const World& w, OnRay& on, const Ray& ray, double extinction, double limit,
             double tolerance, Cost& cost) {
  OnRay alone = on;
  alone.cap = {kInf, kInf, kInf};
  const auto sigma = [&](double x) { return on.weight * extinction * on.line.at(x).rho; };
  March<1> march(tolerance, 1, cost, true);
  march.until = limit;
  walk<1>(
      w, {alone}, ray, march,
      [&](const Present& here, double x) {
        Local<1> l;
        if (!here.empty()) l.sigma[0] = sigma(x);
        return l;
      },
      false);
  on.converged = on.converged && march.converged;
  if (!march.last) return kInf;
  // Where one step of a double is optical depth no number is the place.
  const double there = march.last->b;
  const double steps = there * std::numeric_limits<double>::epsilon();
  if (!(sigma(there) * steps <= 1e3 * tolerance)) on.converged = false;
  // Within that piece, by Newton's method in a bracket.
  const double a = march.last->a;
  double lo = a, hi = march.last->b, t = hi;
  for (int step = 0; step < 200 && hi - lo > 1e-13 * hi; ++step) {
    const AlongRay<1> f = [&](double x) { return Local<1>{{sigma(x)}, {}}; };
    const double short_of =
        limit - march.tau[0] - (t > a ? march.look(f, a, t).tau[0] : 0);
    (short_of > 0 ? lo : hi) = t;
    const double next = t + short_of / sigma(t);
    if (std::abs(next - t) <= 1e-13 * t) return std::clamp(next, lo, hi);
    t = next > lo && next < hi ? next : lo + (hi - lo) / 2;
  }
  return hi;
}

}  // namespace

Media media_on(const World& w, const Ray& ray, std::span<const double> weights,
               double tolerance, Cost& cost) {
  Media media;
  for (const auto& p : w.media) {
    OnRay on(w, p, ray);
    if (p.stage >= 0 && std::size_t(p.stage) < weights.size())
      on.weight = weights[std::size_t(p.stage)];
    const brume_medium& m = p.what;
    on.scatters =
        std::any_of(m.extinction, m.extinction + 3, [](double x) { return x > 0; });
    const bool emits =
        std::any_of(m.emission, m.emission + 3, [](double x) { return x != 0; });
    if (!(on.weight > 0) || m.max_opacity == 0 || !(on.scatters || emits)) continue;
    if (m.max_opacity < 1)
      for (int c = 0; c < 3; ++c) {
        if (!(m.extinction[c] > 0)) continue;
        const bool same = c > 0 && m.extinction[c] == m.extinction[c - 1];
        on.cap[c] = same ? on.cap[c - 1]
                         : reach(w, on, ray, m.extinction[c], -std::log1p(-m.max_opacity),
                                 tolerance, cost);
      }
    media.push_back(on);
  }
  return media;
}

template <int N>
void walk(const World& w, const Media& media, const Ray& ray, March<N>& march,
          const LocalOf<N>& at, bool lit, double begin) {
  std::vector<double> t;
  for (const OnRay& on : media) {
    add_bounds(w, *on.medium, ray, t);
    t.insert(t.end(), on.cap.begin(), on.cap.end());
    if (on.medium->profile != BRUME_LORENTZIAN) continue;
    // A wide one is seen without a cut: pieces are no longer than the way there.
    const auto peak = on.line.peak();
    if (peak.width < std::min(peak.t, ray.end) / 4) t.push_back(peak.t);
  }
  if (lit)
    for (const auto& l : w.lights) add_lamp(w, l.what, ray, t);
  std::erase_if(t, [&](double x) { return !(x > begin && x < ray.end); });
  t.push_back(begin);
  t.push_back(ray.end);
  std::sort(t.begin(), t.end());

  for (std::size_t i = 0; i + 1 < t.size() && !march.done(); ++i) {
    const double a = t[i], b = t[i + 1];
    if (!(a < b)) continue;
    const double mid = b < kInf ? a + (b - a) / 2 : std::max(2 * a, 1.);
    Present here;
    for (const OnRay& on : media)
      if (inside(w, *on.medium, ray, mid) &&
          std::max({on.cap[0], on.cap[1], on.cap[2]}) > mid)
        here.push_back(&on);
    if (here.empty()) continue;
    const AlongRay<N> f = [&](double x) { return at(here, x); };
    if (b == kInf) {
      march_on_forever(march, f, a, here, ray);
      continue;
    }
    const auto cuts = cuts_of(a, b, here, ray);
    for (std::size_t k = 0; k + 1 < cuts.size() && !march.done(); ++k)
      if (cuts[k] < cuts[k + 1]) march.over(f, cuts[k], cuts[k + 1]);
  }
}

template void walk<1>(const World&, const Media&, const Ray&, March<1>&,
                      const LocalOf<1>&, bool, double);
template void walk<3>(const World&, const Media&, const Ray&, March<3>&,
                      const LocalOf<3>&, bool, double);
template void walk<kSpectral>(const World&, const Media&, const Ray&, March<kSpectral>&,
                              const LocalOf<kSpectral>&, bool, double);

}  // namespace brume::truth
