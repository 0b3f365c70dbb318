// The glow of lightning (SOURCES W11): every light adds intensity / (1 + a r^2) per metre
// of air, r the distance from it. The formula and its limits: README.md.

#include "stage/stage.h"
#include "baseline.h"
#include "bolt.h"

namespace {

using brume::Rgb;
using brume::Vec3;

struct Lightning : brume::Stage {
  static constexpr brume::StageAbout about{
      "lightning", "The glow of lightning: one light, many, a line, or a branching bolt.",
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
  }

  void needs(const brume_frame&, brume::StageNeeds& n) override {
    if (intensity == Rgb{}) n.idle = "intensity is 0";
    n.depth = true;
    n.camera = true;
  }

  void publish(const brume_frame& frame, brume::Publisher& world) override {
    for (std::size_t i = 0; i < 3; ++i) eye_[i] = frame.eye[i];
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

  void baseline(const brume_rays& rays, const float* t1, float* const L[3],
                float* const T[3]) const override {
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

  std::vector<lightning::Spark> sparks() const {
    if (points.size() % 3)
      throw std::runtime_error("points has " + std::to_string(points.size()) +
                               " numbers; expected x, y and z for each point");
    std::vector<Vec3> at;
    for (std::size_t i = 0; i < points.size(); i += 3)
      at.push_back({points[i], points[i + 1], points[i + 2]});
    if (form == "points") {
      if (at.empty()) at.push_back(position);
      std::vector<lightning::Spark> all;
      for (const Vec3& p : at) all.push_back({p, 1});
      return all;
    }
    if (at.size() < 2)
      throw std::runtime_error("points: a " + form + " needs two points or more");
    if (form == "line") return lightning::along_line(at, lights);
    return lightning::along_lines(
        lightning::grow(at, {.seed = seed, .roughness = roughness, .branches = branches}),
        lights);
  }

 private:
  Vec3 eye_{};
};

}  // namespace

BRUME_STAGES(Lightning)
