#pragma once
// What a way takes, and how far off it is.

#include "study/rays.h"
#include "study/statistics.h"
#include "study/way.h"
#include "truth/truth.h"

namespace brume::study {

/// T and L of rays in planes, as many as the rays' own.
struct Answers {
  std::vector<float> T[3], L[3];

  explicit Answers(const Rays&);
};

/// All cores. Throws what the way throws.
Answers evaluate(const Way&, const Rays&);

/// What is right, in double, and how far from converged that may be.
struct Reference {
  std::vector<truth::Rgb> T, L;
  double error = 0;  ///< largest of the colour, relative to white + |C|
  std::size_t unconverged = 0;
};

/// Of one quantity over rays: largest, exceeded by 1 in 100, root mean square, mean.
struct ErrorOf {
  double max = 0, p99 = 0, rms = 0, mean = 0;
};
ErrorOf error_of(std::vector<double> differences);

struct Deviation {
  ErrorOf color, T, L;
  std::size_t worst = 0;            ///< the ray where the colour is farthest off
  std::vector<float> color_by_ray;  ///< largest channel of |dC| / (white + |C|)
};
/// Of the first `even` rays p99, rms and mean; max of all. The colour is C = S T + L.
Deviation deviation(const Rays&, const Answers&, const Reference&, double white,
                    std::size_t even);

/// The rays (indices) on which two answers differ most in colour, worst first, at most
/// one of each 16 x 16 pixels.
std::vector<std::uint32_t> farthest_apart(const Rays&, const Answers&, const Answers&,
                                          double white, std::size_t most);

/// Seconds of one core for blocks of neighbouring pixels, in turns.
class Stopwatch {
 public:
  explicit Stopwatch(const Rays& rays) : rays_(rays) {}
  /// `seconds`: at most so long for one measurement.
  void add(const Way&, double seconds);
  /// Measures each way once, one after the other; called again and again, so that what
  /// else the machine does meets all of them alike.
  void round();
  /// Of way number i [s per pixel].
  Spread per_pixel(std::size_t i) const { return spread(entries_[i].seconds); }
  /// What the first call took more than later ones: tables that are made on demand [s].
  double first(std::size_t i) const { return entries_[i].first; }

 private:
  struct Entry {
    const Way* way;
    std::size_t blocks;
    double first = 0;
    std::vector<double> seconds;
  };
  double run(const Way&, std::size_t blocks) const;
  const Rays& rays_;
  std::vector<Entry> entries_;
};

/// Seconds that this thread, or all threads of this process, have had of a processor.
double thread_seconds();
double process_seconds();

}  // namespace brume::study
