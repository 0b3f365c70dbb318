#include "stress/slack.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace brume::stress {
namespace {

constexpr double kEps = std::numeric_limits<float>::epsilon();
constexpr double kTiny = std::numeric_limits<float>::min();
constexpr double kFar = 1e30;

glm::dvec3 vec(const double v[3]) { return {v[0], v[1], v[2]}; }

double spread(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::dot(glm::abs(a), glm::abs(b));
}

// Profiles whose density falls exponentially, or whose smooth part does.
bool falls(const brume_medium& m) {
  return m.falloff != 0 && (m.profile == BRUME_EXPONENTIAL || m.profile == BRUME_CUSTOM);
}

double log_density(const World& w, const brume_medium& m, const glm::dvec3& x) {
  if (!falls(m)) return 0;
  return -m.falloff * glm::dot(vec(m.direction), x + w.eye - vec(m.origin));
}

// How far off along the ray a boundary may be found.
double boundary(const World& w, const brume_medium& m, const glm::dvec3& o,
                const glm::dvec3& d, double t) {
  double off = 0;
  if (m.start > 0) {
    // Roots -b +- sqrt(disc) of |o + t d| = start. Rounding moves disc by `moved`, of the
    // size of the squares that it is made of, and the root by |sqrt(disc + moved) -
    // sqrt(disc)| <= moved / sqrt(max(disc, moved)).
    const double reach = m.start + glm::length(o), b = glm::dot(o, d);
    const double disc = b * b - glm::dot(o, o) + m.start * m.start;
    const double moved = 2 * kEps * reach * reach;
    off += std::min(t, kEps * reach + moved / std::sqrt(std::max(disc, moved)));
  }
  if (m.shape == BRUME_EVERYWHERE) return off;
  glm::dmat3 a;
  glm::dvec3 b;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) a[c][r] = m.local_from_world[4 * r + c];
    b[r] = m.local_from_world[4 * r + 3];
  }
  double size = 0, away = glm::length(a * w.eye + b);
  for (int r = 0; r < 3; ++r) {
    const double row = glm::length(glm::dvec3(a[0][r], a[1][r], a[2][r]));
    if (row > 0) size = std::max(size, 1 / row);
  }
  const double place = 8 * kEps * (size * (1 + away) + glm::length(o));
  // A chord near a rounded edge goes with the root of what is left of the radius.
  return off + place + (m.shape == BRUME_ELLIPSOID ? 4 * std::sqrt(size * place) : 0);
}

}  // namespace

double Slack::of_opacity(double opacity) const {
  const double share = std::min(1 / std::exp(1.), 1.6 * std::abs(opacity));
  return rel < 0.5 ? rel * share + abs : std::numeric_limits<double>::infinity();
}

Slack slack_of(const World& w, const glm::dvec3& o, const glm::dvec3& d, double t,
               double tolerance) {
  Slack sum{8 * kEps, 0};
  const double length = std::min(t, kFar);
  for (const auto& p : w.media) {
    const brume_medium& m = p.what;
    const double most = std::max({m.extinction[0], m.extinction[1], m.extinction[2]});
    double rel = 8 * kEps;
    // An integral of density below the normal floats is a multiple of the smallest.
    sum.abs += 4 * most * double(std::numeric_limits<float>::denorm_min());
    if (falls(m)) {
      const glm::dvec3 axis = vec(m.direction);
      const double at_eye = std::abs(log_density(w, m, glm::dvec3(0)));
      const double x = m.falloff * glm::dot(axis, d) * length;
      const double along = std::abs(m.falloff) * spread(axis, d) * length;
      rel += 2 * kEps * std::abs(m.falloff) * spread(axis, o);
      if (o != glm::dvec3(0)) rel += kEps * at_eye;
      rel += 2 * kEps * along * (x > 1 ? 1 / x : 1);
      sum.abs += most * length * kTiny;  // densities below the normal floats
    }
    if (m.profile == BRUME_LORENTZIAN) {
      const double away = glm::length(vec(m.origin) - w.eye) + glm::length(o);
      rel += 4 * kEps * std::sqrt(m.falloff) * away;
    }
    if (m.profile == BRUME_CUSTOM || m.alone) rel += tolerance;
    if (m.profile == BRUME_CUSTOM) sum.abs += tolerance;  // |dT| <= tolerance (white + T)
    sum.rel = std::max(sum.rel, rel);
    if (m.shape != BRUME_EVERYWHERE || m.start > 0) {
      const double thick =
          std::max(log_density(w, m, o), log_density(w, m, o + length * d));
      sum.abs += most * std::exp(std::min(thick, 700.)) * boundary(w, m, o, d, length);
    }
  }
  return sum;
}

}  // namespace brume::stress
