#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <tuple>

#include "air/glow_form.h"
#include "air/impl.h"
#include "num/error.h"

namespace brume {
namespace {

using air::Medium;

[[noreturn]] void refuse(const std::string& who, const std::string& what,
                         const std::string& hint = {}) {
  throw Error(who.empty() ? "medium" : who, what, hint);
}

void check_finite(const std::string& who, const char* what, const double* v, int n) {
  for (int i = 0; i < n; ++i)
    if (!std::isfinite(v[i])) refuse(who, std::string(what) + " is not finite");
}

void check(const std::string& who, const brume_medium& m) {
  check_finite(who, "origin", m.origin, 3);
  check_finite(who, "direction", m.direction, 3);
  check_finite(who, "falloff", &m.falloff, 1);
  check_finite(who, "extinction", m.extinction, 3);
  check_finite(who, "albedo", m.albedo, 3);
  check_finite(who, "g", &m.g, 1);
  check_finite(who, "color", m.color, 3);
  check_finite(who, "emission", m.emission, 3);
  if (m.shape != BRUME_EVERYWHERE)
    check_finite(who, "local_from_world", m.local_from_world, 12);
  for (int c = 0; c < 3; ++c) {
    if (m.extinction[c] < 0) refuse(who, "extinction is negative");
    if (m.albedo[c] < 0 || m.albedo[c] > 1) refuse(who, "albedo is outside 0 to 1");
  }
  if (std::abs(m.g) >= 1) refuse(who, "g is not between -1 and 1");
  if (!(m.start >= 0)) refuse(who, "start is negative");
  if (!(m.max_opacity >= 0 && m.max_opacity <= 1))
    refuse(who, "max_opacity is outside 0 to 1");
  if (m.profile == BRUME_CUSTOM && !(m.integral && m.density))
    refuse(who, "a custom profile needs its functions integral and density");
  if (m.source == BRUME_SOURCE_CUSTOM && !m.source_at)
    refuse(who, "a custom source needs its function source_at");
  if (m.profile == BRUME_LORENTZIAN && m.falloff < 0) refuse(who, "falloff is negative");
}

// Everything that tells media apart, functions excepted: media are worked on in this
// order, so that the order of stages in a file never changes a bit.
auto content(const Published<brume_medium>& p) {
  const auto& m = p.what;
  std::vector<double> key = {double(m.shape),  double(m.profile), double(m.phase),
                             double(m.source), m.falloff,         m.g,
                             m.start,          m.max_opacity};
  const auto add = [&](const double* v, int n) { key.insert(key.end(), v, v + n); };
  add(m.local_from_world, 12);
  add(m.origin, 3);
  add(m.direction, 3);
  add(m.extinction, 3);
  add(m.albedo, 3);
  add(m.color, 3);
  add(m.emission, 3);
  return std::tuple(key, p.name);
}

void set_bounds(Medium& m, const std::string& who, const brume_medium& from,
                const glm::dvec3& eye) {
  m.shape = from.shape;
  m.radius = std::numeric_limits<float>::infinity();
  if (m.shape == BRUME_EVERYWHERE) return;
  const double* l = from.local_from_world;
  glm::dmat3 A;  // column by column
  glm::dvec3 b;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) A[c][r] = l[4 * r + c];
    b[r] = l[4 * r + 3];
  }
  const glm::dvec3 local_eye = A * eye + b;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) m.A[3 * r + c] = float(A[c][r]);
    m.b[r] = float(local_eye[r]);
  }
  const double length = glm::length(local_eye);
  m.b2_minus_1 = float((length - 1) * (length + 1));
  if (m.shape == BRUME_HALF_SPACE) return;
  const double det = glm::determinant(A);
  if (!(std::abs(det) > 0) || !std::isfinite(1 / det))
    refuse(who, "local_from_world has no inverse", "a shape needs three dimensions");
  const glm::dmat3 world_from_local = glm::inverse(A);
  const glm::dvec3 center = world_from_local * -local_eye;
  double radius = 0;
  if (m.shape == BRUME_BOX) {
    for (int s = 0; s < 4; ++s)
      radius = std::max(
          radius,
          glm::length(world_from_local * glm::dvec3(1, s & 1 ? 1 : -1, s & 2 ? 1 : -1)));
  } else {  // the Frobenius norm bounds the longest axis
    for (int c = 0; c < 3; ++c)
      radius += glm::dot(world_from_local[c], world_from_local[c]);
    radius = std::sqrt(radius);
  }
  for (int c = 0; c < 3; ++c) m.center[c] = float(center[c]);
  m.radius = float(radius * (1 + 1e-5) + 1e-5 * glm::length(center));
}

// An exponential is coefficients times rho, and only the product is given. Chooses rho at
// the eye so that its logarithm is a float exactly (else a density of e^50 would be off
// by 50 eps / 2) and that neither factor leaves the floats where the product does not;
// scales the coefficients to match. Returns log rho at the eye.
double balance(brume_medium& m, const glm::dvec3& eye) {
  const glm::dvec3 origin(m.origin[0], m.origin[1], m.origin[2]);
  const glm::dvec3 dir(m.direction[0], m.direction[1], m.direction[2]);
  const double log_rho = -m.falloff * glm::dot(dir, eye - origin);
  const double most = std::max({m.extinction[0], m.extinction[1], m.extinction[2]});
  // Where both are ordinary numbers they stay, so that a scaled world gives the same
  // bits.
  const bool ordinary = std::abs(log_rho) < 60 && most > 1e-18 && most < 1e18;
  const double taken = ordinary || !(most > 0) ? 1 : most;
  const double wanted = log_rho + std::log(taken), kept = double(float(wanted));
  if (!(std::abs(wanted) < 1e4)) return log_rho;  // nothing or opaque, whatever follows
  const double scale = std::exp(wanted - kept) / taken;
  for (int c = 0; c < 3; ++c) {
    m.extinction[c] *= scale;
    m.emission[c] *= scale;
  }
  return kept;
}

void set_profile(Medium& m, const brume_medium& from, const glm::dvec3& eye,
                 double log_rho0) {
  m.profile = from.profile;
  if (from.profile != BRUME_CUSTOM && from.falloff == 0) m.profile = BRUME_UNIFORM;
  const glm::dvec3 origin(from.origin[0], from.origin[1], from.origin[2]);
  const glm::dvec3 dir(from.direction[0], from.direction[1], from.direction[2]);
  if (m.profile == BRUME_EXPONENTIAL) {
    m.log_rho0 = float(log_rho0);
    m.rho0 = std::abs(log_rho0) < 60 ? float(std::exp(log_rho0)) : 0.f;
    for (int i = 0; i < 3; ++i) m.grad[i] = float(from.falloff * dir[i]);
  }
  if (m.profile == BRUME_LORENTZIAN) {
    for (int i = 0; i < 3; ++i) m.middle[i] = float(origin[i] - eye[i]);
    m.falloff = float(from.falloff);
  }
}

// Light added per optical depth where there is optical depth, and per metre where not.
void set_source(Medium& m, const brume_medium& from, bool has_lamps, bool has_sky) {
  m.g = float(from.g);
  m.phase = from.phase;
  const bool sky = from.source == BRUME_SOURCE_SKY;
  for (int c = 0; c < 3; ++c) {
    const double sigma = from.extinction[c];
    m.sigma[c] = float(sigma);
    m.S[c] =
        from.source == BRUME_SOURCE_COLOR && m.sigma[c] > 0 ? float(from.color[c]) : 0;
    const double folded = m.sigma[c] > 0 ? from.emission[c] / sigma : 0;
    if (m.sigma[c] > 0 && std::abs(folded) < 1e12)
      m.S[c] += float(folded);
    else
      m.emission[c] = float(from.emission[c]);
    m.densest = std::max(m.densest, m.sigma[c]);
    m.absorbs = m.absorbs || m.sigma[c] > 0;
    m.emits = m.emits || m.emission[c] != 0;
    m.albedo[c] = float(from.albedo[c]);
    m.sky_albedo[c] = sky ? 1.f : m.albedo[c];
    m.glows_by_sun = m.glows_by_sun || (m.sky_albedo[c] * m.sigma[c] > 0 && has_sky);
    m.glows_by_lamp = m.glows_by_lamp || (m.albedo[c] * m.sigma[c] > 0 && has_lamps);
  }
  m.grey = m.sigma[0] == m.sigma[1] && m.sigma[1] == m.sigma[2];
  m.self = from.self;
  m.integral = from.integral;
  m.density = from.density;
  if (from.source == BRUME_SOURCE_CUSTOM) m.source_at = from.source_at;
}

air::Light light_of(const brume_light& from, const glm::dvec3& eye) {
  air::Light l;
  l.kind = from.kind;
  for (int i = 0; i < 3; ++i) {
    l.position[i] = float(from.position[i] - eye[i]);
    l.direction[i] = float(from.direction[i]);
    l.power[i] = float(from.power[i]);
  }
  l.radius2 = from.kind == BRUME_SUN ? 0.f : float(from.radius * from.radius);
  const double most = std::max({from.power[0], from.power[1], from.power[2]});
  l.near2 = std::max(l.radius2, float(most / kMostIrradiance));
  l.cone = float(from.cone);
  l.cone_soft = float(std::min(from.cone_soft, from.cone));
  const auto sin2 = [](double angle) {
    const double s = std::sin(angle);
    return float(s * s);
  };
  l.sin2_cone = sin2(from.cone);
  // Where light is whole: of the ratio |cone / theta| - 1 at half the angle.
  l.sin2_inner =
      sin2(from.cone_falloff == 1 ? from.cone / 2
                                  : from.cone - std::min(from.cone_soft, from.cone));
  l.cone_falloff = from.cone_falloff;
  l.attenuated = from.attenuated != 0;
  return l;
}

bool no_power(const air::Light& l) {
  return l.power[0] == 0 && l.power[1] == 0 && l.power[2] == 0;
}

void add_lights(Air::Impl& air, const World& world) {
  for (const auto& l : world.lights) {
    check_finite(l.name, "light power", l.what.power, 3);
    check_finite(l.name, "light direction", l.what.direction, 3);
    if (l.what.kind == BRUME_POINT || l.what.kind == BRUME_SPOT)
      check_finite(l.name, "light position", l.what.position, 3);
    air.lights.push_back(light_of(l.what, world.eye));
    air.skies.push_back(l.what.kind == BRUME_SKY_LIGHT && l.what.radiance
                            ? std::make_unique<air::SkyIrradiance>(l.what, world.up)
                            : nullptr);
  }
  auto lights = world.lights;
  std::stable_sort(lights.begin(), lights.end(), [](const auto& a, const auto& b) {
    return brume::content(a.what) < brume::content(b.what);
  });
  for (const auto& p : lights) {
    const air::Light l = light_of(p.what, world.eye);
    if (no_power(l)) continue;
    const bool lamp = l.kind == BRUME_POINT || l.kind == BRUME_SPOT;
    // A sky's light comes from everywhere: no single path could dim it.
    const bool steady = l.kind == BRUME_SKY_LIGHT || !l.attenuated;
    (lamp ? air.lamps : steady ? air.steady : air.suns).push_back(l);
  }
}

// A coloured medium with a cap ends elsewhere in each channel: three media of one
// channel.
std::vector<Medium> channels_apart(const Medium& m, double limit) {
  std::vector<Medium> parts;
  for (int c = 0; c < 3; ++c) {
    Medium one = m;
    one.absorbs = m.sigma[c] > 0;
    one.emits = m.emission[c] != 0;
    if (!one.absorbs && !one.emits) continue;
    for (int other = 0; other < 3; ++other)
      if (other != c) one.sigma[other] = one.S[other] = one.emission[other] = 0;
    one.densest = one.sigma[c];
    one.cap = one.absorbs ? float(limit / m.sigma[c]) : 0;
    one.grey = false;
    parts.push_back(one);
  }
  return parts;
}

bool same_source(const Medium& a, const Medium& b) {
  if (!std::equal(a.S, a.S + 3, b.S) || a.glows_by_sun != b.glows_by_sun) return false;
  return !a.glows_by_sun || (std::equal(a.sky_albedo, a.sky_albedo + 3, b.sky_albedo) &&
                             a.g == b.g && a.phase == b.phase);
}

}  // namespace

void Air::Impl::link() {
  absorbers.clear();
  for (const Medium& m : media) bounded = bounded || std::isfinite(m.radius);
  anywhere.start({media.data(), int(media.size())});
  for (const Medium& m : media)
    if (m.absorbs) absorbers.push_back(&m);
  casters.clear();
  for (const Medium* m : absorbers)
    if (m->shape == BRUME_BOX || m->shape == BRUME_ELLIPSOID) casters.push_back(m);
  const auto list = [](const auto& v) {
    return air::List<typename std::decay_t<decltype(v)>::value_type>{v.data(),
                                                                     int(v.size())};
  };
  world.media = list(media);
  world.absorbers = list(absorbers);
  world.casters = list(casters);
  world.steady = list(steady);
  world.suns = list(suns);
  world.lamps = list(lamps);
  world.shadowers = list(shadowers);
  world.grey = shadowers.empty() && std::all_of(absorbers.begin(), absorbers.end(),
                                                [](const Medium* m) { return m->grey; });
}

bool air::indifferent(const Medium& a, const Medium& b) {
  if (!a.closed || !b.closed) return false;
  for (int c = 0; c < 3; ++c) {
    const bool both =
        (a.sigma[c] > 0 || a.emission[c] != 0) && (b.sigma[c] > 0 || b.emission[c] != 0);
    const bool clear = !(a.sigma[c] > 0) && !(b.sigma[c] > 0);
    const bool alike = a.source == b.source && a.emission[c] == 0 && b.emission[c] == 0;
    if (both && !clear && !alike) return false;
  }
  return true;
}

namespace {

// Whether it matters on no ray where one medium ends and another goes on. Of many media
// nobody asks: their pairs are more than rays.
bool all_indifferent(const std::vector<Medium>& media) {
  constexpr std::size_t kFew = 16;
  if (media.size() > kFew) return false;
  for (const Medium& a : media) {
    if (!a.closed || a.alone) return false;
    for (const Medium& b : media)
      if (&a != &b && !indifferent(a, b)) return false;
  }
  return true;
}

}  // namespace

Air Air::compile(const World& given, const AirOptions& options) {
  Air made;
  Impl& air = *made.impl_;
  air.kernels = air::kernels_of(options.isa ? *options.isa : isa());
  air.stages = options.stages;
  add_lights(air, given);
  for (const auto& s : given.shadowers)
    air.shadowers.push_back({s.what.self, s.what.optical_depth});
  for (const auto& i : given.interfaces) air.interfaces.push_back(i.what);
  for (const auto& b : given.backgrounds) air.backgrounds.push_back(b.what);

  auto media = given.media;
  std::stable_sort(media.begin(), media.end(),
                   [](const auto& a, const auto& b) { return content(a) < content(b); });
  double brightest = 0;
  for (auto& p : media) {
    check(p.name, p.what);
    const double log_rho0 =
        p.what.profile == BRUME_EXPONENTIAL ? balance(p.what, given.eye) : 0;
    Medium m;
    m.stage = p.stage;
    set_bounds(m, p.name, p.what, given.eye);
    set_profile(m, p.what, given.eye, log_rho0);
    set_source(m, p.what, !air.lamps.empty(), !air.suns.empty() || !air.steady.empty());
    m.start = float(p.what.start);
    m.closed = !m.source_at && !(m.glows_by_sun && !air.suns.empty());
    if (!m.absorbs && !m.emits) continue;
    if (p.what.max_opacity == 0 || !(m.start < air::kFar)) continue;
    for (int c = 0; c < 3; ++c) brightest = std::max(brightest, double(std::abs(m.S[c])));
    if (!m.closed || m.glows_by_sun || m.glows_by_lamp || m.emits)
      brightest = std::numeric_limits<double>::infinity();
    std::vector<Medium> parts = {m};
    if (p.what.max_opacity < 1) {
      const double limit = -std::log1p(-p.what.max_opacity);
      if (m.grey && m.absorbs)
        parts[0].cap = float(limit / m.sigma[0]);
      else
        parts = channels_apart(m, limit);
    } else {
      // Its own answer holds for its own light alone.
      if (!m.glows_by_sun && !m.glows_by_lamp) parts[0].alone = p.what.alone;
    }
    for (Medium& part : parts) {
      part.index = int(air.media.size());
      part.source = part.index;
      for (const Medium& other : air.media)
        if (same_source(part, other)) part.source = std::min(part.source, other.source);
      air.media.push_back(part);
      air.media_names.push_back(p.name);
    }
  }
  air.world.tolerance = float(options.tolerance);
  const bool known = brightest > 0 && brightest < options.white;
  air.world.scale = float(known ? brightest : options.white);
  for (air::Light& lamp : air.lamps) lamp.closed = air::glow_is_closed(air, lamp);
  air.indifferent = all_indifferent(air.media);
  air.link();
  return made;
}

}  // namespace brume
