#pragma once
// What fogs have in common, whatever their density: colour, what they do to light, where
// they end. Header-only, for stages written in C++.
//
//   struct Mist : brume::FogStage {
//     Rgb density;
//     template <class V>
//     void describe(V& v) {
//       v("density", density, ...);
//       describe_look(v);
//     }
//     void publish(const brume_frame&, brume::Publisher& world) override {
//       brume_medium m = fog_of(density);
//       ...

#include "stage/stage.h"

namespace brume {

inline void set(double to[3], const Rgb& c) {
  to[0] = c.r;
  to[1] = c.g;
  to[2] = c.b;
}

struct FogStage : Stage {
  RgbOr color{{0.5, 0.6, 0.7}, ""};
  Rgb albedo;
  double g = 0;
  double max_opacity = 1;
  double start = 0;

  template <class V>
  void describe_look(V& v) {
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

  /// Depth from `start` on, and the camera where the fog is not the same everywhere; or
  /// why there is no fog.
  void ask(StageNeeds& n, const Rgb& density, bool camera = true) const {
    if (density == Rgb{})
      n.idle = "density is 0";
    else if (max_opacity == 0)
      n.idle = "max_opacity is 0";
    n.depth = true;
    n.camera = camera;
    n.nearest = start;
  }

  /// Present everywhere and uniform; bounds and profile are the stage's to set.
  brume_medium fog_of(const Rgb& density) const {
    brume_medium m = new_medium();
    set(m.extinction, density);
    set(m.albedo, albedo);
    set(m.color, color.rgb);
    m.g = g;
    m.source = color.word == "sky" ? BRUME_SOURCE_SKY : BRUME_SOURCE_COLOR;
    m.start = start;
    m.max_opacity = max_opacity;
    return m;
  }

  /// For a baseline whose document has one colour and knows no ends.
  void check_plain(const char* document) const {
    if (color.word == "sky")
      throw std::runtime_error(std::string("the ") + document +
                               " has one colour, not the sky's");
    if (start != 0 || max_opacity != 1)
      throw std::runtime_error(std::string("the ") + document +
                               " knows neither start nor max_opacity");
  }
};

/// Fog that thins with height: density e^(-falloff (z - height)).
struct LayeredFog : FogStage {
  Rgb density;
  double height = 0;
  double falloff = 0.01;

  explicit LayeredFog(double sigma) : density{sigma, sigma, sigma} {}

  template <class V>
  void describe_layers(V& v, const char* what_density_is) {
    v("density", density,
      {.unit = "1/m", .doc = what_density_is, .minimum = 0, .maximum = 1e6});
    v("height", height,
      {.unit = "m",
       .doc = "World height at which the fog has `density`.",
       .minimum = -1e7,
       .maximum = 1e7});
    v("falloff", falloff,
      {.unit = "1/m",
       .doc = "How fast the density falls with height: by a factor e per 1 / falloff "
              "metres; 0 is the same at every height.",
       .minimum = 0,
       .maximum = 1e3});
  }

  /// fog_of, with the layers' origin and falloff; the profile is the stage's.
  brume_medium layers_of(const brume_frame& frame) const {
    brume_medium m = fog_of(density);
    m.falloff = falloff;
    for (int i = 0; i < 3; ++i) {
      m.direction[i] = frame.up[i];
      m.origin[i] = height * frame.up[i];
    }
    return m;
  }
};

}  // namespace brume
