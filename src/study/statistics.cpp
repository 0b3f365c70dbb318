#include "study/statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace brume::study {

namespace {

double quantile(const std::vector<double>& sorted, double p) {
  const double at = p * double(sorted.size() - 1);
  const auto below = std::size_t(at);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (at - double(below)) * (sorted[above] - sorted[below]);
}

bool is_number(const Cost& c) { return !std::isnan(c.seconds) && !std::isnan(c.error); }

}  // namespace

Spread spread(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  return {quantile(values, 0.25), quantile(values, 0.5), quantile(values, 0.75)};
}

std::vector<std::size_t> frontier(std::span<const Cost> costs) {
  std::vector<std::size_t> order(costs.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::erase_if(order, [&](std::size_t i) { return !is_number(costs[i]); });
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (costs[a].seconds != costs[b].seconds) return costs[a].seconds < costs[b].seconds;
    return costs[a].error < costs[b].error;
  });
  std::vector<std::size_t> best;
  for (const std::size_t i : order)
    if (best.empty() || costs[i].error < costs[best.back()].error) best.push_back(i);
  return best;
}

std::optional<std::size_t> least_error_within(std::span<const Cost> costs,
                                              double seconds) {
  std::optional<std::size_t> best;
  for (const std::size_t i : frontier(costs))
    if (costs[i].seconds <= seconds) best = i;
  return best;
}

std::optional<std::size_t> least_time_for(std::span<const Cost> costs, double error) {
  for (const std::size_t i : frontier(costs))
    if (costs[i].error <= error) return i;
  return {};
}

}  // namespace brume::study
