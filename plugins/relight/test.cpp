// Facts about light on surfaces, asked of the product's own path: frames of geometry that
// is known, made pixel by pixel, against the laws at points.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <random>

#include "../../tests/pipeline/frames.h"
#include "../../tests/stage/generated.h"
#include "air/air.h"
#include "num/error.h"
#include "oracle.h"
#include "pipeline/impl.h"
#include "truth/truth.h"

namespace {

using namespace brume;
using glm::dvec3;
using relight::oracle::irradiance;
using relight::oracle::Lamp;
using OracleRgb = relight::oracle::Rgb;
using test::kInf;

// ---- frames ---------------------------------------------------------------------------

struct Hit {
  double t = 1e300;
  dvec3 n{0, 0, 1};  // unit, facing the eye
};
using Geometry = std::function<Hit(const dvec3& o, const dvec3& d)>;

Geometry plane(dvec3 at, dvec3 n) {
  n = glm::normalize(n);
  return [=](const dvec3& o, const dvec3& d) -> Hit {
    const double t = glm::dot(at - o, n) / glm::dot(d, n);
    if (!(t > 0)) return {};
    return {t, glm::dot(n, d) < 0 ? n : -n};
  };
}
Geometry sphere(dvec3 middle, double radius) {
  return [=](const dvec3& o, const dvec3& d) -> Hit {
    const dvec3 m = middle - o;
    const double b = glm::dot(m, d), q = b * b - glm::dot(m, m) + radius * radius;
    if (q < 0 || b - std::sqrt(q) <= 0) return {};
    const double t = b - std::sqrt(q);
    return {t, (o + t * d - middle) / radius};
  };
}
Geometry nearest(std::vector<Geometry> all) {
  return [=](const dvec3& o, const dvec3& d) {
    Hit best;
    for (const Geometry& g : all)
      if (const Hit h = g(o, d); h.t < best.t) best = h;
    return best;
  };
}

const std::string kLooksDown = R"(
[camera]
position = [0, 0, 4]
look_at = [0, 10, 1]
focal = 30
)";

struct Frame {
  int width = 96, height = 64;
  std::string camera = kLooksDown, head;  // head: before the camera
  std::optional<View> view = {};          // instead of it
  std::map<std::string, std::vector<float>> planes;
  std::vector<Hit> truth;
  std::vector<View::RayAt> rays;

  std::size_t at(int x, int y) const { return std::size_t(y * width + x); }
  dvec3 point(std::size_t i) const {
    return rays[i].origin + truth[i].t * rays[i].direction;
  }
  bool covered(std::size_t i) const { return truth[i].t < 1e300; }
};

class Relight : public testing::Test {
 protected:
  Registry registry;

  Frame frame_of(const Geometry& g, Frame f = {}) {
    FrameSource source = source_of(f);
    const SceneFile scene = test::scene_of(registry, f.head + f.camera);
    const auto view = f.view ? f.view : find_view(source.header, scene, 1, "test");
    for (int y = 0; y < f.height; ++y)
      for (int x = 0; x < f.width; ++x) {
        const View::RayAt r = view->ray(x + .5, y + .5);
        const Hit h = g(r.origin, r.direction);
        f.truth.push_back(h);
        f.rays.push_back(r);
        const bool there = h.t < 1e300;
        for (const char* c : {"R", "G", "B"}) f.planes[c].push_back(there ? .1f : 0.f);
        f.planes["A"].push_back(there);
        f.planes["Z"].push_back(there ? float(h.t * r.planar_per_distance) : 1e10f);
      }
    return f;
  }
  static FrameSource source_of(const Frame& f) {
    FrameSource s;
    s.frame = 1;
    s.name = "test";
    s.view = f.view;
    s.header.data_window = s.header.display_window = {0, 0, f.width, f.height};
    for (const char* c : {"A", "B", "G", "R", "Z"})
      s.header.channels.push_back({c, PixelType::float32});
    for (const auto& [name, values] : f.planes)
      if (s.header.find(name) < 0)
        s.header.channels.push_back({name, PixelType::float32});
    return s;
  }

  struct Out {
    std::map<std::string, std::vector<float>> planes;
    Plan plan;
    const std::vector<float>& operator[](const std::string& n) const {
      return planes.at(n);
    }
  };
  Out run(const Frame& f, const std::string& stages, Window part = {}) {
    if (part.empty()) part = {0, 0, f.width, f.height};
    Session session(test::scene_of(registry, f.head + f.camera + stages), registry);
    const PreparedFrame prepared = session.prepare(source_of(f));
    Out out;
    out.plan = prepared.plan();
    std::vector<PlaneIn> in;
    for (const InputChannel& c : prepared.inputs())
      in.push_back({f.planes.at(c.channel).data(), 1, f.width});
    std::vector<PlaneOut> to;
    for (const OutputChannel& c : prepared.outputs()) {
      auto& p = out.planes[c.channel.name];
      p.resize(std::size_t(part.pixels()));
      to.push_back({p.data(), 1, part.width});
    }
    FrameBuffers buffers;
    buffers.window = {0, 0, f.width, f.height};
    buffers.in = in;
    buffers.out = to;
    prepared.apply(buffers, part);
    return out;
  }
  // What the surfaces gained.
  double added(const Out& out, const Frame& f, const char* c, std::size_t i) {
    return double(out[c][i]) - double(f.planes.at(c)[i]);
  }
};

std::string number(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", x);
  return text;
}
std::string list(const dvec3& v) {
  return "[" + number(v.x) + ", " + number(v.y) + ", " + number(v.z) + "]";
}
std::string list(const OracleRgb& v) { return list(dvec3(v[0], v[1], v[2])); }

std::string stage_of(const Lamp& l, const std::string& name) {
  const bool spot = l.cone < 3.2;
  std::string s = "[[stage]]\ntype = \"" +
                  std::string(spot ? "spotlight" : "point_light") + "\"\nname = \"" +
                  name + "\"\nposition = " + list(l.position) +
                  "\npower = " + list(l.power) + "\nradius = " + number(l.radius) + "\n";
  if (spot)
    s += "direction = " + list(l.direction) + "\ncone = " + number(l.cone * 180 / M_PI) +
         "\ncone_soft = " + number(l.cone_soft * 180 / M_PI) + "\nfalloff = \"" +
         (l.ratio ? "ratio" : "smooth") + "\"\n";
  return s;
}
const std::string kRelight = "[[stage]]\ntype = \"relight\"\nalbedo = [0.2, 0.4, 0.8]\n";
const OracleRgb kAlbedo = {.2, .4, .8};
// Lamps that are too far away to matter are not left out where the tolerance is small.
const std::string kFine = "tolerance = 1e-4\n[output]\nwhite = 1e-3\n";

constexpr const char* kChannels[] = {"R", "G", "B"};

// ---- lamps ----------------------------------------------------------------------------

TEST_F(Relight, APlaneIsLitAsLambertSays) {
  // Normals and points from depth: 1e-7 of the distance each, over a pixel of 1e-2 rad:
  // 4e-5 rad, and that much of E's change with angle, here less than 10 E / rad.
  const Geometry tilted = plane({0, 12, 0}, {.2, -.3, 1});
  Frame f = frame_of(tilted, {.head = kFine});
  const Lamp lamp = {{1, 9, 3}, {5, 3, 2}, 0};
  const Out out = run(f, kRelight + stage_of(lamp, "a"));
  int pixels = 0;
  for (std::size_t i = 0; i < f.truth.size(); ++i) {
    if (!f.covered(i)) continue;
    const auto E = irradiance(lamp, f.point(i), f.truth[i].n, {});
    for (std::size_t c = 0; c < 3; ++c) {
      const double want = kAlbedo[c] / M_PI * E[c];
      ASSERT_NEAR(added(out, f, kChannels[c], i), want, 4e-4 * want + 1e-7) << i;
    }
    ++pixels;
  }
  EXPECT_GT(pixels, 3000);
}

TEST_F(Relight, ColouredFogDimsTheLampOnItsWayToTheSurface) {
  // C = T (C0 + rho/pi E e^(-sigma r)): the fog before the surface, too, is exact.
  Frame f = frame_of(plane({0, 0, 0}, {0, 0, 1}), {.head = kFine});
  const OracleRgb sigma = {.05, .2, .8};
  const Lamp lamp = {{1, 9, 3}, {5, 3, 2}, .1};
  const Out out = run(f, kRelight + stage_of(lamp, "a") +
                             "[[stage]]\ntype = \"height_fog\"\nfalloff = 0\ncolor = "
                             "0\ndensity = " +
                             list(sigma) + "\n");
  for (std::size_t i = 0; i < f.truth.size(); ++i) {
    if (!f.covered(i)) continue;
    const auto E = irradiance(lamp, f.point(i), f.truth[i].n, sigma);
    for (std::size_t c = 0; c < 3; ++c) {
      const double T = std::exp(-sigma[c] * f.truth[i].t);
      const double want = T * (.1 + kAlbedo[c] / M_PI * E[c]);
      ASSERT_NEAR(out[kChannels[c]][i], want, 4e-4 * want + 1e-7) << i;
    }
  }
}

TEST_F(Relight, FogThatThinsWithHeightDimsItAsTheTruthSays) {
  Frame f = frame_of(plane({0, 0, 0}, {0, 0, 1}));
  const Lamp lamp = {{1, 9, 3}, {5, 3, 2}, .1};
  const std::string scene = kRelight + stage_of(lamp, "a") +
                            "[[stage]]\ntype = \"height_fog\"\ncolor = 0\ndensity = "
                            "[0.1, 0.3, 2]\nfalloff = 0.7\n"
                            "[[stage]]\ntype = \"fog_volume\"\ncenter = [0, 8, 1]\nhalf "
                            "= [1, 2, 1]\ndensity = 0.5\ncolor = 0\n";
  const Out out = run(f, "[output]\naovs = [\"S\"]\nwhite = 1e-3\n" + scene);
  Session session(test::scene_of(registry, f.camera + scene), registry);
  const PreparedFrame prepared = session.prepare(source_of(f));
  World dark = prepared.impl().world;
  dark.lights.clear();
  for (int y = 20; y < f.height; y += 7)
    for (int x = 3; x < f.width; x += 11) {
      const std::size_t i = f.at(x, y);
      const dvec3 at = f.point(i), way = lamp.position - at;
      const auto E = irradiance(lamp, at, f.truth[i].n, {});
      const auto T = truth::along(dark, at, glm::normalize(way), glm::length(way), {}).T;
      for (std::size_t c = 0; c < 3; ++c) {
        const double want = .1 + kAlbedo[c] / M_PI * E[c] * T[int(c)];
        ASSERT_NEAR(out[std::string("S.") + kChannels[c]][i], want, 4e-4 * want) << i;
      }
    }
}

TEST_F(Relight, SpotlightsHaveTheirConesToTheEdge) {
  Frame f = frame_of(plane({0, 0, 0}, {0, 0, 1}), {.head = kFine});
  for (const double cone : {10., 45., 90.})
    for (const bool ratio : {false, true}) {
      const Lamp lamp = {{.5, 9, 3},        {8, 8, 8},      0,    {.3, -.2, -1},
                         cone * M_PI / 180, 8 * M_PI / 180, ratio};
      const Out out = run(f, kRelight + stage_of(lamp, "a"));
      int dark = 0, lit = 0;
      for (std::size_t i = 0; i < f.truth.size(); ++i) {
        if (!f.covered(i)) continue;
        const double E = irradiance(lamp, f.point(i), f.truth[i].n, {})[1];
        const double got = added(out, f, "G", i), want = .4 / M_PI * E;
        if (E == 0) EXPECT_EQ(got, 0) << i;
        // At the edge: positions to 3e-6 m, an edge over 8 degrees.
        ASSERT_NEAR(got, want, 4e-4 * want + 2e-5) << i << ", cone " << cone;
        (E > 0 ? lit : dark)++;
      }
      EXPECT_GT(lit, 30);
      if (cone < 90) EXPECT_GT(dark, 100);
    }
}

TEST_F(Relight, WhatFacesAwayGetsNothing) {
  // A lamp under the plane, and one behind a sphere: the terminator.
  Frame below = frame_of(plane({0, 0, 0}, {0, 0, 1}), {.head = kFine});
  const Out dark = run(below, kRelight + stage_of({{0, 9, -1}, {50, 50, 50}}, "a"));
  for (std::size_t i = 0; i < below.truth.size(); ++i)
    ASSERT_EQ(dark["R"][i], below.planes["R"][i]);

  Frame ball = frame_of(sphere({0, 10, 2}, 2), {.head = kFine});
  const Lamp lamp = {{9, 9, 6}, {90, 90, 90}};
  const Out out = run(ball, kRelight + stage_of(lamp, "a"));
  int lit = 0, unlit = 0;
  for (std::size_t i = 0; i < ball.truth.size(); ++i) {
    if (!ball.covered(i)) continue;
    const double mu =
        glm::dot(glm::normalize(lamp.position - ball.point(i)), ball.truth[i].n);
    // Normals of this ball are off by less than .05 (NormalsOfASphere).
    unlit += mu < -.05;
    lit += mu > .05;
    if (mu < -.05) EXPECT_EQ(added(out, ball, "R", i), 0);
    if (mu > .05) EXPECT_GT(added(out, ball, "R", i), 0);
  }
  EXPECT_GT(lit, 100);
  EXPECT_GT(unlit, 100);
}

TEST_F(Relight, ALampAtThePixelIsFinite) {
  Frame f = frame_of(plane({0, 0, 0}, {0, 0, 1}), {.head = kFine});
  const std::size_t i = f.at(50, 40);
  const dvec3 x = f.point(i);
  for (const double height : {0., 1e-7, 1e-4}) {
    const Out out =
        run(f, kRelight + stage_of({x + dvec3(0, 0, height), {1, 1, 1}}, "a"));
    for (const char* c : kChannels)
      for (const float v : out[c]) ASSERT_TRUE(std::isfinite(v));
    // No more than from half a pixel away.
    const double half = f.truth[i].t * .5 / 90;  // 64 rows of 35 degrees
    EXPECT_LE(added(out, f, "G", i), .4 / M_PI / (half * half));
  }
  // With a radius it is the lamp's own.
  const Lamp round = {x + dvec3(0, 0, .2), {1, 1, 1}, .5};
  const Out out = run(f, kRelight + stage_of(round, "a"));
  EXPECT_NEAR(added(out, f, "G", i), .4 / M_PI / .25, 1e-3);
}

TEST_F(Relight, ALampBehindTheCameraLightsWhatItSees) {
  Frame f = frame_of(plane({0, 20, 0}, {0, -1, 0}), {.head = kFine});
  const Lamp lamp = {{0, -5, 6}, {900, 900, 900}};
  const Out out = run(f, kRelight + stage_of(lamp, "a"));
  for (std::size_t i = 0; i < f.truth.size(); i += 97) {
    if (!f.covered(i)) continue;
    const double want = .4 / M_PI * irradiance(lamp, f.point(i), f.truth[i].n, {})[1];
    ASSERT_NEAR(added(out, f, "G", i), want, 4e-4 * want);
  }
}

TEST_F(Relight, LightsAddUpInAnyOrder) {
  Frame f = frame_of(nearest({plane({0, 0, 0}, {0, 0, 1}), sphere({1, 9, 1}, 1)}),
                     {.head = kFine});
  std::mt19937 random(7);
  std::uniform_real_distribution<double> u(-5, 5);
  std::vector<std::string> lamps;
  std::vector<Out> alone;
  for (int k = 0; k < 12; ++k) {
    lamps.push_back(stage_of({{u(random), 9 + u(random), 5.5 + u(random)}, {1, 2, 3}},
                             "l" + std::to_string(k)));
    alone.push_back(run(f, kRelight + lamps.back()));
  }
  std::string up = kRelight, down;
  for (const auto& l : lamps) up += l, down = l + down;
  const Out a = run(f, up), b = run(f, down + kRelight);
  for (std::size_t i = 0; i < f.truth.size(); ++i) {
    double sum = 0;
    for (const Out& one : alone) sum += added(one, f, "B", i);
    // 12 roundings of 0.1 + ..., and the cutoff's 1e-8.
    ASSERT_NEAR(added(a, f, "B", i), sum, 3e-7 * (1 + sum) * 12);
    for (const char* c : kChannels)
      ASSERT_EQ(std::bit_cast<std::uint32_t>(a[c][i]),
                std::bit_cast<std::uint32_t>(b[c][i]));
  }
}

TEST_F(Relight, WhatDistantLampsAreLeftOutIsATenthOfTheTolerance) {
  Frame f = frame_of(plane({0, 0, 0}, {0, 0, 1}));
  std::string lamps;
  for (int k = 0; k < 30; ++k)
    lamps += stage_of({{k * 4. - 60, 10. + 3 * k, 2}, {.02, .02, .02}},
                      "l" + std::to_string(k));
  const Out fast = run(f, kRelight + lamps);
  Frame exact = f;
  exact.head = kFine;
  const Out all = run(exact, kRelight + lamps);
  double worst = 0;
  for (std::size_t i = 0; i < f.truth.size(); ++i)
    worst = std::max(worst, double(std::abs(all["B"][i] - fast["B"][i])));
  EXPECT_GT(worst, 0) << "nothing was left out";
  EXPECT_LE(worst, 1e-4);  // a tenth of 1e-3 x white
}

// ---- normals --------------------------------------------------------------------------

// The largest angle between the normals that the stage takes and the true ones, told by
// three suns along the axes [rad]; of pixels for which `counts`.
double worst_normal(const std::function<std::optional<dvec3>(std::size_t)>& taken,
                    const Frame& f, const std::function<bool(std::size_t)>& counts) {
  double worst = 0;
  for (std::size_t i = 0; i < f.truth.size(); ++i) {
    if (!f.covered(i) || !counts(i)) continue;
    const auto n = taken(i);
    if (!n) continue;
    worst = std::max(worst, std::acos(std::clamp(glm::dot(*n, f.truth[i].n), -1., 1.)));
  }
  return worst;
}

class Normals : public Relight {
 protected:
  // Six suns, one along each axis both ways: E_+ - E_- is the normal's component.
  std::vector<dvec3> normals(const Frame& f, const std::string& more = "") {
    std::vector<dvec3> n(f.truth.size());
    for (int axis = 0; axis < 3; ++axis)
      for (const double sign : {1., -1.}) {
        dvec3 d(0);
        d[axis] = -sign;
        const Out out = run(
            f, "[[stage]]\ntype = \"relight\"\nlamps = false\nsun = true\nalbedo = 1\n" +
                   more + "[[stage]]\ntype = \"sun_light\"\ndirection = " + list(d) +
                   "\n");
        for (std::size_t i = 0; i < n.size(); ++i)
          if (f.covered(i)) n[i][axis] += sign * M_PI * added(out, f, "R", i);
      }
    for (dvec3& v : n)
      if (glm::length(v) > 0) v = glm::normalize(v);
    return n;
  }
  double worst(const Frame& f, const std::function<bool(std::size_t)>& counts,
               const std::string& more = "") {
    const auto n = normals(f, more);
    return worst_normal([&](std::size_t i) { return std::optional(n[i]); }, f, counts);
  }
  static bool everywhere(std::size_t) { return true; }
};

TEST_F(Normals, OfPlanesAreExactInEveryProjection) {
  // Rounding alone: directions to 2e-7 over pixels of 7e-3 to 7e-2 rad; E of the suns to
  // 1e-7 of 1.1.
  const Geometry room =
      nearest({plane({0, 0, 0}, {.1, .05, 1}), plane({0, 14, 0}, {.2, -1, 0})});
  const Frame perspective = frame_of(room);
  // Where both meet, too: three pixels on one side always are, but at the frame's border.
  const auto within = [](std::size_t i) { return i % 96 >= 2 && i % 96 < 94; };
  EXPECT_LT(worst(perspective, within), 3e-4);

  View view = *find_view(source_of(perspective).header,
                         test::scene_of(registry, perspective.camera), 1, "test");
  view.projection = Projection::orthographic;
  view.across = .1 * view.right;
  view.down = -.1 * view.up;
  view.corner = -48. * view.across - 32. * view.down;
  const Frame ortho = frame_of(room, {.view = view});
  EXPECT_LT(worst(ortho, everywhere), 3e-4);

  // All around: pixels of 4 degrees, between which a row's rays bend.
  view.projection = Projection::latlong;
  view.corner = {-.5, .25, 0};  // turns
  view.across = {1. / 96, 0, 0};
  view.down = {0, -.5 / 64, 0};
  const Frame latlong =
      frame_of(plane({0, 0, 0}, {.1, .05, 1}),
               {.head = "[input]\ndepth_kind = \"distance\"\n", .view = view});
  EXPECT_LT(worst(latlong, [&](std::size_t i) { return latlong.truth[i].t < 40; }), 2e-3);
}

TEST_F(Normals, OfASphere) {
  // A central difference of h over the slope of a ball of radius R, seen under the angle
  // theta, is off by (h/R)^2 sin/(2 cos^3) [rad]; one to the side by twice as much.
  const Frame f = frame_of(sphere({0, 10, 2}, 2));
  const double h = 10.2 * 36 / 30 / 96;
  const auto n = normals(f);
  double most = 0;
  for (std::size_t i = 0; i < n.size(); ++i) {
    if (!f.covered(i)) continue;
    const double cosine = -glm::dot(f.truth[i].n, f.rays[i].direction),
                 sine = std::sqrt(1 - cosine * cosine),
                 off = std::acos(std::min(glm::dot(n[i], f.truth[i].n), 1.));
    most = std::max(most, off);
    if (cosine > .3)
      EXPECT_LT(off, h * h / 4 * sine / (cosine * cosine * cosine) + 3e-4) << cosine;
  }
  // At the silhouette, pixels whose surface turns away within them.
  EXPECT_LT(most, .5);
}

TEST_F(Normals, HaveNoHaloAtSilhouettes) {
  // A card and a ball before a wall and the ground: every pixel has the normal of its own
  // thing, those along the edges too.
  const Geometry card = [](const dvec3& o, const dvec3& d) -> Hit {
    Hit h = plane({0, 8, 0}, {.3, -1, .2})(o, d);
    const dvec3 x = o + h.t * d;
    return h.t < 1e300 && std::abs(x.x + 1) < .8 && std::abs(x.z - 2) < .7 ? h : Hit{};
  };
  const Frame f = frame_of(
      nearest({card, plane({0, 16, 0}, {.1, -1, 0}), plane({0, 0, 0}, {0, 0, 1})}));
  // Those apart that are alone in their row or column.
  const auto alike = [&](int x, int y, std::size_t i) {
    return x >= 0 && y >= 0 && x < f.width && y < f.height &&
           glm::length(f.truth[f.at(x, y)].n - f.truth[i].n) < 1e-6;
  };
  const auto accompanied = [&](std::size_t i) {
    const int x = int(i) % f.width, y = int(i) / f.width;
    return (alike(x - 1, y, i) || alike(x + 1, y, i)) &&
           (alike(x, y - 1, i) || alike(x, y + 1, i));
  };
  EXPECT_LT(worst(f, accompanied), 1e-3);
}

TEST_F(Normals, OfThinThingsFaceTheEye) {
  // A wire of one pixel before the background, and one before a wall.
  Frame f = frame_of(plane({0, 12, 0}, {0, -1, 0}));
  for (int y = 0; y < f.height; ++y) f.planes["Z"][f.at(30, y)] = 5.f + 0.01f * float(y);
  const auto n = normals(f);
  for (int y = 3; y < f.height - 3; ++y) {
    const std::size_t i = f.at(30, y);
    EXPECT_GT(-glm::dot(n[i], f.rays[i].direction), .6) << y;
    // and its neighbours are the wall's.
    EXPECT_GT(n[f.at(29, y)].y, -1.0001);
    EXPECT_LT(n[f.at(29, y)].y, -.999);
    EXPECT_LT(n[f.at(31, y)].y, -.999);
  }
}

TEST_F(Normals, OfAFilteredEdgeAreOneSidesOrTheOthers) {
  // Depth resolved over two samples: a pixel half way between card and wall is neither;
  // it must not look like a face between them.
  Frame f = frame_of(plane({0, 12, 0}, {0, -1, 0}));
  for (int y = 0; y < f.height; ++y)
    for (int x = 0; x <= 40; ++x) f.planes["Z"][f.at(x, y)] *= x == 40 ? .75f : .5f;
  const auto n = normals(f);
  for (int y = 3; y < f.height - 3; ++y)
    for (int x = 37; x <= 43; ++x) EXPECT_LT(n[f.at(x, y)].y, -.99) << x << " " << y;
}

TEST_F(Normals, OfCoveredPixelsWithoutDepthAreTheirNeighbours) {
  const Geometry ball = sphere({0, 10, 2}, 2);
  Frame f = frame_of(ball);
  // The outermost pixels lose their depth and half of their coverage, as in a frame whose
  // depth is not filtered.
  std::vector<std::size_t> edge;
  for (int y = 1; y + 1 < f.height; ++y)
    for (int x = 1; x + 1 < f.width; ++x)
      if (f.covered(f.at(x, y)) &&
          !(f.covered(f.at(x - 1, y)) && f.covered(f.at(x + 1, y)) &&
            f.covered(f.at(x, y - 1)) && f.covered(f.at(x, y + 1))))
        edge.push_back(f.at(x, y));
  for (const std::size_t i : edge) f.planes["Z"][i] = 1e10f, f.planes["A"][i] = .5f;
  Frame half = f;
  const auto n = normals(half);
  for (const std::size_t i : edge)
    EXPECT_GT(glm::dot(n[i], f.truth[i].n), .5) << i;  // pixels of 4 degrees and more
}

TEST_F(Normals, ComeFromALayerWhereThereIsOne) {
  Frame f = frame_of(sphere({0, 10, 2}, 2));
  for (std::size_t i = 0; i < f.truth.size(); ++i)
    for (int k = 0; k < 3; ++k)
      f.planes["ViewLayer.Normal." + std::string(1, "XYZ"[k])].push_back(
          f.covered(i) ? 3 * float(f.truth[i].n[k]) : std::nanf(""));
  EXPECT_LT(worst(f, everywhere), 1e-6 + 2e-7 * 10);
  EXPECT_GT(worst(f, everywhere, "normals = \"none\"\n"), 1e-4) << "those of the depth";
  const Out out = run(f, kRelight + stage_of({{3, 5, 5}, {9, 9, 9}}, "a"));
  EXPECT_EQ(out.plan.stages[0].reads.size(), 3u);

  // In the camera's axes.
  const SceneFile scene = test::scene_of(registry, f.camera);
  const auto view = find_view(source_of(f).header, scene, 1, "test");
  Frame turned = f;
  for (std::size_t i = 0; i < f.truth.size(); ++i) {
    const dvec3 n = f.truth[i].n;
    const double v[3] = {glm::dot(n, view->right), glm::dot(n, view->up),
                         -glm::dot(n, view->forward)};
    for (int k = 0; k < 3; ++k)
      turned.planes["ViewLayer.Normal." + std::string(1, "XYZ"[k])][i] = float(v[k]);
  }
  EXPECT_LT(worst(turned, everywhere, "normal_space = \"camera\"\n"), 3e-6);
}

// ---- sun and sky
// ------------------------------------------------------------------------

TEST_F(Relight, SkyLightIsTheHemisphereAboutTheNormal) {
  Frame f = frame_of(nearest({sphere({0, 10, 2}, 2), plane({0, 0, 0}, {0, 0, 1})}));
  for (std::size_t i = 0; i < f.truth.size(); ++i)
    for (int k = 0; k < 3; ++k)
      f.planes["N." + std::string(1, "XYZ"[k])].push_back(float(f.truth[i].n[k]));
  for (const double elevation : {50., 4.}) {
    const std::string sky = "[sun]\nelevation = " + number(elevation) +
                            "\nazimuth = 200\n[[stage]]\ntype = \"sky\"\n";
    const std::string scene =
        "[output]\naovs = [\"S\"]\n[[stage]]\ntype = \"relight\"\nlamps = false\nsky = "
        "true\nalbedo = 1\n";
    const Out out = run(f, scene + sky);
    Session session(test::scene_of(registry, f.camera + scene + sky), registry);
    const PreparedFrame prepared = session.prepare(source_of(f));
    const auto& lights = prepared.impl().world.lights;
    const auto light = std::ranges::find_if(
        lights, [](const auto& l) { return l.what.kind == BRUME_SKY_LIGHT; });
    ASSERT_NE(light, lights.end());
    const auto radiance = [&](const dvec3& d) {
      const float v[3] = {float(d.x), float(d.y), float(d.z)};
      const brume_rays one = {1, nullptr, nullptr, nullptr, v, v + 1, v + 2};
      float L[3];
      light->what.radiance(light->what.self, &one, L, L + 1, L + 2);
      return OracleRgb{L[0], L[1], L[2]};
    };
    std::vector<std::size_t> pixels;
    std::vector<dvec3> normals;
    for (int y = 8; y < f.height; y += 8)
      for (int x = 24; x < 72; x += 6)
        if (f.covered(f.at(x, y))) {
          pixels.push_back(f.at(x, y));
          normals.push_back(f.truth[pixels.back()].n);
        }
    const auto E = irradiance(radiance, normals);
    double brightest = 0, worst = 0;
    for (std::size_t k = 0; k < pixels.size(); ++k)
      for (std::size_t c = 0; c < 3; ++c) {
        const double got = out[std::string("S.") + kChannels[c]][pixels[k]] - .1;
        brightest = std::max(brightest, E[k][c]);
        worst = std::max(worst, std::abs(M_PI * got - E[k][c]));
      }
    std::printf("sky, sun at %g degrees: off by %.1e of the brightest\n", elevation,
                worst / brightest);
    EXPECT_LT(worst / brightest, elevation > 10 ? 2e-3 : 8e-3);  // README, "Error"
  }
}

TEST_F(Relight, SunAndSkyAreLeftAloneUnlessAsked) {
  Frame f = frame_of(plane({0, 0, 0}, {0, 0, 1}));
  const std::string sun =
      "[[stage]]\ntype = \"sun_light\"\ndirection = [0, 1, -1]\nirradiance = 2\n";
  const Out idle = run(f, kRelight + sun);
  EXPECT_FALSE(idle.plan.stages[0].runs);
  EXPECT_EQ(idle.plan.stages[0].reason, "no lights: the scene has no lamp");
  EXPECT_TRUE(idle.plan.changes_nothing);
  const Out out = run(f, kRelight + "sun = true\n" + sun);
  for (std::size_t i = 0; i < f.truth.size(); ++i)
    if (f.covered(i))
      ASSERT_NEAR(added(out, f, "B", i), .8 / M_PI * 2 * std::sqrt(.5), 3e-4);
}

// ---- what it is for surfaces
// ------------------------------------------------------------

TEST_F(Relight, AlbedoComesFromItsLayerPremultiplied) {
  Frame f = frame_of(plane({0, 0, 0}, {0, 0, 1}), {.head = kFine});
  for (std::size_t i = 0; i < f.truth.size(); ++i) {
    f.planes["A"][i] *= i % 3 ? 1.f : .5f;
    for (const char* c : {"albedo.R", "albedo.G", "albedo.B"})
      f.planes[c].push_back(i % 7 == 0   ? std::nanf("")
                            : i % 7 == 1 ? 2.f  // more than all
                                         : .3f * f.planes["A"][i]);
  }
  const Lamp lamp = {{1, 9, 3}, {5, 5, 5}};
  const std::string light = stage_of(lamp, "a");
  const Out layer = run(f, kRelight + light);
  const Out plain = run(f, kRelight + "albedo_layer = \"none\"\n" + light);
  const Out own = run(f,
                      "[[stage]]\ntype = \"relight\"\nalbedo_layer = \"none\"\nalbedo = "
                      "\"color\"\n" +
                          light);
  for (std::size_t i = 0; i < f.truth.size(); ++i) {
    if (!f.covered(i)) continue;
    const double a = double(f.planes["A"][i]),
                 E = irradiance(lamp, f.point(i), f.truth[i].n, {})[0];
    const double rho = i % 7 == 0 ? 0 : i % 7 == 1 ? a : .3 * a;
    ASSERT_NEAR(added(layer, f, "R", i), rho / M_PI * E, 4e-4 * E + 1e-7);
    ASSERT_NEAR(added(plain, f, "R", i), a * .2 / M_PI * E, 4e-4 * E + 1e-7);
    ASSERT_NEAR(added(own, f, "R", i), .1 / M_PI * E, 4e-4 * E + 1e-7);
  }
}

TEST_F(Relight, BackgroundIsNotLit) {
  Frame f = frame_of(sphere({0, 10, 2}, 2), {.head = kFine});
  const std::string light = stage_of({{0, 4, 4}, {90, 90, 90}}, "a");
  const Out out = run(f, kRelight + light);
  // A plate's pixels at infinity are no surface, wherever the air takes them to be.
  Frame plate = f;
  plate.head += "[input]\nbackground = \"plate\"\nbackground_distance = 30\n";
  const Out before_plate = run(plate, kRelight + light);
  int there = 0;
  for (std::size_t i = 0; i < f.truth.size(); ++i) {
    if (f.covered(i)) {
      there += added(before_plate, f, "R", i) > 0;
      EXPECT_EQ(before_plate["R"][i], out["R"][i]);
      continue;
    }
    EXPECT_EQ(out["R"][i], 0);
    EXPECT_EQ(before_plate["R"][i], 0);
  }
  EXPECT_GT(there, 200);
}

TEST_F(Relight, HasNothingToDoWithout) {
  Frame f = frame_of(plane({0, 0, 0}, {0, 0, 1}));
  const std::string lamp = stage_of({{0, 9, 3}}, "a");
  const auto reason = [&](const std::string& scene) {
    return run(f, scene).plan.stages[0].reason;
  };
  EXPECT_EQ(reason(kRelight), "no lights: the scene has no lamp");
  EXPECT_EQ(reason("[[stage]]\ntype = \"relight\"\nalbedo = 0\n" + lamp), "albedo is 0");
  EXPECT_EQ(reason(kRelight + "lamps = false\n" + lamp), "lamps, sun and sky are off");
  EXPECT_EQ(reason(kRelight + "[[stage]]\ntype = \"point_light\"\npower = 0\n"),
            "no lights: the scene has no lamp");
  EXPECT_EQ(reason(kRelight + lamp), "on the surface");
  f.camera.clear();
  try {
    run(f, kRelight + lamp);
    FAIL() << "without a camera";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("no camera, and relight needs"),
              std::string::npos)
        << e.what();
  }
}

TEST_F(Relight, ALayerThatIsNotThereIsAnError) {
  Frame f = frame_of(plane({0, 0, 0}, {0, 0, 1}));
  EXPECT_THROW(run(f, kRelight + "normals = \"Nx\"\n" + stage_of({{0, 9, 3}}, "a")),
               Error);
}

TEST_F(Relight, PixelsAreTheSameHoweverCut) {
  // More columns than a run, edges without depth, fog.
  Frame f = frame_of(nearest({sphere({0, 10, 2}, 2), sphere({3, 8, 3}, 1)}),
                     {.width = 600, .height = 24});
  std::mt19937 random(3);
  for (std::size_t i = 0; i < f.truth.size(); ++i)
    if (random() % 5 == 0 && f.covered(i))
      f.planes["Z"][i] = kInf, f.planes["A"][i] = .4f;
  const std::string scene = kRelight + stage_of({{2, 5, 6}, {9, 9, 9}}, "a") +
                            "[[stage]]\ntype = \"height_fog\"\ndensity = 0.01\n";
  const Out whole = run(f, scene);
  for (const Window& w : {Window{0, 0, 300, 5}, Window{250, 7, 40, 10},
                          Window{511, 0, 89, 24}, Window{299, 12, 1, 1}}) {
    const Out part = run(f, scene, w);
    for (const char* c : kChannels)
      for (int y = 0; y < w.height; ++y)
        for (int x = 0; x < w.width; ++x)
          ASSERT_EQ(part[c][std::size_t(y * w.width + x)],
                    whole[c][f.at(w.x + x, w.y + y)])
              << w.x + x << ", " << w.y + y;
  }
}

TEST(RelightReadme, ListsItsParameters) {
  Registry registry;
  test::expect_generated("plugins/relight/README.md", "parameters",
                         markdown_table(registry.specs("relight")));
}

}  // namespace
