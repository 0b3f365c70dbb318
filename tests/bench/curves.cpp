// What accuracy knobs promise, measured against the truth and written beside what they
// turn:
//
//   src/air/curve.h       the integrator's tolerance, over random overlapping media and
//                         lights
//   plugins/NAME/curve.h  the knob of a stage that has a curve.txt, over its
//                         example.toml with what each `case` there sets
//
//   measure_curves [NAME...]     ./run curves; NAME: air, or a stage
//
// A promise is the largest |dC| / (1 + |C|) found, and half of it more for what was not
// tried; two digits, rounded up.

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <sstream>
#include <vector>

#include "air/air.h"
#include "num/random.h"
#include "pipeline/impl.h"
#include "pipeline/probe.h"
#include "stage/registry.h"
#include "truth/probe.h"
#include "truth/truth.h"

namespace {

using namespace brume;

constexpr double kTolerances[] = {1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4,
                                  1e-4, 3e-5, 1e-5, 3e-6, 1e-6};
constexpr int kRays = 64;

double between(Random& r, double lo, double hi) { return lo + (hi - lo) * r.uniform(); }
double magnitude(Random& r, double lo, double hi) {
  return lo * std::pow(hi / lo, r.uniform());
}
std::string three(Random& r, double lo, double hi) {
  char text[100];
  std::snprintf(text, sizeof text, "[%.6g, %.6g, %.6g]", magnitude(r, lo, hi),
                magnitude(r, lo, hi), magnitude(r, lo, hi));
  return text;
}
std::string line(const char* key, const std::string& value) {
  return std::string(key) + " = " + value + "\n";
}
std::string line(const char* key, double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", value);
  return line(key, std::string(text));
}

// One to three height fogs, up to two volumes, lightning, a lamp: in each other, around
// an eye a few metres up. Optical depths from almost none to opaque.
std::string scene_text(Random& r) {
  std::string s;
  const auto stage = [&](const char* type) {
    static std::atomic<int> count{0};
    s += std::string("[[stage]]\ntype = \"") + type + "\"\n";
    s += line("name", "\"s" + std::to_string(count++) + "\"");
  };
  const bool lit = r.uniform() < 0.15;
  // Light through thick layers takes the truth minutes: lamps shine in even fog.
  for (int i = lit ? 1 : 1 + int(3 * r.uniform()); i > 0; --i) {
    stage("height_fog");
    s += r.uniform() < 0.5 ? line("density", magnitude(r, 1e-5, 0.1))
                           : line("density", three(r, 1e-4, 0.1));
    s += line("falloff", lit || r.uniform() < 0.2 ? 0 : magnitude(r, 1e-4, 1));
    s += line("color", three(r, 0.05, 5));
    if (lit) s += line("albedo", between(r, 0.2, 1)) + line("g", between(r, -0.5, 0.8));
    if (r.uniform() < 0.2) s += line("start", magnitude(r, 1, 100));
    if (!lit && r.uniform() < 0.2) s += line("max_opacity", between(r, 0.3, 0.99));
  }
  for (int i = int(3 * r.uniform()); i > 0; --i) {
    stage("fog_volume");
    s += line("shape", r.uniform() < 0.5 ? "\"box\"" : "\"ellipsoid\"");
    s += "center = [" + std::to_string(between(r, -30, 30)) + ", " +
         std::to_string(between(r, 0, 60)) + ", " + std::to_string(between(r, 0, 10)) +
         "]\n";
    s += line("half", three(r, 2, 40)) + line("density", magnitude(r, 1e-3, 1));
    // No more than e^16 within a body: floats cannot tell the face of a harder wall from
    // what is behind it, which is what stress looks at.
    s += line("color", three(r, 0.05, 5)) + line("falloff", magnitude(r, 1e-3, 0.2));
    if (lit) s += line("albedo", between(r, 0.2, 1));
  }
  if (r.uniform() < 0.3) {
    stage("lightning");
    s += line("position", three(r, 1, 100)) + line("intensity", three(r, 1e-3, 1));
    s += line("attenuation", magnitude(r, 1e-4, 1));
  }
  if (lit) {
    stage("point_light");
    s += line("position", three(r, 1, 30)) + line("power", three(r, 1, 1000));
    s += line("radius", 0.1);
  }
  return s;
}

struct Rays {
  std::vector<float> x, y, z, t;
};
Rays rays_for(Random& r) {
  Rays rays;
  for (int i = 0; i < kRays; ++i) {
    const double mu = i % 4 == 0 ? between(r, -0.02, 0.02) : between(r, -1, 1);
    const double phi = between(r, -M_PI, M_PI), s = std::sqrt(1 - mu * mu);
    rays.x.push_back(float(s * std::sin(phi)));
    rays.y.push_back(float(s * std::cos(phi)));
    rays.z.push_back(float(mu));
    rays.t.push_back(i % 8 == 7 ? INFINITY : float(magnitude(r, 1, 1e5)));
  }
  return rays;
}

// |dC| / (1 + |C|) for what may lie behind: nothing, white, bright.
double error_of(double T, double L, double true_T, double true_L) {
  double worst = 0;
  for (const double S : {0., 1., 30.})
    worst = std::max(worst, std::abs(S * (T - true_T) + L - true_L) /
                                (1 + std::abs(S * true_T + true_L)));
  return worst;
}

// The largest error of what `air` makes of the rays.
double error_of(const Air& air, const Rays& rays,
                const std::vector<truth::Answer>& truths) {
  const std::size_t n = rays.t.size(), padded = (n + 15) / 16 * 16;
  std::vector<float> planes(6 * padded);
  const auto plane = [&](std::size_t p) { return planes.data() + p * padded; };
  RaySpans spans;
  spans.n = int(n);
  spans.dx = rays.x.data(), spans.dy = rays.y.data(), spans.dz = rays.z.data();
  spans.t_end = rays.t.data();
  air.integrate(spans, {},
                {{plane(0), plane(1), plane(2)}, {plane(3), plane(4), plane(5)}, {}, {}});
  double worst = 0;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t c = 0; c < 3; ++c)
      worst = std::max(worst, error_of(double(plane(c)[i]), double(plane(3 + c)[i]),
                                       truths[i].T[c], truths[i].L[c]));
  return worst;
}

std::vector<truth::Answer> truths_of(const World& world, const Rays& rays) {
  std::vector<truth::Answer> truths(rays.t.size());
  tbb::parallel_for(std::size_t(0), truths.size(), [&](std::size_t i) {
    truths[i] = truth::along(world, world.eye, {rays.x[i], rays.y[i], rays.z[i]},
                             double(rays.t[i]), {.tolerance = 1e-7});
  });
  return truths;
}

using Curve = std::vector<std::pair<double, double>>;  // value, largest error

SceneFile parse(Registry& registry, const std::string& text) {
  return parse_scene(text, "curves", [&](const std::string& type, const Location& where) {
    return registry.specs(type, where);
  });
}

Curve measure_air(Registry& registry) {
  constexpr int kScenes = 1500;
  std::vector<std::vector<double>> all(kScenes);
  tbb::parallel_for(0, kScenes, [&](int seed) {
    Random r(static_cast<std::uint64_t>(seed));
    const Session session(without_picture(parse(registry, scene_text(r))), registry);
    const PreparedFrame prepared =
        session.prepare(probe_source({0, 0, magnitude(r, 1, 100)}, 1));
    const World& world = prepared.impl().world;
    const Rays rays = rays_for(r);
    const auto truths = truths_of(world, rays);
    for (const double tolerance : kTolerances) {
      const Air air = Air::compile(world, {.tolerance = tolerance,
                                           .stages = int(prepared.impl().stages.size()),
                                           .isa = {}});
      all[std::size_t(seed)].push_back(error_of(air, rays, truths));
    }
  });
  Curve curve;
  for (std::size_t k = 0; k < std::size(kTolerances); ++k) {
    const auto worst = std::ranges::max_element(
        all, [&](const auto& a, const auto& b) { return a[k] < b[k]; });
    std::printf("  air %g: %.2e in scene %td\n", kTolerances[k], (*worst)[k],
                worst - all.begin());
    curve.push_back({kTolerances[k], (*worst)[k]});
  }
  return curve;
}

// curve.txt: what is turned, and what on.
struct Turning {
  std::string knob;
  std::vector<double> values;
  double beyond = 0;  // error of the last value against what no truth here knows
  std::vector<std::vector<std::string>> cases;
};
Turning read_turning(const std::string& file) {
  Turning plan;
  std::ifstream in(file);
  for (std::string text; std::getline(in, text);) {
    std::istringstream words(text.substr(0, text.find('#')));
    std::string what, word;
    words >> what;
    if (what == "knob") {
      words >> plan.knob;
      for (double v; words >> v;) plan.values.push_back(v);
    } else if (what == "beyond") {
      words >> plan.beyond;
    } else if (what == "case") {
      plan.cases.emplace_back();
      while (words >> word) plan.cases.back().push_back(word);
    }
  }
  return plan;
}

// All directions, more of them by the horizon and about the sun; all distances that end
// above the ground: below it a planet ends the air in its own way.
Rays rays_about(const World& world, double eye, std::uint64_t seed) {
  constexpr double kEarth = 6360e3;
  const double horizon = -std::sqrt(eye * (2 * kEarth + eye)) / (kEarth + eye);
  Random r(seed);
  glm::dvec3 sun(0, 0, 1);
  for (const auto& l : world.lights)
    if (l.what.kind == BRUME_SUN)
      sun = {l.what.direction[0], l.what.direction[1], l.what.direction[2]};
  Rays rays;
  for (int i = 0; i < 480; ++i) {
    const double mu = i % 4 == 0 ? between(r, -0.02, 0.02) : between(r, -1, 1);
    const double phi = between(r, -M_PI, M_PI), s = std::sqrt(1 - mu * mu);
    glm::dvec3 d(s * std::sin(phi), s * std::cos(phi), mu);
    if (i % 4 == 1) d = glm::normalize(sun + magnitude(r, 1e-2, 0.5) * d);
    rays.x.push_back(float(d.x));
    rays.y.push_back(float(d.y));
    rays.z.push_back(float(d.z));
    const double ground = d.z < 0 ? -eye / d.z : INFINITY;
    rays.t.push_back(i % 2 && d.z > horizon
                         ? INFINITY
                         : float(std::min(magnitude(r, 10, 2e5), ground)));
  }
  return rays;
}

Curve measure_stage(Registry& registry, const std::string& name, const Turning& plan) {
  std::ifstream in(BRUME_SOURCE_DIR "/plugins/" + name + "/example.toml");
  const std::string example{std::istreambuf_iterator<char>(in), {}};
  Curve curve;
  for (const double v : plan.values) curve.push_back({v, 0});
  for (const auto& settings : plan.cases) {
    SceneFile scene = without_picture(parse(registry, example));
    double eye = 2;
    std::string said;
    for (const std::string& s : settings) {
      said += " " + s;
      if (s.starts_with("eye="))
        eye = std::stod(s.substr(4));
      else
        set(scene, s, {});
    }
    // A frame of a size for which tables pay.
    FrameSource source = probe_source({0, 0, eye}, 1);
    source.header.display_window = source.header.data_window = {0, 0, 256, 128};
    source.view->display = source.header.display_window;
    source.view->corner = {-0.5, 0.25, 0};
    source.view->across = {1. / 256, 0, 0};
    source.view->down = {0, -1. / 256, 0};
    std::vector<std::unique_ptr<Session>> sessions;  // they hold the stages' tables
    const auto prepare = [&](double value) {
      char text[100];
      std::snprintf(text, sizeof text, "%s.%s=%g", name.c_str(), plan.knob.c_str(),
                    value);
      set(scene, text, {});
      sessions.push_back(std::make_unique<Session>(scene, registry));
      return sessions.back()->prepare(source);
    };
    const PreparedFrame finest = prepare(plan.values.back());
    const World& world = finest.impl().world;
    const Rays rays = rays_about(world, eye, 1);
    const auto truths = truths_of(world, rays);
    std::printf("  %s%s:", name.c_str(), said.c_str());
    for (auto& [value, error] : curve) {
      const PreparedFrame prepared = prepare(value);
      const double e = error_of(prepared.impl().air, rays, truths);
      error = std::max(error, e + plan.beyond);
      std::printf(" %.2e", e);
    }
    std::printf("\n");
    std::fflush(stdout);
  }
  return curve;
}

double rounded_up(double x) {
  const double step = std::pow(10, std::floor(std::log10(x)) - 1);
  return std::ceil(x / step * (1 - 1e-12)) * step;
}

// Value, promise, value, promise, ...: what improves on what came before.
std::string table(const Curve& curve, bool air) {
  std::string out;
  double before = INFINITY;
  for (const auto& [value, found] : curve) {
    // The integrator's own bound is promised where less was found.
    double promise = rounded_up(1.5 * found);
    if (air) promise = std::max(promise, value);
    if (!(promise < before)) continue;
    char text[60];
    std::snprintf(text, sizeof text, "%s%.9g, %.9g", out.empty() ? "" : ", ", value,
                  promise);
    out += text;
    before = promise;
  }
  return out;
}

void write(const std::string& file, const std::string& name_space,
           const std::string& name, const std::string& what, const std::string& numbers) {
  std::ofstream(file) << "#pragma once\n// Written by `./run curves`.\n\nnamespace "
                      << name_space << " {\n\n// " << what
                      << ", and the error that is promised\n// at each: |dC| <= error "
                         "(white + |C|).\n// clang-format off\ninline constexpr double "
                      << name << "[] = {" << numbers
                      << "};\n// clang-format on\n\n}  // namespace " << name_space
                      << "\n";
  std::printf("%s: %s\n", file.c_str(), numbers.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  const std::string root = BRUME_SOURCE_DIR;
  const std::set<std::string> wanted(argv + 1, argv + argc);
  const auto asked = [&](const std::string& name) {
    return wanted.empty() || wanted.contains(name);
  };
  Registry registry;
  if (asked("air"))
    write(root + "/src/air/curve.h", "brume", "kAirCurve", "Tolerances of the integrator",
          table(measure_air(registry), true));
  for (const std::string& name : registry.names()) {
    const std::string folder = root + "/plugins/" + name;
    if (!asked(name) || !std::filesystem::exists(folder + "/curve.txt")) continue;
    const Turning plan = read_turning(folder + "/curve.txt");
    write(folder + "/curve.h", "brume::" + name, "kCurve", "Values of " + plan.knob,
          table(measure_stage(registry, name, plan), false));
  }
}
