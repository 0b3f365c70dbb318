#include "truth/segments.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace brume::truth {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kFarthest = 1e300, kShortest = 1e-3;
constexpr double kGrowth = 4;
// A piece of twice so many natural lengths still has a node within a fifth of one of its
// ends: the march sees that it must be cut.
constexpr double kSeen = 8;

// The length over which density changes by a factor, of the media that name one.
double natural_length(const Present& here, const Ray& ray) {
  double s = kInf;
  for (const OnRay* on : here.media) {
    const brume_medium& m = *on->medium;
    if (m.falloff == 0) continue;
    if (m.profile != BRUME_EXPONENTIAL && m.profile != BRUME_CUSTOM) continue;
    const glm::dvec3 up(m.direction[0], m.direction[1], m.direction[2]);
    s = std::min(s, 1 / std::abs(m.falloff * glm::dot(up, ray.d)));
  }
  return s;
}

bool is_custom(const brume_medium& m) {
  return m.profile == BRUME_CUSTOM || m.source == BRUME_SOURCE_CUSTOM;
}
bool any_custom(const Present& here) {
  return std::ranges::any_of(here.media,
                             [](const OnRay* on) { return is_custom(*on->medium); });
}

// Where [a, b] is cut at places. One that is wider than a quarter of the piece it is in
// needs no cut: a node lies within it, and halving finds the rest (a lorentzian leaves
// 1.6^-24 to 12 nodes, which is seen). The narrowest first, so that what is wide finds
// short pieces.
std::vector<double> cuts_at(double a, double b, std::vector<Place> places) {
  std::ranges::sort(places, {}, &Place::width);
  std::vector<double> t = {a, b};
  for (const Place& p : places) {
    if (!(p.t > a && p.t < b)) continue;
    const auto after = std::ranges::upper_bound(t, p.t);
    if (p.width < (*after - *(after - 1)) / 4) t.insert(after, p.t);
  }
  return t;
}

// About a peak pieces grow with the distance from it, and so have nodes that see it
// however long the ray.
void add_peak(const Place& peak, double begin, double end, std::vector<Place>& places) {
  places.push_back(peak);
  if (!(peak.width > 0)) return;
  const double farthest = std::max(std::abs(begin - peak.t), std::abs(end - peak.t));
  for (double x = kGrowth * peak.width; x < farthest; x *= kGrowth)
    places.insert(places.end(), {{peak.t - x, x / 4}, {peak.t + x, x / 4}});
}

// Media that say nothing of their detail are looked at in `parts` at least; what has no
// end in parts of ever doubling lengths. What fades at both ends is smooth between them:
// 4 parts show it.
void add_parts(const OnRay& on, double begin, double end, bool endless, int parts,
               std::vector<Place>& places) {
  const auto add = [&](double a, double length, int n) {
    for (int i = 0; i <= n; ++i)
      places.push_back({a + length * i / n, length / (4 * n) * (1 - 1e-9)});
  };
  for (const Stretch& s : on.stays) {
    const double a = std::max(s.from, begin);
    if (!(a < end)) continue;
    if (endless && s.to == kInf)
      for (double x = kShortest; x < end - a; x *= 2) add(a + x, x, parts / 2);
    else
      add(a, std::min(s.to, end) - a, on.fades ? 4 : parts);
  }
}

// Pieces that grow from both ends inward, from the natural length on: a dense layer near
// one end, thinner than the distance between nodes, is seen.
void add_layers(double a, double b, const Present& here, const Ray& ray,
                std::vector<Place>& places) {
  const double s = natural_length(here, ray);
  for (double x = (b - a) / 2; x > kSeen * s; x /= 2)
    places.insert(places.end(), {{a + x, 0}, {b - x, 0}});
}

// Whether a medium grows denser all along the ray: where it is less than a double at
// first, it is still to come.
bool rises(const Present& here, const Ray& ray) {
  return std::ranges::any_of(here.media, [&](const OnRay* on) {
    const brume_medium& m = *on->medium;
    const glm::dvec3 up(m.direction[0], m.direction[1], m.direction[2]);
    return (m.profile == BRUME_EXPONENTIAL || m.profile == BRUME_CUSTOM) &&
           m.falloff * glm::dot(up, ray.d) < 0;
  });
}

// Pieces of doubling length until nothing more comes: three in a row that fall and add
// less than rounding, or 64 in a row without anything.
template <int N>
void march_on_forever(March<N>& march, const AlongRay<N>& f, double a,
                      const Present& here, const Ray& ray) {
  const double s = natural_length(here, ray);
  const int parts = any_custom(here) ? 4 : 1;
  const bool denser = rises(here, ray);
  int faint = 0, empty = 0;
  double before = 0;
  for (double length = std::min(s, kShortest); a < kFarthest && !march.done();
       length *= 2) {
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
    if (faint == 3 || (empty == 64 && !denser)) return;
    before = gain;
  }
}

// Where the optical depth of one medium alone reaches `limit`; inf where it never does,
// or where nobody knows: its march did not converge. (Limits are at most 37.)
double reach(OnRay& on, const Ray& ray, double extinction, double limit, double tolerance,
             Cost& cost) {
  OnRay alone = on;
  alone.cap = {kInf, kInf, kInf};
  const auto sigma = [&](double x) { return on.weight * extinction * on.line.at(x).rho; };
  std::optional<March<1>> march;
  const auto look = [&](double begin, double end) {
    Ray part = ray;
    part.end = end;
    walk<1>(
        {alone}, part, *march,
        [&](const Present& here, double x) {
          Local<1> l;
          if (!here.empty()) l.sigma[0] = sigma(x);
          return l;
        },
        {}, begin);
  };
  const auto look_from_begin = [&](double end) {
    march.emplace(tolerance, 1, cost, true);
    march->until = limit;
    look(0, end);
  };
  // The parts that a medium is looked at in are as long as its way. What is reached
  // within few of them is looked for again in parts of the way there, as the march up to
  // it will see it; and, where it is not found by then, of as much again. (A way without
  // end has short parts where it begins.)
  double end = ray.end;
  look_from_begin(end);
  while (march->last && end < kInf && march->last->b < end / 4) {
    end = march->last->b;
    look_from_begin(end);
    while (!march->last && !march->stopped && end < ray.end) {
      const double begin = end;
      end = std::min(2 * begin, ray.end);
      look(begin, end);
    }
  }
  on.converged = on.converged && march->converged;
  if (!march->last) return kInf;
  // Where one step of a double is optical depth no number is the place.
  const double there = march->last->b;
  const double steps = there * std::numeric_limits<double>::epsilon();
  if (!(sigma(there) * steps <= 1e3 * tolerance)) on.converged = false;
  // Within that piece, by Newton's method in a bracket.
  const double a = march->last->a;
  double lo = a, hi = march->last->b, t = hi;
  for (int step = 0; step < 200 && hi - lo > 1e-13 * hi; ++step) {
    const AlongRay<1> f = [&](double x) { return Local<1>{{sigma(x)}, {}}; };
    const double short_of =
        limit - march->tau[0] - (t > a ? march->look(f, a, t).tau[0] : 0);
    (short_of > 0 ? lo : hi) = t;
    const double next = t + short_of / sigma(t);
    if (std::abs(next - t) <= 1e-13 * t) return std::clamp(next, lo, hi);
    t = next > lo && next < hi ? next : lo + (hi - lo) / 2;
  }
  return hi;
}

}  // namespace

namespace {

// Whether what it emits at the ends of its stay is nothing even all along it.
bool fades(const OnRay& on, const Options& o) {
  const brume_medium& m = *on.medium;
  const double emission =
      on.weight * std::max({m.emission[0], m.emission[1], m.emission[2]});
  return std::ranges::all_of(on.stays, [&](const Stretch& s) {
    const double rho = std::max(on.line.at(s.from).rho, on.line.at(s.to).rho);
    return rho * emission * (s.to - s.from) <= 1e-2 * o.tolerance * o.white;
  });
}

}  // namespace

Media media_on(const World& w, const Ray& ray, const Options& o, Cost& cost) {
  Media media;
  for (const auto& p : w.media) {
    const brume_medium& m = p.what;
    const bool weighs = p.stage >= 0 && std::size_t(p.stage) < o.weights.size();
    const double weight = weighs ? o.weights[std::size_t(p.stage)] : 1;
    const bool scatters =
        std::any_of(m.extinction, m.extinction + 3, [](double x) { return x > 0; });
    const bool emits =
        std::any_of(m.emission, m.emission + 3, [](double x) { return x != 0; });
    const bool counts = o.only_stage < 0 || p.stage == o.only_stage;
    if (!(weight > 0) || m.max_opacity == 0 || !(scatters || (emits && counts))) continue;
    const Stays where = stays(w, m, ray);
    if (!where.meet(ray.end)) continue;
    OnRay on(w, p, ray, where);
    on.weight = weight;
    if (m.ground[3] > 0) on.lowest = nearest_ground(w, m, ray);
    on.scatters = scatters;
    on.fades = !scatters && m.profile == BRUME_CUSTOM && fades(on, o);
    if (m.max_opacity < 1)
      for (int c = 0; c < 3; ++c) {
        if (!(m.extinction[c] > 0)) continue;
        const bool same = c > 0 && m.extinction[c] == m.extinction[c - 1];
        on.cap[c] = same ? on.cap[c - 1]
                         : reach(on, ray, m.extinction[c], -std::log1p(-m.max_opacity),
                                 1e-2 * o.tolerance, cost);
      }
    media.push_back(on);
  }
  return media;
}

Rgb Present::glow(double t) const {
  Rgb e{};
  for (const Glow& g : glows) {
    const double x = t - g.at, per = 1 / (g.width2 + x * x);
    for (std::size_t c = 0; c < 3; ++c) e[c] += g.emission[c] * per;
  }
  return e;
}

namespace {

// What there is on [a, b], between whose ends nothing but what fades begins or ends.
Present present_on(const Media& media, double a, double b) {
  Present here;
  const double mid = b < kInf ? a + (b - a) / 2 : std::max(2 * a, 1.);
  for (const OnRay& on : media) {
    const bool stays =
        on.fades ? std::ranges::any_of(
                       on.stays, [&](const Stretch& s) { return s.from < b && a < s.to; })
                 : on.stays_at(mid);
    if (!stays || !(std::max({on.cap[0], on.cap[1], on.cap[2]}) > mid)) continue;
    const brume_medium& m = *on.medium;
    const double per = on.weight / m.falloff;
    const bool glow = m.profile == BRUME_LORENTZIAN && !on.scatters && per < 1e200 &&
                      m.source != BRUME_SOURCE_CUSTOM;
    if (!glow) {
      here.media.push_back(&on);
      continue;
    }
    const auto peak = on.line.peak();
    here.glows.push_back(
        {peak.t,
         peak.width * peak.width,
         {per * m.emission[0], per * m.emission[1], per * m.emission[2]}});
  }
  return here;
}

}  // namespace

template <int N>
void walk(const Media& media, const Ray& ray, March<N>& march, const LocalOf<N>& at,
          const Cuts& cuts, double begin) {
  std::vector<Place> peaks;
  for (const OnRay& on : media)
    if (on.medium->profile == BRUME_LORENTZIAN) {
      const auto peak = on.line.peak();
      peaks.push_back({peak.t, peak.width});
    } else if (on.medium->ground[3] > 0) {
      peaks.push_back(on.lowest);
    }
  std::vector<double> ends = {begin, ray.end};
  const auto bound = [&](double t) {
    if (t > begin && t < ray.end) ends.push_back(t);
  };
  double behind = begin;
  for (const OnRay& on : media) {
    for (const double cap : on.cap) bound(cap);
    for (const Stretch& s : on.stays)
      if (on.fades)
        behind = std::max(behind, s.to);
      else
        bound(s.from), bound(s.to);
  }
  if (ray.end == kInf) {  // what has no end begins behind all places
    for (const std::span<const Place> some : {std::span<const Place>(peaks), cuts.lights})
      for (const Place& p : some)
        if (p.width < p.t / 4) behind = std::max(behind, p.t);
    bound(behind);
  }
  std::ranges::sort(ends);
  const double last = ends[ends.size() - (ray.end < kInf ? 1 : 2)];
  std::vector<Place> places, lights;
  for (const Place& p : peaks) add_peak(p, begin, last, places);
  for (const Place& p : cuts.lights) add_peak(p, begin, last, lights);
  for (const OnRay& on : media)
    if (is_custom(*on.medium))
      add_parts(on, begin, last, ray.end == kInf, cuts.parts, places);

  for (std::size_t i = 0; i + 1 < ends.size() && !march.done(); ++i) {
    const double a = ends[i], b = ends[i + 1];
    if (!(a < b)) continue;
    const Present here = present_on(media, a, b);
    if (here.empty()) continue;
    const AlongRay<N> f = [&](double x) { return at(here, x); };
    if (b == kInf) {
      march_on_forever(march, f, a, here, ray);
      continue;
    }
    std::vector<Place> in = places;
    const bool answers =
        std::ranges::any_of(here.media, [](const OnRay* on) { return on->scatters; });
    if (answers) in.insert(in.end(), lights.begin(), lights.end());
    add_layers(a, b, here, ray, in);
    const auto t = cuts_at(a, b, std::move(in));
    for (std::size_t k = 0; k + 1 < t.size() && !march.done(); ++k)
      march.over(f, t[k], t[k + 1]);
  }
}

template void walk<1>(const Media&, const Ray&, March<1>&, const LocalOf<1>&, const Cuts&,
                      double);
template void walk<3>(const Media&, const Ray&, March<3>&, const LocalOf<3>&, const Cuts&,
                      double);
template void walk<kSpectral>(const Media&, const Ray&, March<kSpectral>&,
                              const LocalOf<kSpectral>&, const Cuts&, double);

}  // namespace brume::truth
