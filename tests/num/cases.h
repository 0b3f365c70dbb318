#pragma once
// What is known of each function of num/math.h: its domain, its exact value, and the
// places where its formula changes. The bounds come from the comments of num/math_*.h.

#include <functional>
#include <limits>
#include <map>
#include <ostream>
#include <string>
#include <vector>

namespace brume::test {

struct Bound {
  double single, twice;  // ulp in float, in double
};

/// All "Bound [name]: float a, double b ulp" lines of src/num/math_*.h.
std::map<std::string, Bound> stated_bounds();

/// What `exact` gives where the comment promises nothing.
inline constexpr long double kAnything = std::numeric_limits<long double>::max();

struct Case {
  std::string name;
  std::function<long double(const double*)> exact;       // to 1e-18
  double lo = -std::numeric_limits<double>::infinity();  // of every argument
  double hi = std::numeric_limits<double>::infinity();
  double lo_twice = lo;               // the same in double, where it differs
  double least = 0;                   // smaller arguments count as 0
  std::vector<double> switches = {};  // where the formula changes (one argument only)
  int samples = 100'000;
  /// Arguments near something delicate, from three uniform numbers.
  std::function<void(double* x, double u, double v, double w)> delicate = {};
};
const std::vector<Case>& cases();
inline void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

/// |got - exact| in ulp of T at `exact` (at denormals' where that is smaller). Infinity
/// counts as the number after the largest.
template <class T>
double ulps(T got, long double exact);
extern template double ulps(float, long double);
extern template double ulps(double, long double);

}  // namespace brume::test
