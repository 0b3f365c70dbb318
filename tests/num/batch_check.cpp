#include "batch_check.h"

#include "num/noise.h"

namespace brume::test::inline BRUME_ISA_NS {

constexpr int W = Batch::W;

static bool same(float x, float y) { return bits(x) == bits(y) || (x != x && y != y); }

// The same expression on a Batch and on each of its lanes.
template <class F>
static bool agrees(const float* a, const float* b, F f) {
  const Batch whole = f(load<Batch>(a), load<Batch>(b));
  for (int i = 0; i < W; ++i)
    if (!same(whole[i], f(a[i], b[i]))) return false;
  return true;
}

static const char* disagreement(const float* a, const float* b, int n) {
  for (int i = 0; i + W <= n; i += W, a += W, b += W) {
    if (!agrees(a, b, [](auto x, auto y) { return x + y; })) return "+";
    if (!agrees(a, b, [](auto x, auto y) { return x - y; })) return "-";
    if (!agrees(a, b, [](auto x, auto y) { return x * y; })) return "*";
    if (!agrees(a, b, [](auto x, auto y) { return x / y; })) return "/";
    if (!agrees(a, b, [](auto x, auto) { return -x; })) return "negation";
    if (!agrees(a, b, [](auto x, auto y) { return min(x, y); })) return "min";
    if (!agrees(a, b, [](auto x, auto y) { return max(x, y); })) return "max";
    if (!agrees(a, b, [](auto x, auto y) { return clamp(x, -1.0f, y); })) return "clamp";
    if (!agrees(a, b, [](auto x, auto) { return abs(x); })) return "abs";
    if (!agrees(a, b, [](auto x, auto) { return sqrt(x); })) return "sqrt";
    // (-0 may become 0.)
    if (!agrees(a, b, [](auto x, auto) { return floor(x) + 0; })) return "floor";
    if (!agrees(a, b, [](auto x, auto) { return round(x) + 0; })) return "round";
    if (!agrees(a, b, [](auto x, auto) { return head(x); })) return "head";
    if (!agrees(a, b, [](auto x, auto) { return value(bits(x) ^ 0x5555u); }))
      return "bits";
    if (!agrees(a, b, [](auto x, auto y) { return fused(x, y, x); })) return "fused";
    if (!agrees(a, b, [](auto x, auto y) { return select(x < y, x, 2.0f); })) return "<";
    if (!agrees(a, b, [](auto x, auto y) { return select(x <= y, x, 2.0f); }))
      return "<=";
    if (!agrees(a, b, [](auto x, auto y) { return select(x > y, x, 2.0f); })) return ">";
    if (!agrees(a, b, [](auto x, auto y) { return select(x >= y, x, 2.0f); }))
      return ">=";
    if (!agrees(a, b, [](auto x, auto y) { return select(x == y, x, 2.0f); }))
      return "==";
    if (!agrees(a, b, [](auto x, auto y) { return select(x != y, x, 2.0f); }))
      return "!=";
    if (!agrees(a, b, [](auto x, auto y) { return select((x < y) & !(y < 1), x, y); }))
      return "& !";
    if (!agrees(a, b, [](auto x, auto y) { return select((x < y) | (y < 1), x, y); }))
      return "|";
    if (!agrees(a, b, [](auto x, auto y) { return select((x < y) != (y < 1), x, y); }))
      return "mask !=";
    if (!agrees(a, b, [](auto x, auto) {
          using U = Bits_t<decltype(x)>;
          return uniform<decltype(x)>(hash<U>(bits(x), U(1u), U(2u), U(3u)).w);
        }))
      return "hash";
    if (!agrees(a, b, [](auto x, auto) {
          return value((cell(floor(x)) & 0xffffu) | 0x3f800000u);
        }))
      return "cell";

    const Batch x = load<Batch>(a);
    bool some = false, every = true;
    for (int k = 0; k < W; ++k) some |= a[k] < b[k], every &= a[k] < b[k];
    const Mask m = x < load<Batch>(b);
    if (any(m) != some || all(m) != every || none(m) == some) return "any, all, none";
    for (int k = 0; k < W; ++k)
      if (m[k] != (a[k] < b[k])) return "mask lanes";

    // Numbers of the lanes, loaded and gathered at any alignment.
    const Batch number = iota<Batch>();
    for (int k = 0; k < W; ++k)
      if (number[k] != static_cast<float>(k)) return "iota";
    if (sum(number) != static_cast<float>(W * (W - 1) / 2)) return "sum";
    if (lowest(number + 1) != 1 || highest(number) != W - 1) return "lowest, highest";
    alignas(4) float out[W + 1];
    store(out + 1, gather(a, cell(Batch(W - 1) - number)));
    for (int k = 0; k < W; ++k)
      if (!same(out[k + 1], a[W - 1 - k])) return "gather, store";
  }
  return nullptr;
}

const BatchCheck batch_check = {W, disagreement};

}  // namespace brume::test::inline BRUME_ISA_NS
