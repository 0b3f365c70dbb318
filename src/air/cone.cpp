#include "air/cone.h"

#include "num/batch.h"

namespace brume::air::inline BRUME_ISA_NS {
namespace {

void axis(const Rays& r, float total[3], float* farthest) noexcept {
  Batch x(0.f), y(0.f), z(0.f), far(0.f);
  for (int i = 0; i < r.n; i += Batch::W) {
    x += load<Batch>(r.dx + i);
    y += load<Batch>(r.dy + i);
    z += load<Batch>(r.dz + i);
    far = max(far, load<Batch>(r.end + i));
  }
  total[0] = sum(x);
  total[1] = sum(y);
  total[2] = sum(z);
  *farthest = highest(far);
}

BRUME_INLINE Batch dot(const float a[3], Batch x, Batch y, Batch z) {
  return x * a[0] + y * a[1] + z * a[2];
}

void narrowest(const Rays& r, const Cone& cone, float* cosine, float* off) noexcept {
  Batch least(1.f), most(0.f);
  for (int i = 0; i < r.n; i += Batch::W) {
    const Batch x = load<Batch>(r.dx + i), y = load<Batch>(r.dy + i),
                z = load<Batch>(r.dz + i);
    least = min(least, dot(cone.axis, x, y, z));
    most = max(most, abs(dot(cone.normal, x, y, z)));
  }
  *cosine = lowest(least);
  *off = highest(most);
}

// A sphere is out of it beyond its end, off its plane, or where the angle to the centre
// is more than the cone's half angle and the sphere's together. With room for float; what
// float cannot tell stays in.
int meet(const Cone& cone, const Spheres& s, int* found) noexcept {
  const Batch one(1.f), zero(0.f);
  int n = 0;
  for (int i = 0; i < s.n; i += Batch::W) {
    const Batch x = load<Batch>(s.x + i), y = load<Batch>(s.y + i),
                z = load<Batch>(s.z + i), r = load<Batch>(s.radius + i);
    const Batch d2 = x * x + y * y + z * z;
    const auto outside = (d2 > r * r * Batch(1.0001f)) & (d2 < Batch(1e37f));
    const Batch d = sqrt(max(d2, Batch(1e-37f)));
    const auto too_far = d - r > Batch(cone.farthest) * Batch(1.0001f);
    const auto off_plane =
        abs(dot(cone.normal, x, y, z)) > r + Batch(cone.off) * (d + r) + Batch(1e-6f) * d;
    const Batch sine = min(r / d, one), cosine = sqrt(max(one - sine * sine, zero));
    const Batch limit = Batch(cone.cosine) * cosine - Batch(cone.sine) * sine;
    const auto over_pi = Batch(cone.sine) * cosine + Batch(cone.cosine) * sine < zero;
    const auto off_axis =
        (!over_pi) & (dot(cone.axis, x, y, z) < d * (limit - Batch(1e-5f)));
    const auto out = outside & (too_far | off_plane | off_axis);
    if (all(out)) continue;
    const int count = s.n - i < Batch::W ? s.n - i : Batch::W;
    for (int k = 0; k < count; ++k)
      if (!out[k]) found[n++] = i + k;
  }
  return n;
}

}  // namespace

const ConeKernels cone_kernels = {axis, narrowest, meet};

}  // namespace brume::air::inline BRUME_ISA_NS
