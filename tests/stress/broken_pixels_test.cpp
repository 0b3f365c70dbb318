// Lens and surface stages with mistakes that people make: each must break a law. And
// sound ones that must not.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "broken_print.h"
#include "stress/stress.h"

namespace brume::stress {
namespace {

using Run = void (*)(const brume_tile&);

Report stress_of(const PixelStage& stage, brume_role role) {
  const Maker maker = [&](Random&, const FrameInfo&) -> std::optional<Subject> {
    Subject s;
    s.role = role;
    s.step = BRUME_LIGHT_STEP;
    s.at = [&](const FrameInfo&) { return stage; };
    return s;
  };
  return run("test", maker, {.cases = 20000, .seed = 5, .seconds = 60});
}

void expect_broken(Law law, const PixelStage& stage, brume_role role) {
  const Report r = stress_of(stage, role);
  print(r);
  EXPECT_GT(r.of(law).broken, 0u) << name(law);
}
// Every law holds, and these were asked.
Report expect_sound(const PixelStage& stage, brume_role role,
                    std::initializer_list<Law> asked) {
  const Report r = stress_of(stage, role);
  print(r);
  EXPECT_TRUE(r.ok());
  for (const Law law : asked) EXPECT_GT(r.of(law).checked, 100u) << name(law);
  return r;
}

void each(const brume_tile& t, auto&& f) {
  float* const planes[3] = {t.r, t.g, t.b};
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < t.height; ++y)
      for (int x = 0; x < t.width; ++x) f(planes[c] + y * t.row_stride, x, c, y);
}

// ---- lens -----------------------------------------------------------------------------

float light(float x) { return std::isfinite(x) && x > 0 ? x : 0; }

// Half of the light stays, a quarter goes to each side.
void spread(const brume_tile& t, bool wraps = false) {
  float* const planes[3] = {t.r, t.g, t.b};
  for (float* plane : planes)
    for (int y = 0; y < t.height; ++y) {
      float* row = plane + y * t.row_stride;
      const std::vector<float> in(row, row + t.width);
      const auto at = [&](int x) {
        if (wraps) x = (x + t.width) % t.width;
        return x < 0 || x >= t.width ? 0 : light(in[std::size_t(x)]);
      };
      for (int x = 0; x < t.width; ++x)
        if (std::isfinite(row[x]))
          row[x] += -0.5f * at(x) + 0.25f * at(x - 1) + 0.25f * at(x + 1);
    }
}

void truth_of_spread(const brume_tile& t, std::span<const int> xy, double* rgb) {
  const float* const planes[3] = {t.r, t.g, t.b};
  for (std::size_t c = 0; c < 3; ++c) {
    const float* row = planes[c] + xy[1] * t.row_stride;
    const auto at = [&](int x) {
      return x < 0 || x >= t.width ? 0. : double(light(row[x]));
    };
    rgb[c] = double(row[xy[0]]);
    if (std::isfinite(rgb[c]))
      rgb[c] += -0.5 * at(xy[0]) + 0.25 * at(xy[0] - 1) + 0.25 * at(xy[0] + 1);
  }
}

PixelStage lens(Run run) {
  PixelStage s;
  s.needs.whole_frame = true;
  s.needs.laws = BRUME_LINEAR | BRUME_KEEPS_LIGHT;
  s.run = run;
  s.truth = truth_of_spread;
  return s;
}

void expect_lens_broken(Law law, Run run) { expect_broken(law, lens(run), BRUME_LENS); }

TEST(StressLens, ASoundLensBreaksNoLaw) {
  const Report r =
      expect_sound(lens([](const brume_tile& t) { spread(t); }), BRUME_LENS,
                   {Law::finite, Law::positive, Law::lanes, Law::neighbours, Law::dark,
                    Law::alpha, Law::linear, Law::exposure, Law::keeps, Law::truth});
  EXPECT_GT(r.truths, 500u);
}

TEST(StressLens, FindsLightThatComesInOnTheOtherSide) {
  expect_lens_broken(Law::truth, [](const brume_tile& t) { spread(t, true); });
}

TEST(StressLens, FindsLightFromNowhere) {
  expect_lens_broken(Law::keeps, [](const brume_tile& t) {
    spread(t);
    each(t, [](float* row, int x, int, int) { row[x] *= 1.01f; });
  });
}

TEST(StressLens, FindsACurveInALens) {
  for (const Law law : {Law::linear, Law::exposure})
    expect_lens_broken(law, [](const brume_tile& t) {
      spread(t);
      each(t, [](float* row, int x, int, int) {
        row[x] = row[x] / (1 + 0.1f * light(row[x]));
      });
    });
}

TEST(StressLens, FindsNaNThatSpreads) {
  for (const Law law : {Law::finite, Law::neighbours})
    expect_lens_broken(law, [](const brume_tile& t) {
      each(t, [](float* row, int x, int, int) {
        if (x > 0) row[x] = 0.75f * row[x] + 0.25f * row[x - 1];
      });
    });
}

TEST(StressLens, FindsAVeilOverBlack) {
  expect_lens_broken(Law::dark, [](const brume_tile& t) {
    each(t, [](float* row, int x, int, int) { row[x] += 1e-6f; });
  });
}

TEST(StressLens, FindsRinging) {
  expect_lens_broken(Law::positive, [](const brume_tile& t) {
    each(t, [](float* row, int x, int, int) {
      if (x > 0) row[x] -= 0.1f * light(row[x - 1]);
    });
  });
}

TEST(StressLens, FindsRowsThatItTakesForContiguous) {
  expect_lens_broken(Law::lanes, [](const brume_tile& t) {
    for (int i = 0; i < t.width * t.height; ++i) t.r[i] *= 0.5f;
  });
}

TEST(StressLens, FindsAHandOnCoverage) {
  expect_lens_broken(Law::alpha, [](const brume_tile& t) { t.a[0] *= 0.5f; });
}

TEST(StressLens, FindsAnInstructionSetThatDiffers) {
  PixelStage s = lens([](const brume_tile& t) { spread(t); });
  s.lower = {{Isa::v2, [](const brume_tile& t) { spread(t); }}};
  expect_sound(s, BRUME_LENS, {Law::isa});
  s.lower.push_back({Isa::v3, [](const brume_tile& t) {
                       spread(t);
                       each(t, [](float* row, int x, int, int) { row[x] *= 1.001f; });
                     }});
  expect_broken(Law::isa, s, BRUME_LENS);
}

// ---- surface --------------------------------------------------------------------------

// What all lights send to a pixel whose face looks back at the camera, along its ray.
std::array<double, 3> reflected(const brume_tile& t, std::ptrdiff_t i, double rho,
                                std::size_t first = 0) {
  std::array<double, 3> sum{};
  const float a = light(t.a[i]) < 1 ? light(t.a[i]) : 1, far = t.distance[i];
  if (!(a > 0) || !(far > 0) || !(far < 1e30f)) return sum;
  float o[3], n[3] = {-t.dx[i], -t.dy[i], -t.dz[i]}, E[3];
  for (int c = 0; c < 3; ++c) o[c] = -far * n[c];
  if (t.ox) o[0] += t.ox[i], o[1] += t.oy[i], o[2] += t.oz[i];
  const brume_rays at = {1, o, o + 1, o + 2, n, n + 1, n + 2};
  float* const to[3] = {E, E + 1, E + 2};
  for (std::size_t k = first; k < t.world->light_count; ++k) {
    t.world->irradiance(t.world, k, &at, to);
    for (std::size_t c = 0; c < 3; ++c) sum[c] += double(a) * rho / M_PI * double(E[c]);
  }
  return sum;
}

template <class More>
void light_up(const brume_tile& t, double rho, More&& more, std::size_t first = 0) {
  float* const planes[3] = {t.r, t.g, t.b};
  for (int y = 0; y < t.height; ++y)
    for (int x = 0; x < t.width; ++x) {
      const std::ptrdiff_t i = y * t.row_stride + x;
      const auto add = reflected(t, i, rho, first);
      for (std::size_t c = 0; c < 3; ++c)
        planes[c][i] = float(double(planes[c][i]) + more(add[c], i, x));
    }
}
double as_is(double add, std::ptrdiff_t, int) { return add; }

PixelStage surface(Run run) {
  PixelStage s;
  s.needs.camera = s.needs.depth = true;
  s.run = run;
  return s;
}

void expect_surface_broken(Law law, Run run) {
  expect_broken(law, surface(run), BRUME_SURFACE);
}

TEST(StressSurface, ASoundSurfaceBreaksNoLaw) {
  PixelStage s = surface([](const brume_tile& t) { light_up(t, 0.5, as_is); });
  s.truth = [](const brume_tile& t, std::span<const int> xy, double* rgb) {
    const std::ptrdiff_t i = xy[1] * t.row_stride + xy[0];
    const auto add = reflected(t, i, 0.5);
    const float* const planes[3] = {t.r, t.g, t.b};
    for (std::size_t c = 0; c < 3; ++c) rgb[c] = double(planes[c][i]) + add[c];
  };
  expect_sound(s, BRUME_SURFACE,
               {Law::finite, Law::positive, Law::energy, Law::lanes, Law::neighbours,
                Law::additive, Law::dark, Law::order, Law::scale, Law::turn, Law::alpha,
                Law::truth});
}

TEST(StressSurface, FindsAnInstructionSetThatDiffers) {
  PixelStage s = surface([](const brume_tile& t) { light_up(t, 0.5, as_is); });
  s.lower = {{Isa::v2, [](const brume_tile& t) { light_up(t, 0.5, as_is); }}};
  expect_sound(s, BRUME_SURFACE, {Law::isa});
  s.lower.push_back({Isa::v3, [](const brume_tile& t) { light_up(t, 0.499, as_is); }});
  expect_broken(Law::isa, s, BRUME_SURFACE);
}

TEST(StressSurface, FindsALightThatIsForgotten) {
  expect_surface_broken(Law::additive,
                        [](const brume_tile& t) { light_up(t, 0.5, as_is, 1); });
}

TEST(StressSurface, FindsAGlowWithoutLight) {
  expect_surface_broken(Law::dark, [](const brume_tile& t) {
    light_up(t, 0.5, [](double add, std::ptrdiff_t, int) { return add + 1e-3; });
  });
}

TEST(StressSurface, FindsMoreThanALightSends) {
  expect_surface_broken(Law::energy, [](const brume_tile& t) { light_up(t, 2, as_is); });
}

TEST(StressSurface, FindsLightThatIsTaken) {
  expect_surface_broken(Law::positive,
                        [](const brume_tile& t) { light_up(t, -0.5, as_is); });
}

TEST(StressSurface, FindsMetresInAFormula) {
  expect_surface_broken(Law::scale, [](const brume_tile& t) {
    light_up(t, 0.5, [&](double add, std::ptrdiff_t i, int) {
      return add / (1 + double(light(t.distance[i])));
    });
  });
}

TEST(StressSurface, FindsANormalInTheWrongAxes) {
  expect_surface_broken(Law::turn, [](const brume_tile& t) {
    light_up(t, 0.5, [&](double add, std::ptrdiff_t i, int) {
      return add * std::abs(double(t.dz[i]));
    });
  });
}

TEST(StressSurface, FindsWhatDependsOnTheTile) {
  expect_surface_broken(Law::lanes, [](const brume_tile& t) {
    light_up(t, 0.5, [](double add, std::ptrdiff_t, int x) { return x ? add : 0; });
  });
}

TEST(StressSurface, FindsColourThatRunsOver) {
  expect_surface_broken(Law::neighbours, [](const brume_tile& t) {
    light_up(t, 0.5, [&](double add, std::ptrdiff_t i, int x) {
      return x > 0 ? add + 0.1 * double(t.r[i - 1]) : add;
    });
  });
}

TEST(StressSurface, FindsWrongLightByTheTruth) {
  PixelStage s = surface([](const brume_tile& t) { light_up(t, 0.45, as_is); });
  s.truth = [](const brume_tile& t, std::span<const int> xy, double* rgb) {
    const std::ptrdiff_t i = xy[1] * t.row_stride + xy[0];
    const auto add = reflected(t, i, 0.5);
    const float* const planes[3] = {t.r, t.g, t.b};
    for (std::size_t c = 0; c < 3; ++c) rgb[c] = double(planes[c][i]) + add[c];
  };
  const Report r = stress_of(s, BRUME_SURFACE);
  print(r);
  EXPECT_GT(r.of(Law::truth).broken, 0u);
}

}  // namespace
}  // namespace brume::stress
