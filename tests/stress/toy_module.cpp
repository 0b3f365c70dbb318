// A third party's module: a lens and a surface stage, for stress and conformance to hold.

#include <algorithm>
#include <cmath>

#include "stage/stage.h"

namespace {

struct Vignette : brume::Stage {
  static constexpr brume::StageAbout about{"toy_vignette", "Darker toward the corners.",
                                           BRUME_LENS};
  double depth = 0.5;

  template <class V>
  void describe(V& v) {
    v("depth", depth, {.doc = "How dark a corner is.", .minimum = 0, .maximum = 1});
  }
  void needs(const brume_frame&, brume::StageNeeds& n) override {
    if (depth == 0) n.idle = "depth is 0";
    n.whole_frame = true;
    n.laws = BRUME_LINEAR | BRUME_KEEPS_LIGHT;
  }
  void run(const brume_tile& t) const override {
    float* const planes[3] = {t.r, t.g, t.b};
    for (int y = 0; y < t.height; ++y)
      for (int x = 0; x < t.width; ++x) {
        const double u = 2. * x / t.width - 1, v = 2. * y / t.height - 1;
        for (float* plane : planes)
          plane[y * t.row_stride + x] *= float(1 - depth * (u * u + v * v) / 2);
      }
  }
};

// Lights faces that look back at the camera.
struct Torch : brume::Stage {
  static constexpr brume::StageAbout about{"toy_torch", "Light on what faces the eye.",
                                           BRUME_SURFACE, BRUME_LIGHT_STEP};
  double albedo = 0.2;

  template <class V>
  void describe(V& v) {
    v("albedo", albedo, {.doc = "Of everything.", .minimum = 0, .maximum = 1});
  }
  void needs(const brume_frame&, brume::StageNeeds& n) override {
    if (albedo == 0) n.idle = "albedo is 0";
    n.camera = n.depth = true;
    n.lights = BRUME_LIGHT_BIT(BRUME_POINT) | BRUME_LIGHT_BIT(BRUME_SPOT);
  }
  void run(const brume_tile& t) const override {
    float* const planes[3] = {t.r, t.g, t.b};
    for (int y = 0; y < t.height; ++y)
      for (int x = 0; x < t.width; ++x) {
        const std::ptrdiff_t i = y * t.row_stride + x;
        const float far = t.distance[i], a = std::min(t.a[i], 1.f);
        if (!(a > 0) || !(far > 0) || !(far < 1e30f)) continue;
        float o[3], n[3] = {-t.dx[i], -t.dy[i], -t.dz[i]}, E[3];
        for (int c = 0; c < 3; ++c) o[c] = -far * n[c];
        if (t.ox) o[0] += t.ox[i], o[1] += t.oy[i], o[2] += t.oz[i];
        const brume_rays at = {1, o, o + 1, o + 2, n, n + 1, n + 2};
        float* const to[3] = {E, E + 1, E + 2};
        for (std::size_t k = 0; k < t.world->light_count; ++k) {
          t.world->irradiance(t.world, k, &at, to);
          for (int c = 0; c < 3; ++c) planes[c][i] += a * float(albedo / M_PI) * E[c];
        }
      }
  }
};

}  // namespace

BRUME_STAGES(Vignette, Torch)
