#pragma once
// Numbers about measurements, and the choice between settings.

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace brume::study {

/// Of repeated measurements: the median, and the quartiles as their noise.
struct Spread {
  double low = 0, median = 0, high = 0;
};
/// Quantiles by linear interpolation between order statistics (Hyndman & Fan 1996,
/// definition 7). Zeros for nothing.
Spread spread(std::vector<double>);

/// What a setting takes [s] and how far off it is.
struct Cost {
  double seconds = 0, error = 0;
};

/// The settings that no other beats in both time and error, by rising time: each has less
/// error than all that are faster. Of equals the first. NaN in either is never chosen,
/// here and below.
std::vector<std::size_t> frontier(std::span<const Cost>);

/// The least error among those that take at most `seconds` (of equal errors the fastest);
/// nothing where none is fast enough.
std::optional<std::size_t> least_error_within(std::span<const Cost>, double seconds);

/// The least time among those whose error is at most `error`; nothing where none is.
std::optional<std::size_t> least_time_for(std::span<const Cost>, double error);

}  // namespace brume::study
