#pragma once
#include "gather.h"
#include "view.h"

namespace brume::sky::inline BRUME_ISA_NS {

template <int N, class S>
void make_line(const Air<S>& air, const Trace& trace, int panels,
               Line<S>& line) noexcept {
  place_nodes(air.shape, trace, panels, line.nodes);
  weigh<N>(air, line.nodes, S(1), line.weights);
}

template <class S, int N, int L>
constexpr Kernels<S> kernels_of() {
  return {N,
          L,
          make_line<N, S>,
          gather_first<N, S>,
          gather_next<N, L, S>,
          project<N, L, S>,
          see<N, L, S>,
          see_along<N, L, S>,
          source<N, L, S>};
}

}  // namespace brume::sky::inline BRUME_ISA_NS
