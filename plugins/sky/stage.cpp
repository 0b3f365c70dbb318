// The clear sky as a stage: what the user sets, and what it publishes.
//
//   medium       the air itself; its radiance over [0, inf) is the sky, over [0, d]
//   aerial perspective lights       the sun as it shines at the eye, the sky's radiance
//   by direction background   the sun's disc, which lies beyond the air

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "curve.h"
#include "frame_sky.h"
#include "model.h"
#include "num/error.h"
#include "stage/stage.h"

namespace {

using namespace brume::sky;

struct SkyStage : brume::Stage {
  static constexpr brume::StageAbout about{
      "sky", "Clear sky and aerial perspective of a planet's atmosphere.", BRUME_AIR,
      BRUME_BACKGROUND_STEP, "Nishita et al. 1993, single scattering in 32 steps"};

  std::string model = "scattering", preset_name = "earth", conversion = "cie";
  int harmonics = 10;
  std::vector<double> wavelengths;
  double exposure = 1, sea_level = 0;
  double planet_radius = 6360e3, atmosphere_height = 60e3;
  std::vector<double> rayleigh_scattering, mie_scattering, mie_extinction,
      ozone_absorption, ground_albedo, solar_irradiance;
  double rayleigh_scale_height = 8000, mie_scale_height = 1200, mie_g = .8, turbidity = 0;
  bool sun_disc = true;
  double sun_diameter = .533;
  double detail = 1;
  static constexpr double kFinestTables = 1.5;  // 60 MB; they grow with the cube

  template <class V>
  void describe(V& v) {
    v("model", model,
      {.doc = "How light is computed: scattering (all orders), fast (the same, coarser), "
              "nishita93 (what is scattered once, as that paper has it).",
       .words = {"scattering", "fast", "nishita93"},
       .animatable = false});
    v("harmonics", harmonics,
      {.doc =
           "Angular detail of light scattered twice or more: 2, 4, 6 or 10. Error of the "
           "model, not of numbers: `tolerance` leaves it alone.",
       .minimum = 2,
       .maximum = 10,
       .animatable = false});
    v("preset", preset_name,
      {.doc = "The planet; parameters below that are left at their defaults are its own.",
       .words = {"earth", "hazy", "mars"},
       .animatable = false});
    v("wavelengths", wavelengths,
      {.unit = "nm",
       .doc = "Where light is computed; lists below have one number for each. Empty: "
              "chosen for colour; 680, 550, 440 with "
              "conversion none or lists of three.",
       .minimum = 200,
       .maximum = 4000,
       .animatable = false});
    v("conversion", conversion,
      {.doc = "To colours by the eye's matching functions (cie), or the first three "
              "wavelengths as they are (none).",
       .words = {"cie", "none"},
       .animatable = false});
    v("exposure", exposure,
      {.doc = "Factor on all light; at 1 a colour is in W m^-2 sr^-1 weighted by the "
              "matching functions.",
       .minimum = 0,
       .maximum = 1e9});
    v("sea_level", sea_level,
      {.unit = "m",
       .doc = "World height of the planet's surface.",
       .minimum = -1e7,
       .maximum = 1e7});
    v("planet_radius", planet_radius,
      {.unit = "m",
       .doc = "Of the ground.",
       .minimum = 1e4,
       .maximum = 1e9,
       .animatable = false});
    v("atmosphere_height", atmosphere_height,
      {.unit = "m",
       .doc = "Top of the air above the ground.",
       .minimum = 1,
       .maximum = 1e8,
       .animatable = false});
    const auto list = [&](const char* name, std::vector<double>& member, const char* unit,
                          const char* doc, double most) {
      v(name, member,
        {.unit = unit, .doc = doc, .minimum = 0, .maximum = most, .animatable = false});
    };
    list("rayleigh_scattering", rayleigh_scattering, "1/m",
         "Of the gas at the ground; empty: the preset's.", 1e3);
    v("rayleigh_scale_height", rayleigh_scale_height,
      {.unit = "m",
       .doc = "Height over which the gas thins by e.",
       .minimum = 1,
       .maximum = 1e6,
       .animatable = false});
    list("mie_scattering", mie_scattering, "1/m",
         "Of aerosol at the ground; empty: the preset's.", 1e3);
    list("mie_extinction", mie_extinction, "1/m",
         "Scattering and absorption of aerosol at the ground; empty: the preset's.", 1e3);
    v("turbidity", turbidity,
      {.doc = "Optical depth of air and aerosol over that of air at 550 nm, which scales "
              "the aerosol; 0: the preset's own.",
       .minimum = 0,
       .maximum = 60,
       .animatable = false});
    v("mie_scale_height", mie_scale_height,
      {.unit = "m",
       .doc = "Height over which aerosol thins by e.",
       .minimum = 1,
       .maximum = 1e6,
       .animatable = false});
    v("mie_g", mie_g,
      {.doc = "Asymmetry of the Cornette-Shanks phase function of aerosol.",
       .minimum = -.95,
       .maximum = .95,
       .animatable = false});
    list("ozone_absorption", ozone_absorption, "1/m",
         "At its densest, 25 km; empty: the preset's.", 1e3);
    list("ground_albedo", ground_albedo, "",
         "Of the ground whose light the air scatters; empty: the preset's.", 1);
    list("solar_irradiance", solar_irradiance, "W m^-2 nm^-1",
         "Above the air; empty: the preset's.", 1e12);
    v("sun_disc", sun_disc,
      {.doc = "The sun itself, with limb darkening, behind the air."});
    v("sun_diameter", sun_diameter,
      {.unit = "degrees",
       .doc = "Apparent, of the disc.",
       .minimum = .001,
       .maximum = 90});
    v("detail", detail,
      {.doc = "Nodes of a frame's tables along each axis and panels along a path, over "
              "their usual number; above 1.5 there are no tables, every ray is asked.",
       .minimum = .25,
       .maximum = 4,
       .knob = true,
       .animatable = false,
       .curve = {kCurve, kCurve + std::size(kCurve)}});
  }

  void needs(const brume_frame& frame, brume::StageNeeds& n) override {
    if (!frame.has_sun)
      throw brume::Error("sky", "the scene has no sun",
                         "give [sun] elevation and azimuth");
    n.depth = true;
    n.camera = true;
  }

  void prepare(const brume::Shared& shared) override {
    atmosphere_ = make_atmosphere();
    const Quality quality = make_quality();
    const std::string key = key_of(atmosphere_, quality);
    model_ = &shared.table<Model>(
        key, [&] { return std::make_unique<Model>(atmosphere_, quality); });
    maps_ = &shared.table<Maps>("sky maps of " + key,
                                [] { return std::make_unique<Maps>(); });
  }

  void publish(const brume_frame& frame, brume::Publisher& world) override {
    Placing at;
    std::copy_n(frame.eye, 3, at.eye.begin());
    std::copy_n(frame.up, 3, at.up.begin());
    std::copy_n(frame.to_sun, 3, at.to_sun.begin());
    at.sea_level = sea_level;
    // A few rays (probe, thumbnails) are asked one by one.
    const bool many = double(frame.display_width) * frame.display_height > 4096;
    placed_ = {at, look(frame, at), many && detail <= kFinestTables};
    sky_ = std::make_unique<FrameSky>(*model_, *maps_, at, placed_.look, placed_.tables,
                                      detail, float(frame.mix));
    world.medium(sky_->medium());
    for (const brume_light& l : sky_->lights()) world.light(l);
    if (sun_disc) world.background(sky_->background());
  }

  void baseline(const brume_rays& rays, const float* t1, float* const L[3],
                float* const T[3]) const override {
    std::call_once(nishita_.once, [&] {
      Quality q;
      q.method = Method::nishita93;
      nishita_.model = std::make_unique<Model>(atmosphere_, q);
      nishita_.sky = std::make_unique<FrameSky>(
          *nishita_.model, *maps_, placed_.at, placed_.look, placed_.tables, detail, 1.f);
    });
    const std::vector<float> t0(rays.n, 0.0f);
    const brume_medium m = nishita_.sky->medium();
    m.alone(m.self, &rays, nullptr, t0.data(), t1, L, T);
  }

 private:
  // Wavelengths as given; else what the lists or the conversion ask for; else enough for
  // colour.
  std::vector<double> chosen_wavelengths() const {
    if (!wavelengths.empty()) return wavelengths;
    bool three = conversion == "none";
    for (const auto* list : {&rayleigh_scattering, &mie_scattering, &mie_extinction,
                             &ozone_absorption, &ground_albedo, &solar_irradiance})
      three = three || list->size() == 3;
    if (three) return {680, 550, 440};
    return {385, 450, 515, 555, 590, 605, 640, 700};
  }

  Atmosphere make_atmosphere() const {
    const SkyStage defaults;
    Atmosphere a = preset(preset_name, chosen_wavelengths());
    const std::size_t n = a.wavelengths.size();
    const auto number = [](double& to, double given, double by_default) {
      if (given != by_default) to = given;
    };
    number(a.planet_radius, planet_radius, defaults.planet_radius);
    number(a.atmosphere_height, atmosphere_height, defaults.atmosphere_height);
    number(a.rayleigh_scale_height, rayleigh_scale_height,
           defaults.rayleigh_scale_height);
    number(a.mie_scale_height, mie_scale_height, defaults.mie_scale_height);
    number(a.mie_g, mie_g, defaults.mie_g);
    const auto list = [n](std::vector<double>& to, const std::vector<double>& given,
                          const char* name) {
      if (given.empty()) return;
      if (given.size() != 1 && given.size() != n)
        throw brume::Error(
            name, std::to_string(given.size()) + " numbers",
            "one, or one for each of " + std::to_string(n) + " wavelengths");
      to = given.size() == 1 ? std::vector<double>(n, given[0]) : given;
    };
    list(a.rayleigh_scattering, rayleigh_scattering, "rayleigh_scattering");
    list(a.mie_extinction, mie_extinction, "mie_extinction");
    list(a.mie_scattering, mie_scattering, "mie_scattering");
    list(a.ozone_absorption, ozone_absorption, "ozone_absorption");
    list(a.ground_albedo, ground_albedo, "ground_albedo");
    list(a.solar_irradiance, solar_irradiance, "solar_irradiance");
    if (turbidity > 0) {
      // (tau_R + tau_M)/tau_R at 550 nm, both vertical.
      const Atmosphere at = preset(preset_name, {550});
      const double tau_R = at.rayleigh_scattering[0] * a.rayleigh_scale_height,
                   tau_M = at.mie_extinction[0] * a.mie_scale_height;
      const double factor = std::max(turbidity - 1, 0.) * tau_R / tau_M;
      for (double& x : a.mie_extinction) x *= factor;
      for (double& x : a.mie_scattering) x *= factor;
    }
    check(a);
    return a;
  }

  Quality make_quality() const {
    Quality q = model == "fast" ? Quality::fast() : Quality{};
    if (model != "fast") q.harmonics = harmonics;
    if (model == "nishita93") q.method = Method::single;
    return q;
  }

  Look look(const brume_frame& frame, const Placing& at) const {
    std::array<double, 8> primaries;
    std::copy_n(frame.chromaticities, 8, primaries.begin());
    Look l;
    l.colors = conversion == "none"
                   ? colors_none(model_->size())
                   : colors_of(atmosphere_.wavelengths, primaries, sun_spectrum);
    l.scale.fill(exposure);
    const auto arrives = FrameSky::sun_at_eye(*model_, at, l.colors);
    for (int k = 0; k < 3; ++k)
      if (frame.sun_irradiance[k] > 0 && arrives[k] > 0)
        l.scale[k] = frame.sun_irradiance[k] / arrives[k];
    l.sun_radius = sun_diameter / 2 * M_PI / 180;
    return l;
  }

  Atmosphere atmosphere_;
  const Model* model_ = nullptr;
  const Maps* maps_ = nullptr;
  std::unique_ptr<FrameSky> sky_;

  struct {
    Placing at{};
    Look look{};
    bool tables = false;
  } placed_;
  // Made when somebody compares.
  mutable struct {
    std::once_flag once;
    std::unique_ptr<Model> model;
    std::unique_ptr<FrameSky> sky;
  } nishita_;
};

}  // namespace

BRUME_STAGES(SkyStage)
