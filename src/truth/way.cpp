#include "truth/way.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "truth/geometry.h"
#include "truth/physics.h"

namespace brume::truth {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kRoot = 2;        // width of the widest interval, in v
constexpr int kHalvings = 6;       // of it
constexpr long kCredit = 60;       // ways for polynomials, before any point is asked for
constexpr double kCoarsest = 0.1;  // tolerance of a depth
constexpr double kFiner = 0.5;     // are polynomials than who asks first: others follow
constexpr double kBlack = 60;      // e^-60 of a light is none
constexpr double kParting = 8;     // of depths between which light may hide

// Chebyshev's nodes of the first kind on [-1, 1] and their barycentric weights (Berrut &
// Trefethen 2004, eq. 5.3).
struct Chebyshev {
  double x[12], w[12];
  Chebyshev() {
    for (int k = 0; k < 12; ++k) {
      const double angle = (2 * k + 1) * std::numbers::pi / 24;
      x[k] = std::cos(angle);
      w[k] = (k % 2 ? -1 : 1) * std::sin(angle);
    }
  }
};
const Chebyshev& chebyshev() {
  static const Chebyshev nodes;
  return nodes;
}

}  // namespace

Obstacles::Obstacles(const World& w) : world_(w) {
  for (const auto& p : w.media) {
    const brume_medium& m = p.what;
    const double* e = m.extinction;
    if (m.max_opacity == 0 || !(e[0] > 0 || e[1] > 0 || e[2] > 0)) continue;
    (m.max_opacity < 1 ? capped_ : open_).push_back(&p);
    grey_ = grey_ && !m.tint && e[0] == e[1] && e[1] == e[2];
  }
}

// In `N` lanes: 1 where all are grey.
template <int N>
Obstacles::Depth Obstacles::of(const Chosen& some, const Ray& ray, double tolerance,
                               Cost& cost) const {
  Media media;
  for (const auto* p : some) {
    const Stays where = stays(world_, p->what, ray);
    if (where.meet(ray.end)) media.emplace_back(world_, *p, ray, where);
  }
  if (media.empty()) return {};
  March<N> march(tolerance, 1, cost, true);
  walk<N>(media, ray, march,
          [](const Present& here, double t) {
            Local<N> l;
            for (const OnRay* on : here.media) {
              const AtPoint p = on->line.at(t);
              for (std::size_t c = 0; c < N; ++c)
                l.sigma[c] += p.rho * p.tint[c] * on->medium->extinction[c];
            }
            return l;
          },
          {.parts = 4});  // there are many side by side
  Depth all;
  for (std::size_t c = 0; c < 3; ++c) all.tau[c] = march.tau[N == 1 ? 0 : c];
  all.error = *std::ranges::max_element(march.tau_error);
  return all;
}

Obstacles::Depth Obstacles::depth(const Ray& ray, double tolerance, Cost& cost) const {
  const auto depth_of = [&](const Chosen& media) {
    return grey_ ? of<1>(media, ray, tolerance, cost)
                 : of<3>(media, ray, tolerance, cost);
  };
  Depth all;
  if (!open_.empty()) all = depth_of(open_);
  for (const auto* p : capped_) {
    const double limit = -std::log1p(-p->what.max_opacity);
    const Depth own = depth_of({p});
    for (std::size_t c = 0; c < 3; ++c) all.tau[c] += std::min(own.tau[c], limit);
    all.error += own.error;
  }
  const float o[3] = {float(ray.o.x), float(ray.o.y), float(ray.o.z)};
  const float d[3] = {float(ray.d.x), float(ray.d.y), float(ray.d.z)};
  const brume_rays one = {1, o, o + 1, o + 2, d, d + 1, d + 2};
  const float end = float(ray.end);
  for (const auto& s : world_.shadowers) {
    float rgb[3];
    s.what.optical_depth(s.what.self, &one, &end, rgb, rgb + 1, rgb + 2);
    for (std::size_t c = 0; c < 3; ++c) all.tau[c] += rgb[c] > 0 ? rgb[c] : 0;
  }
  return all;
}

void Obstacles::add_edges(const brume_light& light, const Ray& ray,
                          std::vector<double>& t) const {
  for (const Chosen* some : {&open_, &capped_})
    for (const auto* p : *some) add_shadow_edges(world_, p->what, light, ray, t);
}

Obstacles Obstacles::between(const brume_light& light, const Ray& ray) const {
  Obstacles those = *this;
  for (Chosen* some : {&those.open_, &those.capped_})
    std::erase_if(*some, [&](const auto* p) {
      return !may_stand_between(world_, p->what, light, ray);
    });
  return those;
}

bool Obstacles::custom() const {
  const auto is = [](const auto* p) { return p->what.profile == BRUME_CUSTOM; };
  return std::ranges::any_of(open_, is) || std::ranges::any_of(capped_, is);
}

Ways::Ways(const World& w, const Obstacles& obstacles, const brume_light& light,
           const Ray& ray, Cost& cost)
    : world_(w),
      light_(light),
      ray_(ray),
      obstacles_(obstacles.between(light, ray)),
      cost_(cost) {
  if (!light.attenuated || light.kind == BRUME_SKY_LIGHT) return;
  if (light.kind != BRUME_SUN) {
    glm::dvec3 v;
    for (int i = 0; i < 3; ++i) v[i] = light.position[i] - w.eye[i] - ray.o[i];
    foot_ = glm::dot(v, ray.d);
    // Nearer than a number can be told from its neighbour there is nothing to follow.
    h_ = std::max({glm::length(v - foot_ * ray.d), 1e-15 * std::abs(foot_), 1e-100});
  }
  detail_ = obstacles_.custom();
  obstacles_.add_edges(light, ray, edges_);
  std::erase_if(edges_, [&](double t) { return !(t > 0 && t < ray.end); });
  if (ray.end < kInf) edges_.push_back(ray.end);  // nobody tells of those beyond
  for (double& t : edges_) t = v_of(t);
  std::sort(edges_.begin(), edges_.end());
}

double Ways::v_of(double t) const { return std::asinh((t - foot_) / h_); }
double Ways::t_of(double v) const { return foot_ + h_ * std::sinh(v); }

Obstacles::Depth Ways::depth(double t, double tolerance) const {
  const glm::dvec3 x = ray_.at(t);
  const Incident in = light_at(world_, light_, x);
  return obstacles_.depth({x, in.to, in.distance}, tolerance, cost_);
}

WaysToLight::WaysToLight(const Ways& ways)
    : ways_(&ways), credit_(ways.through_detail() ? 0 : kCredit) {}

Rgb WaysToLight::way(double t, double tolerance) const {
  tolerance = std::min(tolerance, kCoarsest);
  const auto depth = ways_->depth(t, tolerance);
  // An error behind what is black is none.
  const double through =
      std::exp(-std::min({depth.tau[0], depth.tau[1], depth.tau[2], kBlack}));
  worst_ = std::max(worst_, depth.error * through / tolerance);
  return depth.tau;
}

Rgb WaysToLight::interpolated(const Interval& i, double v) const {
  const Chebyshev& nodes = chebyshev();
  const double x = (2 * v - i.begin - i.end) / (i.end - i.begin);
  Rgb sum{};
  double weights = 0;
  for (std::size_t k = 0; k < kNodes; ++k) {
    if (x == nodes.x[k]) return i.depth[k];
    const double w = nodes.w[k] / (x - nodes.x[k]);
    weights += w;
    for (std::size_t c = 0; c < 3; ++c) sum[c] += w * i.depth[k][c];
  }
  for (double& s : sum) s /= weights;
  return sum;
}

// Fills in the nodes; whether the polynomial is right between them.
bool WaysToLight::fits(Interval& i) const {
  const auto way_at = [&](double x) {
    const double v = (i.begin + i.end + x * (i.end - i.begin)) / 2;
    // Finer than polynomials are held to, so that they can be.
    return way(ways_->t_of(v), 0.3 * i.tolerance);
  };
  Rgb least{kBlack, kBlack, kBlack};
  for (std::size_t k = 0; k < kNodes; ++k) {
    i.depth[k] = way_at(chebyshev().x[k]);
    for (std::size_t c = 0; c < 3; ++c) least[c] = std::min(least[c], i.depth[k][c]);
  }
  // Held to depths, not to what comes through: where an edge is in the interval the
  // polynomial swings all over it, and what is black at these places may be clear beside.
  // The ends above all: a dense body may be black at every node and clear where the ray
  // enters it. Then what lies between there and the first node is not known.
  for (const double x : {-1., 1., -0.97, -0.67, -0.22, 0.38, 0.55, 0.93}) {
    const double v = (i.begin + i.end + x * (i.end - i.begin)) / 2;
    const Rgb own = way_at(x), drawn = interpolated(i, v);
    for (std::size_t c = 0; c < 3; ++c) {
      if (!(std::abs(own[c] - drawn[c]) <=
            i.tolerance * std::exp(std::min({least[c], own[c], kBlack}))))
        return false;
      if (std::abs(x) < 1) continue;
      const double beside = i.depth[x < 0 ? kNodes - 1 : 0][c];
      if (std::min(own[c], beside) < kBlack && std::abs(own[c] - beside) > kParting)
        return false;
    }
  }
  return true;
}

Rgb WaysToLight::at(double t, double tolerance) {
  asked_ = true;
  if (ways_->spent() || !(tolerance < kNothing)) return {};
  const double v = ways_->v_of(t);
  if (!(std::abs(v) < 1e6)) return way(t, tolerance);
  ++credit_;
  const double root = std::floor(v / kRoot);
  const std::vector<double>& edges = ways_->edges();
  const auto after = std::upper_bound(edges.begin(), edges.end(), v);
  const double from =
      std::max(kRoot * root, after == edges.begin() ? -kInf : *(after - 1));
  const double to = std::min(kRoot * (root + 1), after == edges.end() ? kInf : *after);
  const auto place = std::pair(std::size_t(after - edges.begin()), int(root));
  Interval* at = &roots_.try_emplace(place, from, to).first->second;
  for (int depth = 0;; ++depth) {
    // What was smooth to a coarser tolerance is tried again.
    if (at->state == Interval::smooth && at->tolerance > tolerance)
      at->state = Interval::fresh;
    if (at->state == Interval::fresh) {
      if (credit_ < kNodes + kTried) return way(t, tolerance);
      credit_ -= kNodes + kTried;
      at->tolerance = kFiner * tolerance;
      at->state = fits(*at)            ? Interval::smooth
                  : depth == kHalvings ? Interval::rough
                                       : Interval::halved;
      if (ways_->spent()) return {};
    }
    if (at->state == Interval::smooth) {
      Rgb tau = interpolated(*at, v);
      for (double& x : tau) x = std::max(x, 0.);
      return tau;
    }
    if (at->state == Interval::rough) return way(t, tolerance);
    const double mid = (at->begin + at->end) / 2;
    auto& half = at->half[v >= mid];
    if (!half)
      half = std::make_unique<Interval>(v >= mid ? mid : at->begin,
                                        v >= mid ? at->end : mid);
    at = half.get();
  }
}

}  // namespace brume::truth
