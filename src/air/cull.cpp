#include "air/cull.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace brume::air {
namespace {

constexpr std::size_t kRoom = 16;  // floats of the widest batch

}  // namespace

Cone cone_around(const Rays& r, const ConeKernels& kernels) {
  Cone cone;
  cone.farthest = std::numeric_limits<float>::infinity();
  if (r.ox) return cone;
  float axis[3], cosine = 1, off = 1, farthest = 0;
  kernels.axis(r, axis, &farthest);
  const float length = std::hypot(axis[0], axis[1], axis[2]);
  if (!(length > 0.1f * float(r.n))) return cone;
  for (int c = 0; c < 3; ++c) cone.axis[c] = axis[c] / length;
  // The plane of a row holds its ends.
  const int last = r.n - 1;
  const float n[3] = {r.dy[0] * r.dz[last] - r.dz[0] * r.dy[last],
                      r.dz[0] * r.dx[last] - r.dx[0] * r.dz[last],
                      r.dx[0] * r.dy[last] - r.dy[0] * r.dx[last]};
  const float size = std::hypot(n[0], n[1], n[2]);
  if (size > 1e-6f)
    for (int c = 0; c < 3; ++c) cone.normal[c] = n[c] / size;
  kernels.narrowest(r, cone, &cosine, &off);
  // Room for float, and for directions that are unit vectors only to float.
  cone.cosine = std::max(-1.f, cosine - 1e-6f);
  cone.sine = std::sqrt(std::max(0.f, 1 - cone.cosine * cone.cosine)) + 1e-6f;
  cone.off = off + 1e-6f;
  cone.farthest = farthest;
  return cone;
}

void Candidates::put(const Medium* m, std::size_t at) {
  media_[at] = m;
  for (std::size_t c = 0; c < 3; ++c)
    sphere_[c][at] = std::isfinite(m->radius) ? m->center[c] : 0.f;
  sphere_[3][at] = m->radius;
}

Spheres Candidates::spheres() const {
  return {size(), sphere_[0].data(), sphere_[1].data(), sphere_[2].data(),
          sphere_[3].data()};
}

void Candidates::start(List<Medium> media) {
  const auto n = std::size_t(media.size);
  media_.resize(n);
  for (auto& plane : sphere_) plane.resize(n + kRoom);
  for (std::size_t i = 0; i < n; ++i) put(media.data + i, i);
}

void Candidates::choose(const Candidates& from, const Cone& cone,
                        const ConeKernels& kernels) {
  found_.resize(std::max(found_.size(), from.media_.size()));
  const auto n = std::size_t(kernels.meet(cone, from.spheres(), found_.data()));
  media_.resize(n);
  for (auto& plane : sphere_) plane.resize(n + kRoom);
  for (std::size_t i = 0; i < n; ++i) {
    const auto k = std::size_t(found_[i]);
    media_[i] = from.media_[k];
    for (std::size_t c = 0; c < 4; ++c) sphere_[c][i] = from.sphere_[c][k];
  }
}

}  // namespace brume::air
