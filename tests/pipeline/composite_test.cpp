// The arithmetic of DESIGN "Exact meanings", kernel by kernel, on every instruction set
// the processor has.

#include "pipeline/composite.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace brume::pipeline {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct One {
  float S = 0.25f, a = 1, T = 0.5f, L = 0.125f, T_inf = 0.25f, L_inf = 0.375f, B = 0,
        fills = 1;
};
struct Answer {
  float C, a, L;
};

class Composite : public testing::TestWithParam<Isa> {
 protected:
  const CompositeKernels& k =
      of_isa(GetParam(), isa_v2::composite_kernels, isa_v3::composite_kernels,
             isa_v4::composite_kernels);

  /// The same pixel in every lane of a run of 19, so that whole batches and the padded
  /// one are asked; all must agree.
  Answer one(const One& p, bool background = false, bool no_alpha = false) {
    constexpr int n = 19;
    const std::vector<float> S(n, p.S), a(n, p.a), T(n, p.T), L(n, p.L),
        T_inf(n, p.T_inf), L_inf(n, p.L_inf), B(n, p.B), fills(n, p.fills);
    std::vector<float> C(n), a_out(n), L_out(n);
    CompositeRun run{};
    run.n = n;
    run.a = no_alpha ? nullptr : a.data();
    run.a_out = a_out.data();
    run.fills = p.fills < 1 ? fills.data() : nullptr;
    for (int c = 0; c < 3; ++c) {
      run.S[c] = S.data(), run.T[c] = T.data(), run.L[c] = L.data();
      run.T_inf[c] = T_inf.data(), run.L_inf[c] = L_inf.data();
      run.B[c] = background ? B.data() : nullptr;
      run.C[c] = C.data(), run.L_out[c] = L_out.data();
    }
    touched = k.composite(run);
    for (int i = 1; i < n; ++i) {
      EXPECT_EQ(std::bit_cast<std::uint32_t>(C[i]), std::bit_cast<std::uint32_t>(C[0]))
          << "lane " << i;
      EXPECT_EQ(std::bit_cast<std::uint32_t>(a_out[i]),
                std::bit_cast<std::uint32_t>(a_out[0]))
          << "lane " << i;
    }
    return {C[0], a_out[0], L_out[0]};
  }
  bool touched = false;
};

TEST_P(Composite, a_covered_pixel_is_T_S_plus_L) {
  const Answer x = one({});
  EXPECT_EQ(x.C, 0.5f * 0.25f + 0.125f);
  EXPECT_EQ(x.a, 1);
}

TEST_P(Composite, an_empty_pixel_sees_the_air_to_infinity) {
  const Answer x = one({.S = 0, .a = 0});
  EXPECT_EQ(x.C, 0.375f);
  EXPECT_EQ(x.a, 0.75f) << "coverage of air that lets a quarter through";
}

TEST_P(Composite, a_half_covered_pixel_has_half_of_each) {
  const Answer x = one({.a = 0.5f});
  EXPECT_EQ(x.C, 0.5f * 0.25f + 0.5f * 0.125f + 0.5f * 0.375f);
  EXPECT_EQ(x.a, 0.5f + 0.5f * 0.75f);
  EXPECT_EQ(x.L, 0.25f);
}

TEST_P(Composite, a_background_shines_through_the_air_behind_and_fills_the_pixel) {
  const Answer x = one({.S = 0, .a = 0, .B = 2}, true);
  EXPECT_EQ(x.C, 0.375f + 0.25f * 2);
  EXPECT_EQ(x.a, 1);
}

TEST_P(Composite, a_part_of_a_background_fills_the_pixel_as_much) {
  const One clear{
      .S = 0, .a = 0.5f, .T = 1, .L = 0, .T_inf = 1, .L_inf = 0, .fills = .25f};
  EXPECT_EQ(one(clear, true).a, 0.5f + 0.5f * 0.25f);
  EXPECT_EQ(one({.a = 0.5f, .fills = 0.25f}, true).a, 0.5f + 0.5f * 0.75f)
      << "air that hides more than that";
  One none = clear;
  none.fills = 0;
  EXPECT_EQ(one(none, true).a, 0.5f);
  EXPECT_FALSE(touched);
}

TEST_P(Composite, clear_air_keeps_every_bit) {
  for (const float S :
       {-0.f, kNan, -kNan, kInf, 1e-40f, std::bit_cast<float>(0x7fc12345u)}) {
    const Answer x = one({.S = S, .a = 0.3f, .T = 1, .L = 0, .T_inf = 1, .L_inf = 0});
    EXPECT_EQ(std::bit_cast<std::uint32_t>(x.C), std::bit_cast<std::uint32_t>(S));
    EXPECT_EQ(x.a, 0.3f);
    EXPECT_FALSE(touched);
  }
}

TEST_P(Composite, opaque_air_hides_an_infinite_colour) {
  EXPECT_EQ(one({.S = kInf, .T = 0}).C, 0.125f);
}

TEST_P(Composite, what_has_no_share_cannot_spoil_the_pixel) {
  EXPECT_EQ(one({.L_inf = kInf}).C, 0.25f) << "covered: nothing behind is seen";
  EXPECT_EQ(one({.S = 0, .a = 0, .L = kNan}).C, 0.375f)
      << "empty: nothing before is seen";
}

TEST_P(Composite, coverage_out_of_range_counts_as_the_nearest) {
  EXPECT_EQ(one({.a = 1.5f}).C, one({.a = 1}).C);
  EXPECT_EQ(one({.a = -1}).C, one({.a = 0}).C);
  EXPECT_EQ(one({.a = kNan}).C, one({.a = 1}).C);
}

TEST_P(Composite, lanes_do_not_meet) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> u(0, 1);
  constexpr int n = 100;
  std::vector<float> v[9];
  for (auto& p : v)
    for (int i = 0; i < n; ++i) p.push_back(u(random));
  const auto run_of = [&](int from, int count, std::vector<float>& C,
                          std::vector<float>& a_out) {
    C.resize(std::size_t(count)), a_out.resize(std::size_t(count));
    std::vector<float> rest(std::size_t(count) * 2);
    CompositeRun run{};
    run.n = count;
    run.a = &v[1][std::size_t(from)];
    run.a_out = a_out.data();
    for (int c = 0; c < 3; ++c) {
      const auto at = [&](int plane) { return &v[plane][std::size_t(from)]; };
      run.S[c] = at(0), run.T[c] = at(2), run.L[c] = at(3), run.T_inf[c] = at(4),
      run.L_inf[c] = at(5);
      run.C[c] = c == 0 ? C.data() : rest.data() + (c - 1) * count;
    }
    k.composite(run);
  };
  std::vector<float> whole, whole_a;
  run_of(0, n, whole, whole_a);
  for (int from : {0, 1, 5, 31})
    for (int count : {1, 3, 8, 17, 60}) {
      std::vector<float> part, part_a;
      run_of(from, count, part, part_a);
      for (int i = 0; i < count; ++i) {
        ASSERT_EQ(part[std::size_t(i)], whole[std::size_t(from + i)]);
        ASSERT_EQ(part_a[std::size_t(i)], whole_a[std::size_t(from + i)]);
      }
    }
}

TEST_P(Composite, a_weight_is_the_mask_within_0_and_1_times_mix) {
  const float mask[] = {0, 1, 0.5f, -3, 7, kNan, kInf};
  const float want[] = {0, 0.5f, 0.25f, 0, 0.5f, 0, 0.5f};
  float w[7];
  k.weight(7, mask, 0.5f, w);
  for (int i = 0; i < 7; ++i) EXPECT_EQ(w[i], want[i]) << i;
}

TEST_P(Composite, a_blend_is_exact_at_both_ends) {
  const float before[] = {kInf, 1, 2, 3}, after[] = {5, kNan, 4, 7},
              w[] = {1, 0, 0.5f, 0.25f};
  const float want[] = {5, 1, 3, 4};
  float out[4];
  k.blend(4, before, after, w, out);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(out[i], want[i]) << i;
}

TEST_P(Composite, both_integrals_are_needed_only_where_something_is_seen_past_a_sample) {
  for (int n = 1; n < 40; ++n)
    for (int hit = -1; hit < n; ++hit) {
      std::vector<float> a(std::size_t(n), 1.f), d(std::size_t(n), 10.f);
      if (hit >= 0) a[std::size_t(hit)] = 0.5f;
      EXPECT_EQ(k.needs_infinity(n, a.data(), d.data()), hit >= 0);
      if (hit >= 0) d[std::size_t(hit)] = kInf;
      EXPECT_FALSE(k.needs_infinity(n, a.data(), d.data()));
    }
}

std::vector<Isa> isas_here() {
  std::vector<Isa> all{Isa::v2};
  if (best_isa() >= Isa::v3) all.push_back(Isa::v3);
  if (best_isa() >= Isa::v4) all.push_back(Isa::v4);
  return all;
}
INSTANTIATE_TEST_SUITE_P(Isa, Composite, testing::ValuesIn(isas_here()),
                         [](const auto& p) { return std::string(name(p.param)); });

}  // namespace
}  // namespace brume::pipeline
