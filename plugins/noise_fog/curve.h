#pragma once
// Written by `./run curves`.

namespace brume::noise_fog {

// Values of error, and the error that is promised
// at each: |dC| <= error (white + |C|).
// clang-format off
inline constexpr double kCurve[] = {0.3, 2.2, 0.1, 0.74, 0.03, 0.098, 0.01, 0.029, 0.003, 0.009, 0.001, 0.0019, 0.0005, 0.00097, 0.0003, 0.0007, 0.0002, 0.00044, 0.00015, 0.0003, 0.0001, 0.00021, 5e-05, 0.00013, 3e-06, 2e-05};
// clang-format on

}  // namespace brume::noise_fog
