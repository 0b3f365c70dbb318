#pragma once
// The table of diffuse light, solved by iterating over orders of scattering.

#include <functional>
#include <vector>

#include "atmosphere.h"
#include "forward.h"
#include "gather.h"

namespace brume::sky {

/// The solver's knobs.
struct Resolution {
  int altitudes = 24, suns = 40;  // nodes of the table
  int up = 8, down = 6,
      around = 8;  // directions above and below the horizon, azimuths over half a turn
  int panels = 6;  // of a path, per monotone piece
  int orders = 5;  // iterations after the first order; the rest by extrapolation
};

/// A table and the kernels' view of it.
template <class S, int N>
struct DiffuseLight {
  Air<S, N> air;
  Table<S> table;
  Forward<S> forward;
  std::vector<S> nodes, ground;
  ForwardTables<S> peak;
};

template <class S, int N, int L>
struct Gather {  // the kernels, of whatever instruction set
  void (*line)(const Air<S, N>&, const Trace&, int panels, Line<S, N>&) =
      [](const Air<S, N>& a, const Trace& t, int panels, Line<S, N>& l) {
        place_nodes(a.shape, t, panels, l.nodes);
        weigh(a.at1, l.nodes, l.weights);
      };
  void (*first)(const Air<S, N>&, const Line<S, N>&, const Suns<S>&,
                S*) = gather_first<S, N>;
  void (*next)(const Air<S, N>&, const Table<S>&, const Line<S, N>&, const Suns<S>&,
               S*) = gather_next<S, N, L>;
};

template <class S, int N>
Air<S, N> make_air(const Atmosphere& a);

template <class S, int N, int L>
void solve(const Atmosphere& a, const Resolution& resolution,
           const Gather<S, N, L>& gather, DiffuseLight<S, N>& out);

}  // namespace brume::sky

#include "solve.inl"
