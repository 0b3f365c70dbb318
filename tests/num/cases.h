#pragma once
// What is known of each function of num/math.h: its domain, its exact value, and the
// places where its formula changes. The bounds come from the comments of num/math_*.h.

#include <functional>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

namespace brume::test {

/// What a function's comment says of it.
struct Stated {
  std::string name;
  double single, twice;  // error bound [ulp] in float, in double
  std::string cost;      // "v4 0.2, v3 0.3, v2 1", ns per value
};

/// All pairs of lines "Bound [name]: float a, double b ulp" and "Cost [name]: ... ns" of
/// src/num/*.h, in their order there.
const std::vector<Stated>& stated();
const Stated* stated(const std::string& name);

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
