// num/math.h keeps what its comments promise, on every instruction set this processor
// has.

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "cases.h"
#include "functions.h"
#include "num/random.h"

namespace brume::test {
namespace {

constexpr int kRow = 1 << 12;
constexpr std::uint64_t kSeed = 20240229;

/// The tables of functions to hold to the bounds: host, and each instruction set there
/// is.
std::vector<std::pair<std::string, Functions>> tables() {
  std::vector<std::pair<std::string, Functions>> all = {{"host", isa_host::functions}};
  const Isa best = best_isa();
  all.emplace_back("v2", isa_v2::functions);
  if (best >= Isa::v3) all.emplace_back("v3", isa_v3::functions);
  if (best >= Isa::v4) all.emplace_back("v4", isa_v4::functions);
  return all;
}

const Function& find(const Functions& table, const std::string& name) {
  for (int i = 0; i < table.size; ++i)
    if (table.begin[i].name == name) return table.begin[i];
  throw std::runtime_error("functions.cpp has no " + name);
}

/// Numbers at which formulas break, in any T.
template <class T>
std::vector<T> edges() {
  using L = std::numeric_limits<T>;
  std::vector<T> e = {0,
                      L::denorm_min(),
                      L::min(),
                      L::epsilon(),
                      T(0.125),
                      T(0.5),
                      T(1) - L::epsilon() / 2,
                      1,
                      T(1) + L::epsilon(),
                      2,
                      T(3.25),
                      40,
                      88,
                      104,
                      709,
                      745,
                      T(8191.5),
                      T(1e9),
                      std::sqrt(L::max()),
                      L::max() / 2,
                      L::max(),
                      L::infinity(),
                      L::quiet_NaN()};
  for (std::size_t i = 0, n = e.size(); i < n; ++i) e.push_back(-e[i]);
  return e;
}

/// A random argument of `c`: any bit pattern, or near 1, or of ordinary size.
template <class T>
T argument(const Case& c, Random& random) {
  const double lo = sizeof(T) == 8 ? c.lo_twice : c.lo;
  for (;;) {
    const std::uint64_t a = random.word(), b = random.word();
    T x;
    if (a % 3 == 0) {
      if constexpr (sizeof(T) == 4)
        x = std::bit_cast<float>(static_cast<std::uint32_t>(b));
      else
        x = std::bit_cast<double>(b << 32 | random.word());
    } else {
      const double scale = a % 3 == 1 ? 3 : 120;
      x = static_cast<T>(random.uniform(-scale, scale));
    }
    if (std::abs(x) < T(c.least)) x = 0;
    if (x >= T(lo) && x <= T(c.hi)) return x;
  }
}

/// Rows of arguments with their exact values.
template <class T>
struct Samples {
  std::vector<T> x[4];
  std::vector<long double> exact;
};

template <class T>
void add(Samples<T>& s, const Case& c, int inputs, const T* x) {
  double wide[4] = {};
  bool nan = false;
  for (int k = 0; k < inputs; ++k) {
    s.x[k].push_back(x[k]);
    wide[k] = static_cast<double>(x[k]);
    nan |= std::isnan(x[k]);
  }
  // NaN in gives NaN out; pow is 1 where its other argument decides, as in C.
  s.exact.push_back(nan && c.name != "pow" ? NAN : c.exact(wide));
}

template <class T>
void fill_row(Samples<T>& s, const Case& c, int inputs) {
  const T x[4] = {1, 1, 1, 1};
  while (s.exact.size() % 16 != 0) add(s, c, inputs, x);
}

template <class T>
Samples<T> random_samples(const Case& c, int inputs) {
  Random random(kSeed, std::hash<std::string>()(c.name));
  Samples<T> s;
  // BRUME_TEST_SAMPLES=100 takes a hundred times as many.
  const char* more = std::getenv("BRUME_TEST_SAMPLES");
  const int n = c.samples * (more ? std::max(1, std::atoi(more)) : 1);
  for (int i = 0; i < n; ++i) {
    T x[4];
    for (int k = 0; k < inputs; ++k) x[k] = argument<T>(c, random);
    if (c.delicate && i % 2 == 0) {
      double d[4] = {};
      c.delicate(d, random.uniform(), random.uniform(), random.uniform());
      for (int k = 0; k < inputs; ++k) x[k] = static_cast<T>(d[k]);
    }
    add(s, c, inputs, x);
  }
  fill_row(s, c, inputs);
  return s;
}

/// All combinations of edges that lie in the domain, and all with a NaN.
template <class T>
Samples<T> edge_samples(const Case& c, int inputs) {
  const std::vector<T> e = edges<T>();
  const double lo = sizeof(T) == 8 ? c.lo_twice : c.lo;
  Samples<T> s;
  std::size_t count = 1;
  for (int k = 0; k < inputs; ++k) count *= e.size();
  const std::size_t stride = inputs > 2 ? 97 : 1;  // not all of 46^4
  for (std::size_t i = 0; i < count; i += stride) {
    T x[4];
    bool inside = true;
    for (std::size_t k = 0, j = i; k < static_cast<std::size_t>(inputs); ++k) {
      x[k] = e[j % e.size()];
      j /= e.size();
      inside &= std::isnan(x[k]) || (x[k] >= T(lo) && x[k] <= T(c.hi) &&
                                     (x[k] == 0 || std::abs(x[k]) >= T(c.least)));
    }
    if (inside) add(s, c, inputs, x);
  }
  fill_row(s, c, inputs);
  return s;
}

/// Runs f over the samples.
template <class T, class F>
std::vector<T> run(const F& f, const Samples<T>& s) {
  std::vector<T> out(s.exact.size());
  for (std::size_t i = 0; i < out.size(); i += kRow) {
    const T* in[4];
    for (int k = 0; k < 4; ++k) in[k] = s.x[k].data() + i;
    f(in, out.data() + i, static_cast<int>(std::min<std::size_t>(kRow, out.size() - i)));
  }
  return out;
}

template <class T>
std::string where(const Samples<T>& s, std::size_t i, int inputs) {
  std::string text;
  char number[40];
  for (int k = 0; k < inputs; ++k) {
    std::snprintf(number, sizeof number, "%s%.17g", k ? ", " : "", double(s.x[k][i]));
    text += number;
  }
  return "(" + text + ")";
}

/// The largest error of f over the samples, in ulp; says where it was.
template <class T, class F>
double worst(const F& f, const Samples<T>& s, int inputs, std::string& place) {
  const std::vector<T> got = run<T>(f, s);
  double worst = 0;
  for (std::size_t i = 0; i < got.size(); ++i) {
    if (s.exact[i] == kAnything) continue;
    const double e = ulps(got[i], s.exact[i]);
    if (!(e <= worst)) {
      worst = e;
      char text[100];
      std::snprintf(text, sizeof text, " = %.9g, exactly %.21Lg", double(got[i]),
                    s.exact[i]);
      place = where(s, i, inputs) + text;
    }
  }
  return worst;
}

class Math : public testing::TestWithParam<Case> {
 protected:
  const Case& c = GetParam();
  const int inputs = find(isa_host::functions, c.name).inputs;

  /// Holds every compiled version of the function to its bound on the samples.
  void expect_within_bound(const Samples<float>& single, const Samples<double>& twice) {
    const Stated* bound = stated(c.name);
    ASSERT_TRUE(bound) << "no line 'Bound [" << c.name << "]' in src/num";
    for (const auto& [isa, table] : tables()) {
      const Function& f = find(table, c.name);
      std::string place;
      const double b = worst(f.batch, single, inputs, place);
      EXPECT_LE(b, bound->single) << isa << " Batch " << c.name << place;
      const double s = worst(f.single, single, inputs, place);
      EXPECT_LE(s, bound->single) << isa << " float " << c.name << place;
      const double d = worst(f.twice, twice, inputs, place);
      EXPECT_LE(d, bound->twice) << isa << " double " << c.name << place;
      if (std::getenv("BRUME_TEST_VERBOSE"))
        std::printf("%-24s %-4s Batch %.3f float %.3f double %.3f\n", c.name.c_str(),
                    isa.c_str(), b, s, d);
    }
  }
};

TEST_P(Math, ErrorStaysWithinTheBoundInItsComment) {
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  expect_within_bound(random_samples<float>(c, inputs),
                      random_samples<double>(c, inputs));
}

TEST_P(Math, EdgesOfItsDomainAndNaN) {
  expect_within_bound(edge_samples<float>(c, inputs), edge_samples<double>(c, inputs));
}

// Where the formula changes, the error may not jump: else a gradient in a picture shows a
// line. From the last number before to the first after by 4 ulp at most, and by 2 in the
// mean of 64 on either side, which leaves out the noise of rounding.
template <class T, class F>
void expect_no_step(const Case& c, const std::string& label, const F& f) {
  constexpr T inf = std::numeric_limits<T>::infinity();
  constexpr std::size_t n = 64;
  for (const double at : c.switches) {
    Samples<T> s;
    T x = static_cast<T>(at);
    for (std::size_t i = 0; i < n; ++i) x = std::nextafter(x, -inf);
    for (std::size_t i = 0; i < 2 * n; ++i, x = std::nextafter(x, inf)) add(s, c, 1, &x);
    const std::vector<T> got = run<T>(f, s);
    const auto error = [&](std::size_t i) {
      return std::copysign(ulps(got[i], s.exact[i]), double(got[i] - s.exact[i]));
    };
    // The number at the switch itself may belong to either side.
    EXPECT_LE(std::abs(error(n) - error(n - 1)), 4) << label << where(s, n, 1);
    EXPECT_LE(std::abs(error(n + 1) - error(n)), 4) << label << where(s, n, 1);
    double before = 0, after = 0;
    for (std::size_t i = 0; i < n; ++i) before += error(i) / n, after += error(n + i) / n;
    EXPECT_LE(std::abs(after - before), 2) << label << where(s, n, 1);
  }
}

TEST_P(Math, NoStepWhereTheFormulaChanges) {
  for (const auto& [isa, table] : tables()) {
    const Function& f = find(table, c.name);
    expect_no_step<float>(c, isa + " Batch " + c.name, f.batch);
    expect_no_step<float>(c, isa + " float " + c.name, f.single);
    expect_no_step<double>(c, isa + " double " + c.name, f.twice);
  }
}

INSTANTIATE_TEST_SUITE_P(AllFunctions, Math, testing::ValuesIn(cases()),
                         [](const testing::TestParamInfo<Case>& test) {
                           std::string name = test.param.name;
                           for (char& c : name)
                             if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
                           return name;
                         });

TEST(MathBounds, EveryStatedBoundIsTested) {
  for (const Stated& s : stated()) {
    bool tested = false;
    for (const Case& c : cases()) tested |= c.name == s.name;
    EXPECT_TRUE(tested) << s.name;
  }
}

// The table in src/num/README.md is made from the comments: BRUME_UPDATE=1 writes it
// anew.
TEST(MathBounds, TableInReadmeIsUpToDate) {
  const std::string path = BRUME_SOURCE_DIR "/src/num/README.md";
  const std::string begin = "<!-- table: test_num -->\n", end = "<!-- end of table -->\n";
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  const std::string readme = text.str();
  const auto from = readme.find(begin), to = readme.find(end);
  ASSERT_TRUE(from != readme.npos && to != readme.npos) << "no place for the table";

  std::ostringstream table;
  table << "| function | float [ulp] | double [ulp] | cost [ns/value] "
           "|\n|---|---|---|---|\n";
  for (const Stated& s : stated()) {
    EXPECT_NE(s.cost, "") << "no line 'Cost [" << s.name << "]'";
    table << "| " << s.name << " | " << s.single << " | " << s.twice << " | " << s.cost
          << " |\n";
  }
  const std::string fresh =
      readme.substr(0, from) + begin + table.str() + readme.substr(to);
  if (std::getenv("BRUME_UPDATE")) std::ofstream(path) << fresh;
  EXPECT_EQ(readme, fresh) << "stale: run test_num with BRUME_UPDATE=1";
}

}  // namespace
}  // namespace brume::test
