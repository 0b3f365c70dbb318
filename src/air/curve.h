#pragma once
// Written by `./run curves`.

namespace brume {

// Tolerances of the integrator, and the error that is promised
// at each: |dC| <= error (white + |C|).
// clang-format off
inline constexpr double kAirCurve[] = {0.1, 0.26, 0.03, 0.17, 0.01, 0.14, 0.003, 0.014, 0.001, 0.0046, 0.0003, 0.00088, 0.0001, 0.00015, 3e-05, 4.2e-05, 1e-05, 1.5e-05};
// clang-format on

}  // namespace brume
