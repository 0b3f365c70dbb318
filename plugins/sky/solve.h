#pragma once
// The table of diffuse light, solved by iterating over orders of scattering: the light of
// order n + 1 is that of order n, scattered once more by every point of the air.

#include <array>
#include <vector>

#include "atmosphere.h"
#include "forward.h"
#include "types.h"

namespace brume::sky {

/// Directions from which light is gathered: elevations above and below the local horizon,
/// azimuths over half a turn; panels on a path's monotone piece.
struct Directions {
  int up, down, around, panels;
};

/// The solver's knobs. Sunlight scattered once has the sharpest features; later orders do
/// with fewer directions. Twice the directions leave the error what it is (README).
struct Resolution {
  int altitudes = 24, suns = 40;
  Directions first{10, 7, 16, 4};
  Directions next{7, 5, 10, 3};
  int orders = 4;  // iterations after the first; the rest as a geometric series
};

/// One group of wavelengths, solved. Not copied: `table` and `forward` point into it.
template <class S>
struct Light {
  Air<S> air;
  Table<S> table;
  Forward<S> forward;
  std::vector<S> nodes, ground, series, column;
  int N, L;

  /// All that solve() finds.
  std::array<std::vector<S>*, 4> tables() { return {&nodes, &ground, &series, &column}; }

  Light() = default;
  Light(const Light&) = delete;
  Light& operator=(const Light&) = delete;
};

/// Everything but the numbers in its tables: for wavelengths `begin` to `begin + k.N` of
/// `a` (the last repeated).
template <class S>
void lay_out(const Atmosphere& a, int begin, const Resolution& r, const Kernels<S>& k,
             Light<S>& out);

/// Lays out and solves. Never throws for a checked atmosphere.
template <class S>
void solve(const Atmosphere& a, int begin, const Resolution& r, const Kernels<S>& k,
           Light<S>& out);

}  // namespace brume::sky
