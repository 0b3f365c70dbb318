// Toy stages for tests of the pipeline, linked in: `paint` (surface), `steepness`
// (surface, looks around), `asks` (surface, asks the world) and `blur` (lens).

#include <cmath>
#include <string>
#include <vector>

#include "stage/registry.h"
#include "stage/stage.h"

namespace {

/// Adds a colour to every covered pixel, or to those of the rows 50 to 59 alone.
struct Paint : brume::Stage {
  static constexpr brume::StageAbout about{"paint", "Adds a colour.", BRUME_SURFACE,
                                           BRUME_LIGHT_STEP};
  brume::Rgb color{1, 0, 0};
  template <class V>
  void describe(V& v) {
    v("color", color, {.doc = "What is added."});
    v("band", band, {.doc = "Rows 50 to 59 only."});
  }
  bool band = false;
  void needs(const brume_frame& f, brume::StageNeeds& n) override {
    if (band) n.screen = {f.display_x, 50, f.display_width, 10};
  }
  void run(const brume_tile& t) const override {
    for (int y = 0; y < t.height; ++y)
      for (int x = 0; x < t.width; ++x) {
        if (band && (t.y + y < 50 || t.y + y >= 60)) continue;
        const std::ptrdiff_t i = y * t.row_stride + x;
        t.r[i] += float(color.r) * t.a[i];
        t.g[i] += float(color.g) * t.a[i];
        t.b[i] += float(color.b) * t.a[i];
      }
  }
};

/// Sets red to the largest difference of distance within two pixels: needs what lies
/// around.
struct Steepness : brume::Stage {
  static constexpr brume::StageAbout about{
      "steepness", "Largest step of distance nearby.", BRUME_SURFACE, BRUME_LIGHT_STEP};
  template <class V>
  void describe(V&) {}
  void needs(const brume_frame&, brume::StageNeeds& n) override {
    n.depth = true;
    n.rows_around = n.columns_around = 2;
  }
  void run(const brume_tile& t) const override {
    for (int y = 0; y < t.height; ++y)
      for (int x = 0; x < t.width; ++x) {
        const float* d = t.distance + y * t.row_stride + x;
        float step = 0;
        for (int j = -2; j <= 2; ++j)
          for (int i = -2; i <= 2; ++i) {
            const float e = std::abs(d[j * t.row_stride + i] - d[0]);
            if (std::isfinite(e)) step = std::max(step, e);
          }
        t.r[y * t.row_stride + x] = step;
      }
  }
};

/// Asks the world: red becomes the transmittance up to the sample, green the irradiance
/// of the first light there on what faces up, blue that of a light that there is not.
struct Asks : brume::Stage {
  static constexpr brume::StageAbout about{"asks", "Asks the world.", BRUME_SURFACE,
                                           BRUME_LIGHT_STEP};
  template <class V>
  void describe(V&) {}
  void needs(const brume_frame& f, brume::StageNeeds& n) override {
    n.depth = n.camera = true;
    n.lights = BRUME_LIGHT_BIT(BRUME_POINT);
    told_ = f.channel_count == 5 && std::string(f.channels[4]) == "Z" &&
            f.camera_right[0] > 0.999 && f.camera_up[2] > 0.99;
  }
  void run(const brume_tile& t) const override {
    const brume_world& w = *t.world;
    if (!told_ || w.light(&w, w.light_count) || w.light(&w, 0)->kind != BRUME_POINT)
      throw std::runtime_error("was told wrong");
    const std::size_t n = std::size_t(t.width);
    std::vector<float> x(3 * n), up(n, 1.f), zero(n, 0.f), rest(7 * n);
    for (std::size_t i = 0; i < n; ++i) {
      const float d = std::min(t.distance[i], 1e6f);
      x[i] = d * t.dx[i], x[n + i] = d * t.dy[i], x[2 * n + i] = d * t.dz[i];
    }
    float* const T[3] = {t.r, &rest[0], &rest[n]};
    const brume_rays rays = {n, t.ox, t.oy, t.oz, t.dx, t.dy, t.dz};
    w.transmittance(&w, &rays, t.distance, T);
    const brume_rays points = {n,           &x[0],       &x[n],    &x[2 * n],
                               zero.data(), zero.data(), up.data()};
    float* const E[3] = {t.g, &rest[2 * n], &rest[3 * n]};
    w.irradiance(&w, 0, &points, E);
    float* const none[3] = {t.b, &rest[4 * n], &rest[5 * n]};
    w.irradiance(&w, w.light_count, &points, none);
  }

 private:
  bool told_ = false;
};

/// Every pixel becomes the mean of the frame.
struct Blur : brume::Stage {
  static constexpr brume::StageAbout about{"blur", "The mean of the frame everywhere.",
                                           BRUME_LENS};
  template <class V>
  void describe(V&) {}
  void needs(const brume_frame&, brume::StageNeeds& n) override { n.whole_frame = true; }
  void run(const brume_tile& t) const override {
    for (float* plane : {t.r, t.g, t.b}) {
      double sum = 0;
      for (int y = 0; y < t.height; ++y)
        for (int x = 0; x < t.width; ++x) sum += plane[y * t.row_stride + x];
      const float mean = float(sum / (double(t.width) * t.height));
      for (int y = 0; y < t.height; ++y)
        for (int x = 0; x < t.width; ++x) plane[y * t.row_stride + x] = mean;
    }
  }
};

}  // namespace

// The symbol is renamed as brume_plugin() does for every linked-in plugin.
#define brume_plugin brume_plugin_toys
BRUME_STAGES(Paint, Steepness, Asks, Blur)
#undef brume_plugin

namespace {
const brume::LinkedPlugin kToys{"toys", brume_plugin_toys};
}
