#include "functions.h"

#include "num/math.h"
#include "num/noise.h"

namespace brume::test::inline BRUME_ISA_NS {

template <class T, auto f>
static void row(const Scalar_t<T>* const* in, Scalar_t<T>* out, int n) {
  for (int i = 0; i < n; i += lanes<T>) {
    const auto x = [&](int k) { return load<T>(in[k] + i); };
    if constexpr (requires { f(x(0)); })
      store(out + i, f(x(0)));
    else if constexpr (requires { f(x(0), x(0)); })
      store(out + i, f(x(0), x(1)));
    else if constexpr (requires { f(x(0), x(0), x(0)); })
      store(out + i, f(x(0), x(1), x(2)));
    else
      store(out + i, f(x(0), x(1), x(2), x(3)));
  }
}

template <auto f>
constexpr Function entry(const char* name) {
  int inputs = 4;
  if constexpr (requires { f(1.0f); })
    inputs = 1;
  else if constexpr (requires { f(1.0f, 1.0f); })
    inputs = 2;
  else if constexpr (requires { f(1.0f, 1.0f, 1.0f); })
    inputs = 3;
  return {name, inputs, row<Batch, f>, row<float, f>, row<double, f>};
}

static constexpr Function table[] = {
    entry<[](auto x) { return exp(x); }>("exp"),
    entry<[](auto x) { return expm1(x); }>("expm1"),
    entry<[](auto x) { return transmit(x).T; }>("transmit T"),
    entry<[](auto x) { return transmit(x).A; }>("transmit A"),
    entry<[](auto x) { return exprel(x); }>("exprel"),
    entry<[](auto x) { return exprel2(x); }>("exprel2"),
    entry<[](auto x) { return source_weights(x).E1; }>("source_weights E1"),
    entry<[](auto x) { return source_weights(x).E2; }>("source_weights E2"),
    entry<[](auto x) { return log(x); }>("log"),
    entry<[](auto x) { return log1p(x); }>("log1p"),
    entry<[](auto x, auto y) { return pow(x, y); }>("pow"),
    entry<[](auto a, auto b) { return log_mean(a, b); }>("log_mean"),
    entry<[](auto x) { return sin(x); }>("sin"),
    entry<[](auto x) { return cos(x); }>("cos"),
    entry<[](auto y, auto x) { return atan2pos(y, x); }>("atan2pos"),
    entry<[](auto y, auto x) { return atan2(y, x); }>("atan2"),
    entry<[](auto a, auto b) { return atan_difference(a, b); }>("atan_difference"),
    entry<[](auto x) { return asin(x); }>("asin"),
    entry<[](auto x) { return acos(x); }>("acos"),
    entry<[](auto x) { return erf(x); }>("erf"),
    entry<[](auto x) { return erfc(x); }>("erfc"),
    entry<[](auto x) { return erfcx(x); }>("erfcx"),
    entry<[](auto a, auto b) { return erf_difference(a, b); }>("erf_difference"),
    entry<[](auto x) { return smoothstep(x); }>("smoothstep"),
    entry<[](auto x, auto y) { return hypot(x, y); }>("hypot"),
    entry<[](auto a, auto b, auto c, auto d) {
      return difference_of_products(a, b, c, d);
    }>("difference_of_products"),
    entry<[](auto a, auto b, auto c) { return quadratic(a, b, c).lo; }>("quadratic lo"),
    entry<[](auto a, auto b, auto c) { return quadratic(a, b, c).hi; }>("quadratic hi"),
    entry<[](auto x, auto y, auto z) { return noise(x, y, z, 7u, 0); }>("noise"),
    entry<[](auto x, auto y, auto z) { return noise(x, y, z, 7u, 5); }>("noise 5"),
};
const Functions functions = {table, sizeof(table) / sizeof(table[0])};

}  // namespace brume::test::inline BRUME_ISA_NS
