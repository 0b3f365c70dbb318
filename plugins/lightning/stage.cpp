// Lightning (SOURCES W11): its glow, every light adding intensity / (1 + a r^2) per metre
// of air, r the distance from it; and the bright core of a line or bolt. The formulas and
// their limits: README.md.

#include "stage/stage.h"

#include <cmath>

#include "baseline.h"
#include "bolt.h"
#include "core.h"
#include "run.h"

namespace {

using brume::Rgb;
using brume::Vec3;

struct Lightning : brume::Stage {
  static constexpr brume::StageAbout about{
      "lightning",
      "Lightning: the glow of one light, of many, of a line, or of a branching bolt, and "
      "the bolt itself.",
      BRUME_AIR, BRUME_BACKGROUND_STEP,
      "Wenzel 2006, the antiderivative as printed, in float"};

  std::string form = "points";
  Vec3 position{0, 0, 0};
  std::vector<double> points;
  Rgb intensity{1, 1, 1};
  double attenuation = 0.01;
  int lights = 24;
  int seed = 1;
  double roughness = 0.25;
  int branches = 4;
  Rgb core_radiance;
  double core_radius = 0.05;

  template <class V>
  void describe(V& v) {
    v("form", form,
      {.doc =
           "\"points\": a light at each point; \"line\": lights evenly along the line "
           "through them; \"bolt\": along a branching path that grows around that line.",
       .words = {"points", "line", "bolt"}});
    v("position", position,
      {.unit = "m",
       .doc = "The one light, where there are no points.",
       .minimum = -1e9,
       .maximum = 1e9});
    v("points", points,
      {.unit = "m",
       .doc = "World positions x, y, z, x, y, z, ...",
       .minimum = -1e9,
       .maximum = 1e9});
    v("intensity", intensity,
      {.unit = "radiance/m",
       .doc = "Radiance per metre at a light; of a line or bolt, of all its lights "
              "together.",
       .minimum = 0,
       .maximum = 1e9});
    v("attenuation", attenuation,
      {.unit = "1/m^2",
       .doc =
           "How fast it falls with distance: at 1 / sqrt(attenuation) metres it is half.",
       .minimum = 1e-12,
       .maximum = 1e12});
    v("lights", lights,
      {.doc = "How many lights a line or bolt is made of.",
       .minimum = 1,
       .maximum = 256});
    v("seed", seed, {.doc = "Which bolt.", .minimum = 0, .maximum = 1e9});
    v("roughness", roughness,
      {.doc = "How far each stretch of a bolt strays, as a part of its length.",
       .minimum = 0,
       .maximum = 1});
    v("branches", branches,
      {.doc = "How many branches leave a bolt.", .minimum = 0, .maximum = 64});
    v("core_radiance", core_radiance,
      {.unit = "radiance",
       .doc =
           "Radiance across the middle of the core of a line or bolt, seen near enough "
           "that it is wider than a pixel; 0: it is not drawn.",
       .minimum = 0,
       .maximum = 1e9});
    v("core_radius", core_radius,
      {.unit = "m",
       .doc = "Radius of the core: six parts in seven of its light come from within it. "
              "Branches are thinner.",
       .minimum = 1e-4,
       .maximum = 1e4});
  }

  void needs(const brume_frame&, brume::StageNeeds& n) override {
    if (intensity == Rgb{} && !has_core())
      n.idle = "intensity is 0, and no core is drawn";
    n.depth = true;
    n.camera = true;
  }

  void publish(const brume_frame& frame, brume::Publisher& world) override {
    for (std::size_t i = 0; i < 3; ++i) eye_[i] = frame.eye[i];
    if (has_core()) publish_core(frame, world);
    if (intensity == Rgb{}) return;
    for (const lightning::Spark& s : sparks()) {
      brume_medium m = brume::new_medium();
      m.profile = BRUME_LORENTZIAN;
      m.falloff = attenuation;
      for (std::size_t i = 0; i < 3; ++i) m.origin[i] = s.at[i];
      m.emission[0] = intensity.r * s.share;
      m.emission[1] = intensity.g * s.share;
      m.emission[2] = intensity.b * s.share;
      world.medium(m);
    }
  }

  bool has_core() const { return core_radiance != Rgb{} && form != "points"; }

  // Every stretch a medium, in the box that just holds it: rays elsewhere do not meet it.
  void publish_core(const brume_frame& frame, brume::Publisher& world) {
    const double radius = core_radius / 2;  // a Gaussian's deviation: e^-2 is outside
    lightning::Sight sight;
    std::copy_n(frame.eye, 3, sight.eye.begin());
    std::copy_n(frame.forward, 3, sight.forward.begin());
    sight.pixel = brume::Footprint(frame);
    sight.parallel = sight.pixel.parallel();
    cores_ = lightning::cores(lines(), radius, sight);
    drawn_.clear();
    drawn_.reserve(cores_.size());  // `self` points into it
    const double per_metre = 1 / (std::sqrt(2 * M_PI) * radius);
    // A step of half of what neighbouring pixels may differ by is not seen.
    const double brightest =
                     std::max({core_radiance.r, core_radiance.g, core_radiance.b}),
                 whole = std::log(20 * brightest / (frame.tolerance * frame.white));
    for (const lightning::Core& core : cores_) {
      drawn_.push_back({core.channel(), &core});
      drawn_.back().channel.whole = whole < 17.9 ? float(std::max(whole, 15.68)) : 0.f;
      brume_medium m = brume::new_medium();
      m.shape = BRUME_BOX;
      core.local_from_world(m.local_from_world);
      m.profile = BRUME_CUSTOM;
      m.emission[0] = core_radiance.r * per_metre;
      m.emission[1] = core_radiance.g * per_metre;
      m.emission[2] = core_radiance.b * per_metre;
      m.self = &drawn_.back();
      m.integral = [](const void* self, const brume_rays* rays, const float* t0,
                      const float* t1, float* D) {
        kernels().integral(of(self).channel, *rays, t0, t1, D);
      };
      m.density = [](const void* self, const brume_rays* rays, const float* t,
                     float* rho) { kernels().density(of(self).channel, *rays, t, rho); };
      m.point = [](const void* self, const double x[3], const double d[3], double* rho,
                   double source[3]) {
        *rho = of(self).core->density(x, d);
        source[0] = source[1] = source[2] = 0;
      };
      world.medium(m);
    }
  }

  void baseline(const brume_rays& rays, const float* t1, float* const L[3],
                float* const T[3]) const override {
    if (has_core()) throw std::runtime_error("the document draws no core");
    for (std::size_t i = 0; i < rays.n; ++i)
      for (int k = 0; k < 3; ++k) L[k][i] = 0, T[k][i] = 1;
    const float color[3] = {float(intensity.r), float(intensity.g), float(intensity.b)};
    for (const lightning::Spark& s : sparks()) {
      float light[3];
      for (std::size_t k = 0; k < 3; ++k) light[k] = float(s.at[k] - eye_[k]);
      for (std::size_t i = 0; i < rays.n; ++i) {
        const float d[3] = {rays.dx[i], rays.dy[i], rays.dz[i]};
        float m[3] = {-light[0], -light[1], -light[2]};
        if (rays.ox) m[0] += rays.ox[i], m[1] += rays.oy[i], m[2] += rays.oz[i];
        const float F =
            lightning::baseline::glow(m, d, t1[i], float(attenuation)) * float(s.share);
        for (int k = 0; k < 3; ++k) L[k][i] += color[k] * F;
      }
    }
  }

  // The places that are given, three numbers each.
  std::vector<Vec3> places() const {
    if (points.size() % 3)
      throw std::runtime_error("points has " + std::to_string(points.size()) +
                               " numbers; expected x, y and z for each point");
    std::vector<Vec3> at;
    for (std::size_t i = 0; i < points.size(); i += 3)
      at.push_back({points[i], points[i + 1], points[i + 2]});
    if (form != "points" && at.size() < 2)
      throw std::runtime_error("points: a " + form + " needs two points or more");
    return at;
  }

  // Of a line or bolt; the first is the trunk.
  std::vector<std::vector<Vec3>> lines() const {
    if (form == "line") return {places()};
    return lightning::grow(places(),
                           {.seed = seed, .roughness = roughness, .branches = branches});
  }

  std::vector<lightning::Spark> sparks() const {
    if (form == "line") return lightning::along_line(places(), lights);
    if (form == "bolt") return lightning::along_lines(lines(), lights);
    std::vector<Vec3> at = places();
    if (at.empty()) at.push_back(position);
    std::vector<lightning::Spark> all;
    for (const Vec3& p : at) all.push_back({p, 1});
    return all;
  }

 private:
  struct Drawn {
    lightning::Channel channel;
    const lightning::Core* core;
  };
  static const Drawn& of(const void* self) { return *static_cast<const Drawn*>(self); }
  static const lightning::Kernels& kernels() {
    using namespace lightning;
    static const Kernels& k = BRUME_ISA_SELECT(kernels);
    return k;
  }

  std::vector<lightning::Core> cores_;
  std::vector<Drawn> drawn_;
  Vec3 eye_{};
};

}  // namespace

BRUME_STAGES(Lightning)
