#include "truth/shown.h"

#include <cmath>
#include <mutex>

#include "truth/physics.h"

namespace brume::truth {
namespace {

glm::dvec3 vec(const float* x, const float* y, const float* z, std::size_t i) {
  return x ? glm::dvec3(x[i], y[i], z[i]) : glm::dvec3(0);
}

}  // namespace

struct Shown::Sky {
  std::once_flag once;
  std::unique_ptr<SkyLight> light;
};

Shown::Shown(const World& world, double tolerance)
    : world_(world), tolerance_(tolerance), skies_(world.lights.size()) {
  for (auto& sky : skies_) sky = std::make_unique<Sky>();
  table_.size = sizeof table_;
  table_.context = this;
  table_.light_count = world.lights.size();
  table_.light = [](const brume_world* of, std::size_t k) -> const brume_light* {
    const auto& lights = static_cast<const Shown*>(of->context)->world_.lights;
    return k < lights.size() ? &lights[k].what : nullptr;
  };
  table_.transmittance = [](const brume_world* of, const brume_rays* r, const float* t1,
                            float* const T[3]) {
    const Shown& shown = *static_cast<const Shown*>(of->context);
    for (std::size_t i = 0; i < r->n; ++i) {
      const Rgb through = shown.transmittance(vec(r->ox, r->oy, r->oz, i),
                                              vec(r->dx, r->dy, r->dz, i), double(t1[i]));
      for (std::size_t c = 0; c < 3; ++c) T[c][i] = float(through[c]);
    }
  };
  table_.irradiance = [](const brume_world* of, std::size_t light, const brume_rays* r,
                         float* const E[3]) {
    const Shown& shown = *static_cast<const Shown*>(of->context);
    for (std::size_t i = 0; i < r->n; ++i) {
      Rgb arrives{};
      if (light < of->light_count)
        arrives = shown.irradiance(light, vec(r->ox, r->oy, r->oz, i),
                                   vec(r->dx, r->dy, r->dz, i));
      for (std::size_t c = 0; c < 3; ++c) E[c][i] = float(arrives[c]);
    }
  };
}

Shown::~Shown() = default;

Rgb Shown::transmittance(const glm::dvec3& o, const glm::dvec3& d, double end) const {
  Rgb T = optical_depth(world_, world_.eye + o, d, end, tolerance_);
  for (double& t : T) t = std::exp(-t);
  return T;
}

Rgb Shown::irradiance(std::size_t k, const glm::dvec3& o, const glm::dvec3& n) const {
  const brume_light& light = world_.lights[k].what;
  Rgb E{};
  if (light.kind == BRUME_SKY_LIGHT) {
    for (std::size_t c = 0; c < 3; ++c) E[c] = M_PI * light.power[c];
    if (!light.radiance) return E;
    Sky& sky = *skies_[k];
    std::call_once(sky.once,
                   [&] { sky.light = std::make_unique<SkyLight>(light, world_.up); });
    return sky.light->irradiance(n);
  }
  const Incident in = light_at(world_, light, o);
  const double mu = glm::dot(in.to, n);
  if (!(mu > 0)) return E;
  const Rgb T = light.attenuated ? transmittance(o, in.to, in.distance) : Rgb{1, 1, 1};
  for (std::size_t c = 0; c < 3; ++c) E[c] = mu * in.E[c] * T[c];
  return E;
}

}  // namespace brume::truth
