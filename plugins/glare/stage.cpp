// Glare: every bright pixel becomes the pattern that the eye, or a lens, makes of a point
// (README.md).
//
//   out = I + e (K * B - B),   B the part of I above the threshold, sum K = 1
//
// Without a threshold that is (1 - e) I + e K * I.

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "baseline.h"
#include "convolve.h"
#include "oracle.h"
#include "stage/stage.h"

namespace {

using namespace brume::glare;

constexpr double kRadians = std::numbers::pi / 180;
// Below this part of the frame's tolerance nobody looks: other stages use it too.
constexpr double kShare = 0.1;

struct Glare : brume::Stage {
  static constexpr brume::StageAbout about{
      "glare",
      "Glare of the eye or of a lens around whatever is bright.",
      BRUME_LENS,
      BRUME_BACKGROUND_STEP,
      "Kallinen 2013, whole transforms in float",
      true};

  std::string pattern = "photopic";
  double strength = 0.2;
  double threshold = 0;
  double knee = 0.5;
  brume::Rgb tint{1, 1, 1};
  double reach = 20;
  double pixel_angle = 0;
  double rotation = 0;
  double aperture = 2;
  int blades = 6;
  double roundness = 0.2;
  int dust = 0;
  int scratches = 0;
  int seed = 1;
  std::string image;
  double image_width = 10;

  template <class V>
  void describe(V& v) {
    v("pattern", pattern,
      {.doc = "What a point becomes: the eye by day, dusk or night (Spencer 1995), a "
              "lens' aperture, or an image.",
       .words = {"photopic", "mesopic", "scotopic", "aperture", "image"}});
    v("strength", strength,
      {.doc = "Part of the light that goes into the pattern.",
       .minimum = 0,
       .maximum = 1});
    v("threshold", threshold,
      {.doc = "Brightness (the largest of R, G, B) from which a pixel glares; 0: all do.",
       .minimum = 0,
       .maximum = 1e9});
    v("knee", knee,
      {.doc = "Part of the threshold, below and above it, over which glare sets in.",
       .minimum = 0,
       .maximum = 1});
    v("tint", tint,
      {.doc = "Strength per channel, times `strength`.", .minimum = 0, .maximum = 1});
    v("reach", reach,
      {.unit = "degrees",
       .doc = "Where the eye's glare ends.",
       .minimum = 0.01,
       .maximum = 90});
    v("pixel_angle", pixel_angle,
      {.unit = "degrees",
       .doc = "Angle of a pixel; 0: from the camera.",
       .minimum = 0,
       .maximum = 10});
    v("rotation", rotation,
      {.unit = "degrees",
       .doc = "Turns aperture or image clockwise.",
       .minimum = -1e6,
       .maximum = 1e6});
    v("aperture", aperture,
      {.unit = "mm",
       .doc = "Diameter of the aperture: focal length by f-number; smaller makes larger "
              "stars.",
       .minimum = 0.01,
       .maximum = 1e3});
    v("blades", blades,
      {.doc = "Blades of the aperture; 0 to 2: a round one.",
       .minimum = 0,
       .maximum = 64});
    v("roundness", roundness,
      {.doc = "How round the blades are: 0 straight, 1 a circle.",
       .minimum = 0,
       .maximum = 1});
    v("dust", dust,
      {.doc = "Grains on the lens, thrown by `seed`.", .minimum = 0, .maximum = 500});
    v("scratches", scratches,
      {.doc = "Scratches on the lens, thrown by `seed`.", .minimum = 0, .maximum = 500});
    v("seed", seed, {.doc = "Which dust and scratches.", .minimum = 0, .maximum = 1e9});
    v("image", image,
      {.doc = "EXR with the pattern (pattern = \"image\"); its middle is the light.",
       .animatable = false});
    v("image_width", image_width,
      {.unit = "degrees",
       .doc = "Angle that the image spans.",
       .minimum = 1e-3,
       .maximum = 180});
  }

  void prepare(const brume::Shared& shared) override {
    cache_ = &shared.table<Cache>("glare", [] { return std::make_unique<Cache>(); });
    if (pattern == "image" && image.empty() && strength > 0)
      throw std::runtime_error("pattern = \"image\" needs image, the path of an EXR");
  }

  void needs(const brume_frame& frame, brume::StageNeeds& n) override {
    if (strength == 0)
      n.idle = "strength is 0";
    else if (tint == brume::Rgb{})
      n.idle = "tint is 0";
    n.whole_frame = true;
    n.camera = pixel_angle == 0;
    n.laws = BRUME_KEEPS_LIGHT | (threshold == 0 ? BRUME_LINEAR : 0);
    unseen_ = kShare * frame.tolerance * frame.white;
    pixel_ = pixel_angle > 0 ? pixel_angle * kRadians : frame.pixel_footprint;
    std::copy_n(frame.chromaticities, 8, chromaticities_.begin());
  }

  void run(const brume_tile& t) const override {
    require_angle();
    const std::vector<float> weight = weights(t);
    const auto strength_of = strengths();
    double most = 0;
    for (int c = 0; c < 3; ++c)
      most = std::max(
          most, strength_of[std::size_t(c)] * brightest(bright_of(t, c, weight), t));
    if (most <= unseen_) return;

    const std::shared_ptr<const Prepared> p = prepared(t);
    float* const out[3] = {t.r, t.g, t.b};
    std::vector<Complex> room;
    for (int c = 0; c < 3; ++c) {
      const double e = strength_of[std::size_t(c)], lost = p->kernel.lost[std::size_t(c)];
      if (e == 0 || most * lost <= unseen_) continue;
      const Bright bright = bright_of(t, c, weight);
      convolve(*p, c, bright, room, [&](std::size_t y, const double* spread) {
        float* row = out[c] + std::ptrdiff_t(y) * t.row_stride;
        for (std::size_t x = 0; x < std::size_t(t.width); ++x) {
          if (!std::isfinite(row[x])) continue;
          const double glare =
              e * (spread[x] - lost * bright.value(x, y, std::size_t(t.width)));
          row[x] =
              float(std::min<double>(row[x] + glare, std::numeric_limits<float>::max()));
        }
      });
    }
  }

  void run_baseline(const brume_tile& t) const override {
    const std::vector<float> weight = weights(t);
    const std::shared_ptr<const Prepared> p = prepared(t);
    float* const out[3] = {t.r, t.g, t.b};
    for (int c = 0; c < 3; ++c) {
      const Bright bright = bright_of(t, c, weight);
      const auto spread = brume::glare::baseline(p->kernel, c, bright, t.width, t.height);
      const float e = float(strengths()[std::size_t(c)]);
      for (std::size_t y = 0, i = 0; y < std::size_t(t.height); ++y)
        for (std::size_t x = 0; x < std::size_t(t.width); ++x, ++i)
          out[c][std::ptrdiff_t(y) * t.row_stride + std::ptrdiff_t(x)] +=
              e * (spread[i] - float(bright.value(x, y, std::size_t(t.width))));
    }
  }

  // Every pixel by every other one (oracle.h).
  void truth(const brume_tile& t, std::span<const int> xy, double* rgb) const override {
    const std::vector<float> weight = weights(t);
    const std::shared_ptr<const Prepared> p = prepared(t);
    for (int c = 0; c < 3; ++c) {
      const Bright bright = bright_of(t, c, weight);
      const auto value = [&](int x, int y) {
        return bright.value(std::size_t(x), std::size_t(y), std::size_t(t.width));
      };
      std::vector<Lit> lit;
      for (int y = 0; y < t.height; ++y)
        for (int x = 0; x < t.width; ++x)
          if (const double v = value(x, y); v > 0) lit.push_back({x, y, v});
      for (std::size_t k = 0; k < xy.size(); k += 2) {
        const int x = xy[k], y = xy[k + 1];
        double& to = rgb[3 * (k / 2) + std::size_t(c)];
        to = bright.plane[y * t.row_stride + x];
        if (std::isfinite(to))
          to += strengths()[std::size_t(c)] *
                double(spread_at(lit, p->kernel, c, x, y) - value(x, y));
      }
    }
  }

 private:
  std::array<double, 3> strengths() const {
    return {strength * tint.r, strength * tint.g, strength * tint.b};
  }

  static Bright bright_of(const brume_tile& t, int channel,
                          const std::vector<float>& weight) {
    const float* const planes[3] = {t.r, t.g, t.b};
    return {planes[channel], weight.empty() ? nullptr : weight.data(), t.row_stride};
  }

  // Part of each pixel above the threshold: 0 below (1 - knee) threshold, a parabola up
  // to (1 + knee) threshold, brightness - threshold beyond; as part of the brightness.
  std::vector<float> weights(const brume_tile& t) const {
    if (threshold == 0) return {};
    std::vector<float> w(std::size_t(t.width) * std::size_t(t.height));
    tbb::parallel_for(0, t.height, [&](int y) {
      for (int x = 0; x < t.width; ++x) {
        const std::ptrdiff_t i = y * t.row_stride + x;
        double m = 0;
        for (const float v : {t.r[i], t.g[i], t.b[i]})
          if (std::isfinite(v)) m = std::max<double>(m, v);
        const double k = knee * threshold, over = m - threshold;
        const double part = over >= k    ? over
                            : over <= -k ? 0
                                         : (over + k) * (over + k) / (4 * k);
        w[std::size_t(y) * std::size_t(t.width) + std::size_t(x)] =
            m > 0 ? float(part / m) : 0;
      }
    });
    return w;
  }

  static double brightest(const Bright& b, const brume_tile& t) {
    double most = 0;
    for (int y = 0; y < t.height; ++y)
      for (int x = 0; x < t.width; ++x)
        most =
            std::max(most, b.value(std::size_t(x), std::size_t(y), std::size_t(t.width)));
    return most;
  }

  void require_angle() const {
    if (!(pixel_ > 0) || !std::isfinite(pixel_))
      throw std::runtime_error("a pixel has no angle here: give pixel_angle");
  }

  std::shared_ptr<const Prepared> prepared(const brume_tile& t) const {
    require_angle();
    PatternSettings s;
    s.kind = pattern;
    s.pixel = pixel_;
    s.reach = reach * kRadians;
    s.rotation = rotation * kRadians;
    s.aperture = aperture * 1e-3;
    s.blades = blades;
    s.roundness = roundness;
    s.dust = dust;
    s.scratches = scratches;
    s.seed = seed;
    s.image = image;
    s.image_width = image_width * kRadians;
    s.chromaticities = chromaticities_;
    const std::string key =
        std::to_string(t.width) + " " + std::to_string(t.height) + " " + s.key();
    return cache_->get(key, [&] {
      std::shared_ptr<const Prepared> p;
      tbb::this_task_arena::isolate([&] {
        p = brume::glare::prepare(make_kernel(s, t.width, t.height), t.width, t.height,
                                  kCacheBytes);
      });
      return p;
    });
  }

  const Cache* cache_ = nullptr;
  double unseen_ = 0, pixel_ = 0;
  std::array<double, 8> chromaticities_{};
};

}  // namespace

BRUME_STAGES(Glare)
