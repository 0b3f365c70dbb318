#include <algorithm>
#include <numeric>

#include "stress/air_group.h"
#include "stress/draw.h"
#include "stress/scenery.h"

namespace brume::stress {
namespace {

template <class F>
void each(Part part, F&& f) {
  for (int i = part.begin; i < part.begin + part.count; ++i)
    for (int c = 0; c < 3; ++c) f(i, c, std::size_t(i));
}

// L(A and B) + L(neither) = L(A) + L(B).
void check_sum(AirGroup& g, const Answers& whole, const Answers& none, Findings& found) {
  const std::size_t n = g.world().lights.size();
  std::vector<std::size_t> parts[2];
  for (std::size_t k = 0; k < n; ++k) parts[k < (n + 1) / 2].push_back(k);
  Answers a[2];
  for (int p : {0, 1})
    a[p] =
        ask(g.compile(with_lights(g.world(), parts[p]), g.isas.back()), g.rays, g.part);
  each(g.part, [&](int i, int c, std::size_t k) {
    const double L = whole.L[c][k];
    const Slack s = g.slack(i, g.rays.t[k]);
    found.near(Law::additive, g.case_of(i), c,
               double(a[0].L[c][k]) + double(a[1].L[c][k]), L + double(none.L[c][k]),
               g.allowed_L(s, i, c, L, 1 - double(whole.T[c][k]), 3));
  });
}

// Everything told in another order.
void check_order(AirGroup& g, const Answers& whole, Findings& found) {
  World w = g.world();
  const auto mix = [&](auto& list) {
    for (std::size_t k = list.size(); k > 1; --k)
      std::swap(list[k - 1], list[std::size_t(integer(g.random, int(k)))]);
  };
  mix(w.media), mix(w.lights);
  const Answers a = ask(g.compile(w, g.isas.back()), g.rays, g.part);
  each(g.part, [&](int i, int c, std::size_t k) {
    found.same(Law::order, g.case_of(i), c, a.T[c][k], whole.T[c][k]);
    found.same(Law::order, g.case_of(i), c, a.L[c][k], whole.L[c][k]);
  });
}

}  // namespace

void check_lights(AirGroup& g, const Answers& whole, Findings& found) {
  if (g.world().lights.size() + g.world().media.size() > 1) check_order(g, whole, found);
  if (g.world().lights.empty()) return;
  const Answers none =
      ask(g.compile(with_lights(g.world(), {}), g.isas.back()), g.rays, g.part);
  each(g.part, [&](int i, int c, std::size_t k) {
    found.same(Law::dark, g.case_of(i), c, whole.T[c][k], none.T[c][k]);
    found.at_most(Law::dark, g.case_of(i), c, none.L[c][k], whole.L[c][k],
                  g.allowed_L(g.slack(i, g.rays.t[k]), i, c, whole.L[c][k],
                              1 - double(whole.T[c][k]), 2));
  });
  check_sum(g, whole, none, found);
}

}  // namespace brume::stress
