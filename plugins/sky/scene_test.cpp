// The sky in scenes: with fog, with its own sun, before terrain; what a frame's pixels
// become.

#include <gtest/gtest.h>

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "../../tests/pipeline/frames.h"
#include "../../tests/stage/generated.h"
#include "image/io.h"
#include "num/error.h"
#include "params/document.h"
#include "truth/frame.h"
#include "truth/truth.h"

namespace brume::test {
namespace {

constexpr double kR = 6360e3;

// A column of pixels around the horizon, one below the other, seen from h metres over a
// black planet without relief; 2e-5 rad each, the horizon between two of them.
struct Column {
  int width, height = 200;
  double h;
  double pitch = 2e-5;

  double dip() const { return std::acos(kR / (kR + h)); }
  // Elevation of row y [rad].
  double elevation(int y) const { return (height / 2. - .5 - y) * pitch - dip(); }

  Pixels pixels() const {
    Pixels p;
    p.window = {0, 0, width, height};
    for (int y = 0; y < height; ++y) {
      const double e = elevation(y), b = (kR + h) * std::sin(e), c = h * (2 * kR + h);
      const bool ground = y >= height / 2;
      // Along the camera's axis, which is what Z means; the camera looks at the horizon.
      const double t = ground ? c / (std::sqrt(std::max(b * b - c, 0.)) - b) : 0;
      for (int x = 0; x < width; ++x) {
        p.a.push_back(ground), p.z.push_back(ground ? float(t) : kInf);
        p.r.push_back(0), p.g.push_back(0), p.b.push_back(0);
      }
    }
    return p;
  }

  std::string camera() const {
    char text[300];
    std::snprintf(text, sizeof text,
                  "[camera]\nposition = [0, 0, %.9g]\nlook_at = [0, %.17g, %.17g]\n"
                  "focal = %.9g\naperture_width = 0.36\n",
                  h, 1e6 * std::cos(dip()), h - 1e6 * std::sin(dip()),
                  0.36 / (width * pitch));
    return text;
  }

  // The middle column's colours.
  std::vector<std::array<double, 3>> see(Registry& registry,
                                         const std::string& scene) const {
    const Pixels p = pixels();
    Session session(scene_of(registry, scene + camera()), registry);
    const Window display{0, 0, width, height};
    const Result r = apply_whole(session.prepare(source_of(p, display)), p, display);
    std::vector<std::array<double, 3>> out;
    for (int y = 0; y < height; ++y) {
      const auto i = std::size_t(y * width + width / 2);
      out.push_back({r["R"][i], r["G"][i], r["B"][i]});
    }
    return out;
  }
};

std::string sky(double elevation, double azimuth, const char* more = "") {
  char text[400];
  std::snprintf(text, sizeof text,
                "[sun]\nelevation = %.17g\nazimuth = %.17g\n[[stage]]\ntype = \"sky\"\n"
                "conversion = \"none\"\n%s\n",
                elevation, azimuth, more);
  return text;
}

double step(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  double worst = 0;
  for (int c = 0; c < 3; ++c)
    worst = std::max(worst, std::abs(a[c] - b[c]) / std::max(std::abs(a[c]), 1e-9));
  return worst;
}

TEST(Scene, ThickFogHidesTheHorizon) {
  Registry registry;
  const Column column{65, 200, 50};
  for (double sun : {2., 40.}) {
    const auto seen = column.see(
        registry, sky(sun, 30) +
                      "[[stage]]\ntype = \"height_fog\"\ndensity = 0.005\nfalloff = "
                      "0.005\ncolor = \"sky\"\n");
    double worst = 0;
    for (int y = 1; y < column.height; ++y)
      worst = std::max(worst, step(seen[y - 1], seen[y]));
    std::printf("sun %g: largest step between rows %.1e\n", sun, worst);
    // Optical depth to the horizon, 25 km away: 90. What is left to see is fog on both
    // sides, and steps are held to a tenth of the tolerance, 1e-3.
    EXPECT_LE(worst, 1e-4);
    // Lit by the sky around, it is as bright as the sky above it, to a factor.
    EXPECT_GT(seen[0][1], .2 * seen[column.height - 1][1]);
  }
}

TEST(Scene, FogInTheAirIsWhatTheTruthSays) {
  // Fog and air in one place: neither may be laid over the other, and each dims the other
  // by its own colour.
  Registry registry;
  Column column{65, 60, 50};
  column.pitch = 3e-3;
  const std::string scene =
      sky(12, 30) + column.camera() +
      "[[stage]]\ntype = \"height_fog\"\ndensity = [0.0001, 0.0002, 0.0003]\n"
      "falloff = 0.002\ncolor = \"sky\"\ng = 0.5\n[output]\nwhite = 0.1\n";
  const Pixels p = column.pixels();
  Image image;
  const Window display{0, 0, column.width, column.height};
  image.header = source_of(p, display).header;
  for (Channel& c : image.header.channels) {
    c.type = PixelType::float32;
    image.planes.push_back(plane_of(p, c.name));
  }
  const std::string file =
      testing::TempDir() + "brume_sky_" + std::to_string(getpid()) + ".exr";
  write_image(image, file);
  const Session session(scene_of(registry, scene), registry);
  const truth::Frame frame(session, 1, file);
  const auto seen = frame.product();
  const auto& outputs = frame.prepared().outputs();
  double worst = 0;
  for (int y : {2, 20, 27, 29, 30, 31, 35, 45, 58}) {
    const truth::Pixel truth = frame.pixel(32, y, {.tolerance = 1e-5, .white = .1});
    for (std::size_t k = 0; k < outputs.size(); ++k) {
      const int c = outputs[k].channel.name == "R"   ? 0
                    : outputs[k].channel.name == "G" ? 1
                    : outputs[k].channel.name == "B" ? 2
                                                     : 3;
      if (c == 3) continue;
      const double got = seen[k][std::size_t(y * column.width + 32)];
      worst = std::max(worst, std::abs(got - truth.C[c]) / truth.C[c]);
    }
  }
  std::filesystem::remove(file);
  std::printf("fog in the air, against the truth: %.2e\n", worst);
  EXPECT_LE(worst, .00375);  // a quarter of aerial perspective's 1.5 %
}

TEST(Scene, ItsReadmeIsFresh) {
  Registry registry;
  expect_generated("plugins/sky/README.md", "parameters",
                   markdown_table(registry.specs("sky")));
}

TEST(Scene, AerialPerspectiveStepsAtTheHorizonAsItsRaysDo) {
  Registry registry;
  for (double h : {50., 3000.})
    for (double sun : {2., 40.}) {
      // A frame of few pixels is answered ray by ray, a larger one from tables.
      const auto truth = Column{1, 200, h}.see(registry, sky(sun, 30)),
                 seen = Column{65, 200, h}.see(registry, sky(sun, 30));
      double worst = 0, smooth = 0, off = 0;
      for (int y = 0; y < 200; ++y) {
        off = std::max(off, step(truth[y], seen[y]));
        if (y == 0) continue;
        const double of_rays = step(truth[y - 1], truth[y]),
                     of_frame = step(seen[y - 1], seen[y]);
        (y == 100 ? worst : smooth) =
            std::max(y == 100 ? worst : smooth, std::abs(of_frame - of_rays));
      }
      std::printf(
          "eye %4.0f m, sun %2.0f: step at the horizon %.4f (rays %.4f), beside it "
          "steps differ by %.1e, colours by %.1e\n",
          h, sun, step(seen[99], seen[100]), step(truth[99], truth[100]), smooth, off);
      EXPECT_LE(worst, .00375);  // a quarter of aerial perspective's 1.5 %
      EXPECT_LE(smooth, .00375);
      EXPECT_LE(off, .00375);
    }
}

TEST(Scene, BackgroundReceivesTheSkyOnceAndTheDiscBehindIt) {
  // Looking straight into the sun 30 degrees high, from 1 m: the row of the reference
  // data (data/reference/sky/sky.csv) with sun, view and azimuth 60, 60, 0.
  const double T[3] = {8.8484812e-01, 7.5397715e-01, 5.8248998e-01};
  const double L[3] = {6.7439407e-02, 9.8459971e-02, 1.4211589e-01};
  const double E[3] = {1.474, 1.8504, 1.91198};
  Registry registry;
  const auto look = [&](const char* more, int width) {
    Pixels p;
    p.window = {0, 0, width, width};
    for (auto* plane : {&p.r, &p.g, &p.b, &p.a})
      plane->assign(std::size_t(width * width), 0);
    p.z.assign(std::size_t(width * width), kInf);
    char camera[200];
    std::snprintf(camera, sizeof camera,
                  "[camera]\nposition = [0, 0, 1]\nlook_at = [0, %.17g, %.17g]\n"
                  "focal = 1000\naperture_width = 1\n",
                  1e6 * std::cos(M_PI / 6), 1 + 1e6 * std::sin(M_PI / 6));
    Session session(scene_of(registry, sky(30, 0, more) + camera), registry);
    const Result r = apply_whole(session.prepare(source_of(p, p.window)), p, p.window);
    const auto i = std::size_t(width * width / 2);
    EXPECT_EQ(r["A"][i], 1);
    return std::array<double, 3>{r["R"][i], r["G"][i], r["B"][i]};
  };
  for (int width : {5, 65}) {
    const auto air = look("sun_disc = false", width), both = look("", width);
    const double radius = .533 / 2 * M_PI / 180,
                 solid_angle = 4 * M_PI * std::pow(std::sin(radius / 2), 2);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(air[c], L[c], .004 * L[c]);  // 60 degrees is judged at .1 % rms
      // Limb darkening of its centre, 2.52/2 (README).
      const double disc = T[c] * E[c] / solid_angle * 1.26;
      EXPECT_NEAR(both[c] - air[c], disc, 1e-3 * disc);
    }
  }
}

TEST(Scene, FogThatTakesItsColourFromASkyThatIsNotThereIsAnError) {
  Registry registry;
  const Column column{5, 10, 50};
  const std::string fog = "[[stage]]\ntype = \"height_fog\"\ncolor = \"sky\"\n";
  try {
    column.see(registry, "[sun]\nelevation = 20\nazimuth = 0\n" + fog);
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(),
                 "test.toml:4:1: height_fog takes its colour from the sky, and no stage "
                 "makes one here; add a [[stage]] of type \"sky\", or give it a color");
  }
  EXPECT_NO_THROW(column.see(registry, sky(20, 0) + fog));
}

TEST(Scene, WithoutDistanceTheSkyLeavesTheSurfaceAsItIs) {
  Registry registry;
  Pixels p = make_pixels(65, 65);
  for (float& z : p.z) z = 1e-6f;
  for (float& a : p.a) a = 1;
  Session session(scene_of(registry, sky(20, 0) + kCamera), registry);
  const Result r = apply_whole(session.prepare(source_of(p, p.window)), p, p.window);
  for (std::size_t i = 0; i < p.r.size(); ++i)
    EXPECT_NEAR(r["R"][i], p.r[i],
                1e-6 * (1 + p.r[i]));  // roundings of T, C and their sum
}

}  // namespace
}  // namespace brume::test
