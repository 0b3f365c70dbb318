#pragma once
// Written by `./run curves`.

namespace brume::sky {

// Values of detail, and the error that is promised
// at each: |dC| <= error (white + |C|).
// clang-format off
inline constexpr double kCurve[] = {0.7, 0.0016, 1, 0.00044, 1.5, 0.00019, 4, 0.00018};
// clang-format on

}  // namespace brume::sky
