#include "cases.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <regex>
#include <stdexcept>

#include "exact.h"

namespace brume::test {

const std::vector<Stated>& stated() {
  static const std::vector<Stated> all = [] {
    static const std::regex bound(
        R"(//\s+Bound \[([^\]]+)\]: float ([0-9.]+), double ([0-9.]+) ulp)");
    static const std::regex cost(R"(//\s+Cost \[([^\]]+)\]: (.*) ns)");
    std::vector<std::filesystem::path> files;
    for (const auto& f : std::filesystem::directory_iterator(BRUME_SOURCE_DIR "/src/num"))
      if (f.path().extension() == ".h") files.push_back(f.path());
    std::sort(files.begin(), files.end());
    std::vector<Stated> list;
    for (const auto& file : files) {
      std::ifstream in(file);
      std::smatch m;
      for (std::string line; std::getline(in, line);) {
        if (std::regex_search(line, m, bound))
          list.push_back({m[1], std::stod(m[2]), std::stod(m[3]), ""});
        else if (std::regex_search(line, m, cost))
          for (Stated& s : list)
            if (s.name == m[1]) s.cost = m[2];
      }
    }
    return list;
  }();
  return all;
}

const Stated* stated(const std::string& name) {
  for (const Stated& s : stated())
    if (s.name == name) return &s;
  return nullptr;
}

template <class T>
double ulps(T got, long double exact) {
  using Limits = std::numeric_limits<T>;
  if (std::isnan(exact) || std::isnan(got))
    return std::isnan(exact) && std::isnan(got) ? 0 : INFINITY;
  const long double beyond = std::ldexp(1.0L, Limits::max_exponent);
  const long double a = std::isinf(got) ? std::copysign(beyond, got) : got;
  if (std::isinf(got) && std::abs(exact) >= beyond)
    return std::signbit(got) == std::signbit(exact) ? 0 : INFINITY;
  if (std::isinf(exact)) return INFINITY;
  int exponent = Limits::min_exponent;
  if (exact != 0) std::frexp(exact, &exponent);
  exponent = std::clamp(exponent, Limits::min_exponent, Limits::max_exponent);
  return static_cast<double>(std::abs(a - exact) /
                             std::ldexp(1.0L, exponent - Limits::digits));
}
template double ulps(float, long double);
template double ulps(double, long double);

namespace {

using exact::Big;
using std::function;
using Arguments = const double*;
using R = long double;

function<R(Arguments)> of1(R (*f)(R)) {
  return [f](Arguments x) { return f(x[0]); };
}
function<R(Arguments)> of2(R (*f)(R, R)) {
  return [f](Arguments x) { return f(x[0], x[1]); };
}

// The second argument nearly equals the first.
void twins(double* x, double u, double v, double w) {
  x[0] = std::pow(10, 6 * u - 3) * (w < 0.5 ? -1 : 1);
  x[1] = x[0] * (1 + std::pow(10, -16 * v) * (std::fmod(w * 4, 1) - 0.5));
}
void positive_twins(double* x, double u, double v, double w) {
  twins(x, u, v, w);
  x[0] = std::abs(x[0]), x[1] = std::abs(x[1]);
}
// From 1 to far away, to a power that stays within the range of T now and then.
void powers(double* x, double u, double v, double w) {
  x[0] = std::exp(20 * (u - 0.5) * v);
  x[1] = (w - 0.5) * 1440 / std::abs(std::log(x[0]) + 1e-9);
}
void gaussian_ends(double* x, double u, double v, double w) {
  x[0] = 20 * (u - 0.5);
  x[1] = x[0] + std::pow(10, 2 - 18 * v) * (w - 0.5);
}
void cancelling_products(double* x, double u, double v, double w) {
  positive_twins(x, u, v, w);
  x[2] = x[0] * (1 + w), x[3] = x[1] / (1 + w);
}
void grazing(double* x, double u, double v, double w) {
  x[0] = std::pow(10, 6 * u - 3), x[1] = std::pow(10, 6 * w - 3);
  x[2] = x[1] * (x[1] / x[0]) * (1 - std::pow(10, -20 * v));
}

R root(Arguments x, bool upper) {
  if (exact::discriminant(x[0], x[1], x[2]) < 0 || (x[0] == 0 && x[1] == 0))
    return kAnything;
  const auto [lo, hi] = exact::roots(x[0], x[1], x[2]);
  return static_cast<R>(upper ? hi : lo);
}

std::vector<Case> all_cases() {
  return {
      {.name = "exp", .exact = of1([](R x) { return std::exp(x); })},
      {.name = "expm1",
       .exact = of1([](R x) { return std::expm1(x); }),
       .switches = {40}},
      {.name = "transmit T",
       .exact = of1([](R x) { return std::exp(-x); }),
       .lo = -88,
       .lo_twice = -709},
      {.name = "transmit A",
       .exact = of1([](R x) { return -std::expm1(-x); }),
       .lo = -88,
       .lo_twice = -709},
      {.name = "exprel", .exact = of1(exact::exprel), .switches = {0, -40}},
      {.name = "exprel2", .exact = of1(exact::exprel2), .switches = {0, -2, 2, -40}},
      {.name = "source_weights E1",
       .exact = of1([](R d) { return exact::source_weight(1, d); }),
       .switches = {0, 4}},
      {.name = "source_weights E2",
       .exact = of1([](R d) { return exact::source_weight(2, d); }),
       .switches = {0, 4}},
      {.name = "log", .exact = of1([](R x) { return std::log(x); })},
      {.name = "log1p", .exact = of1([](R x) { return std::log1p(x); }), .switches = {1}},
      {.name = "pow",
       .exact = of2([](R x, R y) { return std::pow(x, y); }),
       .lo = 0,
       .delicate = powers},
      {.name = "log_mean",
       .exact = of2(exact::log_mean),
       .lo = 0,
       .delicate = positive_twins},
      {.name = "sin",
       .exact = of1([](R x) { return std::sin(x); }),
       .lo = -8192,
       .hi = 8192},
      {.name = "cos",
       .exact = of1([](R x) { return std::cos(x); }),
       .lo = -8192,
       .hi = 8192},
      {.name = "atan2pos",
       .exact = of2([](R y, R x) { return y < 0 ? kAnything : exact::angle(y, x); })},
      {.name = "atan2", .exact = of2(exact::angle)},
      {.name = "atan_difference",
       .exact = of2(exact::atan_difference),
       .lo = -0x1p126,
       .hi = 0x1p126,
       .delicate = twins},
      {.name = "asin",
       .exact = of1([](R x) { return std::asin(x); }),
       .lo = -1,
       .hi = 1,
       .switches = {-0.5, 0.5}},
      {.name = "acos",
       .exact = of1([](R x) { return std::acos(x); }),
       .lo = -1,
       .hi = 1,
       .switches = {-0.5, 0.5}},
      {.name = "erf",
       .exact = of1([](R x) { return std::erf(x); }),
       .switches = {-0.5, 0.5}},
      {.name = "erfc",
       .exact = of1([](R x) { return std::erfc(x); }),
       .switches = {-0.5, 0.5}},
      {.name = "erfcx", .exact = of1(exact::erfcx), .switches = {-0.5, 0.5}},
      {.name = "erf_difference",
       .exact = [](Arguments x) { return R(exact::erf_difference(x[0], x[1])); },
       .samples = 6'000,
       .delicate = gaussian_ends},
      {.name = "smoothstep", .exact = of1([](R x) {
                               return x < 0 ? 0 : x > 1 ? 1 : x * x * (3 - 2 * x);
                             })},
      {.name = "hypot", .exact = of2([](R x, R y) { return std::hypot(x, y); })},
      {.name = "difference_of_products",
       .exact = [](Arguments x) { return R(Big(x[0]) * x[1] - Big(x[2]) * x[3]); },
       .lo = -1e15,
       .hi = 1e15,
       .least = 1e-15,
       .samples = 30'000,
       .delicate = cancelling_products},
      {.name = "quadratic lo",
       .exact = [](Arguments x) { return root(x, false); },
       .lo = -1e15,
       .hi = 1e15,
       .least = 1e-15,
       .samples = 30'000,
       .delicate = grazing},
      {.name = "quadratic hi",
       .exact = [](Arguments x) { return root(x, true); },
       .lo = -1e15,
       .hi = 1e15,
       .least = 1e-15,
       .samples = 30'000,
       .delicate = grazing},
  };
}

}  // namespace

const std::vector<Case>& cases() {
  static const std::vector<Case> list = all_cases();
  return list;
}

}  // namespace brume::test
