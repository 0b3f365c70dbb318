#pragma once
// Colours between primaries: what a scene file's `colorspace` means in a frame.

#include <array>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "params/params.h"

namespace brume {

/// CIE 1931 x, y of red, green, blue and white: rx ry gx gy bx by wx wy.
using Chromaticities = std::array<double, 8>;

/// Rec. ITU-R BT.709-6, what a frame without the attribute has.
inline constexpr Chromaticities kRec709{.64, .33, .30, .60, .15, .06, .3127, .3290};

/// The names that `colorspace` takes: "frame" (the frame's own primaries, linear) first.
std::vector<std::string> color_space_names();

/// A colour of the space called so, as the frame with these primaries has it: decoded
/// where the space is (srgb; values beyond 1 and below 0 go on as the curve does, odd),
/// then between primaries, and between whites by the Bradford transform. `name` is one of
/// color_space_names(). Throws Error for primaries on a line.
glm::dvec3 to_frame(std::string_view name, const Chromaticities& frame, glm::dvec3 rgb);

/// The same to every colour among a stage's values; what leaves its parameter's range by
/// it (a saturated colour of wider primaries) is brought back to the range's end. An rgb
/// per metre is a coefficient per channel, not a colour, and stays.
void to_frame(std::string_view name, const Chromaticities& frame,
              std::span<const ParamSpec> specs, std::span<Value> values);

}  // namespace brume
