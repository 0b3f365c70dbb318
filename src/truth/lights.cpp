#include "truth/lights.h"

#include <algorithm>
#include <cmath>

namespace brume::truth {
namespace {

// Of the tolerance, what all ways together may make of it.
constexpr double kError = 0.5;
// Distances from a lamp, in powers of e, from which its light matters.
constexpr double kScales = 4;

}  // namespace

Lights::Lights(const World& w, const Ray& r, const Options& o, Cost& cost)
    : share_(kError * o.tolerance * o.white), obstacles_(w) {
  ways_.reserve(w.lights.size());
  for (const auto& l : w.lights) {
    ways_.emplace_back(w, obstacles_, l.what, r, cost);
    smooth_.emplace_back(ways_.back());
    detailed_.emplace_back();
    if (ways_.back().through_detail()) {
      detailed_.back().emplace(ways_.back());
      through_detail_.push_back(&ways_.back());
    }
    add_lamp(w, l.what, r, places_);
    for (const double v : ways_.back().edges())
      places_.push_back({ways_.back().t_of(v), 0});
  }
  share_ /= double(std::max<std::ptrdiff_t>(
      1,
      std::ranges::count_if(w.lights, [](const auto& l) { return l.what.attenuated; })));
}

Rgb Lights::dimmed(std::size_t k, const Incident& in, double t, const Rgb& S,
                   double through, const Rgb& sigma) {
  Rgb tau, E = in.E;
  if (detailed_[k]) {
    sent_.push_back({t, k, {S[0] * E[0], S[1] * E[1], S[2] * E[2]}});
    tau = detailed_[k]->at(t);
  } else {
    // What it may be worth in the picture: a lamp shines like this about as far along
    // the ray as it is away. So much the less its way need be known.
    double worth = 0;
    for (std::size_t c = 0; c < 3; ++c)
      if (S[c] > 0)
        worth = std::max(worth,
                         through * S[c] * in.E[c] * std::min(in.distance, 1 / sigma[c]));
    tau = smooth_[k].at(t, share_ / (kScales * worth));
  }
  for (std::size_t c = 0; c < 3; ++c) E[c] *= std::exp(-tau[c]);
  return E;
}

double Lights::error() const {
  double sum = 0;
  for (const WaysToLight& way : smooth_)
    if (way.asked()) sum += share_ * way.worst();
  return sum;
}

void Lights::begin_march() {
  sent_.clear();
  for (auto& d : detailed_)
    if (d) d->forget_light();
}

template <int N>
void Lights::weigh(const std::vector<typename March<N>::Taken>& pieces,
                   const std::array<double, N>& factor) {
  std::ranges::sort(sent_, {}, &Sent::t);
  for (const auto& p : pieces)
    for (int k = 0; k < kNodes; ++k) {
      const double t = node(p.a, p.b, k), x = (1 + nodes().x[k]) / 2;
      Rgb arrives{};
      for (std::size_t lane = 0; lane < N; ++lane)
        arrives[lane % 3] += factor[lane] * (p.b - p.a) / 2 * nodes().w[k] *
                             std::exp(-(p.before[lane] + x * p.own[lane]));
      for (auto s = std::ranges::lower_bound(sent_, t, {}, &Sent::t);
           s != sent_.end() && s->t == t; ++s) {
        Rgb light;
        for (std::size_t c = 0; c < 3; ++c) light[c] = arrives[c] * s->light_per_metre[c];
        detailed_[s->light]->add_light(t, light);
      }
    }
  sent_.clear();
}

bool Lights::refine_detail(const Rgb& L, const Options& o, long& budget) {
  std::vector<WaysThroughDetail*> all;
  for (auto& d : detailed_)
    if (d) all.push_back(&*d);
  const double part = o.enough > 0 ? o.enough : kError * o.tolerance;
  Rgb goal;
  for (std::size_t c = 0; c < 3; ++c) goal[c] = part * (o.white + std::abs(L[c]));
  const bool more = refine(all, goal, *through_detail_[0], budget);
  WaysThroughDetail::Off off;
  for (const WaysThroughDetail* d : all) off.add(d->off());
  detail_error_ = off.all();
  enough_ = true;
  for (std::size_t c = 0; c < 3; ++c) enough_ = enough_ && detail_error_[c] <= goal[c];
  return more;
}
template void Lights::weigh<3>(const std::vector<March<3>::Taken>&,
                               const std::array<double, 3>&);
template void Lights::weigh<kSpectral>(const std::vector<March<kSpectral>::Taken>&,
                                       const std::array<double, kSpectral>&);

}  // namespace brume::truth
