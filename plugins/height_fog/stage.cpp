// Fog whose density falls with height (SOURCES W3). The formula and its limits:
// README.md.
//
//   sigma(z) = density exp(-falloff (z - height))   [1/m], z along the world's up
//
// The stage says what there is; the integrator (src/air) has the closed form.

#include <algorithm>
#include <cmath>

#include "baseline.h"
#include "stage/stage.h"

namespace {

using brume::Rgb;

struct HeightFog : brume::Stage {
  static constexpr brume::StageAbout about{
      "height_fog", "Fog whose density falls exponentially with height.", BRUME_AIR,
      BRUME_BACKGROUND_STEP, "Wenzel 2007, the slide's listing in float"};

  Rgb density{0.002, 0.002, 0.002};
  double height = 0;
  double falloff = 0.01;
  brume::RgbOr color{{0.5, 0.6, 0.7}, ""};
  Rgb albedo;
  double g = 0;
  double max_opacity = 1;
  double start = 0;

  template <class V>
  void describe(V& v) {
    v("density", density,
      {.unit = "1/m",
       .doc = "Extinction at `height`, one number or one per colour.",
       .minimum = 0,
       .maximum = 1e6});
    v("height", height,
      {.unit = "m",
       .doc = "World height at which the fog has `density`.",
       .minimum = -1e7,
       .maximum = 1e7});
    v("falloff", falloff,
      {.unit = "1/m",
       .doc = "How fast the density falls with height: by a factor e per 1 / falloff "
              "metres; 0 is the same fog everywhere.",
       .minimum = 0,
       .maximum = 1e3});
    v("color", color,
      {.doc = "Colour that thick fog takes, scene-linear; \"sky\" takes it from sun and "
              "sky.",
       .minimum = 0,
       .maximum = 1e6,
       .words = {"sky"}});
    v("albedo", albedo,
      {.doc = "Part of the light of lamps that the fog scatters on, in addition to its "
              "colour.",
       .minimum = 0,
       .maximum = 1});
    v("g", g,
      {.doc = "Where scattered light goes: 0 evenly, towards 1 forward, towards -1 back "
              "(Henyey-Greenstein).",
       .minimum = -0.99,
       .maximum = 0.99});
    v("max_opacity", max_opacity,
      {.doc = "The fog ends where it hides this much of what lies behind it.",
       .minimum = 0,
       .maximum = 1});
    v("start", start,
      {.unit = "m",
       .doc = "Nearer to the camera than this there is no fog.",
       .minimum = 0,
       .maximum = 1e9});
  }

  void needs(const brume_frame&, brume::StageNeeds& n) override {
    if (density == Rgb{})
      n.idle = "density is 0";
    else if (max_opacity == 0)
      n.idle = "max_opacity is 0";
    n.depth = true;
    n.camera = falloff != 0;
    n.nearest = start;
  }

  void publish(const brume_frame& frame, brume::Publisher& world) override {
    brume_medium m = brume::new_medium();
    m.profile = falloff == 0 ? BRUME_UNIFORM : BRUME_EXPONENTIAL;
    m.falloff = falloff;
    for (int i = 0; i < 3; ++i) {
      m.direction[i] = frame.up[i];
      m.origin[i] = height * frame.up[i];
    }
    set(m.extinction, density);
    set(m.albedo, albedo);
    set(m.color, color.rgb);
    m.g = g;
    m.source = color.word == "sky" ? BRUME_SOURCE_SKY : BRUME_SOURCE_COLOR;
    m.start = start;
    m.max_opacity = max_opacity;
    world.medium(m);
    for (int i = 0; i < 3; ++i) {
      up_[i] = float(frame.up[i]);
      eye_z_ += frame.eye[i] * frame.up[i];
    }
  }

  void baseline(const brume_rays& rays, const float* t1, float* const L[3],
                float* const T[3]) const override {
    if (color.word == "sky")
      throw std::runtime_error("the listing has one colour, not the sky's");
    if (start != 0 || max_opacity != 1)
      throw std::runtime_error("the listing knows neither start nor max_opacity");
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

  static void set(double to[3], const Rgb& c) {
    to[0] = c.r;
    to[1] = c.g;
    to[2] = c.b;
  }

 private:
  float up_[3] = {};
  double eye_z_ = 0;
};

}  // namespace

BRUME_STAGES(HeightFog)
