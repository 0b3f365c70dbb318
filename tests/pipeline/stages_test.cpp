// Surface and lens stages around the air: order, masks, layers, what lies around a tile.

#include <gtest/gtest.h>

#include <bit>

#include "frames.h"

namespace brume::test {
namespace {

class Stages : public testing::Test {
 protected:
  Registry registry;
  const Window display{0, 0, 83, 47};
  Pixels pixels = make_pixels(83, 47);

  Result run(const std::string& scene, Window render = {}) {
    Session session(scene_of(registry, scene + kCamera), registry);
    const PreparedFrame frame = session.prepare(source_of(pixels, display));
    return apply_whole(frame, pixels, render.empty() ? pixels.window : render);
  }
};

const std::string kUniform =
    "[[stage]]\ntype = \"height_fog\"\ndensity = 0.001\nfalloff = 0\ncolor = [0.5, 0.5, "
    "0.5]\n";
const std::string kPaint = "[[stage]]\ntype = \"paint\"\ncolor = [0.25, 0, 0]\n";
const std::string kBlur = "[[stage]]\ntype = \"blur\"\n";

TEST_F(Stages, light_orders_them_not_the_file) {
  const Result a = run(kPaint + kUniform + kBlur), b = run(kBlur + kUniform + kPaint);
  for (const char* c : {"R", "G", "B", "A"})
    for (std::size_t i = 0; i < a[c].size(); ++i) ASSERT_EQ(a[c][i], b[c][i]);
}

TEST_F(Stages, the_surface_layer_is_written_beside_T_and_L) {
  const Result out = run("[output]\naovs = [\"T\", \"L\"]\n" + kPaint + kUniform);
  for (std::size_t i = 0; i < pixels.r.size(); ++i) {
    ASSERT_EQ(out["S.R"][i], pixels.r[i] + 0.25f * pixels.a[i]);
    const double want = double(out["S.R"][i]) * out["T.R"][i] + out["L.R"][i];
    ASSERT_NEAR(out["R"][i], want, 1e-6 * (1 + std::abs(want)));  // two float roundings
  }
}

TEST_F(Stages, a_surface_stage_is_blended_by_mask_and_mix) {
  const Result out = run(kPaint + "mix = 0.5\nmask = \"A\"\n");
  for (std::size_t i = 0; i < pixels.r.size(); ++i) {
    const float w = 0.5f * pixels.a[i];
    ASSERT_NEAR(out["R"][i], pixels.r[i] + w * 0.25f * pixels.a[i],
                1e-6 * (1 + pixels.r[i]));
  }
}

TEST_F(Stages, a_stage_sees_what_lies_around_its_tile) {
  // However the frame is cut, each pixel finds the same neighbours (replicated at the
  // frame's edges).
  const std::string scene = "[[stage]]\ntype = \"steepness\"\n";
  const Result whole = run(scene);
  Session session(scene_of(registry, scene + kCamera), registry);
  const PreparedFrame frame = session.prepare(source_of(pixels, display));
  const auto view = find_view(source_of(pixels, display).header, session.scene(), 1, "");
  const auto distance = [&](int x, int y) -> float {
    x = std::clamp(x, 0, 82), y = std::clamp(y, 0, 46);
    const float z = pixels.z[std::size_t(y * 83 + x)];
    return z < 1e9f ? z / float(view->ray(x + 0.5, y + 0.5).planar_per_distance) : kInf;
  };
  // Of covered pixels without depth, that of the nearest that has one.
  const auto sample = [&](int x, int y) {
    x = std::clamp(x, 0, 82), y = std::clamp(y, 0, 46);
    float best = distance(x, y);
    if (best < kInf || !(pixels.a[std::size_t(y * 83 + x)] > 0)) return best;
    int nearest = 65;
    for (int j = std::max(y - 8, 0); j <= std::min(y + 8, 46); ++j)
      for (int i = std::max(x - 8, 0); i <= std::min(x + 8, 82); ++i) {
        const int s = (i - x) * (i - x) + (j - y) * (j - y);
        const float d = distance(i, j);
        if (s > nearest || d == kInf || (s == nearest && d >= best)) continue;
        nearest = s, best = d;
      }
    return best;
  };
  for (int y = 0; y < 47; ++y)
    for (int x = 0; x < 83; ++x) {
      const std::size_t i = std::size_t(y * 83 + x);
      if (!(pixels.z[i] < 1e9f)) continue;
      float want = 0;
      for (int j = -2; j <= 2; ++j)
        for (int k = -2; k <= 2; ++k) {
          const float e = std::abs(sample(x + k, y + j) - sample(x, y));
          if (std::isfinite(e)) want = std::max(want, e);
        }
      ASSERT_NEAR(whole["R"][i], want, 1e-6 * 4100 + 1e-6 * want)
          << x << "," << y;  // distances to 1e-6 of their size
    }
  for (const Window& w :
       {Window{0, 0, 7, 5}, Window{60, 20, 23, 27}, Window{11, 0, 72, 1}}) {
    const Result part = apply_whole(frame, pixels, w);
    for (int y = 0; y < w.height; ++y)
      for (int x = 0; x < w.width; ++x)
        ASSERT_EQ(part["R"][std::size_t(y * w.width + x)],
                  whole["R"][std::size_t((w.y + y) * 83 + w.x + x)]);
  }
}

TEST_F(Stages, a_surface_stage_may_ask_the_world) {
  const std::string scene =
      "[output]\naovs = [\"S\"]\n[[stage]]\ntype = \"asks\"\n[[stage]]\ntype = "
      "\"height_fog\"\nfalloff = 0\ndensity = 0.001\n";
  const std::string lamp =
      "[[stage]]\ntype = \"point_light\"\nposition = [0, 300, 90]\npower = 1000\n";
  const Result out = run(scene + lamp);
  const auto view =
      find_view(source_of(pixels, display).header, scene_of(registry, kCamera), 1, "");
  for (int y = 30; y < 47; ++y)
    for (int x = 0; x < 83; ++x) {
      const std::size_t i = std::size_t(y * 83 + x);
      const View::RayAt r = view->ray(x + 0.5, y + 0.5);
      const double d = double(pixels.z[i]) / r.planar_per_distance;
      const glm::dvec3 way = glm::dvec3(0, 300, 90) - (r.origin + d * r.direction);
      const double far = glm::length(way);
      // Fields of view of a float: 1e-6 of positions to 4 km.
      const double E =
          1000 * std::max(way.z, 0.) / (far * far * far) * std::exp(-.001 * far);
      ASSERT_NEAR(out["S.R"][i], std::exp(-.001 * d), 1e-5) << x << ", " << y;
      ASSERT_NEAR(out["S.G"][i], E, 1e-3 * E + 1e-6) << x << ", " << y;
      ASSERT_EQ(out["S.B"][i], 0.f);
    }

  // No light of its kind: left out, and the fog alone is there.
  const Result without = run(scene), fog = run(scene.substr(0, 0) + R"(
[output]
aovs = ["S"]
[[stage]]
type = "height_fog"
falloff = 0
density = 0.001
)");
  for (std::size_t i = 0; i < pixels.r.size(); ++i)
    ASSERT_EQ(without["R"][i], fog["R"][i]);
}

TEST_F(Stages, a_stage_without_its_light_reads_nothing) {
  Session session(
      scene_of(registry, kCamera + std::string("[[stage]]\ntype = \"asks\"\nmask = "
                                               "\"A\"\n")),
      registry);
  const PreparedFrame frame = session.prepare(source_of(pixels, display));
  EXPECT_EQ(frame.plan().stages[0].reason, "no lights: the scene has no lamp");
  EXPECT_TRUE(frame.plan().changes_nothing);
  EXPECT_TRUE(frame.inputs().empty());
}

TEST_F(Stages, a_lens_stage_has_the_whole_frame) {
  for (float& g : pixels.g) g = std::min(g, 1.f);
  const Result out = run(kBlur);
  double sum = 0;
  for (const float r : pixels.r) sum += r;
  for (const float r : out["R"]) ASSERT_FLOAT_EQ(r, float(sum / double(pixels.r.size())));
  const Result part = run(kBlur, {5, 6, 20, 10});
  for (const float r : part["R"])
    ASSERT_EQ(r, out["R"][0]) << "a window of it is a window of the whole";
}

TEST_F(Stages, a_lens_stage_comes_after_the_air) {
  const Result fog = run(kUniform), both = run(kBlur + kUniform);
  double sum = 0;
  for (const float r : fog["R"]) sum += r;
  ASSERT_FLOAT_EQ(both["R"][0], float(sum / double(fog["R"].size())));
}

TEST_F(Stages, a_lens_stage_is_blended_by_mask_and_mix) {
  const Result all = run(kBlur), half = run(kBlur + "mix = 0.5\n"),
               none = run(kBlur + "mix = 0\n" + kPaint);
  for (std::size_t i = 0; i < pixels.r.size(); ++i) {
    ASSERT_NEAR(half["R"][i], 0.5f * (pixels.r[i] + all["R"][0]), 1e-6);
    ASSERT_EQ(none["R"][i], pixels.r[i] + 0.25f * pixels.a[i]);
  }
}

TEST_F(Stages, a_lens_stage_has_a_layer_of_what_it_adds) {
  const std::string layer = "[output]\naovs = [\"blur\"]\n";
  for (const std::string part : {"", "mix = 0.5\n", "mask = \"R\"\n"}) {
    const Result plain = run(kBlur + part), out = run(layer + kBlur + part);
    for (std::size_t i = 0; i < pixels.r.size(); ++i) {
      ASSERT_EQ(out["R"][i], plain["R"][i]);
      ASSERT_EQ(out["blur.G"][i], out["G"][i] - pixels.g[i]);
    }
  }
  const Result idle = run(layer + kBlur + "enabled = false\n" + kPaint);
  for (const float r : idle["blur.R"]) ASSERT_EQ(r, 0.f);
  try {
    run("[output]\naovs = [\"height_fog\"]\n" + kUniform);
    FAIL() << "an air stage has T and L, nothing that it adds";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("height_fog.T"), std::string::npos) << e.what();
  }
}

TEST_F(Stages, a_surface_stage_has_a_layer_of_what_it_adds_before_the_air) {
  const std::string two = kPaint + "name = \"one\"\nmix = 0.5\n" +
                          "[[stage]]\ntype = \"paint\"\nname = \"two\"\n"
                          "color = [0.5, 0.25, 0]\nmask = \"R\"\n" +
                          kUniform,
                    layers = "[output]\naovs = [\"S\", \"one\", \"two\"]\n";
  const Result plain = run(two), out = run(layers + two);
  for (std::size_t i = 0; i < pixels.r.size(); ++i) {
    ASSERT_EQ(out["R"][i], plain["R"][i]);
    // Sums of three floats.
    const float s = out["S.R"][i];
    ASSERT_NEAR(pixels.r[i] + out["one.R"][i] + out["two.R"][i], s, 3e-7 * (1 + s));
    ASSERT_NEAR(out["one.R"][i], 0.125f * pixels.a[i], 1e-6 * (1 + s));
    ASSERT_EQ(out["one.G"][i], 0);
    const float mask = std::clamp(pixels.r[i], 0.f, 1.f);
    ASSERT_NEAR(out["two.G"][i], 0.25f * mask * pixels.a[i], 1e-6 * (1 + pixels.g[i]));
  }
  const Result idle =
      run("[output]\naovs = [\"paint\"]\n" + kPaint + "enabled = false\n" + kUniform);
  for (const float r : idle["paint.R"]) ASSERT_EQ(r, 0.f);
  for (const char* share : {"T", "L"}) try {
      run("[output]\naovs = [\"paint." + std::string(share) + "\"]\n" + kPaint);
      FAIL() << "it is not in the air: no share of that is its";
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find("write paint"), std::string::npos) << e.what();
    }
}

TEST_F(Stages, shares_of_stages_add_up_to_L_and_multiply_to_T) {
  const Result out =
      run("[output]\naovs = [\"T\", \"L\", \"near.T\", \"near.L\", \"far.T\", \"far.L\", "
          "\"off.L\", \"off.T\"]\n"
          "[[stage]]\ntype = \"height_fog\"\nname = \"near\"\ndensity = 0.002\nfalloff = "
          "0.01\ncolor = [1, 0.2, 0]\n"
          "[[stage]]\ntype = \"height_fog\"\nname = \"far\"\ndensity = 0.0005\nfalloff = "
          "0\ncolor = [0, 0.5, 1]\nstart = 300\n"
          "[[stage]]\ntype = \"height_fog\"\nname = \"off\"\nenabled = false\n");
  for (std::size_t i = 0; i < pixels.r.size(); ++i) {
    ASSERT_NEAR(out["near.L.R"][i] + out["far.L.R"][i], out["L.R"][i], 2e-6);
    ASSERT_NEAR(out["near.L.B"][i] + out["far.L.B"][i], out["L.B"][i], 2e-6);
    ASSERT_NEAR(out["near.T.G"][i] * out["far.T.G"][i], out["T.G"][i], 2e-6);
    ASSERT_EQ(out["off.L.R"][i], 0.f);
    ASSERT_EQ(out["off.T.R"][i], 1.f);
  }
}

}  // namespace
}  // namespace brume::test
