// Fog in a box or an ellipsoid (SOURCES W5). The formulas and their limits: README.md.
//
//   sigma(x) = density exp(-falloff gradient . (x - origin))   [1/m], inside the shape
//
// The stage says what there is; the integrator (src/air) has the closed form.

#include "stage/stage.h"
#include "placement.h"

namespace {

using brume::Rgb;
using brume::Vec3;

struct FogVolume : brume::Stage {
  static constexpr brume::StageAbout about{
      "fog_volume",
      "Fog inside a box or an ellipsoid, even or thinning along a direction.", BRUME_AIR};

  std::string shape = "box";
  Vec3 center{0, 0, 0};
  Vec3 half{1, 1, 1};
  Vec3 rotation{0, 0, 0};
  brume::Matrix4 matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  Rgb density{0.1, 0.1, 0.1};
  std::vector<double> origin;
  Vec3 gradient{0, 0, 1};
  double falloff = 0;
  brume::RgbOr color{{0.5, 0.6, 0.7}, ""};
  Rgb albedo;
  double g = 0;
  double max_opacity = 1;
  double start = 0;

  template <class V>
  void describe(V& v) {
    v("shape", shape, {.doc = "What bounds the fog.", .words = {"box", "ellipsoid"}});
    v("center", center,
      {.unit = "m", .doc = "Its middle.", .minimum = -1e9, .maximum = 1e9});
    v("half", half,
      {.unit = "m",
       .doc = "Half its extent along each of its own axes: half edges of the box, "
              "semi-axes of the ellipsoid.",
       .minimum = 1e-6,
       .maximum = 1e9});
    v("rotation", rotation,
      {.unit = "degrees",
       .doc = "Turns about x, y and z, in this order: world = Rz Ry Rx local + center.",
       .minimum = -1e6,
       .maximum = 1e6});
    v("matrix", matrix,
      {.doc =
           "Moves everything once more: world = matrix (Rz Ry Rx local + center). With "
           "center, half and rotation left alone it places the unit box or ball."});
    v("density", density,
      {.unit = "1/m",
       .doc = "Extinction at `origin`, one number or one per colour.",
       .minimum = 0,
       .maximum = 1e9});
    v("origin", origin,
      {.unit = "m",
       .doc = "World position where the fog has `density`; left empty, the centre.",
       .minimum = -1e9,
       .maximum = 1e9});
    v("gradient", gradient,
      {.doc = "World direction along which the fog thins, of any length.",
       .minimum = -1e9,
       .maximum = 1e9});
    v("falloff", falloff,
      {.unit = "1/m",
       .doc =
           "How fast it thins along `gradient`: by a factor e per 1 / falloff metres; 0 "
           "is even fog, below 0 it thickens.",
       .minimum = -1e6,
       .maximum = 1e6});
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
    n.camera = true;
    n.nearest = start;
  }

  void publish(const brume_frame&, brume::Publisher& world) override {
    const auto at = fog_volume::place(center, half, rotation, matrix);
    brume_medium m = brume::new_medium();
    m.shape = shape == "box" ? BRUME_BOX : BRUME_ELLIPSOID;
    for (std::size_t i = 0; i < 12; ++i) m.local_from_world[i] = at.local_from_world[i];
    if (falloff != 0) set_gradient(m, at.center);
    set(m.extinction, density);
    set(m.albedo, albedo);
    set(m.color, color.rgb);
    m.g = g;
    m.source = color.word == "sky" ? BRUME_SOURCE_SKY : BRUME_SOURCE_COLOR;
    m.start = start;
    m.max_opacity = max_opacity;
    world.medium(m);
  }

  void set_gradient(brume_medium& m, const Vec3& middle) const {
    if (!origin.empty() && origin.size() != 3)
      throw std::runtime_error("origin has " + std::to_string(origin.size()) +
                               " numbers; expected x, y and z, or none");
    const double length = std::hypot(gradient[0], gradient[1], gradient[2]);
    if (!(length > 0))
      throw std::runtime_error("gradient is 0 0 0 and says no direction for falloff");
    m.profile = BRUME_EXPONENTIAL;
    m.falloff = falloff;
    for (std::size_t i = 0; i < 3; ++i) {
      m.direction[i] = gradient[i] / length;
      m.origin[i] = origin.empty() ? middle[i] : origin[i];
    }
  }

  static void set(double to[3], const Rgb& c) {
    to[0] = c.r;
    to[1] = c.g;
    to[2] = c.b;
  }
};

}  // namespace

BRUME_STAGES(FogVolume)
