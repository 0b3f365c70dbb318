// Fog with the texture of drifting vapour (SOURCES I2). Formulas and limits: README.md.
//
//   sigma(x) = density e^(-falloff (z - height)) e^(noise(x)) [1/m], mean e^noise = 1
//
// The stage says what there is and integrates it along rays (steps.h); light is the
// integrator's.

#include "stage/fog.h"

#include <atomic>

#include "baseline.h"
#include "curve.h"
#include "oracle.h"
#include "place.h"
#include "run.h"

namespace {

namespace noise_fog = brume::noise_fog;
using brume::Vec3;

struct NoiseFog : brume::LayeredFog {
  static constexpr brume::StageAbout about{
      "noise_fog", "Fog with the texture of drifting vapour, from Perlin noise.",
      BRUME_AIR, BRUME_BACKGROUND_STEP, "Intel 2008: the noise once, at the surface"};

  NoiseFog() : LayeredFog(0.004) {}

  double size = 100;
  int octaves = 4;
  double gain = 0.5;
  double contrast = 0.8;
  int seed = 0;
  int period = 0;
  Vec3 wind{0, 0, 0};
  Vec3 offset{0, 0, 0};
  int smoothing = 0;
  double clearing = 0;
  double error = 1.5e-4;

  template <class V>
  void describe(V& v) {
    describe_layers(v, "Mean extinction at `height`, one number or one per colour.");
    v("size", size,
      {.unit = "m",
       .doc = "Of the largest banks: the cell of the coarsest octave of noise.",
       .minimum = 1e-3,
       .maximum = 1e6});
    v("octaves", octaves,
      {.doc = "How many octaves of noise, each of half the size of the one before.",
       .minimum = 1,
       .maximum = noise_fog::kMostOctaves});
    v("gain", gain,
      {.doc = "Strength of each octave over the one before.",
       .minimum = 0,
       .maximum = 1});
    v("contrast", contrast,
      {.doc =
           "Standard deviation of the logarithm of the density: 0 is smooth fog, 1 has "
           "wisps e times denser and gaps e times thinner than usual.",
       .minimum = 0,
       .maximum = 2});
    v("seed", seed,
      {.doc = "Another number, another fog.", .minimum = 0, .maximum = 1e6});
    v("period", period,
      {.doc = "The pattern repeats after so many of its largest cells along each axis, "
              "without a seam; 0: it does not repeat.",
       .minimum = 0,
       .maximum = 2048});
    v("wind", wind,
      {.unit = "m/s",
       .doc = "How the fog moves through the world.",
       .minimum = -1e4,
       .maximum = 1e4,
       .animatable = false});
    v("offset", offset,
      {.unit = "m",
       .doc = "Where it has been moved to, beside the wind.",
       .minimum = -1e9,
       .maximum = 1e9});
    v("smoothing", smoothing,
      {.doc = "Row of Pascal's triangle whose weights blur the noise along each axis, at "
              "half the finest cell apart; 0: none.",
       .minimum = 0,
       .maximum = 1024});
    v("clearing", clearing,
      {.unit = "m",
       .doc = "The fog clears about the camera's height, with the square of the distance "
              "from it up to about so many metres, at least a millimetre; 0: it does "
              "not.",
       .minimum = 0,
       .maximum = 1e6});
    describe_look(v);
    v("error", error,
      {.doc =
           "Standard deviation of the picture that its steps along a ray are made for, "
           "of white + |C|.",
       .minimum = 1e-7,
       .maximum = 1,
       .knob = true,
       .curve = {noise_fog::kCurve, noise_fog::kCurve + std::size(noise_fog::kCurve)}});
  }

  void needs(const brume_frame&, brume::StageNeeds& n) override { ask(n, density); }

  void publish(const brume_frame& frame, brume::Publisher& world) override {
    static std::atomic<std::uint64_t> made{0};
    const noise_fog::Look look = look_at(frame);
    fog_ = noise_fog::fog_of(look, ++made);
    truth_ = std::make_unique<noise_fog::Oracle>(look);
    brume_medium m = layers_of(frame);
    m.profile = BRUME_CUSTOM;
    m.self = this;
    m.integral = [](const void* self, const brume_rays* rays, const float* t0,
                    const float* t1, float* D) {
      static thread_local const auto tracks = noise_fog::new_tracks();
      kernels().integral(of(self).fog_, *tracks, *rays, t0, t1, D);
    };
    m.density = [](const void* self, const brume_rays* rays, const float* t, float* rho) {
      kernels().density(of(self).fog_, *rays, t, rho);
    };
    m.point = [](const void* self, const double x[3], const double*, double* rho,
                 double source[3]) {
      *rho = of(self).truth_->density({x[0], x[1], x[2]});
      source[0] = source[1] = source[2] = 0;
    };
    world.medium(m);
    std::copy_n(frame.eye, 3, eye_.begin());
  }

  void baseline(const brume_rays& rays, const float* t1, float* const L[3],
                float* const T[3]) const override {
    check_plain("document");
    // Pixels without depth lie where a renderer's far plane would be.
    constexpr float kFarPlane = 1e5f;
    const double sigma[3] = {density.r, density.g, density.b};
    const double S[3] = {color.rgb.r, color.rgb.g, color.rgb.b};
    for (std::size_t i = 0; i < rays.n; ++i) {
      const double t = std::min(t1[i], kFarPlane);
      const double n = truth_->unfiltered(
          {eye_[0] + t * rays.dx[i], eye_[1] + t * rays.dy[i], eye_[2] + t * rays.dz[i]});
      for (int c = 0; c < 3; ++c) {
        T[c][i] = float(noise_fog::baseline::transmittance(sigma[c], t, n));
        L[c][i] = float(S[c] * (1 - double(T[c][i])));
      }
    }
  }

 private:
  noise_fog::Look look_at(const brume_frame& frame) const {
    noise_fog::Look s;
    s.size = size;
    s.octaves = octaves;
    s.gain = gain;
    s.contrast = contrast;
    s.seed = seed;
    s.period = period;
    s.height = height;
    s.falloff = falloff;
    s.clearing = clearing > 0 ? std::max(clearing, kLeastClearing) : 0;
    s.smoothing = smoothing;
    s.start = start;
    s.pixel = brume::Footprint(frame).mean();
    for (std::size_t i = 0; i < 3; ++i) {
      s.shift[i] = offset[i] + wind[i] * frame.time;
      s.up[i] = frame.up[i];
      s.eye[i] = frame.eye[i];
    }
    set(s.sigma, density);
    // An error of T weighs as much as the light that it lets through or adds.
    const double white = frame.white;
    const double bright = std::max({color.rgb.r, color.rgb.g, color.rgb.b, white});
    s.tolerance = error * std::max(white / bright, 1 / kBrightest);
    return s;
  }

  static constexpr double kLeastClearing = 1e-3;  // a place far away is known to 1e-9 m
  static constexpr double kBrightest = 16;  // whites: brighter colours count as that

  static const NoiseFog& of(const void* self) {
    return *static_cast<const NoiseFog*>(self);
  }
  static const noise_fog::Kernels& kernels() {
    using namespace noise_fog;
    static const Kernels& k = BRUME_ISA_SELECT(kernels);
    return k;
  }
  std::array<double, 3> eye_{};
  noise_fog::Fog fog_;
  std::unique_ptr<noise_fog::Oracle> truth_;
};

}  // namespace

BRUME_STAGES(NoiseFog)
