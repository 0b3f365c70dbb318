#include "study/way.h"

#include <algorithm>
#include <limits>

#include "air/impl.h"
#include "num/error.h"
#include "study/march.h"

namespace brume::study {

namespace {

struct Planes {
  alignas(64) float T[3][kBlock], L[3][kBlock];
  float* const to_T[3] = {T[0], T[1], T[2]};
  float* const to_L[3] = {L[0], L[1], L[2]};
};

// How far the middle of a medium is from the eye; everything without bounds is farthest.
double middle_distance(const World& w, const brume_medium& m) {
  if (m.shape == BRUME_EVERYWHERE || m.shape == BRUME_HALF_SPACE)
    return std::numeric_limits<double>::infinity();
  const double* a = m.local_from_world;
  const glm::dmat3 A(a[0], a[4], a[8], a[1], a[5], a[9], a[2], a[6], a[10]);
  return glm::length(glm::inverse(A) * -glm::dvec3(a[3], a[7], a[11]) - w.eye);
}

}  // namespace

Way ours(std::shared_ptr<const Air> air) {
  return [air](const RaySpans& rays, std::span<const float* const> weights,
               float* const T[3], float* const L[3]) {
    air->integrate(rays, weights, {{T[0], T[1], T[2]}, {L[0], L[1], L[2]}, {}, {}});
  };
}

Way of_source(const StageInstance& stage) {
  return [&stage](const RaySpans& r, std::span<const float* const>, float* const T[3],
                  float* const L[3]) {
    stage.baseline({std::size_t(r.n), r.ox, r.oy, r.oz, r.dx, r.dy, r.dz}, r.t_end, L, T);
  };
}

Way marching(std::shared_ptr<const Air> air, int steps, float far) {
  const Air::Impl& f = air->impl();
  if (!f.interfaces.empty()) throw Error("marching", "it does not turn at a surface");
  if (f.media.size() > std::size_t(kMarchedMedia))
    throw Error("marching", std::to_string(f.media.size()) + " media are too many");
  return [air, steps, far](const RaySpans& r, std::span<const float* const> weights,
                           float* const T[3], float* const L[3]) {
    static const MarchKernels& kernels = BRUME_ISA_SELECT(march_kernels);
    const bool any =
        std::any_of(weights.begin(), weights.end(), [](auto* w) { return w; });
    kernels.march(air->impl().world,
                  {r.n, r.ox, r.oy, r.oz, r.dx, r.dy, r.dz, nullptr, r.t_end},
                  any ? weights.data() : nullptr, steps, far, T, L);
  };
}

Way painting(const World& world, const AirOptions& options) {
  struct Layer {
    double distance;
    std::shared_ptr<const Air> air;
  };
  std::vector<Layer> layers;
  for (const auto& medium : world.media) {
    World alone = world;
    alone.media = {medium};
    layers.push_back({middle_distance(world, medium.what),
                      std::make_shared<const Air>(Air::compile(alone, options))});
  }
  std::stable_sort(layers.begin(), layers.end(), [](const Layer& a, const Layer& b) {
    return a.distance > b.distance;
  });
  return [layers](const RaySpans& rays, std::span<const float* const> weights,
                  float* const T[3], float* const L[3]) {
    const auto n = std::size_t(rays.n);
    Planes p;
    for (int c = 0; c < 3; ++c) {
      std::fill_n(T[c], n, 1.0f);
      std::fill_n(L[c], n, 0.0f);
    }
    for (const Layer& layer : layers) {
      layer.air->integrate(
          rays, weights,
          {{p.to_T[0], p.to_T[1], p.to_T[2]}, {p.to_L[0], p.to_L[1], p.to_L[2]}, {}, {}});
      for (int c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < n; ++i) {
          T[c][i] *= p.T[c][i];
          L[c][i] = p.T[c][i] * L[c][i] + p.L[c][i];
        }
    }
  };
}

}  // namespace brume::study
