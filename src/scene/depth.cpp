// Which channel is depth, and what its values mean.

#include <cctype>
#include <cmath>
#include <limits>

#include "num/digits.h"
#include "scene/depth_run.h"
#include "scene/view.h"

namespace brume {
namespace {

// The smallest float that is at least x, so that float < it exactly where float < x.
float float_at_least(double x) {
  const float f = static_cast<float>(x);
  return f < x ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}

const DepthKernels& kernels() noexcept {
  static const DepthKernels& chosen = BRUME_ISA_SELECT(depth_kernels);
  return chosen;
}

bool same(std::string_view a, std::string_view b) {
  const auto low = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (low(a[i]) != low(b[i])) return false;
  return true;
}

// `name` is `tail`, or ends in "." and `tail`; upper and lower case alike.
bool is_or_ends(std::string_view name, std::string_view tail) {
  if (same(name, tail)) return true;
  return name.size() > tail.size() && name[name.size() - tail.size() - 1] == '.' &&
         same(name.substr(name.size() - tail.size()), tail);
}

}  // namespace

DepthRule depth_rule(const InputSection& in) {
  DepthRule r;
  r.kind = in.depth_kind == "distance"     ? DepthKind::distance
           : in.depth_kind == "inverse"    ? DepthKind::inverse
           : in.depth_kind == "normalised" ? DepthKind::normalised
                                           : DepthKind::planar;
  r.metres = in.metres;
  r.near = in.depth_near;
  r.far = in.depth_far;
  r.white_near = in.depth_white_near;
  r.background_from = in.background_from;
  if (!(r.metres > 0) || !std::isfinite(r.metres))
    throw Error("[input]", "metres is not a positive number");
  if (r.kind == DepthKind::normalised &&
      !(r.near >= 0 && r.far > r.near && std::isfinite(r.far)))
    throw Error("[input]",
                "depth_kind is normalised but depth_near and depth_far are not",
                "give both in metres, 0 <= depth_near < depth_far");
  return r;
}

DepthConstants depth_constants(const DepthRule& rule) noexcept {
  DepthConstants c;
  c.scale = static_cast<float>(rule.metres);
  c.from = float_at_least(rule.background_from);
  if (rule.kind == DepthKind::normalised) {
    c.scale = static_cast<float>(rule.far - rule.near);
    c.near = static_cast<float>(rule.near);
    c.slope = rule.white_near ? -1.f : 1.f;
    c.intercept = rule.white_near ? 1.f : 0.f;
  }
  return c;
}

void distances_from_depth(const DepthRule& rule, int n, const float* depth,
                          const float* per_planar, float* distance) noexcept {
  const DepthConstants c = depth_constants(rule);
  const DepthKernels& k = kernels();
  switch (rule.kind) {
    case DepthKind::planar:
      return k.planar(c, n, depth, per_planar, distance);
    case DepthKind::distance:
      return k.distance(c, n, depth, per_planar, distance);
    case DepthKind::inverse:
      return k.inverse(c, n, depth, per_planar, distance);
    case DepthKind::normalised:
      return k.normalised(c, n, depth, per_planar, distance);
  }
}

void distances_from_position(const View& view, double metres, int n, const float* px,
                             const float* py, const float* pz, const float* alpha,
                             const RaySpan& rays, float* distance) noexcept {
  PositionConstants c;
  for (int k = 0; k < 3; ++k) {
    const double eye = view.eye[k] / metres;
    const double high = first_24_bits(eye);
    c.high[k] = static_cast<float>(high);
    c.low[k] = static_cast<float>(eye - high);
  }
  c.metres = static_cast<float>(metres);
  kernels().position(c, n, px, py, pz, alpha, rays, distance);
}

DepthChoice find_depth(const ImageHeader& header) {
  struct Rule {
    bool (*is)(std::string_view);
    const char* why;
  };
  // EXR_CONVENTIONS, most certain first.
  static constexpr Rule rules[] = {
      {[](std::string_view n) { return n == "Z"; }, "EXR's own name for depth"},
      {[](std::string_view n) { return same(n, "depth.Z"); }, "Nuke's depth layer"},
      {[](std::string_view n) { return is_or_ends(n, "Depth.Z"); },
       "the depth pass of a render layer (Cycles)"},
      {[](std::string_view n) { return is_or_ends(n, "Depth.V"); },
       "a depth pass of one value (Cycles)"},
      {[](std::string_view n) { return n.ends_with("WorldDepth.R"); },
       "Unreal's world depth"},
      {[](std::string_view n) { return is_or_ends(n, "VRayZDepth.R"); },
       "V-Ray's depth pass; often normalised: see [input] depth_kind"},
      {[](std::string_view n) { return n == "Pz" || n == "z"; },
       "depth by its usual name in Mantra and 3Delight"},
  };
  for (const Rule& rule : rules) {
    DepthChoice choice;
    int others = 0;
    for (int i = 0; i < static_cast<int>(header.channels.size()); ++i) {
      if (!rule.is(header.channels[static_cast<std::size_t>(i)].name)) continue;
      if (choice.channel < 0)
        choice.channel = i;
      else
        ++others;
    }
    if (choice.channel < 0) continue;
    choice.why = rule.why;
    if (others > 0)
      choice.why += "; the first of " + std::to_string(others + 1) +
                    ", [input] depth chooses another";
    return choice;
  }
  return {-1, "no channel is named like depth; [input] depth names one"};
}

}  // namespace brume
