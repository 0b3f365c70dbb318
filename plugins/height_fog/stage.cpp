// Fog whose density falls with height (SOURCES W3). The formula and its limits:
// README.md.
//
//   sigma(z) = density exp(-falloff (z - height))   [1/m], z along the world's up
//
// The stage says what there is; the integrator (src/air) has the closed form.

#include <algorithm>
#include <cmath>

#include "baseline.h"
#include "stage/fog.h"

namespace {

struct HeightFog : brume::LayeredFog {
  static constexpr brume::StageAbout about{
      "height_fog", "Fog whose density falls exponentially with height.", BRUME_AIR,
      BRUME_BACKGROUND_STEP, "Wenzel 2007, the slide's listing in float"};

  HeightFog() : LayeredFog(0.002) {}

  template <class V>
  void describe(V& v) {
    describe_layers(v, "Extinction at `height`, one number or one per colour.");
    describe_look(v);
  }

  void needs(const brume_frame&, brume::StageNeeds& n) override {
    ask(n, density, falloff != 0);
  }

  void publish(const brume_frame& frame, brume::Publisher& world) override {
    brume_medium m = layers_of(frame);
    m.profile = falloff == 0 ? BRUME_UNIFORM : BRUME_EXPONENTIAL;
    world.medium(m);
    for (int i = 0; i < 3; ++i) {
      up_[i] = float(frame.up[i]);
      eye_z_ += frame.eye[i] * frame.up[i];
    }
  }

  void baseline(const brume_rays& rays, const float* t1, float* const L[3],
                float* const T[3]) const override {
    check_plain("listing");
    // Pixels without depth lie where a renderer's far plane would be.
    constexpr float kFarPlane = 1e6f;
    const float z = float(eye_z_ - height), c = float(falloff);
    const float b[3] = {float(density.r), float(density.g), float(density.b)};
    const float S[3] = {float(color.rgb.r), float(color.rgb.g), float(color.rgb.b)};
    for (std::size_t i = 0; i < rays.n; ++i) {
      const float t = std::min(t1[i], kFarPlane);
      const float dz = rays.dx[i] * up_[0] + rays.dy[i] * up_[1] + rays.dz[i] * up_[2];
      float from = z;
      if (rays.ox)
        from += rays.ox[i] * up_[0] + rays.oy[i] * up_[1] + rays.oz[i] * up_[2];
      const float level = std::sqrt(std::max(1 - dz * dz, 0.0f));
      const float D = height_fog::baseline::integral(t * level, 0, t * dz, from, c);
      for (int k = 0; k < 3; ++k) {
        T[k][i] = std::exp(-b[k] * D);
        L[k][i] = S[k] * (1 - T[k][i]);
      }
    }
  }

 private:
  float up_[3] = {};
  double eye_z_ = 0;
};

}  // namespace

BRUME_STAGES(HeightFog)
