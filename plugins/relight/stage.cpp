// Light of the World's lamps, sun and sky on the surfaces of the frame (README.md).
//
//   C' = C + a rho/pi Sum_k E_k(x, n)        (Lambert)
//
// a coverage, rho albedo, E_k irradiance of light k at the point x with normal n, which
// is src/air's: it knows what lies between. Here: where and how surfaces lie, and which
// lights reach them.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "layers.h"
#include "run.h"
#include "stage/stage.h"
#include "truth.h"

namespace {

using namespace relight;
using brume::Rgb;

constexpr double kPi = std::numbers::pi;
// Of the frame's tolerance, for lamps that are too far away to matter, all together.
constexpr double kShare = 0.1;
// What a normal from floats is off by [rad], times the angle of a pixel, for light twice
// as bright as white; at most half of the tolerance, as what hangs on the last bits by
// more is nobody's to promise (truth::Pixel::undecided).
constexpr double kNormals = 4e-7;
// Of white surfaces under skies up to 8 times as bright as white: 5.5e-5 was measured.
constexpr double kSky = 1e-4;

float clamped(float x, float most) { return x > 0 ? std::min(x, most) : 0.f; }  // NaN: 0

struct Relight : brume::Stage {
  static constexpr brume::StageAbout about{
      "relight",     "Light of lamps, sun and sky on the surfaces of the frame.",
      BRUME_SURFACE, BRUME_LIGHT_STEP,
      nullptr,       true};

  bool lamps = true, sun = false, sky = false;
  brume::RgbOr albedo{{.5, .5, .5}, {}};
  std::string albedo_layer = "auto", normals = "auto", normal_space = "world";

  template <class V>
  void describe(V& v) {
    v("lamps", lamps, {.doc = "Point lights and spotlights shine on surfaces."});
    v("sun", sun,
      {.doc = "Suns do. A rendered frame has the sun's light already, as a rule."});
    v("sky", sky,
      {.doc = "The sky does, over the hemisphere about each normal. Likewise."});
    v("albedo", albedo,
      {.doc = "Part of the light that surfaces reflect, where the frame has no layer of "
              "it; \"color\": the frame's own colour, up to 1.",
       .minimum = 0,
       .maximum = 1,
       .words = {"color"}});
    v("albedo_layer", albedo_layer,
      {.doc = "Layer of the albedo, premultiplied as the colour is (R, G, B); \"auto\" "
              "finds albedo, diffuse_albedo, DiffCol, ..., \"none\" takes `albedo`.",
       .animatable = false});
    v("normals", normals,
      {.doc = "Layer of the normals (X, Y, Z); \"auto\" finds N, normal, Normal, ..., "
              "\"none\" works them out from depth, as does auto where there is none.",
       .animatable = false});
    v("normal_space", normal_space,
      {.doc = "Axes of that layer: the world's, or the camera's (x right, y up, z toward "
              "the viewer).",
       .words = {"world", "camera"},
       .animatable = false});
  }

  void needs(const brume_frame& frame, brume::StageNeeds& n) override {
    // A host older than a field says nothing of it.
    const bool told = frame.size > offsetof(brume_frame, channel_count);
    const std::span channels(frame.channels, told ? frame.channel_count : 0);
    const auto albedo_names =
        find_layer(channels, albedo_layer,
                   {"albedo", "Albedo", "diffuse_albedo", "diffuse_color", "diffcol",
                    "DiffCol", "Denoising Albedo", "VRayDiffuseFilter", "DiffuseFilter"},
                   {"RGB", "rgb", "XYZ"});
    const auto normal_names =
        find_layer(channels, normals,
                   {"N", "normal", "Normal", "normals", "Normals", "world_normal",
                    "WorldNormal", "__Nworld", "Nn"},
                   {"XYZ", "xyz", "RGB", "rgb"});
    has_albedo_ = albedo_names.has_value();
    has_normals_ = normal_names.has_value();
    if (!has_albedo_ && albedo.word.empty() && albedo.rgb == Rgb{})
      n.idle = "albedo is 0";
    if (!(lamps || sun || sky)) n.idle = "lamps, sun and sky are off";
    n.camera = true;
    n.depth = true;
    if (lamps) n.lights |= BRUME_LIGHT_BIT(BRUME_POINT) | BRUME_LIGHT_BIT(BRUME_SPOT);
    if (sun) n.lights |= BRUME_LIGHT_BIT(BRUME_SUN);
    if (sky) n.lights |= BRUME_LIGHT_BIT(BRUME_SKY_LIGHT);
    if (!has_normals_) n.rows_around = n.columns_around = 2;
    n.promise = promise(frame);
    for (const auto& names : {albedo_names, normal_names})  // in this order in run
      if (names) n.channels.insert(n.channels.end(), names->begin(), names->end());
  }

  void publish(const brume_frame& frame, brume::Publisher&) override {
    for (int k = 0; k < 3; ++k) {
      eye_[k] = frame.eye[k];
      forward_[k] = float(frame.forward[k]);
    }
    // Lighter than this no lamp is left out alone; all of them share it (run).
    cutoff_ = kShare * frame.tolerance * frame.white;
    footprint_ = float(frame.pixel_footprint);
    const double* const axes[] = {frame.camera_right, frame.camera_up, frame.forward};
    for (int to = 0; to < 3; ++to)
      for (int from = 0; from < 3; ++from)
        turn_[3 * to + from] = normal_space == "camera"
                                   ? float(from == 2 ? -axes[2][to] : axes[from][to])
                                   : float(to == from);
  }

  void run(const brume_tile& tile) const override {
    if (!tile.world || tile.world->size <= offsetof(brume_world, light))
      throw std::runtime_error("this host does not say what lights there are");
    const brume_world& world = *tile.world;
    thread_local Chosen chosen;
    choose(world, chosen);
    for (int y = 0; y < tile.height; ++y)
      for (int x = 0; x < tile.width; x += kRun)
        light(tile, world, chosen, y * tile.row_stride + x,
              std::min(kRun, tile.width - x));
  }

  void truth(const brume_tile& tile, std::span<const int> xy,
             double* rgb) const override {
    Settings s{has_albedo_,
               has_normals_,
               !albedo.word.empty(),
               {albedo.rgb.r, albedo.rgb.g, albedo.rgb.b},
               lamps,
               sun,
               sky};
    std::copy_n(eye_, 3, s.eye);
    std::copy_n(forward_, 3, s.forward);
    std::copy_n(turn_, 9, s.turn);
    s.footprint = footprint_;
    relight::truth(s, tile, xy, rgb);
  }

 private:
  // README, "Error": what is left out, normals from float depth, the sky's hemisphere.
  double promise(const brume_frame& frame) const {
    double sum = kShare * frame.tolerance;
    if (!has_normals_)
      sum += std::min(frame.orthographic ? 1. : kNormals / frame.pixel_footprint,
                      frame.tolerance / 2);
    if (sky) {
      const bool any = has_albedo_ || !albedo.word.empty();
      sum += kSky * (any ? 1 : std::max({albedo.rgb.r, albedo.rgb.g, albedo.rgb.b}));
    }
    return sum;
  }

  struct Chosen {
    struct One {
      std::size_t k;
      brume_light_kind kind;
      Reach reach;
      float nearest2;  // nearer than this it grows no more [m^2]
    };
    std::vector<One> lights;
  };

  // Everything between the planes of a run.
  struct Work {
    Surface surface;
    alignas(64) float E[3][kRun];
    alignas(64) float o[3][kRun], n[3][kRun], part[3][kRun];
    int at[kRun];
  };

  bool answers_to(brume_light_kind kind) const {
    return kind == BRUME_SUN ? sun : kind == BRUME_SKY_LIGHT ? sky : lamps;
  }

  void choose(const brume_world& world, Chosen& out) const {
    out.lights.clear();
    int count = 0;
    for (std::size_t k = 0; k < world.light_count; ++k) {
      const brume_light& l = *world.light(&world, k);
      if (!answers_to(l.kind)) continue;
      Chosen::One one{k, l.kind, {}, float(l.radius * l.radius)};
      Reach& r = one.reach;
      r.lamp = l.kind == BRUME_POINT || l.kind == BRUME_SPOT;
      count += r.lamp;
      for (int i = 0; i < 3; ++i) {
        r.position[i] = float(l.position[i] - eye_[i]);
        r.direction[i] = float(l.direction[i]);
      }
      // Less than the cosine by more than what rounding may do to it.
      if (l.kind == BRUME_SPOT) {
        r.cosine = float(std::cos(l.cone)) - 1e-5f;
        r.cone = float(l.cone) + 1e-5f;
      }
      out.lights.push_back(one);
    }
    // rho/pi E <= power/(pi r^2): below its share of the cutoff from this distance on.
    for (Chosen::One& one : out.lights) {
      const brume_light& l = *world.light(&world, one.k);
      const double most = std::max({l.power[0], l.power[1], l.power[2]});
      one.reach.radius2 =
          float(std::min(most / kPi * count / std::max(cutoff_, 1e-30), 1e30));
    }
  }

  void light(const brume_tile& tile, const brume_world& world, const Chosen& chosen,
             std::ptrdiff_t at, int n) const {
    static const Kernels& k = BRUME_ISA_SELECT(kernels);
    thread_local Work w;
    const auto plane = [at](const float* p) { return p ? p + at : nullptr; };
    const bool origins = tile.size > offsetof(brume_tile, oz);
    Seen seen = {n,
                 tile.row_stride,
                 plane(tile.distance),
                 plane(tile.dx),
                 plane(tile.dy),
                 plane(tile.dz),
                 plane(origins ? tile.ox : nullptr),
                 plane(origins ? tile.oy : nullptr),
                 plane(origins ? tile.oz : nullptr)};
    std::copy_n(forward_, 3, seen.forward);
    seen.footprint = footprint_;
    if (!k.points(seen, tile.a + at, w.surface)) return;
    const float* const* channel = tile.channels;
    const float* const* rho = has_albedo_ ? channel : nullptr;
    const float* const* normal = channel + (has_albedo_ ? 3 : 0);
    if (has_normals_)
      k.from_channels(seen, normal[0] + at, normal[1] + at, normal[2] + at, turn_,
                      w.surface);
    else
      k.normals(seen, w.surface);

    for (auto& plane_of_E : w.E) std::fill_n(plane_of_E, n, 0.f);
    bool any = false;
    for (const Chosen::One& one : chosen.lights)
      any = add(world, one, seen, k, n, w) || any;
    if (!any) return;

    float* const C[3] = {tile.r + at, tile.g + at, tile.b + at};
    const double own[3] = {albedo.rgb.r, albedo.rgb.g, albedo.rgb.b};
    for (int c = 0; c < 3; ++c)
      for (int i = 0; i < n; ++i) {
        if (!(w.E[c][i] > 0)) continue;
        const float a = clamped(tile.a[at + i], 1.f);
        const float reflected = rho                    ? clamped(rho[c][at + i], a)
                                : !albedo.word.empty() ? clamped(C[c][i], a)
                                                       : a * float(own[c]);
        C[c][i] += reflected * float(1 / kPi) * w.E[c][i];
      }
  }

  // False only where a lamp reaches nothing between lo and hi: too far, or past its cone.
  static bool may_reach(const Reach& l, const Surface& s) {
    double away2 = 0, radius2 = 0, v[3];
    for (int c = 0; c < 3; ++c) {
      const double p = double(l.position[c]), lo = double(s.lo[c]), hi = double(s.hi[c]);
      const double outside = std::max({lo - p, p - hi, 0.});
      away2 += outside * outside;
      radius2 += (hi - lo) * (hi - lo) / 4;
      v[c] = (lo + hi) / 2 - p;
    }
    if (away2 * (1 - 1e-5) > double(l.radius2)) return false;
    const double middle2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    if (l.cosine == -2 || middle2 <= radius2) return true;
    const double mu = (v[0] * double(l.direction[0]) + v[1] * double(l.direction[1]) +
                       v[2] * double(l.direction[2])) /
                      std::sqrt(middle2);
    return std::acos(std::clamp(mu, -1., 1.)) <
           double(l.cone) + std::asin(std::sqrt(radius2 / middle2)) + 1e-5;
  }

  // What light `one` adds to E where it reaches anything.
  bool add(const brume_world& world, const Chosen::One& one, const Seen& seen,
           const Kernels& k, int n, Work& w) const {
    int count = 0;
    if (one.kind == BRUME_SKY_LIGHT) {
      for (int i = 0; i < n; ++i)
        if (w.surface.w[i] > 0) w.at[count++] = i;
    } else {
      if (one.kind == BRUME_SUN) {
        Reach sun_reach = one.reach;
        sun_reach.lamp = false;
        count = k.lit(sun_reach, w.surface, n, w.at);
      } else if (may_reach(one.reach, w.surface)) {
        count = k.lit(one.reach, w.surface, n, w.at);
      }
    }
    if (count == 0) return false;
    for (int j = 0; j < count; ++j)
      for (int c = 0; c < 3; ++c) {
        w.o[c][j] = w.surface.x[c][w.at[j]];
        w.n[c][j] = w.surface.n[c][w.at[j]];
      }
    const brume_rays rays = {
        std::size_t(count), w.o[0], w.o[1], w.o[2], w.n[0], w.n[1], w.n[2]};
    float* const part[3] = {w.part[0], w.part[1], w.part[2]};
    world.irradiance(&world, one.k, &rays, part);
    for (int j = 0; j < count; ++j) {
      const int i = w.at[j];
      const float less = one.reach.lamp ? within_pixel(one, seen, w, i) : 1.f;
      for (int c = 0; c < 3; ++c) w.E[c][i] += less * w.part[c][j];
    }
    return true;
  }

  // A lamp nearer to the surface than half a pixel shines as if it were as far: its
  // light is the pixel's mean, not that of the point.
  float within_pixel(const Chosen::One& one, const Seen& seen, const Work& w,
                     int i) const {
    const float half = 0.5f * footprint_ * (seen.ox ? 1.f : 1.f / w.surface.w[i]);
    float r2 = 0;
    for (int c = 0; c < 3; ++c) {
      const float v = one.reach.position[c] - w.surface.x[c][i];
      r2 += v * v;
    }
    const float lit_as = std::max(std::max(r2, one.nearest2), 1e-30f);
    return lit_as < half * half ? lit_as / (half * half) : 1.f;
  }

  bool has_albedo_ = false, has_normals_ = false;
  double eye_[3] = {}, cutoff_ = 0;
  float footprint_ = 0, forward_[3] = {}, turn_[9] = {};
};

}  // namespace

BRUME_STAGES(Relight)
