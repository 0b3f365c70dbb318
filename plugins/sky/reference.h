#pragma once
// The reference radiances of data/reference/sky, and how an answer is judged against
// them.

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "trace.h"

namespace brume::sky {

struct ReferenceRow {
  double h, sun, view, azimuth;  // [m], [degrees]
  Ray ray;
  double T[3], single[3], L[3], error[3];  // 680, 550, 440 nm
};

/// "sky", "aerial" or "space". Empty where the file is not found.
std::vector<ReferenceRow> reference(const std::string& name);

/// One group of rows, as the issue judges: by altitude and sun.
struct Judged {
  double rmse_over_mean = 0, bias_over_mean = 0, noise_over_mean = 0, worst_T = 0;
  int count = 0;
};

/// `answer(row, L, T)` gives three values each.
template <class Answer>
std::map<std::pair<double, double>, Judged> judge(const std::vector<ReferenceRow>& rows,
                                                  Answer&& answer) {
  struct Sum {
    double squares = 0, error = 0, mean = 0, noise = 0;
  };
  std::map<std::pair<double, double>, Judged> out;
  std::map<std::pair<double, double>, Sum> sums;
  for (const ReferenceRow& row : rows) {
    double L[3], T[3];
    answer(row, L, T);
    Judged& j = out[{row.h, row.sun}];
    Sum& s = sums[{row.h, row.sun}];
    for (int c = 0; c < 3; ++c, ++j.count) {
      const double e = L[c] - row.L[c], t = T[c] - row.T[c];
      s.squares += e * e, s.error += e, s.mean += row.L[c],
          s.noise += row.error[c] * row.error[c];
      if (!(t <= j.worst_T && -t <= j.worst_T)) j.worst_T = t < 0 ? -t : t;
    }
  }
  for (auto& [key, j] : out) {
    const Sum& s = sums[key];
    const double mean = s.mean / j.count;
    j.rmse_over_mean = __builtin_sqrt(s.squares / j.count) / mean;
    j.bias_over_mean = s.error / j.count / mean;
    j.noise_over_mean = __builtin_sqrt(s.noise / j.count) / mean;
  }
  return out;
}

}  // namespace brume::sky
