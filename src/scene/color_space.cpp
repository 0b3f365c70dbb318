#include "scene/color_space.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "num/error.h"

namespace brume {
namespace {

struct Space {
  const char* name;
  Chromaticities primaries;
  bool srgb_curve = false;
};

// Rec.709 and sRGB: BT.709-6, IEC 61966-2-1. Rec.2020: BT.2020-2. P3-D65: SMPTE EG 432-1.
// ACES: S-2014-004 (AP1) and SMPTE ST 2065-1 (AP0).
constexpr Space kSpaces[] = {
    {"rec709", kRec709},
    {"srgb", kRec709, true},
    {"rec2020", {.708, .292, .170, .797, .131, .046, .3127, .3290}},
    {"p3d65", {.680, .320, .265, .690, .150, .060, .3127, .3290}},
    {"acescg", {.713, .293, .165, .830, .128, .044, .32168, .33767}},
    {"aces2065-1", {.7347, .2653, 0, 1, .0001, -.0770, .32168, .33767}},
};

glm::dvec3 xyz(double x, double y) { return {x / y, 1, (1 - x - y) / y}; }

/// Columns: the primaries, scaled so that they add up to the white (SMPTE RP 177-1993).
glm::dmat3 xyz_from_rgb(const Chromaticities& c) {
  for (int i = 0; i < 8; i += 2)
    if (!(std::abs(c[i + 1]) > 1e-9))
      throw Error("chromaticities", "a primary with y = 0", "y other than 0");
  const glm::dmat3 p(xyz(c[0], c[1]), xyz(c[2], c[3]), xyz(c[4], c[5]));
  if (!(std::abs(glm::determinant(p)) > 1e-9))
    throw Error("chromaticities", "primaries on a line",
                "three that span a triangle, as in Rec.709");
  const glm::dvec3 scale = glm::inverse(p) * xyz(c[6], c[7]);
  return {p[0] * scale.x, p[1] * scale.y, p[2] * scale.z};
}

/// Bradford: from one white to another (Lam 1985, in ICC.1:2010 annex E).
glm::dmat3 adapt(glm::dvec3 from, glm::dvec3 to) {
  const glm::dmat3 cones = glm::transpose(
      glm::dmat3(.8951, .2664, -.1614, -.7502, 1.7135, .0367, .0389, -.0685, 1.0296));
  const glm::dvec3 ratio = (cones * to) / (cones * from);
  glm::dmat3 scale(0);
  for (int i = 0; i < 3; ++i) scale[i][i] = ratio[i];
  return glm::inverse(cones) * scale * cones;
}

/// sRGB's curve to linear light, odd.
double decoded(double v) {
  const double a = std::abs(v),
               x = a <= .04045 ? a / 12.92 : std::pow((a + .055) / 1.055, 2.4);
  return std::copysign(x, v);
}

}  // namespace

std::vector<std::string> color_space_names() {
  std::vector<std::string> names{"frame"};
  for (const Space& s : kSpaces) names.push_back(s.name);
  return names;
}

glm::dvec3 to_frame(std::string_view name, const Chromaticities& frame, glm::dvec3 rgb) {
  const auto* space = std::find_if(std::begin(kSpaces), std::end(kSpaces),
                                   [&](const Space& s) { return name == s.name; });
  if (space == std::end(kSpaces)) return rgb;
  if (space->srgb_curve)
    for (int c = 0; c < 3; ++c) rgb[c] = decoded(rgb[c]);
  if (space->primaries == frame) return rgb;
  const Chromaticities &a = space->primaries, &b = frame;
  return glm::inverse(xyz_from_rgb(b)) *
         (adapt(xyz(a[6], a[7]), xyz(b[6], b[7])) * (xyz_from_rgb(a) * rgb));
}

void to_frame(std::string_view name, const Chromaticities& frame,
              std::span<const ParamSpec> specs, std::span<Value> values) {
  if (name == "frame") return;
  for (std::size_t i = 0; i < specs.size(); ++i) {
    const ParamSpec& spec = specs[i];
    std::vector<double>& v = values[i].numbers;
    if (spec.kind != Kind::rgb || spec.unit == "1/m" || v.size() != 3) continue;
    const glm::dvec3 out = to_frame(name, frame, {v[0], v[1], v[2]});
    for (int c = 0; c < 3; ++c)
      v[std::size_t(c)] = std::clamp(out[c], spec.minimum, spec.maximum);
  }
}

}  // namespace brume
