#include "truth/input.h"

#include <algorithm>
#include <cmath>

namespace brume::truth {
namespace {

constexpr int kReach = 8;  // of DESIGN's nearest covered neighbour [pixels]

}  // namespace

FrameInput::FrameInput(const Session& session, double frame,
                       const std::filesystem::path& path)
    : files(session.scene(), frame, path),
      prepared(session.prepare(files.source({}))),
      window(files.main().header().data_window) {
  for (std::size_t k = 0; k < f().inputs.size(); ++k)
    in.push_back(files.read_all(f().inputs[k], window, int(k) == f().depth));
}

View::RayAt FrameInput::ray(int x, int y) const {
  if (f().view) return f().view->ray(x + .5, y + .5);
  return {f().world.eye, {0, 1, 0}, 1};
}

// DESIGN and SOURCES: what the depth channel means, +inf for background.
double FrameInput::sample_distance(int x, int y) const {
  const PreparedFrame::Impl& p = f();
  const View::RayAt r = ray(x, y);
  if (p.position[0] >= 0) {
    if (p.alpha >= 0 && !(value(p.alpha, x, y) > 0)) return kInf;
    glm::dvec3 P;
    for (int c = 0; c < 3; ++c) P[c] = value(p.position[c], x, y);
    const bool finite = std::isfinite(P.x) && std::isfinite(P.y) && std::isfinite(P.z);
    if (!finite || P == glm::dvec3(0)) return kInf;
    return std::max(glm::dot(P * p.metres - r.origin, r.direction), 0.);
  }
  if (p.depth < 0) return kInf;
  const DepthRule& rule = p.depth_rule;
  const double z = value(p.depth, x, y);
  const double per_planar = 1 / r.planar_per_distance;
  switch (rule.kind) {
    case DepthKind::planar:
      return z > 0 && z < rule.background_from ? z * rule.metres * per_planar : kInf;
    case DepthKind::distance:
      return z > 0 && z < rule.background_from ? z * rule.metres : kInf;
    case DepthKind::inverse:
      return z > 0 && z < kInf ? rule.metres * per_planar / z : kInf;
    case DepthKind::normalised: {
      const double t = std::max(rule.white_near ? 1 - z : z, 0.);
      return std::isfinite(z) && t < 1
                 ? (rule.near + t * (rule.far - rule.near)) * per_planar
                 : kInf;
    }
  }
  return kInf;
}

// Partly covered without a depth: the nearest neighbour's, of equally near ones the
// nearer to the eye.
double FrameInput::distance(int x, int y) const {
  const double own = sample_distance(x, y);
  if (own < kInf || f().plate || f().alpha < 0 || !(value(f().alpha, x, y) > 0))
    return own;
  double best = kInf;
  int square = kReach * kReach + 1;
  for (int dy = -kReach; dy <= kReach; ++dy)
    for (int dx = -kReach; dx <= kReach; ++dx) {
      const int s = dx * dx + dy * dy;
      const int nx = x + dx, ny = y + dy;
      if (s > square || s > kReach * kReach || nx < window.x || ny < window.y ||
          nx >= window.right() || ny >= window.bottom())
        continue;
      const double d = sample_distance(nx, ny);
      if (d == kInf || (s == square && d >= best)) continue;
      best = d;
      square = s;
    }
  return best;
}

double FrameInput::alpha(int x, int y) const {
  if (f().plate) return 1;
  return f().alpha >= 0 ? value(f().alpha, x, y) : double(sample_distance(x, y) < kInf);
}

double FrameInput::weight(const RunningStage& stage, int x, int y, bool behind) const {
  if (behind && f().plate && stage.is_sky) return 0;
  if (stage.mask < 0) return double(stage.mix);
  const double m = value(stage.mask, x, y);
  return double(stage.mix) * (std::isnan(m) ? 0 : std::clamp(m, 0., 1.));
}

}  // namespace brume::truth
