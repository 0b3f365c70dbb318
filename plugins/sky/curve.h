#pragma once
// Written by `./run curves`.

namespace brume::sky {

// Values of detail, and the error that is promised
// at each: |dC| <= error (white + |C|).
// clang-format off
inline constexpr double kCurve[] = {0.7, 0.0064, 1, 0.0039, 4, 0.00018};
// clang-format on

}  // namespace brume::sky
