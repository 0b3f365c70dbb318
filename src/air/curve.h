#pragma once
// Written by `./run curves`.

namespace brume {

// Tolerances of the integrator, and the error that is promised
// at each: |dC| <= error (white + |C|).
// clang-format off
inline constexpr double kAirCurve[] = {0.1, 0.96, 0.03, 0.32, 0.01, 0.14, 0.003, 0.024, 0.001, 0.0079, 0.0003, 0.0052, 0.0001, 0.0005, 3e-05, 0.00045, 1e-05, 2.8e-05, 3e-06, 2.2e-05};
// clang-format on

}  // namespace brume
