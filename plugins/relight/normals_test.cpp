// Normals that the stage takes, against those of the geometry.

#include <gtest/gtest.h>

#include <algorithm>

#include "frames_test.h"

namespace {

using namespace relight::test;

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
                         brume::test::scene_of(registry, perspective.camera), 1, "test");
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
    if (cosine > .3) {
      EXPECT_LT(off, h * h / 4 * sine / (cosine * cosine * cosine) + 3e-4) << cosine;
    }
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
  const SceneFile scene = brume::test::scene_of(registry, f.camera);
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

}  // namespace
