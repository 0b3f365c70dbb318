// Facts about a bolt's bright core, asked of the product's own path.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "../../tests/stage/through_air.h"
#include "num/quadrature.h"
#include "truth/truth.h"

namespace {

using namespace brume;
using namespace brume::test;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr double kEps = std::numeric_limits<float>::epsilon();
constexpr double kPixel = 0.65, kRoot2Pi = 2.5066282746310002;

using Point = std::array<double, 3>;
Point operator+(const Point& a, const Point& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
Point operator*(double t, const Point& a) { return {t * a[0], t * a[1], t * a[2]}; }
double dot(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
double length(const Point& a) { return std::sqrt(dot(a, a)); }
Point unit(const Point& a) { return 1 / length(a) * a; }

// README (4) by its words: every place of a stretch from p to q shines with a Gaussian,
// integrated over the stretch and over the ray, 8 nodes in every two deviations. The eye
// is at 0; r is the channel's deviation. Times sqrt(2 pi) r: per radiance.
double light(const Point& p, const Point& q, double r, double pixel, const Ray& ray) {
  const Point o = {ray.o[0], ray.o[1], ray.o[2]}, d = {ray.d[0], ray.d[1], ray.d[2]};
  const Point way = q + -1. * p, a = unit(way);
  const double L = length(way);
  const auto at = [&](double u) { return p + u * a; };
  const auto foot = [&](double u) { return dot(at(u) + -1. * o, d); };
  // The place nearest to the ray, by ternary search; of a stretch along it, its middle.
  const auto away = [&](double u) {
    const Point off = at(u) + -1. * o + -foot(u) * d;
    return dot(off, off) + 1e-6 * (u - L / 2) * (u - L / 2);
  };
  double lo = 0, hi = L;
  for (int i = 0; i < 200; ++i) {
    const double third = (hi - lo) / 3;
    (away(lo + third) > away(hi - third) ? lo : hi) =
        away(lo + third) > away(hi - third) ? lo + third : hi - third;
  }
  const double u0 = (lo + hi) / 2;
  const double s2 = r * r + std::pow(kPixel * pixel, 2) * dot(at(u0), at(u0)),
               s = std::sqrt(s2);
  const auto rule = gauss_legendre<8>();
  const auto over = [&](double a0, double b0, const auto& f) {
    const int panels = std::max(1, int(std::ceil((b0 - a0) / (2 * s))));
    const double half = (b0 - a0) / panels / 2;
    double sum = 0;
    for (int i = 0; i < panels && b0 > a0; ++i)
      for (int k = 0; k < 8; ++k)
        sum += half * double(rule.w[k]) * f(a0 + half * (2 * i + 1 + double(rule.x[k])));
    return sum;
  };
  // Farther along the stretch than 9 deviations across the ray nothing comes.
  const Point across = a + -dot(a, d) * d;
  const double wide = 9 * s / std::max(length(across), 1e-9);
  const double sum = over(std::max(0., u0 - wide), std::min(L, u0 + wide), [&](double u) {
    const double t = foot(u);
    return over(std::max(0., t - 9 * s), std::min(double(ray.t), t + 9 * s),
                [&](double x) {
                  const Point off = o + x * d + -1. * at(u);
                  return std::exp(-dot(off, off) / (2 * s2)) / (kRoot2Pi * s);
                });
  });
  return r * r / s2 * sum / (kRoot2Pi * r);
}

Ray toward(const Point& from, const Point& to, double t) {
  const Point d = unit(to + -1. * from);
  Ray ray;
  for (std::size_t i = 0; i < 3; ++i) {
    ray.o[i] = float(from[i]);
    ray.d[i] = float(d[i]);
  }
  ray.t = float(t);
  return ray;
}

std::string list(const std::vector<Point>& points) {
  std::string s;
  for (const Point& p : points)
    for (double x : p) s += (s.empty() ? "" : ",") + text(x);
  return s;
}

Set line(const std::vector<Point>& points, double radius, const char* radiance = "1") {
  return {{"form", "line"},
          {"points", list(points)},
          {"intensity", "0"},
          {"core_radiance", radiance},
          {"core_radius", text(radius)}};
}

FrameInfo frame_of(double pixel) {
  FrameInfo f = eye_at(0, 0, 0);
  f.pixel_footprint = pixel;
  return f;
}

TEST(LightningCore, IsTheIntegralOfItsDensityOverTheRay) {
  const unsigned seed = 20061123;
  std::mt19937 random(seed);
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  double worst = 0;
  int asked = 0;
  for (int scene = 0; scene < 100; ++scene) {
    const double away = std::pow(10, uniform(0, 3)),
                 radius = std::pow(10, uniform(-3, 0.5)),
                 pixel = scene % 3 ? std::pow(10, uniform(-4, -2)) : 0;
    const double size = away * std::pow(10, uniform(-2, 0));
    const auto place = [&](double x) {
      return Point{uniform(-x, x), uniform(-x, x), uniform(-x, x)};
    };
    const Point middle = away * unit(place(1)), p = middle + place(size),
                q = middle + place(size);
    const double r = radius / 2, s = std::hypot(r, kPixel * pixel * away);
    ThroughAir air(frame_of(pixel));
    air.add("lightning", line({p, q}, radius))
        .compile(1e-3, Isa(random() % (unsigned(best_isa()) + 1)));
    std::vector<Ray> rays;
    for (int i = 0; i < 24; ++i) {
      // Near some place of it, through or past it, ending anywhere about it; some from
      // beside the eye, and some along the stretch.
      const Point target = p + uniform(-.1, 1.1) * (q + -1. * p) + place(3 * s);
      const Point from = i % 4 == 1   ? place(0.3 * away)
                         : i % 8 == 3 ? p + -2. * (q + -1. * p) + place(s)
                                      : Point{};
      const double there = length(target + -1. * from);
      rays.push_back(toward(from, target,
                            i % 3 == 0   ? kInf
                            : i % 3 == 1 ? there + uniform(-4, 4) * s
                                         : uniform(0, 2) * there));
      if (!(rays.back().t > 0)) rays.back().t = float(there);
    }
    const auto got = air(rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const double want = light(p, q, r, pixel, rays[i]);
      // On the axis, for a ray at this angle to the stretch.
      const Point a = unit(q + -1. * p), d = {rays[i].d[0], rays[i].d[1], rays[i].d[2]};
      const double seen = std::min(
          kRoot2Pi * s / std::max(length(a + -dot(a, d) * d), 1e-9), length(q + -1. * p));
      const double peak = r * seen / (s * s * kRoot2Pi);
      // A place is a float relative to the eye, half an eps off; the light across the
      // core is exp(-x^2/2), whose steepest slope is 0.61.
      const Point o = {rays[i].o[0], rays[i].o[1], rays[i].o[2]};
      const double off = kEps / 2 * (away + size + length(o)) / s;
      const double error = std::max(0., std::abs(got[i].L[0] - want) - 0.61 * off * peak);
      worst = std::max(worst, error / peak);
      ++asked;
      EXPECT_LE(error, 1e-5 * peak) << "scene " << scene << ", ray " << i << ": "
                                    << got[i].L[0] << ", not " << want;
      EXPECT_EQ(got[i].T[0], 1);
    }
  }
  std::printf(
      "%d rays, seed %u: largest error %.1e of the peak, beside "
      "the rounding of places\n",
      asked, seed, worst);
}

TEST(LightningCore, ShowsItsRadianceWhereItIsWiderThanAPixel) {
  ThroughAir air(frame_of(1e-4));
  air.add("lightning", line({{-3, 0, 20}, {3, 0, 20}}, 0.4, "7,1,2")).compile();
  // (r/s) with r = 0.2, s^2 = r^2 + (0.65 x 1e-4 x 20)^2.
  const double share = 0.2 / std::hypot(0.2, 0.65e-4 * 20);
  const auto got = air({{0, 0, 0}, {0, 0, 1}, kInf});
  EXPECT_NEAR(got.L[0], 7 * share, 7e-6);
  EXPECT_NEAR(got.L[1], 1 * share, 1e-6);
  EXPECT_NEAR(got.L[2], 2 * share, 2e-6);
}

TEST(LightningCore, AShortRayWithinSeesWhatALongerOneDoesPerMetre) {
  // A kilometre wide, its axis 300 m from the eye: over t metres light changes by up to
  // 300 t / s^2 = 3e-4 t of itself.
  for (int set = 0; set <= int(best_isa()); ++set) {
    const Isa isa = Isa(set);
    ThroughAir air(frame_of(1e-4));
    air.add("lightning", line({{-900, 250, 160}, {1200, 250, 160}}, 2000, "1e6"))
        .compile(1e-3, isa);
    const auto per_metre = [&](float t) {
      return double(air({{0, 0, 0}, {0.6f, 0.8f, 0}, t}).L[0]) / double(t);
    };
    const double one = per_metre(1);
    for (const float t : {1e-6f, 1e-4f, 2e-3f, 0.05f})
      EXPECT_NEAR(per_metre(t) / one, 1, 3e-4 + 1e-5) << name(isa) << " " << t;
  }
}

TEST(LightningCore, ARowOfPixelsGetsTheSameLightAtAnyDistanceAndPlace) {
  // Int L dx = sqrt(2 pi) r per radiance, whatever the pixel: from 20 pixels wide to a
  // fiftieth of one.
  const double pixel = 1e-3, r = 0.05;
  for (const double away : {2.5, 20., 100., 1000., 2500.})
    for (const double shift : {0., 0.25, 0.5, 0.8}) {
      ThroughAir air(frame_of(pixel));
      air.add("lightning", line({{0, -away, away}, {0, away, away}}, 2 * r)).compile();
      double sum = 0;
      for (int i = -400; i <= 400; ++i) {
        const double x = (i + shift) * pixel;
        // Pixels evenly on the plane at the core's distance.
        sum += air(toward({}, {x * away, 0, away}, kInf)).L[0] * pixel * away;
      }
      EXPECT_NEAR(sum / (kRoot2Pi * r), 1, 1e-3) << away << ", " << shift;
    }
}

TEST(LightningCore, JointsShowNeitherKnotNorGap) {
  // The same straight line in one piece and in sixteen, resolved and not.
  for (const double radius : {0.01, 0.3, 3.}) {
    std::vector<Point> whole = {{-2, 1, 30}, {6, 3, 34}}, parts;
    for (int i = 0; i <= 16; ++i)
      parts.push_back(whole[0] + i / 16. * (whole[1] + -1. * whole[0]));
    ThroughAir one(frame_of(1e-3)), many(frame_of(1e-3));
    one.add("lightning", line(whole, radius)).compile();
    many.add("lightning", line(parts, radius)).compile();
    for (int i = 0; i <= 200; ++i) {
      const Point at = whole[0] + (i / 200.) * (whole[1] + -1. * whole[0]);
      const double a = one(toward({}, at, kInf)).L[0],
                   b = many(toward({}, at, kInf)).L[0];
      // A pixel's width changes by 1e-4 from one end of a stretch's share to the other.
      EXPECT_NEAR(b, a, 2e-4 * a) << radius << ", " << i;
    }
  }
}

TEST(LightningCore, ABendIsAsBrightAsTheRest) {
  // Along a zigzag with bends of 60 degrees, a pixel wide: what a pixel's Gaussian gets
  // of two arms is between one arm's light and what the longer way in it adds, 1/cos 30.
  const double pixel = 1e-3, away = 100;
  std::vector<Point> zigzag;
  for (int i = 0; i < 6; ++i)
    zigzag.push_back({(i % 2 ? .5774 : -.5774) * 2, 2. * i, away});
  ThroughAir air(frame_of(pixel));
  air.add("lightning", line(zigzag, 0.01)).compile();
  double least = kInf, most = 0;
  for (std::size_t k = 1; k < zigzag.size(); ++k)
    for (int i = k == 1 ? 20 : 0; i <= (k + 1 == zigzag.size() ? 80 : 100); ++i) {
      const Point at = zigzag[k - 1] + i / 100. * (zigzag[k] + -1. * zigzag[k - 1]);
      const double L = air(toward({}, at, kInf)).L[0];
      least = std::min(least, L);
      most = std::max(most, L);
    }
  EXPECT_GT(least / most, 0.8);
}

TEST(LightningCore, GeometryInFrontHidesIt) {
  ThroughAir air(frame_of(1e-3));
  air.add("lightning", line({{-3, 0, 20}, {3, 0, 20}}, 0.1)).compile();
  const double whole = air({{0, 0, 0}, {0, 0, 1}, kInf}).L[0];
  EXPECT_EQ(air({{0, 0, 0}, {0, 0, 1}, 19}).L[0], 0);
  EXPECT_NEAR(air({{0, 0, 0}, {0, 0, 1}, 20}).L[0], whole / 2, 1e-5 * whole);
  EXPECT_NEAR(air({{0, 0, 0}, {0, 0, 1}, 21}).L[0], whole, 1e-6 * whole);
}

TEST(LightningCore, ItsFaintestEdgeShinesOnRaysThatReachItOnly) {
  // A thousand million shows e^-16: rays at 4 to 5.65 deviations that end short of it, in
  // it and beyond. A deviation is rounded by 5e-6 here, its square by 32 times that; a
  // quadrature is off by 1e-6 of the whole.
  const double r = 0.2;
  const Point p = {-3, 0, 20}, q = {3, 0, 20};
  for (int set = 0; set <= int(best_isa()); ++set) {
    ThroughAir air(frame_of(0));
    air.add("lightning", line({p, q}, 2 * r, "1e9")).compile(1e-3, Isa(set));
    for (const double off : {4., 5., 5.5, 5.65})
      for (const double beyond : {-7., -5., -3., -1., 0., 1., 3., 7.}) {
        Ray ray = toward({}, {0.1, off * r, 20}, 20);
        ray.t = float((20 + beyond * r) / double(ray.d[2]));
        const double want = 1e9 * light(p, q, r, 0, ray);
        EXPECT_NEAR(air(ray).L[0], want, 1e3 * std::exp(-off * off / 2) + 1e-3 * want)
            << name(Isa(set)) << ", " << off << " off, " << beyond << " beyond";
      }
  }
}

TEST(LightningCore, AStretchPastTheEyeIsSeenByTheTruthToo) {
  // From 4 cm before the eye to a hundred metres: pixels are 40 um and 10 cm wide.
  const Point p = {.031, -.027, 0}, q = {-16, 93, 0};
  ThroughAir air(frame_of(1e-3));
  air.add("lightning", line({p, q}, 1e-4, "1e6")).compile();
  for (int i = 0; i < 40; ++i) {
    const double along = std::pow(10., -4 + i / 10.), s = std::hypot(5e-5, 6.5e-4 * .04);
    const Point at = p + along * (q + -1. * p) + Point{0, 0, (i % 3) * s};
    const Ray ray = toward({}, at, 3 + 40 * along);
    const auto truth =
        truth::along(air.world(), {0, 0, 0}, {ray.d[0], ray.d[1], ray.d[2]}, ray.t,
                     {.tolerance = 1e-6});
    // Farther out it is seen along itself: there a long part of it counts, of which each
    // has a width of its own; the formula has one for all.
    const double want = i < 10 ? 1e6 * light(p, q, 5e-5, 1e-3, ray) : truth.L[0];
    EXPECT_NEAR(truth.L[0], want, 2e-3 * want) << i;
    EXPECT_NEAR(air(ray).L[0], truth.L[0], 1e-4 * truth.L[0]) << i;
    EXPECT_TRUE(truth.converged) << i;
  }
}

TEST(LightningCore, RaysBesideItStayAsTheyWere) {
  ThroughAir with(frame_of(1e-3)), without(frame_of(1e-3));
  Set bolt = {{"form", "bolt"},        {"points", "0,0,30,5,0,60"}, {"intensity", "0"},
              {"core_radiance", "90"}, {"core_radius", "0.1"},      {"branches", "0"},
              {"roughness", "0.05"}};
  const Set fog = {{"density", "0.01"}, {"falloff", "0.02"}};
  with.add("lightning", bolt).add("height_fog", fog).compile();
  without.add("height_fog", fog).compile();
  std::vector<Ray> rays;
  for (int i = 0; i < 64; ++i) rays.push_back(toward({}, {20. + i, 1. * i, 30}, 100 + i));
  EXPECT_TRUE(same_bits(with(rays), without(rays)));
}

TEST(LightningCore, BehindFogItIsDimmedAsTheTruthSays) {
  FrameInfo frame = frame_of(1e-3);
  ThroughAir air(frame);
  air.add("lightning", {{"form", "bolt"},
                        {"points", "-1,2,40,2,-1,12"},
                        {"attenuation", "0.2"},
                        {"lights", "3"},
                        {"branches", "1"},
                        {"roughness", "0.1"},
                        {"core_radiance", "5,6,9"},
                        {"core_radius", "0.2"}})
      .add("height_fog", {{"density", "0.01,0.03,0.1"}, {"falloff", "0.05"}})
      .compile();
  int met = 0;
  double worst = 0;
  for (int i = 0; i < 24; ++i) {
    const double w = (i + .5) / 24;
    const Ray r = toward({}, {-1 + 3 * w + .02 * (i % 3), 2 - 3 * w, 40 - 28 * w}, 60);
    const auto truth = truth::along(air.world(), {0, 0, 0}, {r.d[0], r.d[1], r.d[2]}, r.t,
                                    {.tolerance = 1e-6});
    met += truth.L[0] > 0.3;
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(air(r).L[c], truth.L[c], 1e-3 * (1 + truth.L[c])) << i;
      worst = std::max(worst, std::abs(air(r).L[c] - truth.L[c]) / (1 + truth.L[c]));
    }
  }
  EXPECT_GE(met, 4);  // or it said nothing
  std::printf("%d of 24 rays meet it: largest error %.1e\n", met, worst);
}

TEST(LightningCore, TheTruthDecidesAWholeBolt) {
  // Far off, where a pixel is wider than its stretches are long and a ray meets hundreds,
  // and near; 256 lights beside. What `apply --truth` asks for, in a tenth of its
  // evaluations: 64 x 36 such pixels are seconds.
  for (const double pixel : {1.8e-2, 1e-3}) {
    ThroughAir air(frame_of(pixel));
    air.add("lightning", {{"form", "bolt"},
                          {"points", "-700,1100,2200,-420,650,2300,-480,40,2100"},
                          {"intensity", "1e-4"},
                          {"attenuation", "2e-5"},
                          {"lights", "256"},
                          {"branches", "9"},
                          {"core_radiance", "1600"},
                          {"core_radius", "0.15"},
                          {"seed", "21"}})
        .add("height_fog", {{"density", "0.0007"}, {"falloff", "0.0012"}})
        .compile(1e-4);
    double most = 0, worst = 0;
    long evaluations = 0;
    for (int i = 0; i < 12; ++i) {  // across it, past the one place that is known
      const Ray r = toward({}, {-420 + 20. * (i - 6), 650 - 3. * (i - 6), 2300}, kInf);
      const auto truth = truth::along(air.world(), {0, 0, 0}, {r.d[0], r.d[1], r.d[2]},
                                      r.t, {.tolerance = 1e-5, .evaluations = 100'000});
      EXPECT_TRUE(truth.converged) << i;
      EXPECT_LE(truth.L_error[0], 1e-5 * (1 + truth.L[0])) << i;
      const double off = std::abs(air(r).L[0] - truth.L[0]) / (1 + truth.L[0]);
      EXPECT_LE(off, 1e-3) << i;
      worst = std::max(worst, off);
      most = std::max(most, truth.L[0]);
      evaluations = std::max(evaluations, truth.evaluations);
    }
    EXPECT_GT(most, 0.5);
    std::printf("pixel %g: off by %.1e at most, %ld evaluations\n", pixel, worst,
                evaluations);
  }
}

TEST(LightningCore, IsFiniteAndNeverNegativeWhateverTheCase) {
  // Radii of 0.1 mm to 10 km, stretches of nothing to 1e8 m, the eye on the core, on its
  // line, far away; rays along it, through it, ending in it, from anywhere.
  std::mt19937 random(77);
  const auto log_uniform = [&](double a, double b) {
    return a * std::pow(b / a, std::uniform_real_distribution<double>(0, 1)(random));
  };
  const auto sign = [&] { return random() % 2 ? 1. : -1.; };
  const auto place = [&](double a, double b) {
    return Point{sign() * log_uniform(a, b), sign() * log_uniform(a, b),
                 random() % 3 ? sign() * log_uniform(a, b) : 0};
  };
  for (int scene = 0; scene < 400; ++scene) {
    const Point p = scene % 5 ? place(1e-3, 1e8) : Point{},
                q = scene % 7 ? p + place(1e-6, 1e8) : -1. * p;
    ThroughAir air(frame_of(scene % 2 ? log_uniform(1e-6, .1) : 0));
    air.add("lightning", line({p, q}, log_uniform(1e-4, 1e4), "1e6"))
        .compile(1e-3, Isa(random() % (unsigned(best_isa()) + 1)));
    std::vector<Ray> rays;
    for (int i = 0; i < 32; ++i) {
      const Point from = i % 2 ? place(1e-6, 1e9) : Point{};
      Point to = i % 3 ? p + (i % 4) / 3. * (q + -1. * p) : from + (q + -1. * p);
      if (to == from) to = from + Point{0, 0, 1};
      rays.push_back(toward(from, to, i % 5 ? log_uniform(1e-9, 1e12) : kInf));
    }
    for (const Answer& a : air(rays))
      for (int c = 0; c < 3; ++c) {
        EXPECT_TRUE(std::isfinite(a.L[c]) && a.L[c] >= 0) << scene << ": " << a.L[c];
        EXPECT_EQ(a.T[c], 1) << scene;
      }
  }
}

TEST(LightningCore, BranchesAreThinner) {
  ThroughAir air(frame_of(0));
  air.add("lightning", {{"form", "bolt"},
                        {"points", "0,0,30,5,0,0"},
                        {"intensity", "0"},
                        {"core_radiance", "3"},
                        {"branches", "2"}});
  // The trunk is broken into 64, each branch into 16; all shine alike where they are
  // dense.
  EXPECT_EQ(air.world().media.size(), 64u + 2 * 16u);
  for (const auto& m : air.world().media)
    EXPECT_NEAR(m.what.emission[0], 3 / (kRoot2Pi * 0.025), 1e-9);
}

TEST(LightningCore, APixelIsAsWideEverywhereInAnOrthographicView) {
  FrameInfo frame = frame_of(0.5);
  frame.projection = Projection::orthographic;
  ThroughAir air(frame);
  air.add("lightning", line({{-9, 0, 20}, {9, 0, 20}}, 0.2))
      .add("lightning", line({{-9, 5, 900}, {9, 5, 900}}, 0.2))
      .compile();
  const double L = 0.1 / std::hypot(0.1, 0.65 * 0.5);
  EXPECT_NEAR(air({{0, 0, 0}, {0, 0, 1}, kInf}).L[0], L, 1e-4 * L);
  EXPECT_NEAR(air({{0, 5, 0}, {0, 0, 1}, kInf}).L[0], L, 1e-4 * L);
}

}  // namespace
