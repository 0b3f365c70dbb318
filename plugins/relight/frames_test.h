#pragma once
// Frames of geometry that is known, made pixel by pixel, through the product's own path:
// what the tests of this stage share.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <optional>

#include "../../tests/pipeline/frames.h"
#include "oracle.h"
#include "pipeline/impl.h"

namespace relight::test {

using namespace brume;
using glm::dvec3;
using oracle::Lamp;
using OracleRgb = oracle::Rgb;

struct Hit {
  double t = 1e300;
  dvec3 n{0, 0, 1};  // unit, facing the eye
};
using Geometry = std::function<Hit(const dvec3& o, const dvec3& d)>;

inline Geometry plane(dvec3 at, dvec3 n) {
  n = glm::normalize(n);
  return [=](const dvec3& o, const dvec3& d) -> Hit {
    const double t = glm::dot(at - o, n) / glm::dot(d, n);
    if (!(t > 0)) return {};
    return {t, glm::dot(n, d) < 0 ? n : -n};
  };
}
inline Geometry sphere(dvec3 middle, double radius) {
  return [=](const dvec3& o, const dvec3& d) -> Hit {
    const dvec3 m = middle - o;
    const double b = glm::dot(m, d), q = b * b - glm::dot(m, m) + radius * radius;
    if (q < 0 || b - std::sqrt(q) <= 0) return {};
    const double t = b - std::sqrt(q);
    return {t, (o + t * d - middle) / radius};
  };
}
inline Geometry nearest(std::vector<Geometry> all) {
  return [=](const dvec3& o, const dvec3& d) {
    Hit best;
    for (const Geometry& g : all)
      if (const Hit h = g(o, d); h.t < best.t) best = h;
    return best;
  };
}

inline const std::string kLooksDown = R"(
[camera]
position = [0, 0, 4]
look_at = [0, 10, 1]
focal = 30
)";

struct Frame {
  int width = 96, height = 64;
  std::string camera = kLooksDown, head = {};  // head: before the camera
  std::optional<View> view = {};               // instead of it
  std::map<std::string, std::vector<float>> planes = {};
  std::vector<Hit> truth = {};
  std::vector<View::RayAt> rays = {};

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
    const SceneFile scene = brume::test::scene_of(registry, f.head + f.camera);
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
    Session session(brume::test::scene_of(registry, f.head + f.camera + stages),
                    registry);
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

inline std::string number(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", x);
  return text;
}
inline std::string list(const dvec3& v) {
  return "[" + number(v.x) + ", " + number(v.y) + ", " + number(v.z) + "]";
}
inline std::string list(const OracleRgb& v) { return list(dvec3(v[0], v[1], v[2])); }

inline std::string stage_of(const Lamp& l, const std::string& name) {
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
inline const std::string kRelight =
    "[[stage]]\ntype = \"relight\"\nalbedo = [0.2, 0.4, 0.8]\n";
inline const OracleRgb kAlbedo = {.2, .4, .8};
// Lamps that are too far away to matter are not left out where the tolerance is small.
inline const std::string kFine = "tolerance = 1e-4\n[output]\nwhite = 1e-3\n";

inline constexpr const char* kChannels[] = {"R", "G", "B"};

}  // namespace relight::test
