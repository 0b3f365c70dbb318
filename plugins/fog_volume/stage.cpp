// Fog in a box or an ellipsoid (SOURCES W5). The formulas and their limits: README.md.
//
//   sigma(x) = density exp(-falloff gradient . (x - origin))   [1/m], inside the shape
//
// The stage says what there is; the integrator (src/air) has the closed form. With soft
// edges the stage brings its own integral (kernel.h).

#include "stage/fog.h"

#include <algorithm>
#include <limits>

#include "num/digits.h"
#include "placement.h"
#include "run.h"

namespace {

using brume::Rgb;
using brume::Vec3;

struct FogVolume : brume::FogStage {
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
  double softness = 0;

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
    v("softness", softness,
      {.doc = "Over which part of the way from its boundary to its middle the fog fades "
              "in, along each axis: 0 has a hard edge, 1 none at all.",
       .minimum = 0,
       .maximum = 1});
    describe_look(v);
  }

  void needs(const brume_frame&, brume::StageNeeds& n) override { ask(n, density); }

  void publish(const brume_frame& frame, brume::Publisher& world) override {
    const auto at = fog_volume::place(center, half, rotation, matrix);
    brume_medium m = fog_of(density);
    m.shape = shape == "box" ? BRUME_BOX : BRUME_ELLIPSOID;
    for (std::size_t i = 0; i < 12; ++i) m.local_from_world[i] = at.local_from_world[i];
    if (falloff != 0) set_gradient(m, at.center);
    const auto wrong = float_errors(at, frame);
    if (softness > kHard || std::max({wrong[0], wrong[1], wrong[2]}) > kTooWrong)
      integrate_here(m, at, wrong, frame);
    world.medium(m);
  }

  // How far floats may be off in its coordinates: in places along rays from the eye, of
  // the volume's own size on each axis.
  static Vec3 float_errors(const fog_volume::Placement& at, const brume_frame& frame) {
    const double far =
        at.radius + std::hypot(at.center[0] - frame.eye[0], at.center[1] - frame.eye[1],
                               at.center[2] - frame.eye[2]);
    Vec3 wrong;
    for (std::size_t i = 0; i < 3; ++i) {
      const double* row = at.local_from_world.data() + 4 * i;
      const double per_metre = std::hypot(row[0], row[1], row[2]);
      wrong[i] =
          8 * double(std::numeric_limits<float>::epsilon()) * (1 + per_metre * far);
    }
    return wrong;
  }

  // The same medium with a profile of its own: its falloff stays as a hint. Its bounds
  // grow by what floats may be wrong about them, as its own integral knows them better.
  void integrate_here(brume_medium& m, const fog_volume::Placement& at, const Vec3& wrong,
                      const brume_frame& frame) {
    Soft& v = soft_;
    v.box = m.shape == BRUME_BOX;
    v.softness = float(softness);
    const auto set = [&](std::size_t row, std::size_t k, double x) {
      const double head = brume::first_24_bits(x);
      v.hi[row][k] = float(head);
      v.lo[row][k] = float(x - head);
    };
    double log_rho0 = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double* row = m.local_from_world + 4 * i;
      double b = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        set(i, k, row[k]);
        b += row[k] * (frame.eye[k] - at.center[k]);
      }
      set(i, 3, b);
      set(3, i, -m.falloff * m.direction[i]);
      log_rho0 -= m.falloff * m.direction[i] * (frame.eye[i] - m.origin[i]);
    }
    set(3, 3, log_rho0);
    truth_ = m;
    const double most =
        std::max({wrong[0], wrong[1], wrong[2]});  // a ball mixes its axes
    for (std::size_t i = 0; i < 12; ++i)
      m.local_from_world[i] /= 1 + (v.box ? wrong[i / 4] : most);
    m.profile = BRUME_CUSTOM;
    m.self = this;
    m.integral = [](const void* self, const brume_rays* rays, const float* t0,
                    const float* t1,
                    float* D) { kernels().integral(of(self).soft_, *rays, t0, t1, D); };
    m.density = [](const void* self, const brume_rays* rays, const float* t, float* rho) {
      kernels().density(of(self).soft_, *rays, t, rho);
    };
    m.point = [](const void* self, const double x[3], const double*, double* rho,
                 double source[3]) {
      *rho = of(self).at(x);
      source[0] = source[1] = source[2] = 0;
    };
  }

  // rho at a point, in double and by the words of the README.
  double at(const double x[3]) const {
    const brume_medium& m = truth_;
    double inward = 1, r2 = 0, exponent = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double* row = m.local_from_world + 4 * i;
      const double local = row[0] * x[0] + row[1] * x[1] + row[2] * x[2] + row[3];
      if (m.shape == BRUME_BOX) inward *= fade(1 - std::abs(local), softness);
      r2 += local * local;
      exponent -= m.falloff * m.direction[i] * (x[i] - m.origin[i]);
    }
    if (m.shape != BRUME_BOX) inward = fade(1 - r2, softness * (2 - softness));
    return inward * std::exp(std::min(exponent, 300.));
  }
  // How much of the fog there is that far inside, where it is whole from `all` on.
  static double fade(double inside, double all) {
    if (inside >= all) return 1;
    const double u = std::max(inside, 0.) / all;
    return 3 * u * u - 2 * u * u * u;
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

 private:
  using Soft = fog_volume::Soft;
  static constexpr double kHard = 1e-5;  // softer than that floats can tell from hard
  // Of a hard volume's own size, from a thousand half extents away on: closed forms in
  // float end here.
  static constexpr double kTooWrong = 1e-3;

  static const FogVolume& of(const void* self) {
    return *static_cast<const FogVolume*>(self);
  }
  static const fog_volume::Kernels& kernels() {
    using namespace fog_volume;
    static const Kernels& k = BRUME_ISA_SELECT(kernels);
    return k;
  }

  Soft soft_;
  brume_medium truth_{};
};

}  // namespace

BRUME_STAGES(FogVolume)
