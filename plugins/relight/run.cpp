#include "run.h"

#include "kernel.h"
#include "num/tail.h"

namespace relight::inline BRUME_ISA_NS {
namespace {

constexpr int W = Batch::W;

// A ray: its origin and direction, and how far it goes (any distance where it has none).
struct At {
  Batch t, d[3], o[3];
  Mask there;
};

At at(const Seen& s, int i, std::ptrdiff_t shift) {
  const auto plane = [&](const float* p) { return load_some(p + shift, i, s.n); };
  At a = {plane(s.t), {plane(s.dx), plane(s.dy), plane(s.dz)}, {0.f, 0.f, 0.f}, false};
  if (s.ox) {
    a.o[0] = plane(s.ox);
    a.o[1] = plane(s.oy);
    a.o[2] = plane(s.oz);
  }
  a.there = (a.t > Batch(kNearest)) & (a.t < Batch(1e30f));
  a.t = select(a.there, a.t, 1.f);
  return a;
}

Line<Batch> line_of(const Seen& s, int i, const At& here, std::ptrdiff_t step) {
  // t0/t by planar depth where the pixel lies before the camera: exactly linear along a
  // plane in a perspective picture; far to the side, and in a latlong's other half, by
  // distance. Orthographic: t itself, 1000 pixels as the unit.
  const Batch axis[3] = {s.forward[0], s.forward[1], s.forward[2]};
  const auto planar = dot3(here.d, axis) > Batch(0.5f);
  const Batch here_depth = here.t * select(planar, dot3(here.d, axis), 1.f);
  const Batch unit(s.ox ? 1e-3f / s.footprint : 0.f);
  const auto nearness = [&](const At& a) {
    const Batch depth = a.t * select(planar, dot3(a.d, axis), 1.f);
    const Batch w =
        s.ox ? max(Batch(1.f) - unit * (a.t - here.t), Batch(1e-6f)) : here_depth / depth;
    return select(a.there & (w > Batch(0.f)), w, 0.f);
  };
  Line<Batch> line;
  line.t[2] = here.t;
  line.w[2] = nearness(here);
  const Batch scale = Batch(1.f) / here.t;
  for (int j : {0, 1, 3, 4}) {
    const At other = at(s, i, (j - 2) * step);
    line.t[j] = other.t;
    line.w[j] = nearness(other);
    // t' d' - t d without the rounding of either.
    const Batch longer = other.t - here.t;
    for (int k = 0; k < 3; ++k)
      line.q[j][k] = ((other.o[k] - here.o[k]) + longer * here.d[k] +
                      other.t * (other.d[k] - here.d[k])) *
                     scale;
  }
  for (int k = 0; k < 3; ++k) line.q[2][k] = Batch(0.f);
  return line;
}

bool points(const Seen& s, const float* alpha, Surface& out) noexcept {
  const Batch huge(3e38f);
  Batch lo[3] = {huge, huge, huge}, hi[3] = {-huge, -huge, -huge};
  bool any_there = false;
  for (int i = 0; i < s.n; i += W) {
    const At a = at(s, i, 0);
    const Batch w =
        select(a.there & (load_some(alpha, i, s.n) > Batch(0.f)), Batch(1.f) / a.t, 0.f);
    const auto there = w > Batch(0.f);
    any_there = any_there || any(there);
    store(out.w + i, w);
    for (int k = 0; k < 3; ++k) {
      const Batch x = a.o[k] + a.t * a.d[k];
      lo[k] = min(lo[k], select(there, x, huge));
      hi[k] = max(hi[k], select(there, x, -huge));
      store(out.x[k] + i, x);
    }
  }
  for (int k = 0; k < 3; ++k) {
    out.lo[k] = lowest(lo[k]);
    out.hi[k] = highest(hi[k]);
  }
  return any_there;
}

void normals(const Seen& s, Surface& out) noexcept {
  for (int i = 0; i < s.n; i += W) {
    const At here = at(s, i, 0);
    Batch n[3];
    normal_of(line_of(s, i, here, 1), line_of(s, i, here, s.row_stride), here.d, n);
    for (int k = 0; k < 3; ++k) store(out.n[k] + i, n[k]);
  }
}

void from_channels(const Seen& s, const float* nx, const float* ny, const float* nz,
                   const float M[9], Surface& out) noexcept {
  for (int i = 0; i < s.n; i += W) {
    const Batch v[3] = {load_some(nx, i, s.n), load_some(ny, i, s.n),
                        load_some(nz, i, s.n)};
    const At here = at(s, i, 0);
    const Batch to_eye[3] = {-here.d[0], -here.d[1], -here.d[2]};
    Batch n[3];
    for (int k = 0; k < 3; ++k)
      n[k] = Batch(M[3 * k]) * v[0] + Batch(M[3 * k + 1]) * v[1] +
             Batch(M[3 * k + 2]) * v[2];
    normalise(n, to_eye);
    for (int k = 0; k < 3; ++k) store(out.n[k] + i, n[k]);
  }
}

int lit(const Reach& l, const Surface& s, int n, int* out) noexcept {
  int count = 0;
  for (int i = 0; i < n; i += W) {
    Batch v[3], normal[3];
    for (int k = 0; k < 3; ++k) {
      normal[k] = load<Batch>(s.n[k] + i);
      v[k] =
          l.lamp ? Batch(l.position[k]) - load<Batch>(s.x[k] + i) : Batch(l.direction[k]);
    }
    auto reached = (load<Batch>(s.w + i) > Batch(0.f)) & (dot3(v, normal) > Batch(0.f));
    if (l.lamp) {
      const Batch r2 = dot3(v, v);
      reached = reached & (r2 < Batch(l.radius2));
      if (l.cosine > -2) {
        const Batch axis[3] = {l.direction[0], l.direction[1], l.direction[2]};
        reached = reached & (-dot3(v, axis) > Batch(l.cosine) * sqrt(r2));
      }
    }
    if (none(reached)) continue;
    for (int k = 0; k < W && i + k < n; ++k)
      if (reached[k]) out[count++] = i + k;
  }
  return count;
}

}  // namespace

const Kernels kernels = {points, normals, from_channels, lit};

}  // namespace relight::inline BRUME_ISA_NS
