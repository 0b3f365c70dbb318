#pragma once
// Stages as the product runs them: registry, module, instance, World, integrator; rays
// in, T and L out. For the tests of plugins.

#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "air/air.h"
#include "scene/scene_file.h"
#include "stage/instance.h"
#include "stage/registry.h"

namespace brume::test {

using Set = std::vector<std::pair<std::string, std::string>>;

struct Ray {
  float o[3] = {0, 0, 0}, d[3] = {0, 0, 1}, t = 0;  ///< o relative to the eye
  float weight = 1;                                 ///< of all stages (mask x mix)
};
struct Answer {
  float T[3], L[3];
};

inline std::string text(double x) {
  char t[40];
  std::snprintf(t, sizeof t, "%.17g", x);
  return t;
}
inline std::string text(double x, double y, double z) {
  return text(x) + "," + text(y) + "," + text(z);
}

inline FrameInfo eye_at(double x, double y, double z) {
  FrameInfo f;
  f.has_camera = true;
  f.eye = {x, y, z};
  return f;
}

class ThroughAir {
 public:
  explicit ThroughAir(const FrameInfo& frame = eye_at(0, 0, 0),
                      Registry& stages = registry())
      : frame_(frame), stages_(stages) {
    world_.eye = frame.eye;
    world_.up = frame.up;
  }

  /// Publishes one more stage with these values. Throws what the stage says.
  ThroughAir& add(const std::string& type, const Set& set) {
    const StageType& t = stages_.find(type);
    Settings s = Settings::defaults(t.specs);
    for (const auto& [name, value] : set) s.set(name, value, {}, type);
    instances_.push_back(
        std::make_unique<StageInstance>(t, type, s.at(frame_.frame), cache_));
    needs_.push_back(instances_.back()->needs(frame_));
    instances_.back()->publish(frame_, int(instances_.size()) - 1, world_);
    return *this;
  }
  ThroughAir& compile(double tolerance = 1e-3, std::optional<Isa> isa = {}) {
    air_ = Air::compile(world_, {.tolerance = tolerance,
                                 .white = 1,
                                 .stages = int(instances_.size()),
                                 .isa = isa});
    return *this;
  }

  std::vector<Answer> operator()(const std::vector<Ray>& rays) const {
    const std::size_t n = rays.size();
    std::vector<float> in(7 * n), out(6 * n);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        in[k * n + i] = rays[i].o[k];
        in[(3 + k) * n + i] = rays[i].d[k];
        in[6 * n + i] = rays[i].t;
      }
    const auto plane = [&](std::vector<float>& v, std::size_t k) {
      return v.data() + k * n;
    };
    bool from_eye = true;
    for (const Ray& r : rays) from_eye = from_eye && !r.o[0] && !r.o[1] && !r.o[2];
    std::vector<float> weight;
    bool in_part = false;
    for (const Ray& r : rays) {
      weight.push_back(r.weight);
      in_part = in_part || r.weight != 1;
    }
    const std::vector<const float*> weights(in_part ? instances_.size() : 0,
                                            weight.data());
    const RaySpans spans{int(n),
                         from_eye ? nullptr : plane(in, 0),
                         from_eye ? nullptr : plane(in, 1),
                         from_eye ? nullptr : plane(in, 2),
                         plane(in, 3),
                         plane(in, 4),
                         plane(in, 5),
                         plane(in, 6)};
    air_.integrate(spans, weights,
                   {{plane(out, 0), plane(out, 1), plane(out, 2)},
                    {plane(out, 3), plane(out, 4), plane(out, 5)},
                    {},
                    {}});
    std::vector<Answer> answers(n);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t c = 0; c < 3; ++c)
        answers[i].T[c] = out[c * n + i], answers[i].L[c] = out[(3 + c) * n + i];
    return answers;
  }
  Answer operator()(const Ray& r) const { return (*this)(std::vector<Ray>{r})[0]; }

  const World& world() const { return world_; }
  const Air& air() const { return air_; }
  const StageNeeds& needs(std::size_t stage) const { return needs_[stage]; }

  /// The stages that are modules.
  static Registry& registry() {
    static Registry modules({.files = {}, .use_linked = false});
    return modules;
  }

 private:
  FrameInfo frame_;
  Registry& stages_;
  StageCache cache_;
  std::vector<std::unique_ptr<StageInstance>> instances_;
  std::vector<StageNeeds> needs_;
  World world_;
  Air air_;
};

inline bool same_bits(const std::vector<Answer>& a, const std::vector<Answer>& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), a.size() * sizeof(Answer)) == 0;
}

/// The example of plugins/<folder>, its stages found as modules.
inline SceneFile example_of(const std::string& folder) {
  return read_scene(
      std::string(BRUME_SOURCE_DIR) + "/plugins/" + folder + "/example.toml",
      [](const std::string& type, const Location& where) {
        return ThroughAir::registry().specs(type, where);
      });
}

}  // namespace brume::test
