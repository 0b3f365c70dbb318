// Stages for tests of the truth, linked in: `thick` lies to the product; `cover`, `ramp`,
// `half` and `step` change surfaces, all but the first with a truth; `grey` is a lens.

#include <algorithm>

#include "stage/registry.h"
#include "stage/stage.h"

namespace {

/// Black fog of 0.001 per metre whose optical depth along a ray is 1.01 times what its
/// density makes it.
struct Thick : brume::Stage {
  static constexpr brume::StageAbout about{"thick", "A hundredth too thick.", BRUME_AIR};
  template <class V>
  void describe(V&) {}
  void needs(const brume_frame&, brume::StageNeeds& n) override {
    n.depth = n.camera = true;
  }
  void publish(const brume_frame&, brume::Publisher& world) override {
    brume_medium m = brume::new_medium();
    m.profile = BRUME_CUSTOM;
    for (double& e : m.extinction) e = 0.001;
    m.self = this;
    m.integral = [](const void*, const brume_rays* r, const float* t0, const float* t1,
                    float* integral) {
      for (std::size_t i = 0; i < r->n; ++i)
        integral[i] = 1.01f * std::min(t1[i] - t0[i], 1e6f);
    };
    m.density = [](const void*, const brume_rays* r, const float*, float* rho) {
      std::fill_n(rho, r->n, 1.f);
    };
    m.point = [](const void*, const double*, const double*, double* rho, double*) {
      *rho = 1;
    };
    world.medium(m);
  }
};

/// Paints 0.25 and covers whatever has a distance.
struct Cover : brume::Stage {
  static constexpr brume::StageAbout about{"cover", "Paints surfaces.", BRUME_SURFACE,
                                           BRUME_LIGHT_STEP};
  template <class V>
  void describe(V&) {}
  void needs(const brume_frame&, brume::StageNeeds& n) override {
    n.depth = true;
    n.changes_alpha = true;
  }
  void run(const brume_tile& t) const override {
    for (int y = 0; y < t.height; ++y)
      for (int x = 0; x < t.width; ++x) {
        const std::ptrdiff_t i = y * t.row_stride + x;
        if (!(t.distance[i] < 1e30f)) continue;
        t.r[i] = t.g[i] = t.b[i] = 0.25f;
        t.a[i] = 1;
      }
  }
};

/// A surface stage that makes of every number `of(number, distance)`, and says so in
/// double.
template <class Of>
struct ByNumber : brume::Stage {
  template <class V>
  void describe(V&) {}
  void needs(const brume_frame&, brume::StageNeeds& n) override {
    n.depth = Of::asks_distance;
  }
  void run(const brume_tile& t) const override {
    for (int y = 0; y < t.height; ++y)
      for (int x = 0; x < t.width; ++x) {
        const std::ptrdiff_t i = y * t.row_stride + x;
        for (float* plane : {t.r, t.g, t.b})
          plane[i] = Of::of(plane[i], t.distance ? t.distance[i] : 0.f);
      }
  }
  void truth(const brume_tile& t, std::span<const int> xy, double* rgb) const override {
    for (std::size_t k = 0; k < xy.size() / 2; ++k) {
      const std::ptrdiff_t i = xy[2 * k + 1] * t.row_stride + xy[2 * k];
      const float* const planes[] = {t.r, t.g, t.b};
      for (std::size_t c = 0; c < 3; ++c)
        rgb[3 * k + c] =
            Of::of(double(planes[c][i]), t.distance ? double(t.distance[i]) : 0.);
    }
  }
};

/// Adds 0.001 of the distance.
struct Ramp : ByNumber<Ramp> {
  static constexpr brume::StageAbout about{
      "ramp", "Adds a ramp.", BRUME_SURFACE, BRUME_LIGHT_STEP, nullptr, true};
  static constexpr bool asks_distance = true;
  template <class T>
  static T of(T x, T distance) {
    return distance < T(1e30) ? x + T(0.001) * distance : x;
  }
};

/// Half of the colour is left.
struct Half : ByNumber<Half> {
  static constexpr brume::StageAbout about{
      "half", "Half the light.", BRUME_SURFACE, BRUME_INTERFACE_STEP, nullptr, true};
  static constexpr bool asks_distance = false;
  template <class T>
  static T of(T x, T) {
    return T(0.5) * x;
  }
};

/// Adds 1 from 100 m on: an edge.
struct Step : ByNumber<Step> {
  static constexpr brume::StageAbout about{
      "step", "Adds a step.", BRUME_SURFACE, BRUME_LIGHT_STEP, nullptr, true};
  static constexpr bool asks_distance = true;
  template <class T>
  static T of(T x, T distance) {
    return x + T(distance >= 100);
  }
};

/// All pixels become grey.
struct Grey : brume::Stage {
  static constexpr brume::StageAbout about{"grey", "Grey everywhere.", BRUME_LENS};
  template <class V>
  void describe(V&) {}
  void run(const brume_tile& t) const override {
    for (int y = 0; y < t.height; ++y)
      for (float* plane : {t.r, t.g, t.b})
        std::fill_n(plane + y * t.row_stride, t.width, 0.5f);
  }
};

}  // namespace

// The symbol is renamed as brume_plugin() does for every linked-in plugin.
#define brume_plugin brume_plugin_truth_test
BRUME_STAGES(Thick, Cover, Ramp, Half, Step, Grey)
#undef brume_plugin

namespace {
const brume::LinkedPlugin kLinked{"truth_test", brume_plugin_truth_test};
}
