// Frames in files: by chunks and held whole, parts of frames, channels of other files,
// files that are not what they should be.

#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <filesystem>
#include <fstream>

#include "frames.h"
#include "image/io.h"
#include "pipeline/frame_file.h"

namespace brume::test {
namespace {

namespace fs = std::filesystem;

const std::string kScene =
    "[output]\naovs = [\"T\", \"L\", \"height_fog.T\", "
    "\"height_fog.L\"]\n" +
    std::string(kCamera) +
    "[[stage]]\ntype = \"height_fog\"\ndensity = 0.001\nfalloff = "
    "0.01\ncolor = [0.4, 0.5, 0.6]\n";

class Files : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::temp_directory_path() / ("brume_file_test_" + std::to_string(getpid()));
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }

  Image image_of(const Pixels& p, const std::vector<std::string>& names) {
    Image image;
    image.header = source_of(p, {0, 0, 130, 75}, names).header;
    for (Channel& c : image.header.channels) c.type = PixelType::float32;
    for (const Channel& c : image.header.channels)
      image.planes.push_back(plane_of(p, c.name));
    return image;
  }
  fs::path write(const std::string& name, const Image& image) {
    write_image(image, folder / name);
    return folder / name;
  }
  FrameReport apply(const std::string& scene, const fs::path& in, const std::string& out,
                    ApplyOptions options = {}) {
    Session session(scene_of(registry, scene), registry);
    return apply_frame(session, 1, in, folder / out, options);
  }
  void expect_same(const Image& a, const Image& b) {
    ASSERT_EQ(a.header.data_window, b.header.data_window);
    ASSERT_EQ(a.header.channels.size(), b.header.channels.size());
    for (std::size_t k = 0; k < a.planes.size(); ++k) {
      ASSERT_EQ(a.header.channels[k].name, b.header.channels[k].name);
      for (std::size_t i = 0; i < a.planes[k].size(); ++i)
        ASSERT_EQ(std::bit_cast<std::uint32_t>(a.planes[k][i]),
                  std::bit_cast<std::uint32_t>(b.planes[k][i]))
            << a.header.channels[k].name << " " << i;
    }
  }

  Registry registry;
  fs::path folder;
  const std::vector<std::string> kAll{"A", "B", "G", "R", "Z"};
  Pixels pixels = make_pixels(130, 75);
};

TEST_F(Files, a_file_comes_out_as_the_pixels_in_memory_do) {
  const fs::path in = write("in.exr", image_of(pixels, kAll));
  const FrameReport report = apply(kScene, in, "out.exr");
  EXPECT_TRUE(report.copy.streamed);
  EXPECT_EQ(report.counts.pixels, 130u * 75u);
  Session session(scene_of(registry, kScene), registry);
  const Result want = apply_whole(session.prepare(source_of(pixels, {0, 0, 130, 75})),
                                  pixels, pixels.window);
  const Image out = read_image(folder / "out.exr");
  for (std::size_t k = 0; k < want.names.size(); ++k) {
    const int c = out.header.find(want.names[k]);
    ASSERT_GE(c, 0) << want.names[k];
    for (std::size_t i = 0; i < want.planes[k].size(); ++i)
      ASSERT_EQ(std::bit_cast<std::uint32_t>(out.planes[std::size_t(c)][i]),
                std::bit_cast<std::uint32_t>(want.planes[k][i]))
          << want.names[k] << " " << i;
  }
}

TEST_F(Files, band_height_and_threads_change_no_bit) {
  // ZIP has bands of 16 rows, ZIPS of 1, PIZ of 32: silhouettes look over every kind of
  // border.
  Image image = image_of(pixels, kAll);
  std::vector<Image> results;
  for (const Compression c :
       {Compression::zip, Compression::zips, Compression::piz, Compression::none})
    for (const int threads : {1, 3}) {
      image.header.compression = c;
      ApplyOptions options;
      options.threads = threads;
      apply(kScene, write("in.exr", image), "out.exr", options);
      results.push_back(read_image(folder / "out.exr"));
      expect_same(results.back(), results.front());
    }
}

TEST_F(Files, a_region_is_a_crop_of_the_whole) {
  const fs::path in = write("in.exr", image_of(pixels, kAll));
  apply(kScene, in, "whole.exr");
  ApplyOptions options;
  options.region = Window{31, 20, 47, 33};
  apply(kScene, in, "part.exr", options);
  const Image whole = read_image(folder / "whole.exr"),
              part = read_image(folder / "part.exr");
  ASSERT_EQ(part.header.data_window, (Window{31, 20, 47, 33}));
  ASSERT_EQ(part.header.channels, whole.header.channels);
  for (std::size_t k = 0; k < part.planes.size(); ++k)
    for (int y = 0; y < 33; ++y)
      for (int x = 0; x < 47; ++x)
        ASSERT_EQ(part.planes[k][std::size_t(y * 47 + x)],
                  whole.planes[k][std::size_t((20 + y) * 130 + 31 + x)])
            << part.header.channels[k].name;
}

TEST_F(Files, a_proxy_is_the_same_world_on_a_coarser_grid) {
  // Uniform depth and colour: the coarse picture is the fine one, each pixel near the
  // mean of those it covers.
  pixels.a.assign(pixels.a.size(), 1.f), pixels.z.assign(pixels.z.size(), 900.f);
  for (auto* p : {&pixels.r, &pixels.g, &pixels.b}) p->assign(p->size(), 0.25f);
  const fs::path in = write("in.exr", image_of(pixels, kAll));
  apply(kScene, in, "whole.exr");
  ApplyOptions options;
  options.proxy = 5;
  apply(kScene, in, "proxy.exr", options);
  const Image whole = read_image(folder / "whole.exr"),
              proxy = read_image(folder / "proxy.exr");
  ASSERT_EQ(proxy.header.data_window, (Window{0, 0, 26, 15}));
  const auto& fine = whole.planes[std::size_t(whole.header.find("R"))];
  const auto& coarse = proxy.planes[std::size_t(proxy.header.find("R"))];
  for (int y = 0; y < 15; ++y)
    for (int x = 0; x < 26; ++x)
      // The middle of the 5 x 5 block sees the ray of the proxy's pixel: the same pixel,
      // to the rounding of two ways to one ray.
      ASSERT_NEAR(coarse[std::size_t(y * 26 + x)],
                  fine[std::size_t((5 * y + 2) * 130 + 5 * x + 2)], 2e-6);
}

TEST_F(Files, depth_and_mask_from_files_of_their_own) {
  const fs::path whole = write("whole.exr", image_of(pixels, kAll));
  write("depth.0001.exr", image_of(pixels, {"Z"}));
  const fs::path color = write("color.exr", image_of(pixels, {"A", "B", "G", "R"}));
  apply(kScene, whole, "want.exr");
  apply("[input]\ndepth = \"" + (folder / "depth.####.exr").string() + ":Z\"\n" + kScene,
        color, "out.exr");
  const Image want = read_image(folder / "want.exr"),
              out = read_image(folder / "out.exr");
  for (const char* c : {"R", "G", "B", "A", "T.R", "L.B"})
    EXPECT_EQ(out.planes[std::size_t(out.header.find(c))],
              want.planes[std::size_t(want.header.find(c))])
        << c;
  EXPECT_LT(out.header.find("Z"), 0) << "the depth stays in its file";
}

TEST_F(Files, a_depth_of_another_size_is_refused) {
  Image small = image_of(make_pixels(60, 40), {"Z"});
  small.header.display_window = {0, 0, 60, 40};
  write("small.exr", small);
  const fs::path color = write("color.exr", image_of(pixels, {"A", "B", "G", "R"}));
  try {
    apply("[input]\ndepth = \"" + (folder / "small.exr").string() + ":Z\"\n" + kScene,
          color, "out.exr");
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("depth is 60x40 pixels"), std::string::npos)
        << e.what();
  }
  EXPECT_FALSE(fs::exists(folder / "out.exr"));
}

TEST_F(Files, a_scene_that_changes_nothing_copies_the_chunks) {
  const fs::path in = write("in.exr", image_of(pixels, kAll));
  const FrameReport report =
      apply("[[stage]]\ntype = \"height_fog\"\ndensity = 0\n", in, "out.exr");
  EXPECT_EQ(report.copy.chunks_copied, report.copy.chunks);
  EXPECT_GT(report.copy.chunks, 0u);
  expect_same(read_image(folder / "out.exr"), read_image(in));
}

TEST_F(Files, rows_that_no_stage_can_change_are_copied_unread) {
  const fs::path in = write("in.exr", image_of(pixels, kAll));
  const FrameReport report = apply(
      std::string(kCamera) + "[[stage]]\ntype = \"paint\"\nband = true\n", in, "out.exr");
  EXPECT_EQ(report.plan.active, (Window{0, 50, 130, 10}));
  EXPECT_EQ(report.copy.chunks, 5u) << "75 rows by 16";
  EXPECT_EQ(report.copy.chunks_copied, 4u) << "all but that of rows 48 to 63";
  const Image out = read_image(folder / "out.exr");
  const std::vector<float>& r = out.planes[std::size_t(out.header.find("R"))];
  for (int y = 0; y < 75; ++y)
    for (int x = 0; x < 130; ++x) {
      const std::size_t i = std::size_t(y * 130 + x);
      ASSERT_EQ(r[i], pixels.r[i] + (y >= 50 && y < 60 ? pixels.a[i] : 0.f))
          << x << "," << y;
    }
}

TEST_F(Files, provenance_tells_how_the_frame_was_made) {
  const fs::path in = write("in.exr", image_of(pixels, kAll));
  ApplyOptions options;
  options.provenance_scene = "tolerance = 0.001\n";
  apply(kScene, in, "out.exr", options);
  const auto headers = read_headers(folder / "out.exr");
  EXPECT_EQ(headers[0].attributes.at("brume/scene").text(), "tolerance = 0.001\n");
  EXPECT_NE(headers[0].attributes.at("brume/report").text()->find("height_fog"),
            std::string::npos);
  EXPECT_TRUE(headers[0].attributes.contains("brume/version"));
}

TEST_F(Files, a_failing_frame_leaves_no_file) {
  const fs::path in = write("in.exr", image_of(pixels, kAll));
  fs::resize_file(in, fs::file_size(in) / 2);
  EXPECT_THROW(apply(kScene, in, "out.exr"), Error);
  for (const auto& entry : fs::directory_iterator(folder))
    EXPECT_EQ(entry.path().filename(), "in.exr");
}

TEST_F(Files, a_report_is_json_with_every_step) {
  const fs::path in = write("in.exr", image_of(pixels, kAll));
  const FrameReport report = apply(kScene, in, "out.exr");
  const std::string json = report_json({&report, 1}, 1.0);
  for (const char* key :
       {"\"prepare\"", "\"read\"", "\"apply\"", "\"write\"", "\"ns_per_pixel\"",
        "\"bytes_read\"", "\"peak_memory_bytes\"", "\"why\""})
    EXPECT_NE(json.find(key), std::string::npos) << key;
}

}  // namespace
}  // namespace brume::test
