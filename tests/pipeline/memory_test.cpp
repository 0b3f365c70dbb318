// A scene applied to pixels in memory: what comes out, and that it does not depend on how
// it is asked for.

#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <random>
#include <thread>

#include "frames.h"

namespace brume::test {
namespace {

const std::string kFog = std::string(R"(
version = 1
[output]
aovs = ["T", "L"]
)") + kCamera + R"(
[[stage]]
type = "height_fog"
density = 0.002
falloff = 0.02
color = [0.5, 0.6, 0.7]
)";

/// Uniform fog needs no camera's height: T = exp(-sigma d) can be written down.
std::string uniform_fog(const std::string& more = "", const std::string& stage = "") {
  return "version = 1\n" + more + kCamera +
         "[[stage]]\ntype = \"height_fog\"\ndensity = 0.001\nfalloff = 0\ncolor = [1, "
         "0.5, 0.25]\n" +
         stage;
}

class Memory : public testing::Test {
 protected:
  Registry registry;
  const Window display{0, 0, 97, 61};
  Pixels pixels = make_pixels(97, 61);

  Result run(const std::string& scene) {
    Session session(scene_of(registry, scene), registry);
    return apply_whole(session.prepare(source_of(pixels, display)), pixels,
                       pixels.window);
  }
};

void expect_same_bits(const std::vector<float>& a, const std::vector<float>& b,
                      const std::string& what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  for (std::size_t i = 0; i < a.size(); ++i)
    ASSERT_EQ(std::bit_cast<std::uint32_t>(a[i]), std::bit_cast<std::uint32_t>(b[i]))
        << what << " at " << i << ": " << a[i] << " " << b[i];
}

TEST_F(Memory, frame_is_S_T_plus_L) {
  const Result out = run(kFog);
  const char* const names[] = {"R", "G", "B"};
  const std::vector<float>* const S[] = {&pixels.r, &pixels.g, &pixels.b};
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < pixels.r.size(); ++i) {
      const double T = out[std::string("T.") + names[c]][i],
                   L = out[std::string("L.") + names[c]][i];
      const double want = T * (*S[c])[i] + L;
      // One rounding of the product and one of the sum, relative to what was added: 2 x
      // 2^-24 < 2e-7.
      ASSERT_NEAR(out[names[c]][i], want, 2e-7 * (std::abs(T * (*S[c])[i]) + std::abs(L)))
          << names[c] << " " << i;
    }
}

TEST_F(Memory, uniform_fog_is_what_the_exact_meanings_say) {
  const Result out = run(uniform_fog("[output]\naovs = [\"T\", \"L\"]\n"));
  const double sigma = 0.001, color[] = {1, 0.5, 0.25};
  Session session(scene_of(registry, uniform_fog()), registry);
  const FrameSource source = source_of(pixels, display);
  const auto view = find_view(source.header, session.scene(), 1, "memory");
  ASSERT_TRUE(view);
  int edges = 0;
  for (int y = 0; y < display.height; ++y)
    for (int x = 0; x < display.width; ++x) {
      const std::size_t i = std::size_t(y) * 97 + std::size_t(x);
      const double a = pixels.a[i];
      const bool finite = pixels.z[i] < 1e9f;
      if (a > 0 && !finite) {
        ++edges;  // takes a neighbour's depth: another test
        continue;
      }
      const auto ray = view->ray(x + 0.5, y + 0.5);
      const double T =
          finite ? std::exp(-sigma * pixels.z[i] / ray.planar_per_distance) : 0;
      const double T_inf = 0;
      for (int c = 0; c < 3; ++c) {
        const float S = c == 0 ? pixels.r[i] : c == 1 ? pixels.g[i] : pixels.b[i];
        const double L = a * color[c] * (1 - T) + (1 - a) * color[c] * (1 - T_inf);
        const char* const name = c == 0 ? "R" : c == 1 ? "G" : "B";
        // float T: 1e-6 absolute (the kernel's bound), and a float's rounding of the sum.
        ASSERT_NEAR(out[name][i], T * S + L, 1.2e-6 * (1 + std::abs(S))) << x << "," << y;
        ASSERT_NEAR(out[std::string("L.") + name][i], L, 1.2e-6);
      }
      ASSERT_NEAR(out["A"][i], a + (1 - a) * (1 - T_inf), 2e-7);
    }
  EXPECT_GT(edges, 20) << "the frame has silhouettes";
}

TEST_F(Memory, a_covered_pixel_without_depth_takes_its_nearest_neighbours) {
  const Result out = run(uniform_fog("[output]\naovs = [\"T\"]\n"));
  for (int y = 0; y + 1 < display.height; ++y)
    for (int x = 0; x < display.width; ++x) {
      const std::size_t i = std::size_t(y) * 97 + std::size_t(x);
      if (pixels.a[i] > 0 && pixels.z[i] >= 1e9f) {
        EXPECT_GT(out["T.R"][i], 0.f) << "not at infinity: " << x << "," << y;
      }
    }
}

TEST_F(Memory, any_window_gives_the_bits_of_the_whole) {
  Session session(scene_of(registry, kFog), registry);
  const PreparedFrame frame = session.prepare(source_of(pixels, display));
  const Result whole = apply_whole(frame, pixels, pixels.window);
  std::mt19937 random(3);
  for (int trial = 0; trial < 40; ++trial) {
    Window w;
    w.x = int(random() % 97), w.y = int(random() % 61);
    w.width = 1 + int(random() % unsigned(97 - w.x)),
    w.height = 1 + int(random() % unsigned(61 - w.y));
    const Result part = apply_whole(frame, pixels, w);
    for (std::size_t k = 0; k < part.names.size(); ++k)
      for (int y = 0; y < w.height; ++y)
        for (int x = 0; x < w.width; ++x) {
          const float p = part.planes[k][std::size_t(y * w.width + x)];
          const float q = whole.planes[k][std::size_t((w.y + y) * 97 + w.x + x)];
          ASSERT_EQ(std::bit_cast<std::uint32_t>(p), std::bit_cast<std::uint32_t>(q))
              << part.names[k] << " at " << w.x + x << "," << w.y + y << " of " << w.width
              << "x" << w.height;
        }
  }
}

TEST_F(Memory, a_tile_with_its_surroundings_gives_the_bits_of_the_whole) {
  Session session(scene_of(registry, kFog), registry);
  const PreparedFrame frame = session.prepare(source_of(pixels, display));
  const Result whole = apply_whole(frame, pixels, pixels.window);
  ASSERT_GT(frame.around(), 0);
  for (int ty = 0; ty < 61; ty += 13)
    for (int tx = 0; tx < 97; tx += 19) {
      const Window tile = intersect({tx, ty, 19, 13}, pixels.window);
      const int around = frame.around();
      const Window given = intersect({tile.x - around, tile.y - around,
                                      tile.width + 2 * around, tile.height + 2 * around},
                                     pixels.window);
      Pixels cut;
      cut.window = given;
      for (const auto& [from, to] : {std::pair{&pixels.r, &cut.r},
                                     {&pixels.g, &cut.g},
                                     {&pixels.b, &cut.b},
                                     {&pixels.a, &cut.a},
                                     {&pixels.z, &cut.z}})
        for (int y = given.y; y < given.bottom(); ++y)
          to->insert(to->end(), from->begin() + y * 97 + given.x,
                     from->begin() + y * 97 + given.right());
      const Result part = apply_whole(frame, cut, tile);
      for (std::size_t k = 0; k < part.names.size(); ++k)
        for (int y = 0; y < tile.height; ++y)
          for (int x = 0; x < tile.width; ++x)
            ASSERT_EQ(std::bit_cast<std::uint32_t>(
                          part.planes[k][std::size_t(y * tile.width + x)]),
                      std::bit_cast<std::uint32_t>(
                          whole.planes[k][std::size_t((tile.y + y) * 97 + tile.x + x)]))
                << part.names[k] << " tile " << tx << "," << ty;
    }
}

TEST_F(Memory, strides_and_origin_change_no_bit) {
  Session session(scene_of(registry, kFog), registry);
  const PreparedFrame frame = session.prepare(source_of(pixels, display));
  const Result whole = apply_whole(frame, pixels, pixels.window);
  // Interleaved, rows upward, padding between rows: as hosts of nodes hand images over.
  const std::size_t channels = 5, row = 97 * channels + 11;
  const char* const order[] = {"R", "G", "B", "A", "Z"};
  std::vector<float> in(row * 61, -7.f);
  for (int y = 0; y < 61; ++y)
    for (int x = 0; x < 97; ++x)
      for (std::size_t c = 0; c < channels; ++c)
        in[std::size_t(60 - y) * row + std::size_t(x) * channels + c] =
            plane_of(pixels, order[c])[std::size_t(y * 97 + x)];
  std::vector<PlaneIn> from;
  for (const InputChannel& c : frame.inputs())
    for (std::size_t k = 0; k < channels; ++k)
      if (c.channel == order[k])
        from.push_back({in.data() + k, std::ptrdiff_t(channels), std::ptrdiff_t(row)});
  const std::size_t n = frame.outputs().size();
  std::vector<float> out(97 * 61 * n);
  std::vector<PlaneOut> to;
  for (std::size_t k = 0; k < n; ++k)
    to.push_back({out.data() + k, std::ptrdiff_t(n), std::ptrdiff_t(97 * n)});
  FrameBuffers buffers;
  buffers.window = pixels.window;
  buffers.bottom_left = true;
  buffers.in = from;
  buffers.out = to;
  frame.apply(buffers, pixels.window);
  for (std::size_t k = 0; k < n; ++k)
    for (int y = 0; y < 61; ++y)
      for (int x = 0; x < 97; ++x)
        ASSERT_EQ(std::bit_cast<std::uint32_t>(
                      out[(std::size_t(60 - y) * 97 + std::size_t(x)) * n + k]),
                  std::bit_cast<std::uint32_t>(whole.planes[k][std::size_t(y * 97 + x)]));
}

TEST_F(Memory, several_threads_at_once_on_one_frame) {
  Session session(scene_of(registry, kFog), registry);
  const PreparedFrame frame = session.prepare(source_of(pixels, display));
  const Result whole = apply_whole(frame, pixels, pixels.window);
  std::vector<Result> results(8);
  std::vector<std::thread> threads;
  for (Result& r : results)
    threads.emplace_back([&] { r = apply_whole(frame, pixels, pixels.window); });
  for (std::thread& t : threads) t.join();
  for (const Result& r : results)
    for (std::size_t k = 0; k < r.planes.size(); ++k)
      expect_same_bits(r.planes[k], whole.planes[k], r.names[k]);
}

TEST_F(Memory, in_place_is_allowed) {
  Session session(scene_of(registry, kFog), registry);
  const PreparedFrame frame = session.prepare(source_of(pixels, display));
  const Result whole = apply_whole(frame, pixels, pixels.window);
  Pixels mine = pixels;
  std::vector<PlaneIn> in;
  for (const InputChannel& c : frame.inputs())
    in.push_back({plane_of(mine, c.channel).data(), 1, 97});
  std::vector<std::vector<float>> spare;
  std::vector<PlaneOut> out;
  for (const OutputChannel& c : frame.outputs()) {
    if (c.changed) {
      out.push_back({const_cast<float*>(plane_of(mine, c.channel.name).data()), 1, 97});
    } else {
      out.push_back({});  // not wanted
    }
  }
  FrameBuffers buffers;
  buffers.window = mine.window;
  buffers.in = in;
  buffers.out = out;
  frame.apply(buffers, mine.window);
  expect_same_bits(mine.r, whole["R"], "R");
  expect_same_bits(mine.g, whole["G"], "G");
  expect_same_bits(mine.b, whole["B"], "B");
  expect_same_bits(mine.a, whole["A"], "A");
}

TEST_F(Memory, mask_times_mix_scales_the_extinction) {
  // sigma of half the density is the square root of T: exact law.
  pixels.z.assign(pixels.z.size(), 700.f);
  pixels.a.assign(pixels.a.size(), 1.f);
  const Result full = run(uniform_fog("[output]\naovs = [\"T\"]\n"));
  const Result half = run(uniform_fog("[output]\naovs = [\"T\"]\n", "mix = 0.5\n"));
  for (std::size_t i = 0; i < full["T.R"].size(); ++i)
    ASSERT_NEAR(half["T.R"][i] * half["T.R"][i], full["T.R"][i],
                2e-6);  // 2 T dT, dT <= 1e-6
  // A mask of the picture itself: A is 1 everywhere, so nothing changes.
  const Result masked = run(uniform_fog("[output]\naovs = [\"T\"]\n", "mask = \"A\"\n"));
  expect_same_bits(masked["T.R"], full["T.R"], "T under a mask of 1");
}

TEST_F(Memory, a_mask_of_zero_leaves_the_pixel_untouched) {
  for (std::size_t i = 0; i < pixels.a.size(); ++i) pixels.a[i] = i % 3 == 0 ? 1.f : 0.f;
  pixels.z.assign(pixels.z.size(), 500.f);
  pixels.r[4] = std::bit_cast<float>(0x7fc00123u);
  const Result out = run(uniform_fog("", "mask = \"A\"\n"));
  for (std::size_t i = 0; i < pixels.a.size(); ++i) {
    if (pixels.a[i] != 0) continue;
    ASSERT_EQ(std::bit_cast<std::uint32_t>(out["R"][i]),
              std::bit_cast<std::uint32_t>(pixels.r[i]));
    ASSERT_EQ(out["A"][i], 0.f);
  }
}

TEST_F(Memory, nan_and_infinity_stay_in_their_pixel) {
  const Result clean = run(kFog);
  Pixels bad = pixels;
  const std::size_t at = 50 * 97 + 40;
  bad.r[at] = std::numeric_limits<float>::quiet_NaN();
  bad.g[at] = kInf;
  bad.z[at + 2] = std::numeric_limits<float>::quiet_NaN();
  std::swap(pixels, bad);
  const Result out = run(kFog);
  for (std::size_t k = 0; k < out.planes.size(); ++k)
    for (std::size_t i = 0; i < out.planes[k].size(); ++i) {
      if (i == at || i == at + 2) continue;
      ASSERT_EQ(std::bit_cast<std::uint32_t>(out.planes[k][i]),
                std::bit_cast<std::uint32_t>(clean.planes[k][i]))
          << out.names[k] << " " << i;
    }
  EXPECT_TRUE(std::isnan(out["R"][at]));
  EXPECT_TRUE(std::isinf(out["G"][at]));
  EXPECT_TRUE(std::isfinite(out["R"][at + 2])) << "a NaN depth is background";
}

TEST_F(Memory, a_plate_keeps_its_sky_and_gets_the_fog_at_its_distance) {
  const Result out =
      run(uniform_fog("[input]\nbackground = \"plate\"\nbackground_distance = "
                      "2000\n[output]\naovs = [\"T\"]\n"));
  for (std::size_t i = 0; i < pixels.z.size(); ++i)
    if (!(pixels.z[i] < 1e9f)) {
      ASSERT_NEAR(out["T.R"][i], std::exp(-2.0), 1e-6);
    }
  for (const std::string& name : out.names)
    EXPECT_NE(name, "A") << "a plate has no coverage to change";
}

TEST_F(Memory, alpha_may_be_kept) {
  for (const std::string& name : run(uniform_fog("[output]\nalpha = \"keep\"\n")).names)
    EXPECT_NE(name, "A");
}

TEST_F(Memory, a_frame_without_alpha_covers_what_has_depth) {
  Session session(scene_of(registry, uniform_fog()), registry);
  const PreparedFrame frame =
      session.prepare(source_of(pixels, display, {"B", "G", "R", "Z"}));
  pixels.r.assign(pixels.r.size(), 0.f);
  const Result out = apply_whole(frame, pixels, pixels.window);
  for (std::size_t i = 0; i < pixels.z.size(); ++i)
    if (!(pixels.z[i] < 1e9f)) {
      ASSERT_EQ(out["R"][i], 1.f) << "fog to infinity";
    }
}

TEST_F(Memory, a_stage_that_does_nothing_is_left_out_with_its_reason) {
  struct Case {
    const char *stage, *reason;
  };
  for (const Case& c : {Case{"density = 0\n", "density is 0"},
                        {"enabled = false\n", "enabled = false"},
                        {"mix = 0\n", "mix is 0"},
                        {"frames = [10, 20]\n", "frame 1 is outside frames 10 to 20"}}) {
    Session session(
        scene_of(registry, std::string("[[stage]]\ntype = \"height_fog\"\n") + c.stage),
        registry);
    const PreparedFrame frame = session.prepare(source_of(pixels, display));
    ASSERT_EQ(frame.plan().stages.size(), 1u);
    EXPECT_FALSE(frame.plan().stages[0].runs);
    EXPECT_EQ(frame.plan().stages[0].reason, c.reason);
    EXPECT_TRUE(frame.plan().changes_nothing);
    EXPECT_TRUE(frame.inputs().empty()) << "nothing is read for it";
    EXPECT_TRUE(frame.outputs().empty());
  }
}

TEST_F(Memory, what_cannot_be_done_is_said) {
  const auto message = [&](const std::string& scene,
                           std::vector<std::string> names) -> std::string {
    try {
      Session session(scene_of(registry, scene), registry);
      session.prepare(source_of(pixels, display, std::move(names)));
    } catch (const Error& e) {
      return e.what();
    }
    return "no error";
  };
  const std::string fog = "[[stage]]\ntype = \"height_fog\"\n";
  EXPECT_EQ(message(fog + kCamera, {"A", "B", "G", "R"}),
            "memory: no depth channel; it has A, B, G, R; name one with [input] depth = "
            "\"CHANNEL\" or \"FILE:CHANNEL\"");
  EXPECT_NE(message(fog, {"A", "B", "G", "R", "Z"})
                .find("memory: no camera, and height_fog needs to know"),
            std::string::npos)
      << message(fog, {"A", "B", "G", "R", "Z"});
  EXPECT_NE(message(fog + kCamera, {"Z"}).find("no colour"), std::string::npos);
  EXPECT_NE(message(std::string("[input]\ndepth = \"ZZ\"\n") + kCamera + fog,
                    {"A", "B", "G", "R", "Z"})
                .find("did you mean Z?"),
            std::string::npos);
  EXPECT_NE(message(std::string("[output]\naovs = [\"height_fog.LL\"]\n") + kCamera + fog,
                    {"A", "B", "G", "R", "Z"})
                .find("did you mean height_fog.L?"),
            std::string::npos);
  EXPECT_EQ(message(fog + "falloff = 0\n", {"A", "B", "G", "R", "Z"}), "no error")
      << "uniform fog needs only distances";
}

TEST_F(Memory, planes_that_do_not_fit_are_refused) {
  Session session(scene_of(registry, kFog), registry);
  const PreparedFrame frame = session.prepare(source_of(pixels, display));
  FrameBuffers buffers;
  buffers.window = pixels.window;
  EXPECT_THROW(frame.apply(buffers, pixels.window), Error);
  EXPECT_THROW(apply_whole(frame, pixels, {90, 0, 10, 10}), Error)
      << "beyond the pixels given";
}

}  // namespace
}  // namespace brume::test
