#include "truth/detail.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace brume::truth {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kRoot = 2;         // width of the widest panel, in v
constexpr double kInside = 1e-9;    // of a panel: its ends are seen from within
constexpr double kFiner = 1. / 20;  // ways that are asked for again
constexpr double kCoarsest = 0.01;  // tolerance of a depth's pieces
constexpr double kNarrowest = 1e-12;

double through(double tau) { return std::exp(-std::max(tau, 0.)); }

}  // namespace

Quartic::Quartic(double begin, double end, const std::array<Rgb, 5>& values)
    : begin_(begin), end_(end), newton_(values) {
  for (std::size_t order = 1; order < 5; ++order)
    for (std::size_t k = 4; k >= order; --k)
      for (std::size_t c = 0; c < 3; ++c)
        newton_[k][c] = (newton_[k][c] - newton_[k - 1][c]) / double(order);
}

Rgb Quartic::at(double v) const {
  const double x = std::clamp((v - begin_) / (end_ - begin_), 0., 1.) * 4;
  Rgb p = newton_[4];
  for (std::size_t k = 4; k-- > 0;)
    for (std::size_t c = 0; c < 3; ++c) p[c] = p[c] * (x - double(k)) + newton_[k][c];
  for (double& value : p) value = std::max(value, 0.);
  return p;
}

void WaysThroughDetail::Off::add(const Off& o) {
  for (std::size_t c = 0; c < 3; ++c) {
    change[c] += o.change[c];
    unknown[c] += o.unknown[c];
    squares[c] += o.squares[c];
    arriving[c] += o.arriving[c];
  }
}

Rgb WaysThroughDetail::Off::all() const {
  Rgb sum;
  for (std::size_t c = 0; c < 3; ++c)
    sum[c] = unknown[c] + std::min(change[c], 2 * std::sqrt(squares[c]));
  return sum;
}

// What its light changed by when it was halved; beside it what its ways may be off by,
// which are random to each other.
void WaysThroughDetail::Panel::weigh() {
  off = {};
  double mean_error = 0, ways = 0, all = 0;
  for (const double e : error) mean_error += e / 5;
  for (const Light& l : lights) {
    const Rgb tau = now.at(l.v), was = before.at(l.v);
    for (std::size_t c = 0; c < 3; ++c) {
      const double T = known ? through(tau[c]) : 1;
      off.arriving[c] += T * l.light[c];
      if (known)
        off.change[c] += std::abs(T - through(was[c])) * l.light[c];
      else
        off.unknown[c] += l.light[c];
    }
  }
  if (!known) return;
  for (std::size_t c = 0; c < 3; ++c) {
    const double made = off.arriving[c] * std::min(mean_error, 1.);
    const double both = std::hypot(off.change[c], made);
    ways += made, all += both;
    off.change[c] = both;
    off.squares[c] = both * both;
  }
  by_ways = all > 0 ? ways / all : 0;
}

std::pair<std::size_t, int> WaysThroughDetail::root_of(double v) const {
  const std::vector<double>& edges = ways_->edges();
  const auto after = std::upper_bound(edges.begin(), edges.end(), v);
  return {std::size_t(after - edges.begin()), int(std::floor(v / kRoot))};
}

// The panel of v's root that holds v or is nearest to it.
auto WaysThroughDetail::find(double v) const -> Panels::const_iterator {
  const auto root = root_of(v);
  const auto after = panels_.upper_bound(v);
  if (after != panels_.begin()) {
    const auto before = std::prev(after);
    if (before->second.root == root) return before;
  }
  return after != panels_.end() && after->second.root == root ? after : panels_.end();
}

Rgb WaysThroughDetail::at(double t) const {
  const double v = ways_->v_of(t);
  const auto p = find(v);
  return p == panels_.end() || !p->second.known ? Rgb{} : p->second.now.at(v);
}

void WaysThroughDetail::forget_light() {
  for (auto& [begin, panel] : panels_) panel.lights.clear(), panel.off = {};
  homeless_.clear();
}

void WaysThroughDetail::add_light(double t, const Rgb& light) {
  homeless_.push_back({ways_->v_of(t), light});
}

// Where light comes from and no panel is yet: one from its first to its last place.
void WaysThroughDetail::new_roots() {
  std::map<std::pair<std::size_t, int>, std::pair<double, double>> hulls;
  for (const Light& l : homeless_) {
    if (find(l.v) != panels_.end()) continue;
    auto& [begin, end] = hulls.try_emplace(root_of(l.v), l.v, l.v).first->second;
    begin = std::min(begin, l.v), end = std::max(end, l.v);
  }
  for (const auto& [root, hull] : hulls) {
    // A little wider: between a march's nodes others may be asked for.
    const auto [edges, k] = root;
    const std::vector<double>& edge = ways_->edges();
    const double wider = 0.02 * (hull.second - hull.first) + 1e-9;
    const double from =
        std::max({hull.first - wider, kRoot * k, edges > 0 ? edge[edges - 1] : -kInf});
    const double to = std::min(
        {hull.second + wider, kRoot * (k + 1), edges < edge.size() ? edge[edges] : kInf});
    Panel p;
    p.root = root;
    p.end = to;
    panels_.emplace(from, std::move(p));
  }
}

auto WaysThroughDetail::off() const -> Off {
  Off sum;
  for (const auto& [begin, panel] : panels_) sum.add(panel.off);
  return sum;
}

void WaysThroughDetail::settle() {
  new_roots();
  for (const Light& l : homeless_) {
    const auto p = find(l.v);
    panels_.find(p->first)->second.lights.push_back(l);
  }
  homeless_.clear();
  for (auto& [begin, panel] : panels_) panel.weigh();
}

auto WaysThroughDetail::worst(const Rgb& goal) -> std::pair<Panels::iterator, double> {
  std::pair<Panels::iterator, double> found{panels_.end(), 0};
  for (auto p = panels_.begin(); p != panels_.end(); ++p) {
    if (p->second.finest) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      const Off& off = p->second.off;
      const double most = (off.change[c] + off.unknown[c]) / goal[c];
      if (most > found.second) found = {p, most};
    }
  }
  return found;
}

void WaysThroughDetail::work(Panels::iterator at, double tolerance) {
  Panel& p = at->second;
  const double begin = at->first, width = p.end - begin;
  const auto ask = [&](double x, Rgb& depth, double& error) {
    const double v = begin + std::clamp(x, kInside, 1 - kInside) * width;
    const Obstacles::Depth d =
        ways_->depth(ways_->t_of(v), std::min(tolerance, kCoarsest));
    depth = d.tau;
    error = d.error;
  };
  if (!p.known || p.by_ways > 0.7) {
    if (p.known) {
      double mean = 0;
      for (const double e : p.error) mean += e / 5;
      tolerance = std::min(tolerance, kFiner * mean);
    }
    for (std::size_t k = 0; k < 5; ++k) ask(double(k) / 4, p.depth[k], p.error[k]);
    p.now = Quartic(begin, p.end, p.depth);
    if (!p.known) {  // before it, the parabola through three of the five
      auto parabola = p.depth;
      for (std::size_t c = 0; c < 3; ++c) {
        const double a = p.depth[0][c], b = p.depth[2][c], d = p.depth[4][c];
        parabola[1][c] = (3 * a + 6 * b - d) / 8;
        parabola[3][c] = (3 * d + 6 * b - a) / 8;
      }
      p.before = Quartic(begin, p.end, parabola);
    }
    p.known = true;
    p.weigh();
    return;
  }
  // Halves: each has three of its places already.
  Panel near, far;
  const double mid = begin + width / 2;
  for (std::size_t k = 0; k < 5; ++k) {
    if (k % 2 == 0) {
      near.depth[k] = p.depth[k / 2], near.error[k] = p.error[k / 2];
      far.depth[k] = p.depth[2 + k / 2], far.error[k] = p.error[2 + k / 2];
    } else {
      ask(double(k) / 8, near.depth[k], near.error[k]);
      ask(.5 + double(k) / 8, far.depth[k], far.error[k]);
    }
  }
  near.end = mid, far.end = p.end;
  near.now = Quartic(begin, mid, near.depth), far.now = Quartic(mid, p.end, far.depth);
  for (Panel* half : {&near, &far}) {
    half->root = p.root, half->known = true, half->before = p.now;
    half->finest = width < kNarrowest * std::max(std::abs(mid), 1.);
  }
  for (const Light& l : p.lights) (l.v < mid ? near : far).lights.push_back(l);
  near.weigh(), far.weigh();
  p = std::move(near);
  panels_.emplace(mid, std::move(far));
}

bool refine(std::span<WaysThroughDetail* const> all, const Rgb& goal, const Ways& ways,
            long& budget) {
  for (WaysThroughDetail* one : all) one->settle();
  for (bool changed = false;; changed = true) {
    WaysThroughDetail::Off off;
    for (const WaysThroughDetail* one : all) off.add(one->off());
    const Rgb error = off.all();
    double light = 0, finer = kInf;
    bool enough = true;
    for (std::size_t c = 0; c < 3; ++c) {
      enough = enough && error[c] <= goal[c];
      light = std::max(light, off.arriving[c] / goal[c]);
    }
    if (enough || budget <= 0) return changed;
    WaysThroughDetail* whose = nullptr;
    WaysThroughDetail::Panels::iterator where;
    double worst = 0;
    for (WaysThroughDetail* one : all)
      if (const auto [p, by] = one->worst(goal); by > worst)
        whose = one, where = p, worst = by;
    if (!whose) return changed;
    finer = 3 / light;
    const long before = ways.so_far();
    whose->work(where, finer);
    budget -= ways.so_far() - before;
  }
}

}  // namespace brume::truth
