// Lamps and a sun: lights that shine in the media of every stage (SOURCES I3, I4).
//
//   point   E(x) = power / max(r, radius)^2
//   spot    the same times its cone's edge at the angle from `direction`
//   sun     E the same everywhere
//
// The stages say what there is; how it glows is the integrator's.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "stage/stage.h"

namespace {

using brume::Rgb;
using brume::Vec3;

constexpr double kPerDegree = std::numbers::pi / 180;

void set(double to[3], const Rgb& c) {
  to[0] = c.r;
  to[1] = c.g;
  to[2] = c.b;
}
void set_direction(double to[3], const Vec3& v, const char* name) {
  const double length = std::hypot(v[0], v[1], v[2]);
  if (!(length > 0))
    throw std::runtime_error(std::string(name) + " is 0 0 0 and says no direction");
  for (std::size_t i = 0; i < 3; ++i) to[i] = v[i] / length;
}

// What all lamps have.
struct Lamp : brume::Stage {
  Vec3 position{0, 0, 0};
  Rgb power{1, 1, 1};
  double radius = 0;
  bool attenuated = true;

  template <class V>
  void describe_lamp(V& v) {
    v("position", position,
      {.unit = "m", .doc = "Where it is.", .minimum = -1e9, .maximum = 1e9});
    v("power", power,
      {.unit = "radiance m^2",
       .doc =
           "Radiant intensity per steradian: what it sends into each direction (a lamp "
           "of P watts that shines evenly all around has P / (4 pi)).",
       .minimum = 0,
       .maximum = 1e12});
    v("radius", radius,
      {.unit = "m",
       .doc = "Its size: nearer than this its light grows no more.",
       .minimum = 0,
       .maximum = 1e6});
    v("attenuated", attenuated,
      {.doc = "Air dims its light on the way to what it lights."});
  }

  void needs(const brume_frame&, brume::StageNeeds& n) override {
    if (power == Rgb{}) n.idle = "power is 0";
    n.camera = true;
    n.depth = true;
  }

  brume_light lamp(brume_light_kind kind) const {
    brume_light l = brume::new_light();
    l.kind = kind;
    for (std::size_t i = 0; i < 3; ++i) l.position[i] = position[i];
    set(l.power, power);
    l.radius = radius;
    l.attenuated = attenuated;
    return l;
  }
};

struct PointLight : Lamp {
  static constexpr brume::StageAbout about{
      "point_light", "A lamp that shines evenly all around, in the air of every stage.",
      BRUME_AIR};

  template <class V>
  void describe(V& v) {
    describe_lamp(v);
  }
  void publish(const brume_frame&, brume::Publisher& world) override {
    world.light(lamp(BRUME_POINT));
  }
};

struct Spotlight : Lamp {
  static constexpr brume::StageAbout about{
      "spotlight", "A lamp that shines into a cone, in the air of every stage.",
      BRUME_AIR};

  Vec3 direction{0, 0, -1};
  double cone = 30;
  double cone_soft = 5;
  std::string falloff = "smooth";

  template <class V>
  void describe(V& v) {
    describe_lamp(v);
    v("direction", direction,
      {.doc = "Where it shines to, of any length.", .minimum = -1e9, .maximum = 1e9});
    v("cone", cone,
      {.unit = "degrees",
       .doc = "Half the angle of its cone.",
       .minimum = 0.01,
       .maximum = 90});
    v("cone_soft", cone_soft,
      {.unit = "degrees",
       .doc = "Over this angle, inside the cone, its edge fades.",
       .minimum = 0,
       .maximum = 90});
    v("falloff", falloff,
      {.doc =
           "How: \"smooth\" over cone_soft, or \"ratio\", |cone / angle| - 1 between 0 "
           "and 1 (Intel 2008).",
       .words = {"smooth", "ratio"}});
  }
  void publish(const brume_frame&, brume::Publisher& world) override {
    brume_light l = lamp(BRUME_SPOT);
    set_direction(l.direction, direction, "direction");
    l.cone = cone * kPerDegree;
    l.cone_soft = std::min(cone_soft, cone) * kPerDegree;
    l.cone_falloff = falloff == "ratio";
    world.light(l);
  }
};

struct SunLight : brume::Stage {
  static constexpr brume::StageAbout about{
      "sun_light", "Parallel light from one direction, in the air of every stage.",
      BRUME_AIR};

  Vec3 direction{0, 0, -1};
  Rgb irradiance{1, 1, 1};
  bool attenuated = true;

  template <class V>
  void describe(V& v) {
    v("direction", direction,
      {.doc = "Where it shines to, of any length.", .minimum = -1e9, .maximum = 1e9});
    v("irradiance", irradiance,
      {.doc = "On a plane that faces it.", .minimum = 0, .maximum = 1e9});
    v("attenuated", attenuated,
      {.doc = "Air dims its light on the way to what it lights."});
  }
  void needs(const brume_frame&, brume::StageNeeds& n) override {
    if (irradiance == Rgb{}) n.idle = "irradiance is 0";
    n.camera = true;
    n.depth = true;
  }
  void publish(const brume_frame&, brume::Publisher& world) override {
    brume_light l = brume::new_light();
    l.kind = BRUME_SUN;
    set_direction(l.direction, direction, "direction");
    for (double& x : l.direction) x = -x;  // published: toward the light
    set(l.power, irradiance);
    l.attenuated = attenuated;
    world.light(l);
  }
};

}  // namespace

BRUME_STAGES(PointLight, Spotlight, SunLight)
