// Kernels are total, but not for nonsense: what a plugin publishes is checked here, once
// per frame, with the name of the field that is wrong.

#include "stage/validate.h"

#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include "stage/abi.h"

namespace brume::abi {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
// What reaches pixels is float.
constexpr double kLargest = std::numeric_limits<float>::max();

std::string number(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", x);
  return text;
}

// Collects the first thing that is wrong.
struct Findings {
  std::string first;

  void say(const std::string& what) {
    if (first.empty()) first = what;
  }
  // Inclusive; NaN is never inside.
  void within(const char* field, double x, double low, double high) {
    if (!(x >= low && x <= high))
      say(std::string(field) + " is " + number(x) + "; expected " + number(low) + " to " +
          number(high));
  }
  void within(const char* field, const double* x, int n, double low, double high) {
    for (int i = 0; i < n && first.empty(); ++i)
      within((std::string(field) + " " + std::to_string(i)).c_str(), x[i], low, high);
  }
  void finite(const char* field, double x) {
    if (!std::isfinite(x)) say(std::string(field) + " is " + number(x));
  }
  void finite(const char* field, const double* x, int n) {
    for (int i = 0; i < n && first.empty(); ++i)
      finite((std::string(field) + " " + std::to_string(i)).c_str(), x[i]);
  }
  // To 1e-6, the least that a plugin working in float can be held to.
  void unit(const char* field, const double v[3]) {
    finite(field, v, 3);
    const double length = std::hypot(v[0], v[1], v[2]);
    if (first.empty() && std::abs(length - 1) > 1e-6)
      say(std::string(field) + " has length " + number(length) + "; expected 1");
  }
  template <class E>
  void word(const char* field, const E& e, E last) {
    if (!abi::within(e, last))
      say(std::string(field) + " is " + std::to_string(raw(e)) + "; expected 0 to " +
          std::to_string(int(last)));
  }
  template <class Fn>
  void function(const char* field, Fn* f, const char* who) {
    if (!f) say(std::string("no function ") + field + "; " + who + " needs it");
  }
};

}  // namespace

std::string wrong_with(const brume_medium& m) {
  Findings f;
  f.word("shape", m.shape, BRUME_ELLIPSOID);
  f.word("profile", m.profile, BRUME_CUSTOM);
  f.word("phase", m.phase, BRUME_CORNETTE_SHANKS);
  f.word("source", m.source, BRUME_SOURCE_CUSTOM);
  if (!f.first.empty()) return f.first;
  if (m.shape != BRUME_EVERYWHERE) f.finite("local_from_world", m.local_from_world, 12);
  if (m.profile == BRUME_EXPONENTIAL) {
    f.finite("origin", m.origin, 3);
    f.unit("direction", m.direction);
    f.finite("falloff", m.falloff);
  }
  if (m.profile == BRUME_LORENTZIAN) {
    f.finite("origin", m.origin, 3);
    f.within("falloff", m.falloff, 0, kLargest);
  }
  if (m.profile == BRUME_CUSTOM) {
    f.function("integral", m.integral, "a custom profile");
    f.function("density", m.density, "a custom profile");
    f.function("point", m.point, "a custom profile");
  }
  if (m.source == BRUME_SOURCE_CUSTOM) {
    f.function("source_at", m.source_at, "a custom source");
    f.function("point", m.point, "a custom source");
  }
  f.within("extinction", m.extinction, 3, 0, kLargest);
  f.within("albedo", m.albedo, 3, 0, 1);
  if (!(std::abs(m.g) < 1)) f.say("g is " + number(m.g) + "; expected -1 < g < 1");
  if (m.source == BRUME_SOURCE_COLOR) f.within("color", m.color, 3, -kLargest, kLargest);
  f.within("emission", m.emission, 3, -kLargest, kLargest);
  f.within("start", m.start, 0, kInf);
  f.within("max_opacity", m.max_opacity, 0, 1);
  // More is garbage, not a list of wavelengths.
  constexpr int kMostWavelengths = 4096;
  f.within("wavelengths", m.wavelengths, 0, kMostWavelengths);
  if (m.wavelengths > 0 && f.first.empty()) {
    f.function("spectral_point", m.spectral_point, "a medium of wavelengths");
    if (!m.spectral_radiance || !m.spectral_transmittance)
      f.say("wavelengths without spectral_radiance and spectral_transmittance");
  }
  if (m.wavelengths > 0 && f.first.empty()) {
    f.finite("spectral_radiance", m.spectral_radiance, 3 * m.wavelengths);
    f.within("spectral_transmittance", m.spectral_transmittance, 3 * m.wavelengths, 0, 1);
  }
  return f.first;
}

std::string wrong_with(const brume_light& l) {
  Findings f;
  f.word("kind", l.kind, BRUME_SPOT);
  if (!f.first.empty()) return f.first;
  if (l.kind == BRUME_POINT || l.kind == BRUME_SPOT) f.finite("position", l.position, 3);
  if (l.kind == BRUME_SUN || l.kind == BRUME_SPOT) f.unit("direction", l.direction);
  f.within("power", l.power, 3, 0, kLargest);
  f.within("radius", l.radius, 0, kLargest);
  if (l.kind == BRUME_SPOT) {
    f.within("cone", l.cone, 0, std::numbers::pi);
    f.within("cone_soft", l.cone_soft, 0, l.cone);
    f.within("cone_falloff", l.cone_falloff, 0, 1);
  }
  return f.first;
}

std::string wrong_with(const brume_shadower& s) {
  Findings f;
  f.function("optical_depth", s.optical_depth, "a shadower");
  return f.first;
}

std::string wrong_with(const brume_interface& i) {
  Findings f;
  f.function("hit", i.hit, "an interface");
  return f.first;
}

std::string wrong_with(const brume_background& b) {
  Findings f;
  f.function("radiance", b.radiance, "a background");
  return f.first;
}

std::string wrong_with(const brume_needs& n) {
  Findings f;
  // More is garbage, not a list of channels.
  constexpr std::size_t kMostChannels = 4096;
  const auto list = [&](const char* field, const char* const* names, std::size_t count) {
    if (count > kMostChannels || (count && !names)) {
      f.say(std::string(field) + ": a count of " + std::to_string(count) +
            (names ? "" : " and no list"));
      return;
    }
    for (std::size_t i = 0; i < count; ++i)
      if (!names[i] || !*names[i]) f.say(std::string(field) + ": a channel without name");
  };
  list("channels", n.channels, n.channel_count);
  list("optional", n.optional, n.optional_count);
  constexpr int kFarthestRow = 1 << 20;
  f.within("rows_around", n.rows_around, 0, kFarthestRow);
  f.within("columns_around", n.columns_around, 0, kFarthestRow);
  if (n.screen[2] < 0 || n.screen[3] < 0) f.say("screen has a negative size");
  f.within("nearest", n.nearest, 0, kInf);
  f.within("farthest", n.farthest, n.nearest, kInf);
  f.within("promise", n.promise, 0, kInf);
  return f.first;
}

}  // namespace brume::abi
