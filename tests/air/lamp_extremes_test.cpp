// Lamps where numbers run out: on the ray, far from stiff fog, in a cone as narrow as a
// beam. Each was wrong once, and found by `brume stress`.

#include <gtest/gtest.h>

#include <bit>

#include "support.h"

namespace brume {
namespace {

using namespace testing_air;

brume_light clear(brume_light l) {  // nothing dims it
  l.attenuated = 0;
  return l;
}
double L_of(const World& w, glm::dvec3 o, glm::dvec3 d, double t, Isa isa) {
  AirOptions options = testing_air::options();
  options.isa = isa;
  Bundle b;
  b.add(o, d, t);
  return double(integrate(Air::compile(w, options), b).L[0][0]);
}
// Int f over [a, b] of a function that is smooth in the logarithm.
template <class F>
double integral(double a, double b, F&& f) {
  constexpr int n = 20000;
  const double step = std::log(b / a) / n;
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const double x = a * std::exp((i + .5) * step);
    sum += f(x) * x * step;
  }
  return sum;
}

TEST(LampExtremes, ExactlyBehindTheEye) {
  // g != 0, so that it goes by quadrature. Light goes where the ray does: p(-1) all
  // along.
  const double sigma = 5e-4, g = -0.5, power = 1e6, away = 141;
  const World w = world_of({white_fog(sigma, g)}, {clear(lamp({0, 0, -away}, power))});
  const double p = (1 - g * g) / (4 * M_PI * std::pow(1 + g * g + 2 * g, 1.5));
  const double want = sigma * p * power * integral(away, 1e7, [&](double r) {
                        return std::exp(-sigma * (r - away)) / (r * r);
                      });
  for (const Isa isa : isas())
    EXPECT_NEAR(L_of(w, {0, 0, 0}, {0, 0, 1}, 1e7, isa) / want, 1, 1e-3) << name(isa);
}

TEST(LampExtremes, ASmallOneAtTheEye) {
  // Int dr / max(r, r0)^2 = 2 / r0. The fog is as clear as that light is near.
  const double sigma = 6e-7, g = 0.3, power = 0.02, r0 = 2.6e-8;
  brume_light l = clear(lamp({0, 0, 0}, power));
  l.radius = r0;
  const World w = world_of({white_fog(sigma, g)}, {l});
  const double p = (1 - g * g) / (4 * M_PI * std::pow(1 + g * g + 2 * g, 1.5));
  const double want = sigma * p * power * 2 / r0;
  for (const Isa isa : isas())  // 1e-3 (1 + L) is the tolerance
    EXPECT_NEAR(L_of(w, {0, 0, 0}, {0.2, 0.3, 1}, INFINITY, isa), want, 1e-3 * (1 + want))
        << name(isa);
}

TEST(LampExtremes, FarFromFogThatIsOpaqueAtOnce) {
  // L = p E where the ray begins: all of it within the first centimetres, or within less
  // than floats tell apart.
  const double g = 0.67, power = 1e9;
  const glm::dvec3 at(60.5, 52.6, 1129);
  const double r = glm::length(at), mu = at.x / r;  // the ray goes along x
  const double p = (1 - g * g) / (4 * M_PI * std::pow(1 + g * g - 2 * g * mu, 1.5));
  for (const double sigma : {68., 1e6, 1e13})
    for (const Isa isa : isas()) {
      const World w = world_of({white_fog(sigma, g)}, {clear(lamp(at, power))});
      EXPECT_NEAR(L_of(w, {0, 0, 0}, {1, 0, 0}, 800, isa) / (p * power / (r * r)), 1,
                  2e-3)
          << name(isa) << " " << sigma;
    }
}

TEST(LampExtremes, InTheNarrowestPeakThatAPhaseFunctionHas) {
  // L = p E of opaque fog, (1 - |g|)^2 = 1e-4: a cosine in float is off by 1e-7. Floats
  // of the place are by 1e-7 of an angle of .01, in which p halves; rounding, 1e-5.
  const double power = 1e3, r = 4;
  for (const double g : {0.99, -0.99})
    for (const double angle : {0., 1e-3, 4e-3, 1e-2}) {
      const double far = g > 0 ? r : -r;
      const glm::dvec3 at(r * std::sin(angle), 0, far * std::cos(angle));
      const double chord = 2 * std::sin(angle / 2);
      const double q =
          (1 - std::abs(g)) * (1 - std::abs(g)) + std::abs(g) * chord * chord;
      const double p = (1 - g * g) / (4 * M_PI * q * std::sqrt(q));
      const World w = world_of({white_fog(1e7, g)}, {clear(lamp(at, power))});
      for (const Isa isa : isas())
        EXPECT_NEAR(L_of(w, {0, 0, 0}, {0, 0, 1}, 2, isa) / (p * power / (r * r)), 1,
                    1e-4)
            << name(isa) << " " << g << " " << angle;
    }
}

TEST(LampExtremes, DimmedByStiffFogOnBothWays) {
  // A slab of 400 per metre that begins 1 m before the eye, lit from the eye's side, the
  // lamp 10 m behind: tau there and back, Int e^(-2 tau) dtau = 1/2.
  const double power = 1e4;
  const World w =
      world_of({shaped(white_fog(400, -0.9), BRUME_BOX, {0, 0, 51}, {100, 100, 50})},
               {lamp({0, 0.01, -10}, power)});
  const double p =
      1.9 * 0.1 / (4 * M_PI * std::pow(1 + .81 - 1.8, 1.5));  // straight back
  for (const Isa isa : isas())
    EXPECT_NEAR(L_of(w, {0, 0, 0}, {0, 0, 1}, INFINITY, isa) / (p * power / 121 / 2), 1,
                1e-2)  // 1 / (r^2) changes by 2 / 400 / 11, the peak by (1e-3)^2 / 0.01
        << name(isa);
}

TEST(LampExtremes, AThinLayerFarFromIt) {
  // All of the light is scattered within a centimetre, a kilometre away: Int e^-tau dtau.
  // Floats there are 6e-5 m apart, half of which is 0.015 of the layer's scale.
  const double power = 1e6, g = 0.3, down = 1000, aside = 300;
  brume_medium layer = height_fog(30, 500, 0, 0);
  for (double& a : layer.albedo) a = 1;
  layer.g = g;
  World w = world_of({layer}, {clear(lamp({aside, 0, 0}, power))});
  w.media[0].what.origin[2] = -down;
  const double r2 = down * down + aside * aside, mu = -down / std::sqrt(r2);
  const double p = (1 - g * g) / (4 * M_PI * std::pow(1 + g * g - 2 * g * mu, 1.5));
  const auto until = [&](double depth) {
    return double(float(down + std::log(depth * 500 / 30) / 500));
  };
  for (const Isa isa : isas())
    for (const double t :
         {until(1), until(3), until(12), down + 1, 3000., 1e9, double(INFINITY)}) {
      const double seen = -std::expm1(-30 / 500. * std::exp(500 * (t - down)));
      EXPECT_NEAR(L_of(w, {0, 0, 0}, {0, 0, -1}, t, isa) / (p * power / r2 * seen), 1,
                  0.015)
          << name(isa) << " " << t;
    }
}

TEST(LampExtremes, ALayerThatIsLitFromItsFaceAlone) {
  // So thick that no node of a whole ray would be lit, from the eye to the lamp's foot
  // and beyond: the slab lets 1 / 400 m of it through, as above.
  const double sigma = 400, power = 1e4, aside = 3;
  const World w =
      world_of({shaped(white_fog(sigma, 0.1), BRUME_BOX, {0, 0, 51}, {100, 100, 50})},
               {lamp({aside, 0, -1}, power)});
  // Lit askew: over d on the way of the eye light goes d r / 2 in the fog, r as the lamp
  // sees the face.
  const double r2 = 4 + aside * aside, r = std::sqrt(r2), mu = -2 / r, g = 0.1;
  const double p = (1 - g * g) / (4 * M_PI * std::pow(1 + g * g - 2 * g * mu, 1.5));
  for (const Isa isa : isas())
    EXPECT_NEAR(L_of(w, {0, 0, 0}, {0, 0, 1}, 90, isa) / (p * power / r2 / (1 + r / 2)),
                1, 1e-2)
        << name(isa);
}

TEST(LampExtremes, ASpotlightOfHalfTheWorld) {
  // Lit is what lies before the plane through the lamp.
  const double sigma = 0.1, power = 100, plane = -0.28 / 0.96;
  brume_light l = clear(lamp({0, 0, 0}, power, BRUME_SPOT));
  l.direction[0] = 0.28, l.direction[2] = 0.96;
  l.cone = M_PI / 2, l.cone_soft = 0;
  const World w = world_of({white_fog(sigma)}, {l});
  for (const double before : {5., 500.})
    for (const double behind : {5., 500.}) {
      const double want =
          sigma / (4 * M_PI) * power * integral(1e-9, behind - plane, [&](double u) {
            const double z = u + plane;
            return std::exp(-sigma * (before + z)) / (1 + z * z);
          });
      for (const Isa isa : isas())
        EXPECT_NEAR(L_of(w, {1, 0, -before}, {0, 0, 1}, before + behind, isa), want,
                    1e-4 * want + 1e-6)
            << name(isa) << " " << before << " " << behind;
    }
}

TEST(LampExtremes, ABeamThatEndsAtTheEye) {
  // Half a milliradian of beam from 550 m away, looked across: p E times what is seen of
  // it, half its width, 0.1375 m, smoothly fading.
  const double sigma = 0.01, power = 1e9, away = 550;
  brume_light l = clear(lamp({0, 0, away}, power, BRUME_SPOT));
  l.direction[0] = 0, l.direction[2] = -1;
  l.cone = 2.5e-4, l.cone_soft = 2.5e-4;
  const World w = world_of({white_fog(sigma)}, {l});
  const double want = sigma / (4 * M_PI) * power / (away * away) * away * l.cone / 2;
  for (const Isa isa : isas())
    for (const double slope : {0., 1., 3.}) {  // slope: it is crossed askew
      const double longer = std::sqrt(1 + slope * slope);
      EXPECT_NEAR(L_of(w, {0, 0, 0}, {1, 0, -slope}, 2000, isa) / (want * longer), 1,
                  3e-3)
          << name(isa) << " " << slope;
    }
}

TEST(LampExtremes, NoNumberComesOutOfALampOnTheRay) {
  for (const double power : {1e-9, 1., 1e12})
    for (const double at : {0., 1e-30, 1e-3, 1e3, 1e9})
      for (const double g : {0., 0.9, -0.99})
        for (const bool dimmed : {false, true})
          for (const Isa isa : isas()) {
            brume_light l = lamp({0, 0, at}, power);
            l.attenuated = dimmed;
            const World w =
                world_of({white_fog(1e-3, g), height_fog(1e6, 1e-3, 0, 1e9)}, {l});
            for (const double t : {0., 1e-30, 1e-3, 1e3, 1e30}) {
              const double L = L_of(w, {0, 0, 0}, {0, 0, 1}, t, isa);
              EXPECT_TRUE(std::isfinite(L) && L >= 0)
                  << L << ": power " << power << " at " << at << " to " << t;
            }
          }
}

TEST(LampExtremes, WhatNeighboursMeetChangesNoBit) {
  // An ellipsoid that only the second ray meets, of another phase.
  const brume_medium ball =
      shaped(white_fog(0.3, 0.8), BRUME_ELLIPSOID, {50, 0, 50}, {5, 5, 5});
  for (const bool dimmed : {false, true})
    for (const double g : {0., 0.4})
      for (const Isa isa : isas()) {
        brume_light l = lamp({1, 2, 20}, 100);
        l.attenuated = dimmed;
        AirOptions o = options();
        o.isa = isa;
        const Air air = Air::compile(world_of({white_fog(0.02, g), ball}, {l}), o);
        Bundle alone, both;
        alone.add({0, 0.1, 1}, 60);
        both.add({0, 0.1, 1}, 60);
        both.add({1, 0, 1}, 200);
        EXPECT_EQ(std::bit_cast<std::uint32_t>(integrate(air, alone).L[0][0]),
                  std::bit_cast<std::uint32_t>(integrate(air, both).L[0][0]));
      }
}

TEST(LampExtremes, DensitiesThatLeaveTheFloatsHideWhatIsBehindThem) {
  // e^177 times 4 per metre under a clear sun, thin fog beside it; and the same with a
  // cap. L = source (1 - T).
  brume_light sun = lamp({0, 0, 0}, 4e8, BRUME_SUN);
  sun.attenuated = 0;
  brume_medium dense = height_fog(4, 6.8e-4, 0, 0);
  for (double& a : dense.albedo) a = 0.98;
  const World w = world_of({dense, white_fog(2e-5)}, {sun});
  brume_medium capped = height_fog(0.002, 0.01, 0, 1.8e5);
  capped.max_opacity = 0.45;
  for (double& a : capped.albedo) a = 1e-3;
  brume_light low = lamp({0, 0, 0}, 6, BRUME_SUN);  // dimmed: no closed form
  const World c = world_of({capped}, {low});
  for (const Isa isa : isas()) {
    EXPECT_NEAR(L_of(w, {0, 0, -2.6e5}, {0, 1, 0}, 100, isa) / (0.98 * 4e8 / (4 * M_PI)),
                1, 2e-3)
        << name(isa);
    EXPECT_NEAR(L_of(c, {0, 0, -1e4}, {1, 0, 0.3}, 1e20, isa) / (1.8e5 * 0.45), 1, 2e-3)
        << name(isa);
  }
}

}  // namespace
}  // namespace brume
